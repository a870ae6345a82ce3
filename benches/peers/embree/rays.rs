//! `rays FOLDER REPEATS LEVEL primary|incoherent`: finds nearest hits on a teapot of `LEVEL`² quads a patch, one
//! thread. Writes the mesh, the rays and the hits as raw little-endian arrays, with which another program can repeat
//! it, and prints seconds as JSON.
//!
//! Primary rays are those of the default camera. Incoherent ones run from random points of the mesh's bounding sphere
//! through random points of its box.

use std::env;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Hit, Node, Ray};
use goniochrome_benches::clock::processor_time;
use goniochrome_benches::stages;
use goniochrome_cli::render::camera::{Camera, View};
use goniochrome_cli::render::mesh::TriangleMesh;

const INCOHERENT: usize = 1 << 20;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, repeats, level, kind] = &arguments[..] else {
        return Err("usage: rays FOLDER REPEATS LEVEL primary|incoherent".into());
    };
    let mesh = TriangleMesh::teapot(level.parse()?);
    let mut nodes = vec![Node::EMPTY; Bvh::required_nodes(mesh.triangles.len())];
    let mut order = vec![0; mesh.triangles.len()];
    let mut corners = vec![0.0; Bvh::required_corners(mesh.triangles.len())];
    let start = Instant::now();
    let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut nodes, &mut order, &mut corners)?;
    let build = start.elapsed().as_secs_f64();

    // Both programs get the same rays: in single precision, which is what the other one takes.
    let rays: Vec<Ray> = if kind == "primary" { primary(&mesh)? } else { stages::incoherent(&mesh, INCOHERENT) };
    let (mut one_by_one, mut batch) = (Vec::new(), Vec::new());
    // Its pages are touched once: faults cost as much as a tenth of the rays.
    let (mut found, mut hits): (Vec<Option<Hit>>, Vec<Option<Hit>>) = (vec![None; rays.len()], vec![None; rays.len()]);
    for _ in 0..repeats.parse::<usize>()? {
        let ((), time) = processor_time(|| {
            for (hit, ray) in found.iter_mut().zip(black_box(&rays)) {
                *hit = bvh.intersect_nearest(ray, |_| true);
            }
        });
        one_by_one.push(time.as_secs_f64());
        let ((), time) = processor_time(|| bvh.intersect_batch(black_box(&rays), &mut hits, |_, _| true));
        batch.push(time.as_secs_f64());
        if found != hits {
            return Err("hits differ in a batch".into());
        }
    }

    let write = |name: &str, bytes: Vec<u8>| fs::write(Path::new(folder).join(name), bytes);
    let points = |points: &mut dyn Iterator<Item = [f64; 3]>| -> Vec<u8> {
        points.flatten().flat_map(|x| (x as f32).to_le_bytes()).collect()
    };
    write("vertices.f32", points(&mut mesh.positions.iter().map(|p| p.to_array())))?;
    write("triangles.i32", mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect())?;
    write("origins.f32", points(&mut rays.iter().map(|ray| ray.origin.to_array())))?;
    write("directions.f32", points(&mut rays.iter().map(|ray| ray.direction.to_array())))?;
    write("distances.f64", hits.iter().flat_map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t).to_le_bytes()).collect())?;
    println!("{}", serde_json::json!({ "one by one": one_by_one, "batch": batch, "build": build }));
    Ok(())
}

/// A ray from `origin`, rounded to single precision.
fn ray(origin: DVec3, direction: DVec3) -> Ray {
    let single = |v: DVec3| v.as_vec3().as_dvec3();
    Ray { origin: single(origin), direction: single(direction), t_min: 0.0, t_max: f64::INFINITY }
}

/// The rays of the default camera, through the middle of each pixel.
fn primary(mesh: &TriangleMesh) -> Result<Vec<Ray>, Box<dyn Error>> {
    let (centre, radius) = mesh.bounding_sphere();
    let camera = Camera::new(&View::default(), centre, radius)?;
    let [width, height] = camera.size;
    let middle = |i: u32| (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
    Ok((0..width * height)
        .map(|i| {
            let (x, y) = middle(i);
            ray(camera.eye, camera.direction(x, y))
        })
        .collect())
}
