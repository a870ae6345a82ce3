//! `goniochrome scatter`.

use goniochrome::bins::DirectionBins;
use serde_json::{Value, json};

use crate::args::ScatterArgs;
use crate::bumpy::Bumpy;
use crate::commands::direction;
use crate::error::{Error, Result};
use crate::output;
use crate::progress::bar;
use crate::scatter::{BATCHES, Estimate, Request, Scattered, scatter};
use crate::scene::load;

pub fn run(args: &ScatterArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    output::check_destination(&args.json, &scene.files)?;
    let bumpy = Bumpy::new(&scene)?;
    let [cos, phi] = args.bins.0;
    let request = Request {
        coherence: args.coherence,
        rays: args.rays,
        seed: args.seed,
        bins: DirectionBins { cos, phi },
        precision: args.precision,
        threads: args.threads.map_or_else(crate::parallel::available, usize::from),
    };
    let wi = direction(args.theta, args.phi)?;
    let progress = bar(&scene.name, BATCHES as usize, args.quiet);
    let found = scatter(&bumpy, wi, &[args.wavelength], &request, &|| progress.inc(1))?;
    progress.finish_and_clear();
    let text = serde_json::to_string_pretty(&report(args, &request.bins, &found[0])).map_err(Error::failed)?;
    output::write_text(&args.json, &(text + "\n"))
}

fn estimate(of: Estimate) -> Value {
    json!({ "value": of.value, "std_error": of.std_error })
}

fn report(args: &ScatterArgs, grid: &DirectionBins, found: &Scattered) -> Value {
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
        "rays": args.rays,
        "seed": args.seed,
        "reflected": estimate(found.reflected),
        "transmitted": estimate(found.transmitted),
        "absorbed": estimate(found.absorbed),
        "truncated": estimate(found.truncated),
        "imbalance": estimate(found.imbalance),
        "bins": bins,
    })
}
