//! Comparison of ray tracing with the closed form: the paper's section 4.5 and figure 7.

use crate::plot::{Picture, Profile, side_by_side};
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::{Method, Spectra, SpectraRequest, spectra};
use crate::support::error::Result;

/// Spectra of one grid of angles and wavelengths, computed by two methods.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Spectra by the transfer-matrix recursion.
    pub closed: Spectra,
    /// Spectra by ray tracing.
    pub traced: Spectra,
}

impl Comparison {
    /// Computes the spectra by both methods. The traced spectra take the method of the request, or ray splitting with
    /// closed loops if the request names the closed form.
    ///
    /// # Errors
    /// What [`spectra`] refuses: media that are unknown at a wavelength, or angles and wavelengths out of range.
    pub fn new(
        planar: &PlanarScene<'_>,
        theta_deg: &[f64],
        wavelength_nm: &[f64],
        request: &SpectraRequest,
    ) -> Result<Self> {
        let traced = if request.method == Method::Stack { Method::Trace } else { request.method };
        let run = |method| spectra(planar, theta_deg, wavelength_nm, &SpectraRequest { method, ..*request }, &|| ());
        Ok(Self { closed: run(Method::Stack)?, traced: run(traced)? })
    }

    /// Unpolarised reflectances at one angle and wavelength: closed form, then traced.
    #[must_use]
    pub fn pair(&self, angle: usize, wavelength: usize) -> [f64; 2] {
        [&self.closed, &self.traced].map(|spectra| spectra.row(angle)[wavelength].mean_reflectance())
    }

    /// The largest difference of s or p reflectance between the two methods.
    #[must_use]
    pub fn largest_difference(&self) -> f64 {
        let pairs = self.closed.samples.iter().zip(&self.traced.samples);
        pairs.fold(0.0, |worst: f64, (a, b)| {
            let s = (a.reflectance.s - b.reflectance.s).abs();
            worst.max(s).max((a.reflectance.p - b.reflectance.p).abs())
        })
    }

    /// A picture of both reflectances against the angle, side by side, and of their difference.
    #[must_use]
    pub fn picture(&self, title: &str) -> Picture {
        // Commands keep the order in which angles and wavelengths were given; a picture has axes.
        let angles = increasing(&self.closed.theta_deg);
        let wavelengths = increasing(&self.closed.wavelength_nm);
        let theta_deg: Vec<f64> = angles.iter().map(|&angle| self.closed.theta_deg[angle]).collect();
        let curves: Vec<[Vec<f64>; 2]> = wavelengths
            .iter()
            .map(|&wavelength| {
                [0, 1].map(|which| angles.iter().map(|&angle| self.pair(angle, wavelength)[which]).collect())
            })
            .collect();
        let profiles: Vec<Profile<'_>> = curves
            .iter()
            .zip(&wavelengths)
            .map(|([left, right], &wavelength)| Profile {
                wavelength_nm: self.closed.wavelength_nm[wavelength],
                theta_deg: &theta_deg,
                left,
                right,
            })
            .collect();
        side_by_side(title, "Closed form", "Ray tracing", &profiles)
    }
}

/// The indices of numbers in increasing order of the numbers, of equal numbers one.
fn increasing(numbers: &[f64]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..numbers.len()).collect();
    places.sort_by(|&a, &b| numbers[a].total_cmp(&numbers[b]));
    places.dedup_by(|a, b| numbers[*a].total_cmp(&numbers[*b]).is_eq());
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_have_their_axes_in_order() {
        assert_eq!(increasing(&[60.0, 0.0, 30.0, 0.0]), [1, 2, 0]);
    }
}
