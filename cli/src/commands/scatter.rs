//! The command `goniochrome scatter`.

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use serde_json::{Value, json};

use crate::commands::args::{Diffracting, ScatterArgs, spelled};
use crate::commands::cell_options::{light_direction, listed_wavelengths};
use crate::commands::notes::{note_on_front, note_on_scene, note_on_waves};
use crate::commands::wave_choice::{RAYS, first_given, wave_cell};
use crate::scene::{Scene, load};
use crate::solve::cell_warnings::{not_converged, unbalanced};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::order_error;
use crate::solve::scatter::{Coherence, ScatterRequest, Scattered, scatter, steps};
use crate::solve::waves::WaveCell;
use crate::solve::waves::one_direction::{WaveDiffraction, wave_orders};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::{bar, note};
use crate::support::text;
use crate::table::statistics::MeanWithError;

pub fn run(args: &ScatterArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.json, &scene.files)?;
    let wavelengths = listed_wavelengths(&args.wavelengths, &scene)?;
    let wi = light_direction(args.theta, args.phi)?;
    let cell = match args.coherence {
        Coherence::Cell => {
            let accuracy = args.diffracting.accuracy(args.target_error);
            let Diffracting { method, .. } = args.diffracting;
            wave_cell(&scene, method, ray_option(args), wavelengths, accuracy, args.running.quiet)?
        }
        _ if args.diffracting.method.is_some() || args.diffracting.max_harmonic.is_some() => {
            return Err(Error::usage("--method, --max-harmonic: are for --coherence cell; leave them out"));
        }
        _ => None,
    };
    note_on_scene(&scene, wavelengths, args.running.quiet);
    let reports = match cell {
        Some(cell) => by_waves(args, &cell, wi, wavelengths)?,
        None => by_rays(args, &scene, wi, wavelengths)?,
    };
    let whole = if let [report] = &reports[..] { report.clone() } else { Value::Array(reports) };
    let text = serde_json::to_string_pretty(&whole).map_err(Error::failed)?;
    output::write_text(&args.json, &(text::json(&text) + "\n"))
}

/// The first option of rays that the user gave.
fn ray_option(args: &ScatterArgs) -> Option<&'static str> {
    first_given(&[
        ("--rays", args.rays.is_some()),
        ("--precision", args.precision.is_some()),
        ("--seed", args.seed.is_some()),
    ])
}

/// The bins of the options.
fn bins(args: &ScatterArgs) -> DirectionBins {
    let [cos, phi] = args.bins.0;
    DirectionBins { cos, phi }
}

/// Counts the diffraction orders of waves in bins.
fn by_waves(args: &ScatterArgs, cell: &WaveCell<'_>, wi: DVec3, wavelengths: &[f64]) -> Result<Vec<Value>> {
    let accuracy = args.diffracting.accuracy(args.target_error);
    let progress = bar(&cell.scene().name, wavelengths.len(), args.running.quiet);
    let found = wave_orders(cell, wi, wavelengths, accuracy, args.running.threads(), &|| progress.inc(1))?;
    progress.finish_and_clear();
    note_on_waves(cell, &found, accuracy, args.running.quiet)?;
    let report = |found: &WaveDiffraction| {
        let mut report = report(args, found.wavelength_nm, &found.in_bins(bins(args)), &[]);
        report["method"] = json!("waves");
        report["error"] = json!(found.error);
        report
    };
    Ok(found.iter().map(report).collect())
}

fn by_rays(args: &ScatterArgs, scene: &Scene, wi: DVec3, wavelengths: &[f64]) -> Result<Vec<Value>> {
    if args.diffracting.max_harmonic.is_some() {
        return Err(Error::usage("--max-harmonic: is of waves; give rays --rays"));
    }
    let mesh_scene = MeshScene::new(scene)?;
    note_on_front(scene, args.running.quiet);
    let mut request = ScatterRequest {
        coherence: args.coherence,
        rays: args.rays.unwrap_or(RAYS),
        seed: args.seed.unwrap_or(0),
        bins: bins(args),
        precision: args.precision.unwrap_or_default(),
        threads: args.running.threads(),
    };
    let once = |request: &ScatterRequest| {
        let progress = bar(&scene.name, steps(wavelengths.len(), request), args.running.quiet);
        let found = scatter(&mesh_scene, wi, wavelengths, request, &|| progress.inc(1));
        progress.finish_and_clear();
        found
    };
    let mut found = once(&request)?;
    while let Some(error) = args.target_error.and_then(|target| Some(largest_error(&found)).filter(|e| *e > target)) {
        if request.rays > MAX_RAYS / 2 {
            return Err(Error::failed(format_args!(
                "{}: the standard error is still {error:.1e} with {} rays; give a larger --target-error or larger bins",
                scene.name, request.rays
            )));
        }
        request.rays *= 2;
        found = once(&request)?;
    }
    let mut reports = Vec::with_capacity(found.len());
    for (found, &nm) in found.iter().zip(wavelengths) {
        let off = match request.coherence {
            Coherence::Cell => order_error::warning(&mesh_scene, wi, &[nm])?,
            _ => None,
        };
        let warnings: Vec<String> =
            [unbalanced(request.coherence, found.imbalance), not_converged(found.without_interference.value), off]
                .into_iter()
                .flatten()
                .collect();
        for warning in &warnings {
            note(args.running.quiet, format_args!("{}: {nm} nm: {warning}", scene.name));
        }
        let mut report = report(args, nm, found, &warnings);
        report["rays"] = json!(request.rays);
        report["seed"] = json!(request.seed);
        reports.push(report);
    }
    Ok(reports)
}

/// The largest number of rays that a target error asks for.
const MAX_RAYS: u32 = 1 << 28;

/// The largest standard error of all printed numbers.
fn largest_error(found: &[Scattered]) -> f64 {
    let numbers = |found: &Scattered| {
        let totals = [found.reflected, found.transmitted, found.absorbed];
        totals.iter().chain(&found.bins).map(|estimate| estimate.std_error).fold(0.0, f64::max)
    };
    found.iter().map(numbers).fold(0.0, f64::max)
}

/// A mean with its error as JSON.
fn estimate(of: MeanWithError) -> Value {
    json!({ "value": of.value, "std_error": of.std_error })
}

fn report(args: &ScatterArgs, wavelength_nm: f64, found: &Scattered, warnings: &[String]) -> Value {
    let grid = bins(args);
    let bins: Vec<Value> = found
        .bins
        .iter()
        .enumerate()
        .map(|(bin, power)| {
            let [cos_min, cos_max, phi_min, phi_max] = grid.bounds(bin);
            json!({
                "cos_min": cos_min,
                "cos_max": cos_max,
                "phi_min_deg": phi_min.to_degrees(),
                "phi_max_deg": phi_max.to_degrees(),
                "power": power.value,
                "std_error": power.std_error,
            })
        })
        .collect();
    json!({
        "scene": args.scene,
        "theta_deg": args.theta,
        "phi_deg": args.phi,
        "wavelength_nm": wavelength_nm,
        "coherence": spelled(args.coherence),
        "reflected": estimate(found.reflected),
        "transmitted": estimate(found.transmitted),
        "absorbed": estimate(found.absorbed),
        "truncated": estimate(found.truncated),
        "imbalance": estimate(found.imbalance),
        "without_interference": estimate(found.without_interference),
        "warnings": warnings,
        "bins": bins,
    })
}
