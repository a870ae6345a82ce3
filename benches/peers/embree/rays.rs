//! `rays FOLDER REPEATS`: traces the primary rays of the default camera on the teapot, one thread, and writes mesh, rays and hits
//! as raw little-endian arrays for another program to repeat; prints seconds as JSON.

use std::env;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use goniochrome::bvh::{Bvh, Node, Ray};
use goniochrome_cli::render::camera::{Camera, View};
use goniochrome_cli::render::mesh::{DEFAULT_LEVEL, Mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [folder, repeats] = &arguments[..] else { return Err("usage: rays FOLDER REPEATS".into()) };
    let mesh = Mesh::teapot(DEFAULT_LEVEL);
    let mut nodes = vec![Node::EMPTY; Bvh::required_nodes(mesh.triangles.len())];
    let mut order = vec![0; mesh.triangles.len()];
    let start = Instant::now();
    let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut nodes, &mut order)?;
    let build = start.elapsed().as_secs_f64();

    let (centre, radius) = mesh.bounding_sphere();
    let camera = Camera::new(&View::default(), centre, radius)?;
    let [width, height] = camera.size;
    let middle = |i: u32| (f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
    let rays: Vec<Ray> = (0..width * height)
        .map(|i| {
            let (x, y) = middle(i);
            Ray { origin: camera.eye, direction: camera.direction(x, y), t_min: 0.0, t_max: f64::INFINITY }
        })
        .collect();
    let mut seconds = Vec::new();
    let mut hits = Vec::new();
    for _ in 0..repeats.parse::<usize>()? {
        let start = Instant::now();
        hits = black_box(&rays).iter().map(|ray| bvh.closest(ray, |_| true)).collect();
        seconds.push(start.elapsed().as_secs_f64());
    }

    let write = |name: &str, bytes: Vec<u8>| fs::write(Path::new(folder).join(name), bytes);
    let points = |points: &mut dyn Iterator<Item = [f64; 3]>| -> Vec<u8> {
        points.flatten().flat_map(|x| (x as f32).to_le_bytes()).collect()
    };
    write("vertices.f32", points(&mut mesh.positions.iter().map(|p| p.to_array())))?;
    write("triangles.i32", mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect())?;
    write("directions.f32", points(&mut rays.iter().map(|ray| ray.direction.to_array())))?;
    write("distances.f64", hits.iter().flat_map(|hit| hit.map_or(f64::INFINITY, |hit| hit.t).to_le_bytes()).collect())?;
    println!("{}", serde_json::json!({ "seconds": seconds, "build": build, "eye": camera.eye.to_array() }));
    Ok(())
}
