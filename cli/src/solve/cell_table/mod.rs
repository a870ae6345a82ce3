//! Tables of cells of tilted facets: every incident direction is traced, and its light counted by half vectors, and in
//! lobes of flat facets.

mod request;
mod record;
mod sums;
mod flat;
mod defaults;
mod warp;
mod starts;
mod node_areas;
mod worker;
mod lobes;
mod reciprocal;

use std::sync::OnceLock;

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::table::{HalfVectorWarp, ScatterLayout};

use crate::solve::checkpoint::Checkpoint;
use crate::solve::groups::Groups;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{BinLight, Likeness, Workspace, in_ray_lanes};
use crate::solve::wave_limits::slots_without_fallback;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::metadata::Metadata;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size, warp_pairs};
use flat::{are_parallel, flat_normals, indices_under_planes, possible_lobes};
use lobes::lobes_with_light;
use record::DirectionRecord;
use warp::densities;
use worker::{Places, TableSum, TableWorker, table_sum};

pub use defaults::{Sides, default_rays, default_sides};
pub(crate) use node_areas::NodeAreas;
pub use reciprocal::reciprocal;
pub use request::TableRequest;
pub use worker::{MAX_RAYS, lobe_directions};

/// Traces the table of a cell, without metadata. `progress` is called after each incident direction. Directions that
/// the checkpoint holds are taken from it, the others are added to it.
///
/// The rays of every direction start in strata of equal shares of the facets that they meet first; the differences
/// between neighbouring strata give the standard error. With one incident azimuth (an isotropic table) they come from
/// 32 azimuths around the normal. Where starting rays interfere, batches of them give the error by the jackknife.
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
    let likeness = Likeness::of(mesh_scene, wavelength_nm, request.tracing.coherence.adding());
    let mut table = in_ray_lanes!(request.tracing.precision, likeness, wavelength_nm, V => {
        traced::<V>(mesh_scene, wavelength_nm, request, checkpoint, progress)
    })?;
    share_normal_incidence(&mut table);
    if request.reciprocal && request.share.is_none() {
        reciprocal(&mut table)?;
    }
    table.values.iter_mut().chain(&mut table.luminance_error).for_each(|value| *value = rounded(*value));
    set_rgb(&mut table, request);
    Ok(table)
}

/// The table with spectra and errors, still without colours.
fn traced<V: RayLanes>(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &TableRequest<'_>,
    checkpoint: Option<&Checkpoint>,
    progress: &(dyn Fn() + Sync),
) -> Result<ScatterTable> {
    let sum = table_sum(request.tracing.coherence)?;
    let bare = ScatterLayout::new(request.incident, request.half_vectors, 0).map_err(Error::failed)?;
    check_scatter_size(&bare, wavelength_nm.len())?;
    if let TableSum::Fields = sum {
        BinLight::<DirectionBins>::expect_room::<V>(&bins_like(&bare))?;
    }
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let mut groups = Groups::<V>::new(mesh_scene.scene(), wavelength_nm);
    let groups = groups.evaluate(mesh_scene.scene(), cell.above(), wavelength_nm)?;
    let isotropic = bare.is_isotropic();
    // Around the normal, only level facets keep their directions.
    let flat: Vec<_> =
        flat_normals(mesh_scene).into_iter().filter(|n| !isotropic || are_parallel(*n, DVec3::Z)).collect();
    let warp = densities(mesh_scene, &flat, isotropic);
    let [pairs_u, pairs_v] = warp_pairs(&warp)?;
    let half_vectors = HalfVectorWarp::from_pairs(&pairs_u, &pairs_v).map_err(Error::failed)?;
    let indices = indices_under_planes(mesh_scene, wavelength_nm[wavelength_nm.len() / 2])?;
    // Without flat facets nothing is looked for.
    let possible = if flat.is_empty() { Vec::new() } else { possible_lobes(&flat, &indices) };
    let seed = request.tracing.seed;
    let lobes = lobes_with_light(mesh_scene, cell, &groups, &bare, half_vectors, &possible, seed);
    // There are at most 64 lobes.
    let layout =
        ScatterLayout::new(request.incident, request.half_vectors, lobes.len() as u32).map_err(Error::failed)?;
    let (places, count) = (layout.places(), layout.count());
    let mut table = ScatterTable {
        layout,
        warp,
        lobes,
        wavelength_nm: wavelength_nm.to_vec(),
        values: filled(0.0, count * wavelength_nm.len(), "the table")?,
        rgb: filled([0.0; 3], count, "the table")?,
        luminance_error: filled(0.0, count, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: Metadata::default(),
    };
    let spectra = table.values.chunks_mut(places * wavelength_nm.len());
    let rows = spectra.zip(table.luminance_error.chunks_mut(places)).zip(&mut table.energy);
    let mut rows: Vec<_> =
        rows.map(|((values, error), energy)| Some(DirectionRecord { values, error, energy })).collect();
    if let Some(checkpoint) = checkpoint {
        checkpoint.restore(
            DirectionRecord::bytes(places, wavelength_nm.len()),
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
        // All columns of the first row are light along the normal, which is traced once.
        rows.into_iter()
            .enumerate()
            .filter(|(incident, _)| !(1..layout.incident_sides()[1] as usize).contains(incident))
            .filter(|(incident, _)| request.share.is_none_or(|share| share.takes(*incident)))
            .filter_map(|(incident, row)| Some((incident, row?))),
        || TableWorker {
            cell,
            groups: &groups,
            request,
            places: Places { layout, warp: half_vectors, lobes: &table.lobes },
            sum,
            slots: slots_without_fallback(mesh_scene),
            memory: Workspace::<V>::new(mesh_scene),
        },
        |worker, (incident, mut row)| {
            if failure.get().is_some() {
                return; // the table is refused already
            }
            worker.trace_direction(incident, &mut row);
            let energy = *row.energy;
            let totals = [energy.reflected.value, energy.transmitted, energy.absorbed, energy.truncated];
            let checked = request.tracing.coherence.check_totals(mesh_scene, totals);
            let is_refused = checked.is_err();
            let kept =
                checked.and_then(|()| checkpoint.map_or(Ok(()), |checkpoint| checkpoint.keep(incident, &row.write())));
            if let Err(error) = kept {
                let _ = failure.set((error, is_refused));
            }
            progress();
        },
    );
    let Some((error, is_refused)) = failure.into_inner() else { return Ok(table) };
    if let (true, Some(checkpoint)) = (is_refused, checkpoint) {
        checkpoint.abandon();
    }
    Err(error)
}

/// A grid of as many bins as a layout has nodes, to reckon memory with.
fn bins_like(layout: &ScatterLayout) -> DirectionBins {
    let [u, v] = layout.square_sides();
    DirectionBins { cos: u, phi: v }
}

/// Copies what was traced along the normal to all columns of the first row.
fn share_normal_incidence(table: &mut ScatterTable) {
    let columns = table.layout.incident_sides()[1] as usize;
    let (places, wavelengths) = (table.layout.places(), table.wavelength_nm.len());
    for column in 1..columns {
        table.values.copy_within(..places * wavelengths, column * places * wavelengths);
        table.luminance_error.copy_within(..places, column * places);
        table.energy[column] = table.energy[0];
    }
}

/// Sets the RGB of the values from their spectra.
fn set_rgb(table: &mut ScatterTable, request: &TableRequest<'_>) {
    let places = table.layout.places();
    let wavelengths = table.wavelength_nm.len();
    for (rgb, values) in table.rgb.chunks_mut(places).zip(table.values.chunks(places * wavelengths)) {
        for (place, rgb) in rgb.iter_mut().enumerate() {
            let spectrum = (0..wavelengths).map(|w| f64::from(values[w * places + place]));
            *rgb =
                request.space.from_xyz(goniochrome::colour::xyz(request.weights, spectrum)).map(|c| rounded(c as f32));
        }
    }
}

/// The number to 13 significant bits, 6e-5 of it: far below the noise of rays. Files of such numbers are half as large.
fn rounded(x: f32) -> f32 {
    const DROPPED: u32 = 11;
    let half = 1 << (DROPPED - 1);
    f32::from_bits((x.to_bits() + half) >> DROPPED << DROPPED)
}
