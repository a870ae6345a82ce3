//! Colours of spectra: weights of the wavelengths, colour spaces and their names, luminance, colour differences.

pub mod difference;

use glam::{DMat3, DVec3};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM, xyz_weights};

use crate::support::error::{Error, Result};

/// Weights of linear R, G and B (Rec. 709 primaries, white D65) in the luminance Y: ITU-R BT.709-6, section 3.
pub const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// [`LUMINANCE`] in single precision.
pub const LUMINANCE_F32: [f32; 3] = [LUMINANCE[0] as f32, LUMINANCE[1] as f32, LUMINANCE[2] as f32];

/// Luminance of linear RGB.
#[must_use]
pub fn luminance(rgb: [f64; 3]) -> f64 {
    rgb.iter().zip(LUMINANCE).map(|(c, weight)| c * weight).sum()
}

/// Matrix from XYZ to linear RGB of a colour space.
#[must_use]
pub fn xyz_to_rgb(space: RgbSpace) -> DMat3 {
    DMat3::from_cols_array_2d(&space.matrix()).transpose()
}

/// Colours converted from one linear RGB space to another.
#[must_use]
pub fn converted(from: RgbSpace, to: RgbSpace, rgb: &[[f32; 3]]) -> Vec<[f32; 3]> {
    if from == to {
        return rgb.to_vec();
    }
    let convert = xyz_to_rgb(to) * xyz_to_rgb(from).inverse();
    rgb.iter().map(|&rgb| (convert * DVec3::from_array(rgb.map(f64::from))).to_array().map(|c| c as f32)).collect()
}

/// Colour spaces that have a name.
pub const SPACES: [RgbSpace; 4] = [RgbSpace::Srgb, RgbSpace::Paper, RgbSpace::Rec2020, RgbSpace::AcesCg];

/// Name of a colour space, on the command line and in the metadata of files.
#[must_use]
pub fn space_name(space: RgbSpace) -> &'static str {
    match space {
        RgbSpace::Srgb => "srgb",
        RgbSpace::Paper => "paper",
        RgbSpace::Rec2020 => "rec2020",
        RgbSpace::AcesCg => "acescg",
    }
}

/// Colour space by its name, in upper or lower case.
#[must_use]
pub fn space_named(name: &str) -> Option<RgbSpace> {
    SPACES.into_iter().find(|space| space_name(*space).eq_ignore_ascii_case(name))
}

/// Whether some of the increasing wavelengths may be visible, so that they have a colour.
#[must_use]
pub fn visible(wavelength_nm: &[f64]) -> bool {
    let [first, last] = VISIBLE_NM.map(f64::from);
    wavelength_nm.first().is_some_and(|&shortest| shortest <= last)
        && wavelength_nm.last().is_some_and(|&longest| longest >= first)
}

/// Weights of X, Y and Z for each wavelength.
///
/// # Errors
/// Wavelengths of which none is visible, or that [`xyz_weights`] refuses.
pub fn visible_weights(wavelength_nm: &[f64], illuminant: Illuminant, quadrature: Quadrature) -> Result<Vec<[f64; 3]>> {
    if let (Some(&shortest), Some(&longest)) = (wavelength_nm.first(), wavelength_nm.last())
        && !visible(wavelength_nm)
    {
        let [first, last] = VISIBLE_NM;
        return Err(Error::usage(format_args!(
            "--wavelengths: {shortest} to {longest} nm are invisible; a colour needs some from {first} to {last} nm"
        )));
    }
    let mut weights = vec![[0.0; 3]; wavelength_nm.len()];
    xyz_weights(wavelength_nm, illuminant, quadrature, &mut weights)
        .map_err(|error| Error::usage(format_args!("--wavelengths: {error}")))?;
    Ok(weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_stays_white_between_spaces() {
        for from in [RgbSpace::Srgb, RgbSpace::Rec2020, RgbSpace::AcesCg] {
            let [white] = converted(from, RgbSpace::Srgb, &[[1.0; 3]])[..] else { panic!("one colour") };
            // The matrices have seven digits.
            assert!(white.iter().all(|c| (c - 1.0).abs() < 1e-5), "{white:?}");
        }
    }

    #[expect(clippy::float_cmp, reason = "constants are compared, not results")]
    #[test]
    fn single_precision_weights_are_the_nearest_to_the_published_digits() {
        assert_eq!(LUMINANCE_F32, [0.2126, 0.7152, 0.0722]);
    }
}
