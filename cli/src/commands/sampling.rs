//! `goniochrome sampling`.

use crate::args::SamplingArgs;
use crate::commands::write_csv;
use crate::error::{Error, Result};
use crate::output;
use crate::planar::Planar;
use crate::progress::bar;
use crate::sampling::{Setting, error_curve, picture};
use crate::scene::load;

/// A sample each 0.1 nm; beyond, the reference of 1 nm is the coarser.
const MOST_SAMPLES: u16 = 4000;

pub fn run(args: &SamplingArgs) -> Result<()> {
    if let Some(wrong) = args.samples.iter().find(|n| !(1..=MOST_SAMPLES).contains(*n)) {
        return Err(Error::usage(format_args!("--samples: {wrong} must lie between 1 and {MOST_SAMPLES}")));
    }
    let scene = load(&args.scene)?;
    for path in [Some(&args.csv), args.output.as_ref()].into_iter().flatten() {
        output::check_destination(path, &scene.files)?;
    }
    let planar = Planar::new(&scene)?;
    let setting = Setting {
        theta_deg: &args.theta.0,
        illuminant: args.illuminant.into(),
        space: args.space.into(),
        request: args.computing.request(),
    };
    let progress = bar(&scene.name, args.samples.len(), args.computing.quiet);
    let points = error_curve(&planar, &args.samples, &setting, &|| progress.inc(1))?;
    progress.finish_and_clear();
    if let Some(path) = &args.output {
        let title = format!("{}: colour error against the number of wavelengths", scene.name);
        picture(&title, &[(scene.name.clone(), points.clone())]).save(path)?;
    }
    let rows = points.iter().map(|point| vec![point.samples.to_string(), format!("{:.6}", point.error)]);
    write_csv(&args.csv, &["samples", "largest_error"], rows)
}
