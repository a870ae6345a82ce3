//! The 2D table of a planar scene.

use goniochrome::colour::{Quadrature, RgbSpace};

use crate::colour::visible;
use crate::commands::args::{EstimateArgs, ModelArg, spelled};
use crate::commands::make_table::metadata::planar_metadata;
use crate::commands::notes::note_fall_backs;
use crate::commands::planar_spectra::{compute_spectra, note_on_colours};
use crate::scene::Scene;
use crate::solve::backing::Backing;
use crate::solve::colours::colours_of;
use crate::solve::grid::Wavelengths;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::{Sample, Spectra, spectra};
use crate::support::error::{Error, Result};
use crate::support::progress::{bar, note};
use crate::table::Table;
use crate::table::mirror::{MirrorTable, ThicknessAxis, check_size};

/// Bytes of a sample in a 2D table: unpolarised reflectance and both of its parts, four bytes each.
const BYTES_PER_SAMPLE: usize = 12;
/// The smallest size of a table that its summary states.
const LARGE_BYTES: usize = 1_000_000;

/// Computes the table of a planar scene; also returns its summary.
pub(super) fn mirror_table(args: &EstimateArgs, scene: &Scene) -> Result<(Table, String)> {
    let cell = &args.cell;
    if args.farm.share()?.is_some() {
        return Err(Error::usage(format_args!(
            "--part: {} is planar, and its table takes seconds; leave it out",
            scene.name
        )));
    }
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
    let scenes = match &args.vary {
        None => vec![scene.clone()],
        Some(vary) => vary.thicknesses().map(|nm| vary.scene_at(scene, nm)).collect::<Result<Vec<_>>>()?,
    };
    let surfaces = scenes.iter().map(PlanarScene::new).collect::<Result<Vec<_>>>()?;
    let (thickest, thinner) = surfaces.split_last().expect("a table has a surface");
    let angles = args.angles.unwrap_or(90);
    let theta_deg: Vec<f64> = (0..angles).map(|i| 90.0 * f64::from(i) / f64::from(angles)).collect();
    let wavelengths = args.wavelengths.as_ref().map_or(Wavelengths::VISIBLE, Wavelengths::increasing);
    let illuminant = args.colouring.illuminant.into();
    // The thickest film has the narrowest fringes, and needs the most wavelengths.
    let of_thickest = compute_spectra(thickest, &theta_deg, &wavelengths, illuminant, &args.computing)?;
    let quiet = args.computing.running.quiet;
    if !visible(&of_thickest.wavelength_nm) {
        if args.plot.is_some() {
            return Err(Error::usage(
                "--plot draws colours, and no wavelength is visible; leave it out and use `goniochrome plot`",
            ));
        }
        note(quiet, "no wavelength is visible: the table has spectra and no R, G, B");
    } else {
        note_on_colours(thickest, &of_thickest, &wavelengths, illuminant, &args.computing)?;
    }
    let backing = Backing::of(thickest, &of_thickest.wavelength_nm)?;
    let spectra = with_thinner(thinner, of_thickest, args)?;
    let colours = |power| -> Result<Vec<[f32; 3]>> {
        if !visible(&spectra.wavelength_nm) {
            return Ok(Vec::new());
        }
        let space = RgbSpace::from(args.colouring.space);
        let colours = colours_of(&spectra, power, illuminant, space, Quadrature::Interpolated)?;
        Ok(colours.iter().map(|colour| colour.rgb.map(|c| c as f32)).collect())
    };
    let power = |of: fn(&Sample) -> f64| spectra.samples.iter().map(|s| of(s) as f32).collect();
    let mut table = MirrorTable {
        reflectance_s: power(|sample| sample.reflectance.s),
        reflectance_p: power(|sample| sample.reflectance.p),
        rgb: colours(Sample::mean_reflectance)?,
        thickness: args.vary.map(|vary| ThicknessAxis { layer: vary.layer, nm: vary.thicknesses().collect() }),
        theta_deg,
        wavelength_nm: spectra.wavelength_nm.clone(),
        ..MirrorTable::default()
    };
    // The paper's fluxes are sums of amplitudes: what they leave out is not what goes through.
    let transmits = backing != Backing::Opaque && args.computing.model == ModelArg::Physical;
    if transmits {
        table.transmittance_s = power(|sample| sample.transmittance.s.max(0.0));
        table.transmittance_p = power(|sample| sample.transmittance.p.max(0.0));
        table.rgb_transmitted = colours(Sample::mean_transmittance)?;
    }
    table.metadata = planar_metadata(args, scene, &spectra, if transmits { backing } else { Backing::Opaque });
    let bytes = spectra.samples.len() * BYTES_PER_SAMPLE * if transmits { 2 } else { 1 };
    let size =
        if bytes < LARGE_BYTES { String::new() } else { format!(" ({} MB before compression)", bytes / 1_000_000) };
    let again = match spectra.recomputed {
        0 => String::new(),
        samples => {
            format!("; {samples} samples computed again with more digits than {}", spelled(args.computing.precision))
        }
    };
    let family = table.thickness.as_ref().map_or_else(String::new, |axis| {
        let error = between_thicknesses(&table);
        format!("{} thicknesses (between them colours are within {error:.1e}) × ", axis.nm.len())
    });
    let summary = format!(
        "{family}{} angles × {} wavelengths{size}; truncated ≤ {:.1e}, imbalance ≤ {:.1e}{again}",
        table.theta_deg.len(),
        table.wavelength_nm.len(),
        spectra.worst(|sample| sample.truncated),
        spectra.worst(|sample| sample.imbalance)
    );
    Ok((table.into(), summary))
}

/// The spectra of all surfaces of a family, the thickest last, whose own are known.
fn with_thinner(thinner: &[PlanarScene<'_>], of_thickest: Spectra, args: &EstimateArgs) -> Result<Spectra> {
    let Some((first, others)) = thinner.split_first() else { return Ok(of_thickest) };
    let Spectra { theta_deg, wavelength_nm, .. } = &of_thickest;
    check_size(thinner.len() + 1, theta_deg.len(), wavelength_nm.len())?;
    let quiet = args.computing.running.quiet;
    let progress = bar(&first.scene().name, thinner.len(), quiet);
    let compute = |planar| {
        let spectra = spectra(planar, theta_deg, wavelength_nm, &args.computing.request(), &|| ())?;
        progress.inc(1);
        Ok(spectra)
    };
    let mut all: Spectra = compute(first)?;
    for planar in others {
        all.append(compute(planar)?);
    }
    progress.finish_and_clear();
    note_fall_backs(all.fell_back, all.samples.len(), quiet);
    all.append(of_thickest);
    Ok(all)
}

/// Estimates the largest error of a colour that is interpolated half-way between two thicknesses: an eighth of the
/// second difference.
fn between_thicknesses(table: &MirrorTable) -> f32 {
    let angles = table.theta_deg.len();
    let largest = |colours: &[[f32; 3]]| {
        let of_step = |(low, (middle, high)): (&[f32; 3], (&[f32; 3], &[f32; 3]))| {
            (0..3).map(|c| (low[c] - 2.0 * middle[c] + high[c]).abs() / 8.0).fold(0.0, f32::max)
        };
        let next = colours.iter().skip(angles).zip(colours.iter().skip(2 * angles));
        colours.iter().zip(next).map(of_step).fold(0.0, f32::max)
    };
    largest(&table.rgb).max(largest(&table.rgb_transmitted))
}
