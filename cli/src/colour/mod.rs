//! Colours of spectra: weights of the wavelengths, names of lights and colour spaces, differences.

pub mod difference;

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM, xyz_weights};

use crate::support::error::{Error, Result};

/// The light that a table's colours were made for.
#[must_use]
pub fn illuminant_of(metadata: &BTreeMap<String, String>) -> Illuminant {
    match metadata.get("illuminant").map(String::as_str) {
        Some("E") => Illuminant::E,
        _ => Illuminant::D65,
    }
}

/// The space in which a screen takes a table's colours: linear sRGB, except that the paper's matrix is its own display.
#[must_use]
pub fn screen_space(metadata: &BTreeMap<String, String>) -> RgbSpace {
    if space_of(metadata) == RgbSpace::Paper { RgbSpace::Paper } else { RgbSpace::Srgb }
}

/// A table's colours as a screen takes them.
#[must_use]
pub fn screen_rgb(metadata: &BTreeMap<String, String>, rgb: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let (from, to) = (space_of(metadata), screen_space(metadata));
    if from == to {
        return rgb.to_vec();
    }
    let matrix = |space: RgbSpace| DMat3::from_cols_array_2d(&space.matrix()).transpose();
    let convert = matrix(to) * matrix(from).inverse();
    rgb.iter().map(|&rgb| (convert * DVec3::from_array(rgb.map(f64::from))).to_array().map(|c| c as f32)).collect()
}

/// The space of a table's colours.
#[must_use]
pub fn space_of(metadata: &BTreeMap<String, String>) -> RgbSpace {
    let named = metadata.get("colour_space").map_or("", String::as_str);
    SPACES.into_iter().find(|space| space_name(*space).eq_ignore_ascii_case(named)).unwrap_or(RgbSpace::Srgb)
}

/// The colour spaces that have a name.
pub const SPACES: [RgbSpace; 4] = [RgbSpace::Srgb, RgbSpace::Paper, RgbSpace::Rec2020, RgbSpace::AcesCg];

/// The name of a colour space, on the command line and in the metadata of files.
#[must_use]
pub fn space_name(space: RgbSpace) -> &'static str {
    match space {
        RgbSpace::Srgb => "srgb",
        RgbSpace::Paper => "paper",
        RgbSpace::Rec2020 => "rec2020",
        RgbSpace::AcesCg => "acescg",
    }
}

/// Whether increasing wavelengths reach into the visible range, so that they have a colour.
#[must_use]
pub fn visible(wavelength_nm: &[f64]) -> bool {
    let [first, last] = VISIBLE_NM.map(f64::from);
    wavelength_nm.first().is_some_and(|&shortest| shortest <= last)
        && wavelength_nm.last().is_some_and(|&longest| longest >= first)
}

/// Weights of XYZ for each wavelength.
///
/// # Errors
/// If none of the wavelengths is visible.
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
