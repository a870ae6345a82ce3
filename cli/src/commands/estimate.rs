//! `goniochrome estimate`.

use std::path::Path;
use std::sync::Once;

use goniochrome::colour::{Quadrature, RgbSpace};
use goniochrome::measure::bins::DirectionBins;
use goniochrome::table::ScatterLayout;

use crate::colour::{visible, visible_weights};
use crate::commands::args::{EstimateArgs, ModelArg, spelled};
use crate::commands::{compute, named, remark_on_colours, remark_on_media, save};
use crate::plot::{Format, tables};
use crate::scene::{Scene, Shape, load};
use crate::solve::cell_table::{TableRequest, estimate};
use crate::solve::cell_warnings::{too_few, unbalanced, without_sum};
use crate::solve::checkpoint::Checkpoint;
use crate::solve::colours::colours;
use crate::solve::grid::Wavelengths;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::scatter::ScatterRequest;
use crate::solve::spectra::{Method, Sample, Spectra};
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::{bar, note};
use crate::table::metadata::{Metadata, MetadataKey};
use crate::table::mirror::MirrorTable;
use crate::table::{Table, file};

/// Starting rays of an incident direction unless the user says otherwise.
const RAYS: u32 = 4096;

/// Starting rays of a table that is only drawn: the presets then take seconds.
const RAYS_IN_MEMORY: u32 = 512;

pub fn run(args: &EstimateArgs) -> Result<()> {
    if args.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("exr")) {
        return Err(Error::usage(format_args!("{}: a table is written as .exr; name it so", args.output.display())));
    }
    let scene = load(&args.scene)?;
    for path in [Some(&args.output), args.plot.as_ref()].into_iter().flatten() {
        output::check_destination(path, &scene.files)?;
    }
    if let Some(plot) = &args.plot {
        Format::of(plot)?;
        output::refuse_same_output(&args.output, plot)?;
    }
    let (table, said, checkpoint) = table_of(args, &scene, Some(&args.output))?;
    file::write(&args.output, &table, args.computing.request().threads)?;
    if let Some(path) = &args.plot {
        save(&tables::disc(&table, None, 0.0)?, path, args.computing.running.quiet)?;
    }
    // Not before all is written: on a full disk, say, the work is kept.
    checkpoint.map_or(Ok(()), Checkpoint::remove)?;
    note(args.computing.running.quiet, format_args!("{}: {said}", args.output.display()));
    Ok(())
}

/// A 2D table holds unpolarised reflectance and both of its parts, four bytes each.
const BYTES_PER_SAMPLE: usize = 12;
/// The size of a table is said from here on.
const LARGE_BYTES: usize = 1_000_000;

/// The table of a scene, what to say of it, and the checkpoint that holds its parts if it is kept beside an output.
fn table_of(args: &EstimateArgs, scene: &Scene, output: Option<&Path>) -> Result<(Table, String, Option<Checkpoint>)> {
    match &scene.shape {
        Shape::Mesh(_) => scattering(args, scene, output),
        Shape::Stack { .. } | Shape::Planes(_) => mirror_like(args, scene).map(|(table, said)| (table, said, None)),
    }
}

/// The table of a scene by the defaults of `estimate`, cells with fewer rays, and what to say of it. Nothing is
/// written.
pub(super) fn in_memory(scene: &Scene, quiet: bool) -> Result<(Table, String)> {
    let mut args = EstimateArgs::defaults();
    args.computing.running.quiet = quiet;
    if matches!(scene.shape, Shape::Mesh(_)) {
        args.cell.rays = Some(RAYS_IN_MEMORY);
    }
    table_of(&args, scene, None).map(|(table, said, _)| (table, said))
}

/// The 2D table of planes.
fn mirror_like(args: &EstimateArgs, scene: &Scene) -> Result<(Table, String)> {
    let cell = &args.cell;
    for (given, name) in [
        (cell.incident.is_some(), "incident"),
        (cell.bins.is_some(), "bins"),
        (cell.rays.is_some(), "rays"),
        (cell.coherence.is_some(), "coherence"),
        (cell.seed.is_some(), "seed"),
        (cell.reciprocal, "reciprocal"),
        (cell.target_error.is_some(), "target-error"),
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
    let spectra = compute(&planar, &theta_deg, &wavelengths, illuminant, &args.computing)?;
    let mut rgb = Vec::new();
    if visible(&spectra.wavelength_nm) {
        let colours = colours(&spectra, illuminant, RgbSpace::from(args.colouring.space), Quadrature::Interpolated)?;
        rgb.extend(colours.iter().map(|colour| colour.rgb.map(|c| c as f32)));
        remark_on_colours(&planar, &spectra, &wavelengths, illuminant, &args.computing)?;
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
    let said = format!(
        "{} angles × {} wavelengths{size}; truncated ≤ {:.1e}, imbalance ≤ {:.1e}{again}",
        table.theta_deg.len(),
        table.wavelength_nm.len(),
        spectra.worst(|sample| sample.truncated),
        spectra.worst(|sample| sample.imbalance)
    );
    Ok((table.into(), said))
}

/// The 4D table of tilted facets.
fn scattering(
    args: &EstimateArgs,
    scene: &Scene,
    output: Option<&Path>,
) -> Result<(Table, String, Option<Checkpoint>)> {
    let refuse =
        |option: &str, why: &str| Error::usage(format_args!("{option}: {} has tilted facets; {why}", scene.name));
    if args.angles.is_some() {
        return Err(refuse("--angles", "name its directions by --incident"));
    }
    if args.computing.model != ModelArg::Physical {
        return Err(refuse("--model", "they are traced by exact physics alone"));
    }
    if args.computing.method != Method::Trace {
        return Err(refuse("--method", "they can only be traced"));
    }
    let wavelengths = args.wavelengths.as_ref().map_or_else(|| Wavelengths::every(10.0), Wavelengths::increasing);
    let wavelength_nm = named(&wavelengths, scene)?;
    let cell = &args.cell;
    if cell.target_error.is_some_and(|error| error.is_nan() || error <= 0.0) {
        return Err(Error::usage("--target-error must be positive"));
    }
    let [theta, phi] = cell.incident.map_or([8, 16], |bins| bins.0);
    let [cos, around] = cell.bins.map_or([16, 32], |bins| bins.0);
    let bins = DirectionBins { cos, phi: around };
    let layout = ScatterLayout::new(theta, phi, bins)
        .map_err(|error| Error::usage(format_args!("--incident {theta}x{phi} --bins {cos}x{around}: {error}")))?;
    let weights = visible_weights(wavelength_nm, args.colouring.illuminant.into(), Quadrature::Interpolated)?;
    let tracing = ScatterRequest {
        coherence: cell.coherence.unwrap_or_default(),
        rays: cell.rays.unwrap_or(RAYS),
        seed: cell.seed.unwrap_or(0),
        bins,
        precision: args.computing.precision,
        threads: args.computing.request().threads,
    };
    let space = args.colouring.space.into();
    let (target_error, reciprocal) = (cell.target_error, cell.reciprocal);
    let request = TableRequest { layout, tracing, target_error, weights: &weights, space, reciprocal };
    let mesh_scene = MeshScene::new(scene)?;
    remark_on_media(scene, wavelength_nm, args.computing.running.quiet);
    let checkpoint = match output {
        Some(output) => Checkpoint::open(output, &request.identity(scene, wavelength_nm), cell.restart)?,
        None => None,
    };
    let quiet = args.computing.running.quiet;
    let progress = bar(&scene.name, layout.incident_count(), quiet);
    // With the first direction, and not before: what is refused has nothing to resume.
    let (says, said) = (checkpoint.as_ref().map(Checkpoint::says), Once::new());
    let finished = || {
        said.call_once(|| says.iter().for_each(|says| progress.suspend(|| note(quiet, says))));
        progress.inc(1);
    };
    let mut table = estimate(&mesh_scene, wavelength_nm, &request, checkpoint.as_ref(), &finished)?;
    progress.finish_and_clear();
    if let Err(error) = table.check() {
        checkpoint.map_or(Ok(()), Checkpoint::remove)?;
        return Err(error);
    }
    let coherence = request.tracing.coherence;
    let imbalance = table.worst_imbalance(|imbalance| unbalanced(coherence, imbalance).is_some());
    let alone = table.energy.iter().map(|energy| energy.without_interference).fold(0.0, f64::max);
    let few = too_few(&mesh_scene, coherence, wavelength_nm);
    let warnings: Vec<String> =
        [unbalanced(coherence, imbalance), without_sum(alone), few].into_iter().flatten().collect();
    warnings.iter().for_each(|warning| note(quiet, format_args!("{}: {warning}", scene.name)));
    let imbalance = table.worst_imbalance(|_| true).value;
    table.metadata = scatter_metadata(args, scene, &request.tracing, imbalance, &warnings);
    let truncated = table.energy.iter().map(|energy| energy.truncated).fold(0.0, f64::max);
    let said = format!(
        "{theta} × {phi} incident directions × {cos} × {around} bins × {} wavelengths; standard error of the albedo ≤ {:.1e}, \
         truncated ≤ {truncated:.1e}, imbalance ≤ {:.1e}",
        wavelength_nm.len(),
        table.worst_error(),
        imbalance.abs(),
    );
    Ok((table.into(), said, checkpoint))
}

/// Metadata of a cell's table.
fn scatter_metadata(
    args: &EstimateArgs,
    scene: &Scene,
    tracing: &ScatterRequest,
    imbalance: f64,
    warnings: &[String],
) -> Metadata {
    let mut metadata = common_metadata(args, scene, imbalance);
    metadata.insert(MetadataKey::Coherence, spelled(tracing.coherence));
    metadata.insert(MetadataKey::Seed, tracing.seed.to_string());
    metadata.insert(MetadataKey::Reciprocal, args.cell.reciprocal.to_string());
    if !warnings.is_empty() {
        metadata.insert(MetadataKey::Warning, warnings.join("; "));
    }
    metadata
}

/// Metadata of a planar scene's table.
fn planar_metadata(args: &EstimateArgs, scene: &Scene, spectra: &Spectra) -> Metadata {
    let mut metadata = common_metadata(args, scene, spectra.worst(|sample| sample.imbalance));
    metadata.insert(MetadataKey::Method, spelled(args.computing.method));
    metadata.insert(MetadataKey::TruncatedMax, format!("{:e}", spectra.worst(|sample| sample.truncated)));
    metadata.insert(MetadataKey::Recomputed, spectra.recomputed.to_string());
    if args.computing.method == Method::Hits {
        metadata.insert(MetadataKey::FellBack, spectra.fell_back.to_string());
    }
    metadata
}

/// Metadata of every table. Nothing here depends on when or where, so equal runs give equal files.
fn common_metadata(args: &EstimateArgs, scene: &Scene, imbalance_max: f64) -> Metadata {
    [
        (MetadataKey::Generator, format!("goniochrome {}", env!("CARGO_PKG_VERSION"))),
        (MetadataKey::Scene, scene.name.clone()),
        (MetadataKey::SceneToml, scene.toml.clone()),
        (MetadataKey::Model, spelled(args.computing.model)),
        (MetadataKey::Precision, spelled(args.computing.precision)),
        (MetadataKey::Illuminant, spelled(args.colouring.illuminant)),
        (MetadataKey::ColourSpace, spelled(args.colouring.space)),
        (MetadataKey::Observer, "CIE 1931 2 degree".into()),
        (MetadataKey::ImbalanceMax, format!("{imbalance_max:e}")),
    ]
    .into_iter()
    .collect()
}
