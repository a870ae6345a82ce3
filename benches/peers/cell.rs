//! `cell mesh SCENE` prints the mesh of a cell as JSON, for other tracers to read. `cell scatter SCENE` reads tasks
//! from standard input, one JSON object a line. It scatters light from the direction of each, and prints seconds and
//! histograms.

use std::env;
use std::error::Error;
use std::io::{BufRead, stdin};
use std::time::Instant;

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::optics::interface::Below;
use goniochrome::optics::medium::MediumIndex;
use goniochrome_benches::clock::processor_time;
use goniochrome_cli::scene::{Scene, load};
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Scattered, scatter};
use goniochrome_cli::table::statistics::MeanWithError;
use serde_json::{Value, json};

/// Wavelength, in nanometres, of the indices that Mitsuba's dielectrics get: they have one for all wavelengths.
const INDEX_WAVELENGTH_NM: f64 = 580.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["mesh", scene] => println!("{}", mesh(&load(scene)?)?),
        ["scatter", scene] => {
            let scene = load(scene)?;
            for line in stdin().lock().lines() {
                println!("{}", task(&scene, &serde_json::from_str(&line?)?)?);
            }
        }
        _ => return Err("usage: cell mesh SCENE | cell scatter SCENE".into()),
    }
    Ok(())
}

/// The mesh of a scene as JSON: vertices, and the triangles and media of each interface.
fn mesh(scene: &Scene) -> Result<Value, Box<dyn Error>> {
    let cell = scene.shape.polygons().ok_or("no polygons")?;
    let (mesh, period_nm, interfaces) = (cell.mesh(), cell.period_nm(), cell.interfaces());
    let eta = |medium: MediumIndex| {
        let eta = scene.media[usize::from(medium)].medium.borrow().eta(INDEX_WAVELENGTH_NM)?;
        if eta.im == 0.0 { Ok(eta.re) } else { Err::<f64, Box<dyn Error>>("a medium absorbs".into()) }
    };
    let sheets = interfaces.iter().enumerate().map(|(index, named)| {
        let of_sheet = mesh.triangles.iter().filter(|triangle| usize::from(triangle.interface) == index);
        let triangles: Vec<[u32; 3]> = of_sheet.map(|triangle| triangle.vertices).collect();
        let Below::Medium(below) = named.interface.below else { return Err("a mirror".into()) };
        Ok(json!({
            "name": named.name,
            "above": eta(named.interface.above)?,
            "below": eta(below)?,
            "triangles": triangles,
        }))
    });
    let sheets: Result<Vec<Value>, Box<dyn Error>> = sheets.collect();
    Ok(json!({ "period_nm": period_nm, "vertices": mesh.vertices, "sheets": sheets? }))
}

/// The result of a task: the light that a scene scatters from one direction.
fn task(scene: &Scene, task: &Value) -> Result<Value, Box<dyn Error>> {
    let number = |key: &str| task[key].as_f64().ok_or_else(|| format!("no number {key}"));
    let whole = |key: &str| number(key).map(|value| value as u32);
    let coherence = match task["coherence"].as_str() {
        Some("ray") => Coherence::Ray,
        Some("none") => Coherence::None,
        _ => return Err("coherence is ray or none".into()),
    };
    let request = ScatterRequest {
        coherence,
        rays: whole("rays")?,
        seed: whole("seed")?,
        bins: DirectionBins { cos: whole("cos")?, phi: whole("phi")? },
        precision: Precision::F32,
        threads: whole("threads")? as usize,
    };
    let (theta, azimuth) = (number("theta_i")?, number("phi_i")?);
    let wi = DVec3::new(theta.sin() * azimuth.cos(), theta.sin() * azimuth.sin(), theta.cos());
    let wavelengths: Vec<f64> = serde_json::from_value(task["wavelengths"].clone())?;
    let mesh_scene = MeshScene::new(scene)?;
    let start = Instant::now();
    let (found, used) = processor_time(|| scatter(&mesh_scene, wi, &wavelengths, &request, &|| ()));
    let (found, seconds) = (found?, start.elapsed().as_secs_f64());
    let both = |of: &MeanWithError| [of.value, of.std_error];
    let total = |of: fn(&Scattered) -> MeanWithError| found.iter().map(|found| both(&of(found))).collect::<Vec<_>>();
    let bins: Vec<Vec<[f64; 2]>> = found.iter().map(|found| found.bins.iter().map(both).collect()).collect();
    Ok(json!({
        "seconds": seconds,
        "processor_seconds": used.as_secs_f64(),
        "reflected": total(|found| found.reflected),
        "transmitted": total(|found| found.transmitted),
        "truncated": total(|found| found.truncated),
        "bins": bins,
    }))
}
