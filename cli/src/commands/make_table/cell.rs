//! The 4D table of a cell of tilted facets.

use std::path::Path;

use goniochrome::colour::Quadrature;

use crate::colour::visible_weights;
use crate::commands::args::{EstimateArgs, ModelArg};
use crate::commands::cell_options::listed_wavelengths;
use crate::commands::make_table::made::Made;
use crate::commands::make_table::metadata::scatter_metadata;
use crate::commands::make_table::shared::{made_share, scatter_layout, sides, ticking};
use crate::commands::notes::{note_on_front, note_on_scene};
use crate::scene::Scene;
use crate::solve::cell_table::{TableRequest, default_rays, default_sides, estimate};
use crate::solve::cell_warnings::{not_converged, too_few, unbalanced};
use crate::solve::checkpoint::Checkpoint;
use crate::solve::grid::Wavelengths;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{Coherence, Tracing};
use crate::solve::spectra::Method;
use crate::support::error::{Error, Result};
use crate::support::progress::{bar, note};

/// Traces the table of a cell; also returns its summary, and its checkpoint if it has an output.
pub(super) fn scatter_table(
    args: &EstimateArgs,
    scene: &Scene,
    coherence: Coherence,
    output: Option<&Path>,
) -> Result<Made> {
    let refuse =
        |option: &str, why: &str| Error::usage(format_args!("{option}: {} has tilted facets; {why}", scene.name));
    if args.angles.is_some() {
        return Err(refuse("--angles", "name its directions by --incident"));
    }
    if args.vary.is_some() {
        return Err(refuse("--vary", "it is for the layers of a [stack]"));
    }
    if args.computing.model != ModelArg::Physical {
        return Err(refuse("--model", "they are traced by exact physics alone"));
    }
    if args.computing.method != Method::Trace {
        return Err(refuse("--method", "they can only be traced"));
    }
    if args.cell.max_harmonic.is_some() {
        return Err(refuse("--max-harmonic", "it is for --coherence cell, which is computed by waves"));
    }
    let wavelengths = args.wavelengths.as_ref().map_or_else(|| Wavelengths::every(10.0), Wavelengths::increasing);
    let wavelength_nm = listed_wavelengths(&wavelengths, scene)?;
    let cell = &args.cell;
    let mesh_scene = MeshScene::new(scene)?;
    let layout = scatter_layout(args, default_sides(&mesh_scene))?;
    let weights = visible_weights(wavelength_nm, args.colouring.illuminant.into(), Quadrature::Interpolated)?;
    let tracing = Tracing {
        coherence,
        rays: cell.rays.unwrap_or_else(|| default_rays(&mesh_scene, wavelength_nm, coherence)),
        seed: cell.seed.unwrap_or(0),
        precision: args.computing.precision,
        threads: args.computing.request().threads,
    };
    let space = args.colouring.space.into();
    let (target_error, reciprocal) = (cell.target_error, cell.reciprocal);
    let (incident, half_vectors) = (layout.incident_sides(), layout.square_sides());
    let share = args.farm.share()?;
    let weights = &weights;
    let request = TableRequest { incident, half_vectors, tracing, target_error, weights, space, share, reciprocal };
    note_on_scene(scene, wavelength_nm, args.computing.running.quiet);
    note_on_front(scene, args.computing.running.quiet);
    let checkpoint = match output {
        Some(output) => Checkpoint::open(output, &request.identity(scene, wavelength_nm), cell.restart)?,
        None => None,
    };
    let quiet = args.computing.running.quiet;
    // Light along the normal is traced once.
    let directions = layout.incident_count() + 1 - layout.incident_sides()[1] as usize;
    let directions = share.map_or(directions, |share| directions.div_ceil(share.of as usize));
    let progress = bar(&scene.name, directions, quiet);
    let finished = ticking(&progress, checkpoint.as_ref(), quiet);
    let mut table = estimate(&mesh_scene, wavelength_nm, &request, checkpoint.as_ref(), &finished)?;
    progress.finish_and_clear();
    if share.is_some() {
        return made_share(checkpoint, request.identity(scene, wavelength_nm));
    }
    if let Err(error) = table.check() {
        checkpoint.map_or(Ok(()), Checkpoint::remove)?;
        return Err(error);
    }
    let imbalance = table.worst_imbalance(|imbalance| unbalanced(coherence, imbalance).is_some());
    let alone = table.energy.iter().map(|energy| energy.without_interference).fold(0.0, f64::max);
    let few = too_few(&mesh_scene, coherence, wavelength_nm);
    let warnings: Vec<String> =
        [unbalanced(coherence, imbalance), not_converged(alone), few].into_iter().flatten().collect();
    warnings.iter().for_each(|warning| note(quiet, format_args!("{}: {warning}", scene.name)));
    let imbalance = table.worst_imbalance(|_| true).value;
    table.metadata = scatter_metadata(args, scene, &request.tracing, imbalance, &warnings);
    let truncated = table.energy.iter().map(|energy| energy.truncated).fold(0.0, f64::max);
    let summary = format!(
        "{} × {} wavelengths; standard error of the albedo ≤ {:.1e}, truncated ≤ {truncated:.1e}, imbalance ≤ {:.1e}",
        sides(&table.layout),
        wavelength_nm.len(),
        table.worst_error(),
        imbalance.abs(),
    );
    Ok(Made::Table(Box::new(table.into()), summary, checkpoint))
}
