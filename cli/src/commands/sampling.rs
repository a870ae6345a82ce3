//! The command `goniochrome sampling`.

use std::cell::Cell;

use crate::commands::args::SamplingArgs;
use crate::commands::csv_file::write_csv;
use crate::commands::notes::note_fall_backs;
use crate::commands::pictures::check_outputs;
use crate::paper::wavelength_count::{Setting, error_curve, picture};
use crate::scene::load;
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;
use crate::support::output;
use crate::support::progress::bar;

pub fn run(args: &SamplingArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    check_outputs(&args.csv, args.output.as_deref(), &scene)?;
    let planar = PlanarScene::new(&scene)?;
    let setting = Setting {
        theta_deg: &args.theta.0,
        illuminant: args.illuminant.into(),
        space: args.space.into(),
        request: args.computing.request(),
    };
    let progress = bar(&scene.name, args.samples.len(), args.computing.running.quiet);
    let (fell_back, all) = (Cell::new(0), Cell::new(0));
    let points = error_curve(&planar, &args.samples, &setting, &|spectra| {
        fell_back.set(fell_back.get() + spectra.fell_back);
        all.set(all.get() + spectra.samples.len());
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    note_fall_backs(fell_back.get(), all.get(), args.computing.running.quiet);
    let rows = points.iter().map(|point| vec![point.samples.to_string(), format!("{:.6}", point.error)]);
    let csv = || write_csv(&args.csv, &["samples", "largest_error"], rows);
    let Some(path) = &args.output else { return csv() };
    let title = format!("{}: colour error against the number of wavelengths", scene.name);
    let picture = picture(&title, &[(scene.name.clone(), points.clone())]);
    output::write_file_and(path, &picture.encoded(path)?, csv)
}
