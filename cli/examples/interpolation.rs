//! How far tables of cells are off between their directions: presets against direct tracing, in the boxes of the table.
//!
//!     cargo run --release -p goniochrome-cli --example interpolation -- beetle-pits [theta phi u v rays coherence]

use std::time::Instant;

use goniochrome::table::{HalfVectorGrid, HalfVectorWarp, LobeDirection, ScatterLayout, tent_solid_angles};
use goniochrome_cli::colour::visible_weights;
use goniochrome_cli::scene::load;
use goniochrome_cli::solve::cell_table::{TableRequest, default_rays, default_sides, estimate};
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Tracing, scatter};
use goniochrome_cli::table::scatter::ScatterTable;

/// Powers of the table in each place, for light from wi.
fn of_table(table: &ScatterTable, pairs: &[Vec<f32>; 2], wi: glam::DVec3) -> Vec<f64> {
    let layout = table.layout;
    let warp = HalfVectorWarp::from_pairs(&pairs[0], &pairs[1]).unwrap();
    let wi = wi.as_vec3();
    let origin = if layout.is_isotropic() { wi.y.atan2(wi.x) } else { 0.0 };
    let mut area = vec![0.0; layout.node_count()];
    tent_solid_angles(&layout, &warp, wi, origin, |node, part| area[node] += f64::from(part / wi.z));
    let nodes = layout.incident_nodes(wi);
    let columns = layout.square_sides()[0] as usize;
    let mut power = vec![0.0; layout.places()];
    for place in 0..layout.places() {
        let value: f64 = nodes.iter().map(|n| f64::from(n.weight) * f64::from(table.row(n.index, 0)[place])).sum();
        if place >= layout.node_count() {
            power[place] = value;
        } else if place % columns == 0 {
            power[0] += value * area[place];
        } else {
            power[place] = value * area[place];
        }
    }
    power
}

fn direction(theta: f64, phi: f64) -> glam::DVec3 {
    glam::DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: u32| args.get(i).map_or(default, |a| a.parse().unwrap());
    let scene = load(&args[0]).unwrap();
    let mesh_scene = MeshScene::new(&scene).unwrap();
    let coherence = match args.get(6).map(String::as_str) {
        Some("ray") => Coherence::Ray,
        _ => Coherence::None,
    };
    let wavelength = [550.0];
    let rays = number(5, default_rays(&mesh_scene));
    let sides = default_sides(&mesh_scene);
    let tracing = Tracing { coherence, rays, seed: 0, precision: Precision::F32, threads: 2 };
    let weights = visible_weights(
        &wavelength,
        goniochrome::colour::Illuminant::D65,
        goniochrome::colour::Quadrature::Interpolated,
    )
    .unwrap();
    let request = TableRequest {
        incident: [number(1, sides.incident[0]), number(2, sides.incident[1])],
        half_vectors: [number(3, sides.half_vectors[0]), number(4, sides.half_vectors[1])],
        tracing,
        target_error: None,
        weights: &weights,
        space: goniochrome::colour::RgbSpace::Srgb,
        reciprocal: false,
    };
    let start = Instant::now();
    let table = estimate(&mesh_scene, &wavelength, &request, None, &|| ()).unwrap();
    println!(
        "{}: {:?} {:.1} s, {} lobes, error {:.1e}",
        scene.name,
        table.layout,
        start.elapsed().as_secs_f64(),
        table.lobes.len(),
        table.worst_error()
    );
    let [u, v] = &table.warp;
    let mut memory = vec![0.0; HalfVectorWarp::required_len([u.len(), v.len()])];
    HalfVectorWarp::new([u, v], &mut memory).unwrap();
    let of_v = memory.split_off(2 * u.len());
    let pairs = [memory, of_v];
    let warp = HalfVectorWarp::from_pairs(&pairs[0], &pairs[1]).unwrap();
    let golden = |i: usize, step: f64| (i as f64 * step).fract();
    let random = (1..=10).map(|i| [golden(i, 0.618_034).sqrt().asin().to_degrees(), 360.0 * golden(i, 0.754_877)]);
    let mut worst: f64 = 0.0;
    for [theta, phi] in [[34.0, 15.0], [56.0, 15.0], [34.0, 45.0], [56.0, 75.0]].into_iter().chain(random) {
        let wi = direction(theta.to_radians(), phi.to_radians());
        let mut lobes: Vec<LobeDirection> = table
            .lobes
            .iter()
            .enumerate()
            .filter_map(|(lobe, map)| {
                Some(LobeDirection { direction: map.direction(wi.as_vec3())?.as_dvec3().normalize(), lobe })
            })
            .collect();
        lobes.sort_by(|a, b| a.direction.x.total_cmp(&b.direction.x));
        let grid = HalfVectorGrid::new(table.layout, warp, wi, &lobes);
        let direct_rays = if coherence == Coherence::Ray { 1 << 15 } else { 1 << 18 };
        let request = ScatterRequest {
            coherence,
            rays: direct_rays,
            seed: 7,
            bins: &grid,
            precision: Precision::F32,
            threads: 2,
        };
        let direct = &scatter(&mesh_scene, wi, &wavelength, &request, &|| ()).unwrap()[0];
        let power = of_table(&table, &pairs, wi);
        let (mut difference, mut sum, mut whole, mut noise, mut lobe) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (place, (bin, power)) in direct.bins.iter().zip(&power).enumerate() {
            difference += (bin.value - power).abs();
            sum += bin.value;
            whole += power;
            noise += 0.8 * bin.std_error;
            if place >= table.layout.node_count() {
                lobe += (bin.value - power).abs();
            }
        }
        worst = worst.max(difference / sum);
        println!(
            "  {theta:5.1} {phi:5.1}: L1 {:.3} (lobes {:.3}, noise of the reference {:.3}), albedo {:.4} for {:.4} ({:+.2} %)",
            difference / sum,
            lobe / sum,
            noise / sum,
            whole,
            sum,
            100.0 * (whole / sum - 1.0)
        );
    }
    println!("  worst {worst:.3}");
    let _ = ScatterLayout::THETA_MAX;
}
