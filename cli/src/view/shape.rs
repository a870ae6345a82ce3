//! The meshes of a page.

use std::f64::consts::TAU;

use glam::DVec3;
use serde_json::{Value, json};

use super::pack;
use crate::render::body::DISC_HOLE;
use crate::render::mesh::TriangleMesh;

/// Segments along each edge of a patch of the teapot: no silhouette is off by a third of a pixel at 1024 pixels.
const TEAPOT_LEVEL: u32 = 18;

/// A quarter of the segments around the sphere: facets lie less than a tenth of a pixel below it at 1024 pixels.
const SPHERE_LEVEL: u32 = 32;

/// Segments around the disc: its edge lies less than a twentieth of a pixel inside the circle at 1024 pixels.
const DISC_SEGMENTS: u32 = 256;

/// All meshes of a page.
pub(super) fn packed() -> Value {
    json!({
        "teapot": mesh(&TriangleMesh::teapot(TEAPOT_LEVEL)),
        "sphere": mesh(&TriangleMesh::sphere(SPHERE_LEVEL)),
        "plane": mesh(&TriangleMesh::plane()),
        "disc": mesh(&disc()),
    })
}

/// The disc of `render` as a mesh. Its tangents are its positions: linear between vertices, they point exactly away
/// from the middle everywhere, which vectors of unit length would not.
fn disc() -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for radius in [DISC_HOLE, 1.0] {
        for segment in 0..=DISC_SEGMENTS {
            let (sin, cos) = (TAU * f64::from(segment % DISC_SEGMENTS) / f64::from(DISC_SEGMENTS)).sin_cos();
            mesh.push(radius * DVec3::new(cos, sin, 0.0), DVec3::Z, DVec3::X);
        }
    }
    mesh.grid(0, DISC_SEGMENTS, 1, false);
    mesh.tangents.clone_from(&mesh.positions);
    mesh
}

/// A mesh, with positions relative to the centre of its bounding sphere, in its radii.
fn mesh(mesh: &TriangleMesh) -> Value {
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
