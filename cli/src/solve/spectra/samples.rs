//! Reflectance and transmittance over a grid of angles and wavelengths.

use goniochrome::simd::complex::Polarised;

/// Reflectance and transmittance at one angle and wavelength.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Reflectance.
    pub reflectance: Polarised<f64>,
    /// Transmittance into the substrate.
    pub transmittance: Polarised<f64>,
    /// The error bar for rays that were not followed: the largest difference of the four powers from their values
    /// with closed loops. 0 for all methods but [`Hits`](crate::solve::spectra::Method::Hits).
    pub truncated: f64,
    /// The power that the tracer's ledger misses, the larger of s and p. 0 in closed form.
    pub imbalance: f64,
}

impl Sample {
    /// Unpolarised reflectance.
    #[must_use]
    pub fn mean_reflectance(&self) -> f64 {
        0.5 * (self.reflectance.s + self.reflectance.p)
    }

    /// Unpolarised transmittance.
    #[must_use]
    pub fn mean_transmittance(&self) -> f64 {
        0.5 * (self.transmittance.s + self.transmittance.p)
    }
}

/// Samples over a grid of angles and wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectra {
    /// Angles of incidence in the ambient medium.
    pub theta_deg: Vec<f64>,
    /// Vacuum wavelengths.
    pub wavelength_nm: Vec<f64>,
    /// One sample for each pair: `samples[row * wavelengths + wavelength]`. Rows are the angles, once or, after
    /// [`Spectra::append`], once for each surface.
    pub samples: Vec<Sample>,
    /// Samples that [`Hits`](crate::solve::spectra::Method::Hits) could not sum, so that their loops were closed
    /// instead.
    pub fell_back: usize,
    /// Samples that were computed again with more digits than the request's precision has, to keep its
    /// [`tolerance`](crate::solve::precision::Precision::tolerance).
    pub recomputed: usize,
}

impl Spectra {
    /// The samples of one row: at one angle.
    #[must_use]
    pub fn row(&self, row: usize) -> &[Sample] {
        let width = self.wavelength_nm.len();
        &self.samples[row * width..(row + 1) * width]
    }

    /// The number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.samples.len() / self.wavelength_nm.len()
    }

    /// Adds the rows of another surface, at the same angles and wavelengths.
    pub fn append(&mut self, other: Self) {
        self.samples.extend(other.samples);
        self.fell_back += other.fell_back;
        self.recomputed += other.recomputed;
    }

    /// The largest of a quantity over all samples.
    #[must_use]
    pub fn worst(&self, of: impl Fn(&Sample) -> f64) -> f64 {
        self.samples.iter().map(of).fold(0.0, f64::max)
    }
}
