//! The meshes of a page.

use serde_json::{Value, json};

use super::pack;
use crate::render::mesh::TriangleMesh;

/// Segments along each edge of a patch of the teapot: no silhouette is off by a third of a pixel at 1024 pixels.
const TEAPOT_LEVEL: u32 = 18;

/// A quarter of the segments around the sphere: facets lie less than a tenth of a pixel below it at 1024 pixels.
const SPHERE_LEVEL: u32 = 32;

/// All meshes of a page, with tangents only if the surface needs them.
pub(super) fn packed(tangents: bool) -> Value {
    json!({
        "teapot": mesh(&TriangleMesh::teapot(TEAPOT_LEVEL), tangents),
        "sphere": mesh(&TriangleMesh::sphere(SPHERE_LEVEL), tangents),
        "plane": mesh(&TriangleMesh::plane(), tangents),
    })
}

/// A mesh, with positions relative to the centre of its bounding sphere, in its radii.
fn mesh(mesh: &TriangleMesh, tangents: bool) -> Value {
    let (centre, radius) = mesh.bounding_sphere();
    let numbers = |list: &[glam::DVec3]| pack::signed(list.iter().flat_map(|v| v.to_array()));
    let index = |i: &u32| u16::try_from(*i).expect("the meshes of a page have less than 65536 vertices");
    let mut packed = json!({
        "positions": pack::signed(mesh.positions.iter().flat_map(|p| ((*p - centre) / radius).to_array())),
        "normals": numbers(&mesh.normals),
        "triangles": pack::indices(mesh.triangles.iter().flatten().map(index)),
    });
    if tangents {
        packed["tangents"] = numbers(&mesh.tangents);
    }
    packed
}
