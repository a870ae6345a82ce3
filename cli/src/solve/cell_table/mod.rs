//! Tables of cells of tilted facets: every incident direction is traced, and its light counted in bins.

mod request;
mod record;
mod sums;
mod worker;
mod reciprocal;

use std::sync::OnceLock;

use goniochrome::simd::lanes::Lanes;

use crate::solve::checkpoint::Checkpoint;
use crate::solve::groups::Groups;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::in_lanes;
use crate::solve::scatter::{BinLight, Workspace};
use crate::solve::wave_limits::slots_without_fallback;
use crate::support::error::Result;
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::metadata::Metadata;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size};
use record::DirectionRecord;
use worker::{TableSum, TableWorker, table_sum};

pub use reciprocal::reciprocal;
pub use request::TableRequest;
pub use worker::MAX_RAYS;

/// Traces the table of a cell, without metadata. `progress` is called after each incident direction. Directions that
/// the checkpoint holds are taken from it, the others are added to it.
///
/// The rays of every direction are divided into 32 independently scrambled batches, whose spread gives the standard
/// error. With one incident azimuth (an isotropic table) the batches come from as many azimuths around the normal, and
/// the error includes the spread between them; where starting rays interfere, each azimuth has 32 batches of its own.
///
/// # Errors
/// Coherence `cell`, a table that is too large, more light left out than
/// [`MAX_TRUNCATED`](crate::solve::truncation::MAX_TRUNCATED), a mesh that the core refuses, a medium without data at a
/// wavelength, a checkpoint that cannot be read or written.
pub fn estimate(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    check_scatter_size(&request.layout, wavelength_nm.len())?;
    let mut table = in_lanes!(request.tracing.precision, V => {
        traced::<V>(mesh_scene, wavelength_nm, request, checkpoint, progress)
    })?;
    if request.reciprocal {
        reciprocal(&mut table);
    }
    set_rgb(&mut table, request);
    Ok(table)
}

/// The table with spectra and errors, still without colours.
fn traced<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    let sum = table_sum(request.tracing.coherence)?;
    if let TableSum::Fields = sum {
        BinLight::expect_room::<V>(&request.tracing.bins)?;
    }
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let mut groups = Groups::<V>::new(mesh_scene.scene(), wavelength_nm);
    let groups = groups.evaluate(mesh_scene.scene(), cell.above(), wavelength_nm)?;
    let layout = request.layout;
    let (bins, pairs) = (layout.bins().count(), layout.count());
    let mut table = ScatterTable {
        layout,
        wavelength_nm: wavelength_nm.to_vec(),
        brdf: filled(0.0, pairs * wavelength_nm.len(), "the table")?,
        rgb: filled([0.0; 3], pairs, "the table")?,
        luminance_error: filled(0.0, pairs, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: Metadata::default(),
    };
    let brdfs = table.brdf.chunks_mut(bins * wavelength_nm.len());
    let rows = brdfs.zip(table.luminance_error.chunks_mut(bins)).zip(&mut table.energy);
    let mut rows: Vec<_> = rows.map(|((brdf, error), energy)| Some(DirectionRecord { brdf, error, energy })).collect();
    if let Some(checkpoint) = checkpoint {
        checkpoint.restore(
            DirectionRecord::bytes(bins, wavelength_nm.len()),
            layout.incident_count(),
            |incident, part| {
                if let Some(mut direction) = rows[incident].take() {
                    direction.read(part);
                    progress();
                }
            },
        )?;
    }
    let failure = OnceLock::new();
    parallel::for_each(
        request.tracing.threads,
        rows.into_iter().enumerate().filter_map(|(incident, row)| Some((incident, row?))),
        || TableWorker {
            cell,
            groups: &groups,
            request,
            sum,
            slots: slots_without_fallback(mesh_scene),
            memory: Workspace::<V>::new(mesh_scene),
        },
        |worker, (incident, row)| {
            if failure.get().is_some() {
                return; // the table is refused already
            }
            let energy = worker.trace_direction(incident, row.brdf, row.error);
            *row.energy = energy;
            let totals = [energy.reflected.value, energy.transmitted, energy.absorbed, energy.truncated];
            let kept = request
                .tracing
                .coherence
                .check_totals(mesh_scene, totals)
                .and_then(|()| checkpoint.map_or(Ok(()), |checkpoint| checkpoint.keep(incident, &row.write())));
            if let Err(error) = kept {
                let _ = failure.set(error);
            }
            progress();
        },
    );
    failure.into_inner().map_or(Ok(table), Err)
}

/// Sets the RGB of f from its spectra.
fn set_rgb(table: &mut ScatterTable, request: &TableRequest<'_>) {
    let bins = table.layout.bins().count();
    let wavelengths = table.wavelength_nm.len();
    for (rgb, brdf) in table.rgb.chunks_mut(bins).zip(table.brdf.chunks(bins * wavelengths)) {
        for (bin, rgb) in rgb.iter_mut().enumerate() {
            let spectrum = (0..wavelengths).map(|w| f64::from(brdf[w * bins + bin]));
            *rgb = request.space.from_xyz(goniochrome::colour::xyz(request.weights, spectrum)).map(|c| c as f32);
        }
    }
}
