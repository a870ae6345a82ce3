//! Fuzzing of meshes from any text: as a mesh to render, as the mesh of a cell, and as a cell.

use goniochrome::optics::interface::{Below, Interface};
use goniochrome_cli::render::mesh::{Axes, TriangleMesh};
use goniochrome_cli::scene::{self, NamedInterface, NamedMedium, OwnedMedium, Shape};

/// Checks any bytes that are text.
pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    rendered(text);
    let mesh = match scene::parse_mesh("fuzz.obj", text, &["top", "mirror"]) {
        Err(error) => return assert!(!error.to_string().contains('\n')),
        Ok(mesh) => mesh,
    };
    let count = mesh.vertices.len();
    assert!(!mesh.triangles.is_empty());
    assert!(mesh.triangles.iter().all(|t| t.interface < 2 && t.vertices.iter().all(|&v| (v as usize) < count)));
    let medium = |n: f64| NamedMedium { name: n.to_string(), medium: OwnedMedium::constant(n, 0.0).expect("passive") };
    let interface = |name: &str, above, below| NamedInterface {
        name: name.to_owned(),
        interface: Interface { above, below },
        coating: Vec::new(),
    };
    let interfaces = [interface("top", 0, Below::Medium(1)), interface("mirror", 1, Below::Mirror)];
    match Shape::of_mesh(mesh, [9.0, 9.0], interfaces.to_vec(), &[medium(1.0), medium(1.5)]) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok(Shape::Planes(flat)) => assert!(flat.planes().windows(2).all(|pair| pair[0].z_nm >= pair[1].z_nm)),
        Ok(shape) => assert!(shape.polygons().is_some()),
    }
}

/// Checks that a mesh to render has triangles with unit normals.
fn rendered(text: &str) {
    match TriangleMesh::from_obj("fuzz.obj", text, Axes::YUp) {
        Err(error) => assert!(!error.to_string().contains('\n')),
        Ok((mesh, repairs)) => {
            let count = mesh.positions.len();
            assert!(repairs.triangles > 0 && repairs.triangles == mesh.triangles.len());
            assert!(mesh.triangles.iter().flatten().all(|&corner| (corner as usize) < count));
            assert!(mesh.positions.iter().all(|position| position.is_finite()));
            assert!(mesh.normals.iter().all(|normal| (normal.length() - 1.0).abs() < 1e-9));
        }
    }
}
