//! `scaling [PLOT.svg]`: measures how cost grows with layers, wavelengths, polygons, rays and threads. Prints
//! exponents, fitted to the logarithms by least squares, and plots the curves.

use std::env;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Node};
use goniochrome::measure::bins::DirectionBins;
use goniochrome::optics::interface::Model;
use goniochrome::simd::lanes::F32;
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome_benches::clock::processor_time;
use goniochrome_benches::{LIMITS, MAX_PLANES, contrast, group, stages, twenty_layers};
use goniochrome_cli::render::mesh::TriangleMesh;
use goniochrome_cli::scene::load;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, scatter};
use goniochrome_cli::solve::spectra::{Method, SpectraRequest, spectra};

/// Costs in seconds at several sizes.
struct Curve {
    name: &'static str,
    points: Vec<[f64; 2]>,
}

impl Curve {
    fn of(name: &'static str, sizes: &[usize], mut cost: impl FnMut(usize) -> f64) -> Self {
        let points = sizes.iter().map(|&size| [size as f64, least(|| cost(size))]).collect();
        Self { name, points }
    }

    /// The slope of ln cost over ln size.
    fn exponent(&self) -> f64 {
        let logs: Vec<[f64; 2]> = self.points.iter().map(|point| point.map(f64::ln)).collect();
        let count = logs.len() as f64;
        let mean: [f64; 2] = std::array::from_fn(|axis| logs.iter().map(|log| log[axis]).sum::<f64>() / count);
        let sum = |other: usize| logs.iter().map(|log| (log[0] - mean[0]) * (log[other] - mean[other])).sum::<f64>();
        sum(1) / sum(0)
    }
}

/// The least of three measurements.
fn least(mut cost: impl FnMut() -> f64) -> f64 {
    (0..3).map(|_| cost()).fold(f64::MAX, f64::min)
}

/// Seconds of one trace through so many layers.
fn layers(summation: Summation) -> impl FnMut(usize) -> f64 {
    move |layers| {
        let mut workspace = Box::new(Workspace::<F32, MAX_PLANES>::new());
        contrast(layers).with_prepared::<F32, _>(0.0, &group::<F32>(), |prepared| {
            let repeats = 2000 / layers + 1;
            let run = || {
                for _ in 0..repeats {
                    black_box(
                        trace_planar(black_box(prepared), summation, workspace.memory()).expect("the stack fits"),
                    );
                }
            };
            processor_time(run).1.as_secs_f64() / repeats as f64
        })
    }
}

/// Seconds of the 20-layer stack's spectra at so many wavelengths.
fn wavelengths(count: usize) -> f64 {
    let scene = twenty_layers();
    let planar = PlanarScene::new(&scene).expect("a planar scene");
    let theta: Vec<f64> = (0..90).map(f64::from).collect();
    let wavelengths: Vec<f64> = (0..count).map(|i| 380.0 + 400.0 * i as f64 / count as f64).collect();
    let request =
        SpectraRequest { model: Model::Physical, method: Method::Trace, precision: Precision::F32, threads: 1 };
    let run = || {
        for _ in 0..8 {
            black_box(spectra(&planar, &theta, &wavelengths, &request, &|| ()).expect("a good grid"));
        }
    };
    processor_time(run).1.as_secs_f64() / 8.0
}

/// Number of triangles of a teapot with `level` quads along each patch, and seconds of one ray through it.
fn polygons(level: usize) -> [f64; 2] {
    let mesh = TriangleMesh::teapot(level as u32);
    let count = mesh.triangles.len();
    let mut nodes = vec![Node::EMPTY; Bvh::required_nodes(count)];
    let (mut order, mut corners) = (vec![0; count], vec![0.0; Bvh::required_corners(count)]);
    let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut nodes, &mut order, &mut corners).expect("a good mesh");
    let rays = stages::incoherent(&mesh, 200_000);
    let run = || {
        for ray in &rays {
            black_box(bvh.intersect_nearest(ray, |_| true));
        }
    };
    let seconds = least(|| processor_time(run).1.as_secs_f64());
    [count as f64, seconds / rays.len() as f64]
}

/// Processor and wall-clock seconds of so many starting rays in the bumpy soap film.
fn rays(count: usize, threads: usize) -> [f64; 2] {
    let scene = load("bumpy-soap-film").expect("a preset");
    let mesh_scene = MeshScene::new(&scene).expect("a cell");
    let request = ScatterRequest {
        coherence: Coherence::None,
        rays: count as u32,
        seed: 1,
        bins: DirectionBins { cos: 16, phi: 32 },
        precision: Precision::F32,
        threads,
    };
    let wi = DVec3::new(0.5, 0.0, 0.75_f64.sqrt());
    let start = Instant::now();
    let (found, used) = processor_time(|| scatter(&mesh_scene, wi, &[450.0, 550.0, 650.0], &request, &|| ()));
    black_box(found.expect("a good cell"));
    [used.as_secs_f64(), start.elapsed().as_secs_f64()]
}

fn main() -> Result<(), Box<dyn Error>> {
    let plot = env::args().nth(1);
    let curves = [
        Curve::of("layers, loops closed", &[4, 8, 15, 30, 60], layers(Summation::ClosedLoops)),
        Curve::of("layers, hit by hit", &[4, 8, 15, 30, 60], layers(Summation::Generations(LIMITS))),
        Curve::of("wavelengths", &[16, 32, 64, 128, 256, 512], wavelengths),
        Curve { name: "polygons (one ray)", points: [9, 20, 40, 80, 125].map(polygons).to_vec() },
        Curve::of("starting rays", &[2048, 8192, 32768], |count| rays(count, 1)[0]),
    ];
    println!("cost ~ size^exponent, least processor time of 3");
    for curve in &curves {
        let points: Vec<String> =
            curve.points.iter().map(|[size, cost]| format!("{size:.0}: {:.3} µs", cost * 1e6)).collect();
        println!("{:22} {:5.2}   {}", curve.name, curve.exponent(), points.join(", "));
    }
    let wall = |threads: usize| least(|| rays(32768, threads)[1]);
    println!("two threads are {:.2} times as fast as one (wall clock, 32768 starting rays)", wall(1) / wall(2));
    if let Some(plot) = plot {
        fs::write(Path::new(&plot), svg(&curves))?;
    }
    Ok(())
}

/// A plot with two logarithmic axes, in which each curve starts at 1.
fn svg(curves: &[Curve]) -> String {
    const COLOURS: [&str; 5] = ["#0b6e99", "#c4472b", "#3f8f4f", "#8a5fb0", "#b5851a"];
    let (width, height, left, bottom, decade) = (760.0, 420.0, 60.0, 380.0, 80.0);
    let x = |growth: f64| left + decade * 1.7 * growth.log10();
    let y = |growth: f64| bottom - decade * growth.log10();
    let mut out = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {width} {height}' font-family='Inter, sans-serif' \
         font-size='13'><rect width='100%' height='100%' fill='white'/>"
    );
    for power in 0..=4 {
        let (at, label) = (10f64.powi(power), format!("×{}", 10u32.pow(power as u32)));
        out += &format!(
            "<path d='M{left} {0:.1}H520' stroke='#ddd'/><text x='{1}' y='{2:.1}' text-anchor='end'>{label}</text>",
            y(at),
            left - 6.0,
            y(at) + 4.0
        );
        if power <= 3 {
            out += &format!(
                "<path d='M{0:.1} 40V{bottom}' stroke='#ddd'/>\
                 <text x='{0:.1}' y='{1}' text-anchor='middle'>{label}</text>",
                x(at),
                bottom + 18.0
            );
        }
    }
    for (i, curve) in curves.iter().enumerate() {
        let colour = COLOURS[i % COLOURS.len()];
        let first = curve.points[0];
        let line: Vec<String> =
            curve.points.iter().map(|p| format!("{:.1},{:.1}", x(p[0] / first[0]), y(p[1] / first[1]))).collect();
        let name = format!("{} ^{:.2}", curve.name, curve.exponent());
        out += &format!(
            "<polyline points='{}' fill='none' stroke='{colour}' stroke-width='2'/>\
             <text x='535' y='{}' fill='{colour}'>{name}</text>",
            line.join(" "),
            60 + 22 * i
        );
    }
    out + "<text x='290' y='414' text-anchor='middle'>size</text>\
           <text x='60' y='28'>cost, relative to the smallest</text></svg>"
}
