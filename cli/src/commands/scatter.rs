//! `goniochrome scatter`.

use glam::DVec3;
use goniochrome::bins::DirectionBins;
use serde_json::{Value, json};

use crate::args::{ScatterArgs, spelled};
use crate::bumpy::Bumpy;
use crate::coherent::{scatter_bins, scatter_orders};
use crate::commands::{direction, remark_on_media};
use crate::diffraction::{default_hits, unreliable};
use crate::error::{Error, Result};
use crate::output;
use crate::progress::{bar, remark};
use crate::scatter::{BATCHES, Coherence, Estimate, Request, Scattered, scatter};
use crate::scene::load;
use crate::text;

pub fn run(args: &ScatterArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.json, &scene.files)?;
    let bumpy = Bumpy::new(&scene)?;
    let [cos, phi] = args.bins.0;
    let wi = direction(args.theta, args.phi)?;
    let mut request = Request {
        coherence: args.coherence,
        rays: args.rays,
        seed: args.seed,
        bins: DirectionBins { cos, phi },
        precision: args.precision,
        threads: args.threads.map_or_else(crate::parallel::available, usize::from),
    };
    remark_on_media(&scene, &[args.wavelength], args.quiet);
    let mut found = once(&bumpy, wi, args, &request)?;
    while args.target_error.is_some_and(|target| largest_error(&found) > target) {
        if request.rays > MOST_RAYS / 2 {
            return Err(Error::failed(format_args!(
                "{}: the standard error is still {:.1e} with {} rays; give a larger --target-error or larger bins",
                scene.name,
                largest_error(&found),
                request.rays
            )));
        }
        request.rays *= 2;
        found = once(&bumpy, wi, args, &request)?;
    }
    if request.coherence == Coherence::Cell
        && let Some(warning) = unreliable(&bumpy, &[args.wavelength])
    {
        remark(args.quiet, warning);
    }
    let text = serde_json::to_string_pretty(&report(args, &request, &found)).map_err(Error::failed)?;
    output::write_text(&args.json, &(text::json(&text) + "\n"))
}

/// With a target, rays double up to here.
const MOST_RAYS: u32 = 1 << 28;

fn once(bumpy: &Bumpy<'_>, wi: DVec3, args: &ScatterArgs, request: &Request) -> Result<Scattered> {
    match request.coherence {
        Coherence::Bin => scatter_bins(bumpy, wi, args.wavelength, request),
        Coherence::Cell => scatter_orders(bumpy, wi, args.wavelength, request, default_hits(bumpy)),
        Coherence::Ray | Coherence::None => {
            let progress = bar(&bumpy.scene().name, BATCHES as usize, args.quiet);
            let mut found = scatter(bumpy, wi, &[args.wavelength], request, &|| progress.inc(1))?;
            progress.finish_and_clear();
            Ok(found.remove(0))
        }
    }
}

/// The largest standard error of a number that is printed.
fn largest_error(found: &Scattered) -> f64 {
    let totals = [found.reflected, found.transmitted, found.absorbed];
    totals.iter().chain(&found.bins).map(|estimate| estimate.std_error).fold(0.0, f64::max)
}

fn estimate(of: Estimate) -> Value {
    json!({ "value": of.value, "std_error": of.std_error })
}

fn report(args: &ScatterArgs, request: &Request, found: &Scattered) -> Value {
    let grid = request.bins;
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
        "wavelength_nm": args.wavelength,
        "coherence": spelled(args.coherence),
        "rays": request.rays,
        "seed": args.seed,
        "reflected": estimate(found.reflected),
        "transmitted": estimate(found.transmitted),
        "absorbed": estimate(found.absorbed),
        "truncated": estimate(found.truncated),
        "imbalance": estimate(found.imbalance),
        "without_interference": estimate(found.without_interference),
        "bins": bins,
    })
}
