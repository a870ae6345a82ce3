//! The channels in which light is traced: R, G and B, or one for each wavelength.

use glam::{DMat3, DVec3, Mat3};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace};

use crate::colour::visible_weights;
use crate::support::error::{Error, Result};

/// Wavelengths at which light passes from blue to green and from green to red: the crossings of sRGB's matching
/// functions.
const PASSES_NM: [f64; 2] = [490.0, 575.0];
/// Width of each of these passages, wide enough to add no features to a spectrum.
const PASS_WIDTH_NM: f64 = 12.0;

/// Smallest determinant of the basis' colours, relative to that of exact R, G and B, at which wavelengths can tell
/// colours apart.
const MIN_DETERMINANT: f64 = 1e-3;

/// The conversion of an environment's RGB into channels, and of channels into the colour of a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Channels {
    /// The radiance of each channel where the environment's R, G or B is 1 and the others are 0.
    basis: Vec<[f32; 3]>,
    /// R, G and B of radiance 1 in each channel.
    weights: Vec<[f32; 3]>,
}

impl Channels {
    /// Three channels: R, G and B.
    #[must_use]
    pub fn rgb() -> Self {
        let identity = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { basis: identity.clone(), weights: identity }
    }

    /// A channel for each wavelength, seen by the observer under an illuminant.
    ///
    /// An environment's RGB becomes the illuminant times R b_R(λ) + G b_G(λ) + B b_B(λ). The basis starts from three
    /// smooth bands that add up to 1. It is then mixed linearly so that it still adds up to 1 (white light is the
    /// illuminant itself) and each of R, G, B alone keeps its colour on a perfect mirror. It may be slightly negative:
    /// saturated lights of sRGB are not natural spectra.
    ///
    /// # Errors
    /// Wavelengths that are invisible, or too few to tell R, G and B apart.
    pub fn spectral(wavelength_nm: &[f64], illuminant: Illuminant, space: RgbSpace) -> Result<Self> {
        let weights: Vec<DVec3> = visible_weights(wavelength_nm, illuminant, Quadrature::Interpolated)?
            .into_iter()
            .map(|xyz| DVec3::from_array(space.from_xyz(xyz)))
            .collect();
        let bands: Vec<DVec3> = wavelength_nm.iter().map(|&nm| bands(nm)).collect();
        // Column k: the colour of band k on a perfect mirror.
        let colours = |k: usize| -> DVec3 { bands.iter().zip(&weights).map(|(band, &w)| band[k] * w).sum() };
        let found = DMat3::from_cols(colours(0), colours(1), colours(2));
        let white: DVec3 = weights.iter().sum();
        let wanted = DMat3::from_diagonal(white);
        let apart = found.determinant().abs() > MIN_DETERMINANT * wanted.determinant().abs();
        if !apart {
            return Err(Error::failed(format_args!(
                "{} wavelengths cannot tell red, green and blue light apart; estimate the table with more of them, or leave \
                 --spectral out",
                wavelength_nm.len()
            )));
        }
        let mix = found.inverse() * wanted;
        let narrow = |v: DVec3| v.to_array().map(|x| x as f32);
        Ok(Self {
            basis: bands.into_iter().map(|band| narrow(mix.transpose() * band)).collect(),
            weights: weights.into_iter().map(narrow).collect(),
        })
    }

    /// The number of channels.
    #[must_use]
    pub fn count(&self) -> usize {
        self.basis.len()
    }

    /// The matrix of each channel from an environment's RGB to the RGB that a reflectance of 1 in this channel alone
    /// makes of it.
    pub(super) fn matrices(&self) -> impl Iterator<Item = Mat3> {
        self.basis.iter().zip(&self.weights).map(|(basis, weight)| {
            let column = |c: usize| (basis[c] * glam::Vec3::from(*weight)).to_array();
            Mat3::from_cols_array_2d(&[column(0), column(1), column(2)])
        })
    }

    /// Adds `scale` × throughput × the environment's light `rgb` to the radiance of each channel.
    pub fn add_light(&self, radiance: &mut [f32], throughput: &[f32], rgb: [f32; 3], scale: f32) {
        for ((sum, through), basis) in radiance.iter_mut().zip(throughput).zip(&self.basis) {
            *sum += scale * through * (basis[0] * rgb[0] + basis[1] * rgb[1] + basis[2] * rgb[2]);
        }
    }

    /// The linear RGB of the radiance in the channels.
    #[must_use]
    pub fn colour(&self, radiance: &[f32]) -> [f32; 3] {
        let mut rgb = [0.0; 3];
        for (value, weight) in radiance.iter().zip(&self.weights) {
            (0..3).for_each(|c| rgb[c] += value * weight[c]);
        }
        rgb
    }
}

/// The red, green and blue band at a wavelength; their sum is 1.
fn bands(nm: f64) -> DVec3 {
    let beyond = PASSES_NM.map(|pass| 1.0 / (1.0 + ((pass - nm) / PASS_WIDTH_NM).exp()));
    DVec3::new(beyond[1], beyond[0] - beyond[1], 1.0 - beyond[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(step: usize) -> Vec<f64> {
        (380..=780).step_by(step).map(f64::from).collect()
    }

    #[test]
    fn white_light_is_the_illuminant_and_every_light_keeps_its_colour() {
        for (illuminant, space) in [(Illuminant::D65, RgbSpace::Srgb), (Illuminant::E, RgbSpace::Paper)] {
            for step in [1, 5, 10, 20] {
                let channels = Channels::spectral(&grid(step), illuminant, space).unwrap();
                let through = vec![1.0; channels.count()];
                let shown = |rgb: [f32; 3]| {
                    let mut radiance = vec![0.0; channels.count()];
                    channels.add_light(&mut radiance, &through, rgb, 1.0);
                    (channels.colour(&radiance), radiance)
                };
                let (white, spectrum) = shown([1.0; 3]);
                assert!(spectrum.iter().all(|x| (x - 1.0).abs() < 1e-5));
                for light in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.8, 0.1]] {
                    let (colour, _) = shown(light);
                    assert!((0..3).all(|c| (colour[c] - white[c] * light[c]).abs() < 1e-4), "{light:?} {colour:?}");
                }
            }
        }
    }

    #[test]
    fn the_basis_is_nearly_positive() {
        let channels = Channels::spectral(&grid(5), Illuminant::D65, RgbSpace::Srgb).unwrap();
        let min = channels.basis.iter().flatten().copied().fold(f32::INFINITY, f32::min);
        let max = channels.basis.iter().flatten().copied().fold(0.0, f32::max);
        println!("{min} to {max}");
        assert!(min > -0.25 && max < 1.5);
    }

    #[test]
    fn too_few_wavelengths_are_refused() {
        let error = Channels::spectral(&[450.0, 550.0], Illuminant::D65, RgbSpace::Srgb).unwrap_err();
        assert!(error.to_string().contains("2 wavelengths cannot tell"), "{error}");
    }
}
