//! Spectra at one place of a surface, by the requested method.

use super::request::{Method, SpectraRequest};
use super::samples::Spectra;
use super::{hit_by_hit, planar_grid};
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;

/// Reflectance and transmittance where all thicknesses are as written.
///
/// # Errors
/// A medium without data at a wavelength, an ambient medium that absorbs too much, a grid of too many samples.
pub(super) fn spectra(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Spectra> {
    let found = planar_grid::compute(planar, theta_deg, wavelength_nm, request, progress)?;
    if request.method != Method::Hits {
        return Ok(found);
    }
    let closed = SpectraRequest { method: Method::Trace, ..*request };
    let closed = planar_grid::compute(planar, theta_deg, wavelength_nm, &closed, &|| ())?;
    Ok(hit_by_hit::replace_unconverged(found, &closed, request.precision))
}
