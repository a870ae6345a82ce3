//! One file per command: arguments in, files out.

pub mod args;
mod colour;
mod compare;
mod estimate;
mod export;
mod figures;
mod orders;
mod plot;
mod presets;
mod render;
mod sampling;
mod scatter;
mod source;
mod spectrum;
mod view;

use std::path::Path;

use glam::DVec3;
use goniochrome::colour::Illuminant;

use crate::commands::args::{Command, Computing};
use crate::scene::{NamedMedium, Scene};
use crate::solve::fidelity;
use crate::solve::grid::Wavelengths;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::precision::Precision;
use crate::solve::refine::{Choice, most};
use crate::solve::spectra::{Spectra, spectra};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::{bar, note};

/// Does what the command line asks for.
///
/// # Errors
/// One line for the user.
pub fn run(command: &Command) -> Result<()> {
    dispatch(command).map_err(|error| error.with_remedy(command.asks_wavelengths()))
}

fn dispatch(command: &Command) -> Result<()> {
    match command {
        Command::Presets { materials: true, .. } => presets::materials(),
        Command::Presets { name, .. } => presets::run(name.as_deref()),
        Command::Spectrum(args) => spectrum::run(args),
        Command::Colour(args) => colour::run(args),
        Command::Estimate(args) => estimate::run(args),
        Command::Scatter(args) => scatter::run(args),
        Command::Orders(args) => orders::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Sampling(args) => sampling::run(args),
        Command::Plot(args) => plot::run(args),
        Command::Render(args) => render::run(args),
        Command::View(args) => view::run(args),
        Command::Figures(args) => figures::run(args),
        Command::Export(args) => export::run(args),
    }
}

/// Spectra over a grid with a progress bar; says how many wavelengths `auto` has chosen, and how true their colours
/// are.
fn compute(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelengths: &Wavelengths,
    illuminant: Illuminant,
    computing: &Computing,
) -> Result<Spectra> {
    let request = computing.request();
    let Choice { wavelength_nm, xyz } = wavelengths.resolve(planar, theta_deg, illuminant, &request)?;
    remark_on_media(planar.scene(), &wavelength_nm, computing.running.quiet);
    let progress = bar(&planar.scene().name, theta_deg.len(), computing.running.quiet);
    let spectra = spectra(planar, theta_deg, &wavelength_nm, &request, &|| progress.inc(1))?;
    progress.finish_and_clear();
    remark_fall_backs(spectra.fell_back, spectra.samples.len(), computing.running.quiet);
    if let (Wavelengths::Auto(_), [first, .., last]) = (wavelengths, wavelength_nm.as_slice()) {
        let mut said = format!("{} wavelengths from {first} to {last} nm", wavelength_nm.len());
        if wavelength_nm.len() == most(theta_deg.len()) {
            said += ", the most that a table holds";
        }
        /// Errors below the last digit are not shown as 0.
        const SHOWN: f64 = 0.01;
        // Invisible wavelengths have no colour.
        if let Ok((error, theta)) = fidelity::largest_error(&spectra, &xyz, illuminant) {
            said +=
                &format!("; their colours are within ΔE2000 {:.2} of the integral's (at {theta}°)", error.max(SHOWN));
        }
        note(computing.running.quiet, said);
    }
    Ok(spectra)
}

/// Says of how many samples the loops were closed although `--method hits` was asked for.
fn remark_fall_backs(fell_back: usize, samples: usize, quiet: bool) {
    if fell_back > 0 {
        note(
            quiet,
            format_args!(
                "{fell_back} of {samples} samples do not converge hit by hit within the work allowed; \
                 their loops are closed, as by --method trace"
            ),
        );
    }
}

/// Says what was guessed or rounded in the data of media that are used at these wavelengths.
fn remark_on_media(scene: &Scene, wavelength_nm: &[f64], quiet: bool) {
    for NamedMedium { name, medium } in &scene.media {
        if let Some(said) = medium.note(wavelength_nm) {
            note(quiet, format_args!("{}: material {name}: {said}", scene.name));
        }
    }
}

/// Writes a picture, and says how many of its colours had to be changed.
fn save(picture: &crate::plot::Picture, path: &Path, quiet: bool) -> Result<()> {
    picture.save(path)?;
    if let Some(said) = picture.out_of_gamut().note() {
        note(quiet, format_args!("{}: {said}", path.display()));
    }
    Ok(())
}

/// Says what is amiss with the wavelengths from which colours are made.
fn remark_on_colours(
    planar: &PlanarScene<'_>,
    spectra: &Spectra,
    wavelengths: &Wavelengths,
    illuminant: Illuminant,
    computing: &Computing,
) -> Result<()> {
    if computing.running.quiet {
        return Ok(());
    }
    let left_out = fidelity::left_out(&spectra.wavelength_nm, illuminant)?;
    left_out.into_iter().for_each(|said| note(false, said));
    if matches!(wavelengths, Wavelengths::List(_)) {
        match fidelity::too_few(planar, spectra, illuminant, &computing.request()) {
            Ok(too_few) => too_few.into_iter().for_each(|said| note(false, said)),
            Err(error) => note(false, format_args!("whether the wavelengths are enough is not known: {error}")),
        }
    }
    Ok(())
}

/// Refuses, before long work, a CSV and a picture that cannot be written at its end.
fn check_outputs(csv: &Path, picture: Option<&Path>, scene: &Scene) -> Result<()> {
    output::check_destination(csv, &scene.files)?;
    let Some(picture) = picture else { return Ok(()) };
    crate::plot::Format::of(picture)?;
    output::check_destination(picture, &scene.files)?;
    output::refuse_same_output(csv, picture)
}

/// The wavelengths that were named, for commands that cannot choose them.
fn named<'w>(wavelengths: &'w Wavelengths, scene: &Scene) -> Result<&'w [f64]> {
    match wavelengths {
        Wavelengths::List(list) => Ok(list),
        Wavelengths::Auto(_) => Err(Error::usage(format_args!(
            "--wavelengths auto: {} is traced, and has no one optical path; name the wavelengths, as 380:780:10",
            scene.name
        ))),
    }
}

/// The unit vector towards the light.
fn direction(theta_deg: f64, phi_deg: f64) -> Result<DVec3> {
    if !((0.0..90.0).contains(&theta_deg) && phi_deg.is_finite()) {
        return Err(Error::usage(format_args!(
            "--theta {theta_deg} --phi {phi_deg}: theta must lie in [0, 90) degrees and phi be finite"
        )));
    }
    let ((sin, cos), (sin_phi, cos_phi)) = (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
    Ok(DVec3::new(sin * cos_phi, sin * sin_phi, cos))
}

/// Writes rows of text as CSV.
fn write_csv(path: &Path, header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Result<()> {
    let failed = |error| Error::failed(format_args!("{}: {error}", path.display()));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(failed)?;
    for row in rows {
        writer.write_record(&row).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|error| Error::failed(error.error()))?;
    output::write_text(path, &String::from_utf8_lossy(&bytes))
}

/// The shortest text that gives the number back at its precision.
fn number(x: f64, precision: Precision) -> String {
    match precision {
        Precision::F32 => (x as f32).to_string(),
        Precision::F64 => x.to_string(),
    }
}
