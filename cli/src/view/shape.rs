//! The meshes of a page.

use std::f64::consts::TAU;

use glam::DVec3;
use serde_json::{Value, json};

use super::pack;
use crate::render::body::{Body, BodyShape, BvhMemory, DISC_HOLE};
use crate::render::mesh::TriangleMesh;
use crate::render::thickness::ThicknessMap;
use crate::support::error::Result;

/// Segments along each edge of a patch of the teapot: no silhouette is off by a third of a pixel at 1024 pixels.
const TEAPOT_LEVEL: u32 = 18;

/// A quarter of the segments around the sphere: facets lie less than a tenth of a pixel below it at 1024 pixels.
const SPHERE_LEVEL: u32 = 32;

/// Segments around the disc: its edge lies less than a twentieth of a pixel inside the circle at 1024 pixels.
const DISC_SEGMENTS: u32 = 256;

/// Segments along each side of the plane, for films whose thickness varies over it.
const PLANE_SEGMENTS: u32 = 64;

/// All meshes of a page, with the thickness of a film at their vertices.
///
/// # Errors
/// Too little memory.
pub(super) fn packed(thickness: Option<&ThicknessMap>) -> Result<Value> {
    let mut meshes = json!({});
    for (name, mesh) in [
        ("teapot", TriangleMesh::teapot(TEAPOT_LEVEL)),
        ("sphere", TriangleMesh::sphere(SPHERE_LEVEL)),
        ("plane", plane()),
        ("disc", disc()),
    ] {
        meshes[name] = packed_mesh(&mesh);
        if let Some(map) = thickness {
            meshes[name]["shares"] = shares(mesh, map)?;
        }
    }
    Ok(meshes)
}

/// Shares of the way from the first thickness to the last at the vertices of a mesh, as numbers of 16 bits.
fn shares(mesh: TriangleMesh, map: &ThicknessMap) -> Result<Value> {
    let shape = BodyShape::Mesh(mesh);
    let mut memory = BvhMemory::default();
    let body = Body::new(&shape, &mut memory)?;
    let BodyShape::Mesh(mesh) = &shape else { unreachable!("made above") };
    let mut shares = vec![0u16; mesh.positions.len()];
    for (triangle, corners) in (0..).zip(&mesh.triangles) {
        for &corner in corners {
            let share = map.at(&body, triangle, mesh.positions[corner as usize]);
            shares[corner as usize] = (share * f64::from(u16::MAX)).round() as u16;
        }
    }
    Ok(pack::indices(shares))
}

/// The square of `render`, with more vertices.
fn plane() -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let at = |step: u32| 2.0 * f64::from(step) / f64::from(PLANE_SEGMENTS) - 1.0;
    for row in 0..=PLANE_SEGMENTS {
        for column in 0..=PLANE_SEGMENTS {
            let (x, y) = (at(column), at(row));
            mesh.push(DVec3::new(x, y, 0.0), DVec3::Z, DVec3::X);
            mesh.textures.push([0.5 + 0.5 * x, 0.5 + 0.5 * y]);
        }
    }
    mesh.grid(0, PLANE_SEGMENTS, PLANE_SEGMENTS, true);
    mesh
}

/// The disc of `render` as a mesh. Its tangents are its positions: linear between vertices, they point exactly away
/// from the middle everywhere, which vectors of unit length would not.
fn disc() -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for radius in [DISC_HOLE, 1.0] {
        for segment in 0..=DISC_SEGMENTS {
            let (sin, cos) = (TAU * f64::from(segment % DISC_SEGMENTS) / f64::from(DISC_SEGMENTS)).sin_cos();
            mesh.push(radius * DVec3::new(cos, sin, 0.0), DVec3::Z, DVec3::X);
            mesh.textures.push([0.5 + 0.5 * radius * cos, 0.5 + 0.5 * radius * sin]);
        }
    }
    mesh.grid(0, DISC_SEGMENTS, 1, false);
    mesh.tangents.clone_from(&mesh.positions);
    mesh
}

/// A mesh, with positions relative to the centre of its bounding sphere, in its radii.
fn packed_mesh(mesh: &TriangleMesh) -> Value {
    let (centre, radius) = mesh.bounding_sphere();
    let numbers = |list: &[DVec3]| pack::signed(list.iter().flat_map(|v| v.to_array()));
    let index = |i: &u32| u16::try_from(*i).expect("the meshes of a page have less than 65536 vertices");
    json!({
        "positions": pack::signed(mesh.positions.iter().flat_map(|p| ((*p - centre) / radius).to_array())),
        "normals": numbers(&mesh.normals),
        "tangents": numbers(&mesh.tangents),
        "triangles": pack::indices(mesh.triangles.iter().flatten().map(index)),
    })
}
