use std::f64::consts::TAU;
use std::hint::black_box;

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Node, Ray};
use goniochrome::trace::random::Random;
use goniochrome_cli::render::mesh::TriangleMesh;

use super::{Visit, Work};

const RAYS: usize = 1000;

/// The hierarchy of a teapot of 5112 triangles: building it, and incoherent rays through it.
///
/// # Panics
/// If a result is wrong.
pub fn bvh(visit: Visit<'_>) {
    let mesh = TriangleMesh::teapot(9);
    let count = mesh.triangles.len();
    let mut nodes = vec![Node::EMPTY; Bvh::required_nodes(count)];
    let (mut order, mut corners) = (vec![0; count], vec![0.0; Bvh::required_corners(count)]);
    visit(&Work { stage: "bvh", name: "build", unit: "triangles", amount: count as f64 }, &mut || {
        let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut nodes, &mut order, &mut corners);
        black_box(bvh.expect("a good mesh"));
    });
    let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut nodes, &mut order, &mut corners).expect("a good mesh");
    let rays = incoherent(&mesh, RAYS);
    let hits = rays.iter().filter(|ray| bvh.intersect_nearest(ray, |_| true).is_some()).count();
    assert!((RAYS / 2..RAYS).contains(&hits), "{hits}");
    visit(&Work { stage: "bvh", name: "nearest hit", unit: "rays", amount: RAYS as f64 }, &mut || {
        for ray in black_box(&rays) {
            black_box(bvh.intersect_nearest(ray, |_| true));
        }
    });
    let mut found = vec![None; RAYS];
    bvh.intersect_batch(&rays, &mut found, |_, _| true);
    assert!(rays.iter().map(|ray| bvh.intersect_nearest(ray, |_| true)).eq(found.iter().copied()));
    visit(&Work { stage: "bvh", name: "nearest hits, batch", unit: "rays", amount: RAYS as f64 }, &mut || {
        bvh.intersect_batch(black_box(&rays), &mut found, |_, _| true);
        black_box(&found);
    });
}

/// Incoherent rays: from random points of the mesh's bounding sphere, through random points of its box.
#[must_use]
pub fn incoherent(mesh: &TriangleMesh, count: usize) -> Vec<Ray> {
    let (centre, radius) = mesh.bounding_sphere();
    let min = mesh.positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let max = mesh.positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let mut random = Random::new(0, 1);
    let single = |v: DVec3| v.as_vec3().as_dvec3();
    (0..count)
        .map(|_| {
            let (z, phi) = (2.0 * random.next() - 1.0, TAU * random.next());
            let s = (1.0 - z * z).sqrt();
            let origin = single(centre + radius * DVec3::new(s * phi.cos(), s * phi.sin(), z));
            let through = DVec3::new(random.next(), random.next(), random.next());
            let direction = single((min + through * (max - min) - origin).normalize());
            Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
        })
        .collect()
}
