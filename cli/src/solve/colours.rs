//! The colours of spectra.

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz};

use crate::colour::visible_weights;
use crate::solve::spectra::{Sample, Spectra};
use crate::support::error::Result;

/// A colour at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// CIE 1931 XYZ, with Y = 1 for ρ = 1.
    pub xyz: [f64; 3],
    /// Linear, unclipped RGB in the requested space.
    pub rgb: [f64; 3],
}

impl Colour {
    /// The RGB that a screen shows: linear sRGB, except that the RGB of the paper's matrix is shown as it is.
    #[must_use]
    pub fn display(&self, space: RgbSpace) -> [f32; 3] {
        let rgb = match space {
            RgbSpace::Srgb | RgbSpace::Paper => self.rgb,
            RgbSpace::Rec2020 | RgbSpace::AcesCg => RgbSpace::Srgb.from_xyz(self.xyz),
        };
        rgb.map(|c| c as f32)
    }
}

/// The colours of unpolarised reflectance, one for each row of samples.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn colours(
    spectra: &Spectra,
    illuminant: Illuminant,
    space: RgbSpace,
    quadrature: Quadrature,
) -> Result<Vec<Colour>> {
    colours_of(spectra, Sample::mean_reflectance, illuminant, space, quadrature)
}

/// The colours of a power, one for each row of samples.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn colours_of(
    spectra: &Spectra,
    power: fn(&Sample) -> f64,
    illuminant: Illuminant,
    space: RgbSpace,
    quadrature: Quadrature,
) -> Result<Vec<Colour>> {
    let weights = visible_weights(&spectra.wavelength_nm, illuminant, quadrature)?;
    let colour = |row| {
        let xyz = xyz(&weights, spectra.row(row).iter().map(power));
        Colour { xyz, rgb: space.from_xyz(xyz) }
    };
    Ok((0..spectra.rows()).map(colour).collect())
}
