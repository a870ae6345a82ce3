//! Ray tracing beside the closed form: the paper's section 4.5 and figure 7.

use crate::error::Result;
use crate::estimate::{Method, Request, Spectra, spectra};
use crate::picture::{Picture, Profile, side_by_side};
use crate::planar::Planar;

/// The same grid computed twice.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// By the transfer-matrix recursion.
    pub closed: Spectra,
    /// By following rays.
    pub traced: Spectra,
}

impl Comparison {
    /// Computes both; a request for the closed form is traced with loops closed.
    ///
    /// # Errors
    /// As [`spectra`].
    pub fn new(planar: &Planar<'_>, theta_deg: &[f64], wavelength_nm: &[f64], request: &Request) -> Result<Self> {
        let traced = if request.method == Method::Stack { Method::Trace } else { request.method };
        let run = |method| spectra(planar, theta_deg, wavelength_nm, &Request { method, ..*request }, &|| ());
        Ok(Self { closed: run(Method::Stack)?, traced: run(traced)? })
    }

    /// Unpolarised reflectance of both at one angle and wavelength: closed form, traced.
    #[must_use]
    pub fn pair(&self, angle: usize, wavelength: usize) -> [f64; 2] {
        [&self.closed, &self.traced].map(|spectra| spectra.row(angle)[wavelength].mean_reflectance())
    }

    /// The largest difference of s or p reflectance.
    #[must_use]
    pub fn largest_difference(&self) -> f64 {
        let pairs = self.closed.samples.iter().zip(&self.traced.samples);
        pairs.fold(0.0, |worst: f64, (a, b)| {
            let s = (a.reflectance.s - b.reflectance.s).abs();
            worst.max(s).max((a.reflectance.p - b.reflectance.p).abs())
        })
    }

    /// Reflectance against angle, side by side, and the difference.
    #[must_use]
    pub fn picture(&self, title: &str) -> Picture {
        let curves: Vec<[Vec<f64>; 2]> = (0..self.closed.wavelength_nm.len())
            .map(|wavelength| {
                [0, 1].map(|which| {
                    (0..self.closed.theta_deg.len()).map(|angle| self.pair(angle, wavelength)[which]).collect()
                })
            })
            .collect();
        let profiles: Vec<Profile<'_>> = curves
            .iter()
            .zip(&self.closed.wavelength_nm)
            .map(|([left, right], &wavelength_nm)| Profile {
                wavelength_nm,
                theta_deg: &self.closed.theta_deg,
                left,
                right,
            })
            .collect();
        side_by_side(title, "Closed form", "Ray tracing", &profiles)
    }
}
