extern crate std;

mod meshes;
mod structure;
mod nearest;
mod watertight;
mod batch;

use super::leaf::{Leaf, Shear, TERMS, WINDOW, exact_cross, terms};
use super::node::{Child, MAX_DEPTH, WIDTH};
use super::{Bvh, BvhError, Hit, Node, Ray};
use glam::DVec3;
use meshes::{bumpy_sphere, sheet, slab, soup};
use std::vec::Vec;
use std::{print, println, vec};

/// Vertices and triangles.
#[derive(Clone)]
struct Mesh(Vec<DVec3>, Vec<[u32; 3]>);

/// The memory of a hierarchy.
struct Memory(Vec<Node>, Vec<u32>, Vec<f64>);

impl Mesh {
    fn memory(&self) -> Memory {
        let count = self.1.len();
        Memory(vec![Node::EMPTY; Bvh::required_nodes(count)], vec![0; count], vec![0.0; Bvh::required_corners(count)])
    }

    fn bvh<'a>(&'a self, memory: &'a mut Memory) -> Bvh<'a> {
        let bvh = Bvh::build(&self.0, &self.1, &mut memory.0, &mut memory.1, &mut memory.2).unwrap();
        check_structure(&bvh);
        bvh
    }

    fn moved(mut self, scale: f64, by: DVec3) -> Self {
        self.0.iter_mut().for_each(|v| *v = *v * scale + by);
        self
    }
}

/// Random numbers, vectors and directions.
struct RandomVectors(crate::trace::random::Random);

impl RandomVectors {
    fn new(seed: u32) -> Self {
        Self(crate::trace::random::Random::new(0, seed))
    }

    /// A number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.0.next()
    }

    /// A point of the cube [−1, 1)³.
    fn cube(&mut self) -> DVec3 {
        DVec3::new(2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0)
    }

    /// A direction, often along an axis, in a coordinate plane or nearly horizontal.
    fn direction(&mut self) -> DVec3 {
        let d = self.cube();
        match (8.0 * self.unit()) as u32 {
            0 => DVec3::Z * if d.z < 0.0 { -1.0 } else { 1.0 },
            1 => DVec3::X * if d.x < 0.0 { -1.0 } else { 1.0 },
            2 => DVec3::new(0.0, d.y, d.z),
            3 => DVec3::new(d.x, d.y, -0.0),
            4 => DVec3::new(d.x, d.y, 1e-4 * d.z),
            _ => d,
        }
    }
}

/// Checks that the depth is within bounds, every triangle in one leaf, and every box around its triangles. Returns the
/// depth.
fn check_structure(bvh: &Bvh) -> usize {
    let mut seen = vec![false; bvh.triangles.len()];
    let (mut deepest, mut visited) = (0, 0);
    let all = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    let mut waiting = vec![(0usize, 1usize, all)];
    while let Some((node, depth, outer)) = waiting.pop() {
        deepest = deepest.max(depth);
        visited += 1;
        let node = &bvh.nodes[node];
        for i in 0..WIDTH {
            let side = |s: usize| core::array::from_fn(|axis| f64::from(node.bounds[axis][s][i]));
            let inner: [[f64; 3]; 2] = [side(0), side(1)];
            let (first, count) = (node.children[i].index(), node.children[i].count());
            if inner[0][0] == f64::INFINITY {
                assert_eq!(count, 0);
                continue;
            }
            assert!((0..3).all(|axis| inner[0][axis] >= outer[0][axis] && inner[1][axis] <= outer[1][axis]));
            if count == 0 {
                waiting.push((first, depth + 1, inner));
            }
            let leaf = (count > 0).then(|| Leaf::new(bvh.corners, Child::leaf(first, count)).unwrap());
            for triangle in leaf.iter().flat_map(|leaf| (0..count).map(|i| leaf.triangle(i) as usize)) {
                assert!(!core::mem::replace(&mut seen[triangle], true));
                for vertex in bvh.triangles[triangle] {
                    let v = ((bvh.vertices[vertex as usize] - bvh.frame.centre) * bvh.frame.scale).to_array();
                    assert!((0..3).all(|axis| inner[0][axis] < v[axis] && v[axis] < inner[1][axis]));
                }
            }
        }
    }
    let kept = seen.iter().filter(|seen| **seen).count();
    assert_eq!(bvh.corners.len(), Bvh::required_corners(kept));
    assert_eq!(visited, bvh.nodes.len());
    assert!(deepest <= MAX_DEPTH);
    deepest
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
}

/// The nearest hit by the triangle test of the hierarchy, on every triangle in turn.
fn nearest_of_all(mesh: &Mesh, ray: &Ray) -> Option<Hit> {
    let shear = Shear::new(ray);
    let hit = |(triangle, corners): (u32, &[u32; 3])| {
        let mut numbers = [0.0; WINDOW];
        numbers[..TERMS].copy_from_slice(&terms(corners.map(|v| mesh.0[v as usize]), triangle));
        let mut found = None;
        shear.intersect(Leaf::new(&numbers, Child::leaf(0, 1)).unwrap(), |hit| found = Some(hit));
        found
    };
    let hits = (0..).zip(&mesh.1).filter_map(hit);
    let inside = hits.filter(|hit| (ray.t_min..=ray.t_max).contains(&hit.t));
    inside.reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Run with `cargo test --release -p goniochrome bvh::tests::timing -- --ignored --nocapture`.
#[test]
#[ignore = "prints times"]
fn timing() {
    for cells in [50, 224, 707] {
        let mesh = sheet(cells);
        let mut memory = mesh.memory();
        let start = std::time::Instant::now();
        let bvh = Bvh::build(&mesh.0, &mesh.1, &mut memory.0, &mut memory.1, &mut memory.2).unwrap();
        print!(
            "{} triangles, {} nodes: built in {:.3} s",
            mesh.1.len(),
            bvh.nodes.len(),
            start.elapsed().as_secs_f64()
        );
        let mut random = RandomVectors::new(8);
        let down: Vec<Ray> = (0..1_000_000)
            .map(|_| {
                let (p, d) = (random.cube(), random.cube());
                ray(DVec3::new(p.x, p.y, 0.2), DVec3::new(d.x, d.y, -d.z.abs()))
            })
            .collect();
        // From where those hit, in any direction upwards: what a tracer does.
        let from_surface: Vec<Ray> = down
            .iter()
            .map(|r| {
                let t = bvh.intersect_nearest(r, |_| true).map_or(0.0, |hit| hit.t);
                let d = random.cube();
                ray(r.origin + r.direction * t, DVec3::new(d.x, d.y, d.z.abs()))
            })
            .collect();
        for (name, rays, t_min) in [("from above", down, 0.0), ("from the surface", from_surface, 1e-9)] {
            let start = std::time::Instant::now();
            let hits = rays.iter().filter(|r| bvh.intersect_nearest(&Ray { t_min, ..**r }, |_| true).is_some()).count();
            let rate = rays.len() as f64 / start.elapsed().as_secs_f64();
            print!("; {name} {:.2} M rays/s ({hits} hits)", rate / 1e6);
        }
        println!();
    }
}
