//! The command `goniochrome compare`.

use goniochrome::colour::Illuminant;

use crate::commands::args::CompareArgs;
use crate::commands::csv_file::{number, write_csv};
use crate::commands::notes::note_fall_backs;
use crate::commands::pictures::check_outputs;
use crate::paper::comparison::Comparison;
use crate::scene::load;
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::note;

/// The largest number of wavelengths in a picture: each is a curve and a disc, and more cannot be read.
const MAX_CURVES: usize = 24;

pub fn run(args: &CompareArgs) -> Result<()> {
    let scene = load(&args.scene)?;
    check_outputs(&args.csv, args.output.as_deref(), &scene)?;
    let planar = PlanarScene::new(&scene)?;
    let request = args.computing.request();
    let wavelengths = args.wavelengths.resolve(&planar, &args.theta.0, Illuminant::D65, &request)?.wavelength_nm;
    if args.output.is_some() && wavelengths.len() > MAX_CURVES {
        return Err(Error::usage(format_args!(
            "--output: a picture shows at most {MAX_CURVES} wavelengths, and these are {}; name fewer, or leave it out for the CSV",
            wavelengths.len()
        )));
    }
    let comparison = Comparison::new(&planar, &args.theta.0, &wavelengths, &request)?;
    let rows = args.theta.0.iter().enumerate().flat_map(|(angle, theta)| {
        let comparison = &comparison;
        wavelengths.iter().enumerate().map(move |(wavelength, nm)| {
            let [closed, traced] = comparison.pair(angle, wavelength);
            let mut row = vec![theta.to_string(), nm.to_string()];
            row.extend([closed, traced].map(|r| number(r, args.computing.precision)));
            row.push(format!("{:.3e}", traced - closed));
            row
        })
    });
    let header = ["theta_deg", "wavelength_nm", "R_closed_form", "R_ray_tracing", "difference"];
    let csv = || write_csv(&args.csv, &header, rows);
    match &args.output {
        None => csv()?,
        Some(path) => {
            let picture = comparison.picture(&format!("{}: ray tracing against the closed form", scene.name));
            output::write_file_and(path, &picture.encoded(path)?, csv)?;
        }
    }
    let traced = &comparison.traced;
    note_fall_backs(traced.fell_back, traced.samples.len(), args.computing.running.quiet);
    note(
        args.computing.running.quiet,
        format_args!("largest difference of R_s or R_p: {:.2e}", comparison.largest_difference()),
    );
    Ok(())
}
