//! Spectra to colours.

use std::collections::BTreeMap;

use clap::ValueEnum;
use glam::{DMat3, DVec3};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM, xyz, xyz_weights};

use crate::args::SpaceArg;
use crate::error::{Error, Result};
use crate::estimate::Spectra;

/// A colour at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// CIE 1931, Y = 1 for ρ = 1.
    pub xyz: [f64; 3],
    /// Linear, unclipped, in the space asked for.
    pub rgb: [f64; 3],
}

impl Colour {
    /// What a screen shows: linear sRGB, except that the paper's matrix is its own display.
    #[must_use]
    pub fn display(&self, space: RgbSpace) -> [f32; 3] {
        let rgb = match space {
            RgbSpace::Srgb | RgbSpace::Paper => self.rgb,
            RgbSpace::Rec2020 | RgbSpace::AcesCg => RgbSpace::Srgb.from_xyz(self.xyz),
        };
        rgb.map(|c| c as f32)
    }
}

/// The colour of unpolarised reflectance at each angle of a grid.
///
/// # Errors
/// If none of the wavelengths is visible.
pub fn colours(
    spectra: &Spectra,
    illuminant: Illuminant,
    space: RgbSpace,
    quadrature: Quadrature,
) -> Result<Vec<Colour>> {
    let weights = visible_weights(&spectra.wavelength_nm, illuminant, quadrature)?;
    let colour = |angle| {
        let xyz = xyz(&weights, spectra.row(angle).iter().map(|sample| sample.mean_reflectance()));
        Colour { xyz, rgb: space.from_xyz(xyz) }
    };
    Ok((0..spectra.theta_deg.len()).map(colour).collect())
}

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
    SpaceArg::from_str(named, true).map_or(RgbSpace::Srgb, RgbSpace::from)
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
