//! Scattering by cells of polygons: starting rays over the period, sums of their light in bins of directions, standard
//! errors.

mod coherence;
mod likeness;
mod request;
mod tally;
mod powers;
mod bin_fields;
mod order_bins;

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::measure::bins::DirectionGrid;
use goniochrome::simd::ray_lanes::RayLanes;

use crate::solve::batches::BATCHES;
use crate::solve::groups::{Group, Groups, group_count};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::in_lanes;
use crate::support::error::Result;
use crate::support::memory::expect_list;

pub(crate) use bin_fields::BinLight;
pub use coherence::Coherence;
pub(crate) use coherence::{Adding, Paths};
pub(crate) use likeness::{Likeness, in_ray_lanes};
pub(crate) use powers::{RayLight, Unseen, Workspace, trace_rays};
pub use request::{ScatterRequest, Scattered, Tracing};
pub(crate) use tally::Tally;

/// Scatters light from the unit direction `wi` at each wavelength, by the requested coherence. `progress` is called
/// [`steps`] times.
///
/// # Errors
/// A mesh that the core refuses, a medium without data at a wavelength, an ambient medium that absorbs too much, more
/// memory than there is, waves that do not converge, more light left out than
/// [`MAX_TRUNCATED`](crate::solve::truncation::MAX_TRUNCATED).
pub fn scatter<G: DirectionGrid + Copy + Sync>(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &ScatterRequest<G>,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Scattered>> {
    let tallies = [BATCHES as usize, wavelength_nm.len(), request.bins.count()];
    expect_list::<f64>(&tallies, "all --bins at all --wavelengths")?;
    let adding = request.coherence.adding();
    match adding {
        Adding::Powers(paths) => {
            let likeness = Likeness::of(mesh_scene, wavelength_nm, adding);
            if (paths, likeness) == (Paths::Alone, Likeness::Light) && wavelength_nm.len() > 1 {
                // Powers have no phase, so nothing differs.
                let middle = wavelength_nm[wavelength_nm.len() / 2];
                let found = scatter(mesh_scene, wi, &[middle], request, progress)?;
                return Ok(found.into_iter().cycle().take(wavelength_nm.len()).collect());
            }
            in_ray_lanes!(request.precision, likeness, wavelength_nm, V => {
                summarised::<V, G>(mesh_scene, wavelength_nm, request, |cell, groups| {
                    Ok(powers::powers(mesh_scene, cell, groups, wi, paths, request, progress))
                })
            })
        }
        Adding::Fields => in_lanes!(request.precision, V => {
            summarised::<V, G>(mesh_scene, wavelength_nm, request, |cell, groups| {
                BinLight::expect_room::<V>(&request.bins)?;
                let light = BinLight::new(mesh_scene, cell, wi, request.bins, request.tracing());
                Ok(light.all_tallies(groups, progress))
            })
        }),
        Adding::Orders => order_bins::orders_in_bins(mesh_scene, wi, wavelength_nm, request, progress),
    }
}

/// Number of calls of `progress` by [`scatter`].
#[must_use]
pub fn steps<G>(wavelengths: usize, request: &ScatterRequest<G>) -> usize {
    BATCHES as usize
        * match request.coherence.adding() {
            Adding::Powers(_) => 1,
            Adding::Fields | Adding::Orders => group_count(wavelengths, request.precision),
        }
}

/// Means and standard errors over the tallies that `work` makes of a cell: for each batch, one for each wavelength.
fn summarised<V: RayLanes, G>(
    mesh_scene: &MeshScene<'_>,
    wavelength_nm: &[f64],
    request: &ScatterRequest<G>,
    work: impl FnOnce(MeshCell<'_>, &[Group<'_, V>]) -> Result<Vec<Vec<Tally>>>,
) -> Result<Vec<Scattered>> {
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let mut groups = Groups::<V>::new(mesh_scene.scene(), wavelength_nm);
    let groups = groups.evaluate(mesh_scene.scene(), cell.above(), wavelength_nm)?;
    let batches = work(cell, &groups)?;
    let found: Vec<Scattered> =
        (0..wavelength_nm.len()).map(|i| tally::summarise(batches.iter().map(|batch| &batch[i]))).collect();
    for Scattered { reflected, transmitted, absorbed, truncated, .. } in &found {
        let totals = [reflected, transmitted, absorbed, truncated].map(|total| total.value);
        request.coherence.check_totals(mesh_scene, totals)?;
    }
    Ok(found)
}
