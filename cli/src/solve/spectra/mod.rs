//! Spectra of planar scenes over angles and wavelengths.

mod request;
mod samples;
mod hit_by_hit;
mod planar_grid;
mod one_place;
mod places;

use crate::solve::planar_scene::PlanarScene;
use crate::support::error::Result;

pub use request::{Method, SpectraRequest};
pub use samples::{Sample, Spectra};

/// Reflectance and transmittance of a planar scene at every angle and wavelength, as means over the places of its
/// surface. `progress` is called after each angle.
///
/// # Errors
/// A medium without data at a wavelength, an ambient medium that absorbs too much, a grid of more samples than a table
/// may hold, thicknesses that vary too much to be averaged.
pub fn spectra(
    planar: &PlanarScene<'_>,
    theta_deg: &[f64],
    wavelength_nm: &[f64],
    request: &SpectraRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Spectra> {
    if planar.spreads().is_empty() {
        return one_place::spectra(planar, theta_deg, wavelength_nm, request, progress);
    }
    places::mean(planar, theta_deg, wavelength_nm, request, progress)
}
