//! The 2D table of a planar scene.

use goniochrome::colour::{Quadrature, RgbSpace};

use crate::colour::visible;
use crate::commands::args::{EstimateArgs, spelled};
use crate::commands::make_table::metadata::planar_metadata;
use crate::commands::planar_spectra::{compute_spectra, note_on_colours};
use crate::scene::Scene;
use crate::solve::colours::colours;
use crate::solve::grid::Wavelengths;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::Sample;
use crate::support::error::{Error, Result};
use crate::support::progress::note;
use crate::table::Table;
use crate::table::mirror::MirrorTable;

/// Bytes of a sample in a 2D table: unpolarised reflectance and both of its parts, four bytes each.
const BYTES_PER_SAMPLE: usize = 12;
/// The smallest size of a table that its summary states.
const LARGE_BYTES: usize = 1_000_000;

/// Computes the table of a planar scene; also returns its summary.
pub(super) fn mirror_table(args: &EstimateArgs, scene: &Scene) -> Result<(Table, String)> {
    let cell = &args.cell;
    for (given, name) in [
        (cell.incident.is_some(), "incident"),
        (cell.half_vectors.is_some(), "half-vectors"),
        (cell.rays.is_some(), "rays"),
        (cell.coherence.is_some(), "coherence"),
        (cell.seed.is_some(), "seed"),
        (cell.reciprocal, "reciprocal"),
        (cell.target_error.is_some(), "target-error"),
        (cell.max_harmonic.is_some(), "max-harmonic"),
    ] {
        if given {
            return Err(Error::usage(format_args!(
                "--{name} is for cells of tilted facets; {} is planar, and its table has one direction out for one in",
                scene.name
            )));
        }
    }
    let planar = PlanarScene::new(scene)?;
    let angles = args.angles.unwrap_or(90);
    let theta_deg: Vec<f64> = (0..angles).map(|i| 90.0 * f64::from(i) / f64::from(angles)).collect();
    let wavelengths = args.wavelengths.as_ref().map_or(Wavelengths::VISIBLE, Wavelengths::increasing);
    let illuminant = args.colouring.illuminant.into();
    let spectra = compute_spectra(&planar, &theta_deg, &wavelengths, illuminant, &args.computing)?;
    let mut rgb = Vec::new();
    if visible(&spectra.wavelength_nm) {
        let colours = colours(&spectra, illuminant, RgbSpace::from(args.colouring.space), Quadrature::Interpolated)?;
        rgb.extend(colours.iter().map(|colour| colour.rgb.map(|c| c as f32)));
        note_on_colours(&planar, &spectra, &wavelengths, illuminant, &args.computing)?;
    } else if args.plot.is_some() {
        return Err(Error::usage(
            "--plot draws colours, and no wavelength is visible; leave it out and use `goniochrome plot`",
        ));
    } else {
        note(args.computing.running.quiet, "no wavelength is visible: the table has spectra and no R, G, B");
    }
    let reflectance = |of: fn(&Sample) -> f64| spectra.samples.iter().map(|s| of(s) as f32).collect();
    let table = MirrorTable {
        reflectance_s: reflectance(|sample| sample.reflectance.s),
        reflectance_p: reflectance(|sample| sample.reflectance.p),
        rgb,
        metadata: planar_metadata(args, scene, &spectra),
        theta_deg,
        wavelength_nm: spectra.wavelength_nm.clone(),
    };
    let bytes = spectra.samples.len() * BYTES_PER_SAMPLE;
    let size =
        if bytes < LARGE_BYTES { String::new() } else { format!(" ({} MB before compression)", bytes / 1_000_000) };
    let again = match spectra.recomputed {
        0 => String::new(),
        samples => {
            format!("; {samples} samples computed again with more digits than {}", spelled(args.computing.precision))
        }
    };
    let summary = format!(
        "{} angles × {} wavelengths{size}; truncated ≤ {:.1e}, imbalance ≤ {:.1e}{again}",
        table.theta_deg.len(),
        table.wavelength_nm.len(),
        spectra.worst(|sample| sample.truncated),
        spectra.worst(|sample| sample.imbalance)
    );
    Ok((table.into(), summary))
}
