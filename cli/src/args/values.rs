//! Values that options of several commands take.

use clap::ValueEnum;
use goniochrome::colour::{Illuminant, RgbSpace};
use goniochrome::interface::Model;

/// `--model`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum ModelArg {
    /// Complex amplitudes of s and p, power |Σ|²
    Physical,
    /// Fresnel power ratios as weights, flux |Σ|
    Paper,
}

impl From<ModelArg> for Model {
    fn from(model: ModelArg) -> Self {
        match model {
            ModelArg::Physical => Self::Physical,
            ModelArg::Paper => Self::Paper,
        }
    }
}

/// `--illuminant`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum IlluminantArg {
    /// Daylight, 6504 K
    #[value(name = "D65")]
    D65,
    /// Equal energy
    #[value(name = "E")]
    E,
}

impl From<IlluminantArg> for Illuminant {
    fn from(illuminant: IlluminantArg) -> Self {
        match illuminant {
            IlluminantArg::D65 => Self::D65,
            IlluminantArg::E => Self::E,
        }
    }
}

/// `--space`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum SpaceArg {
    /// Linear sRGB (Rec. 709 primaries), white D65
    Srgb,
    /// The matrix printed in the paper
    Paper,
    /// Linear Rec. 2020, white D65
    Rec2020,
    /// ACEScg (AP1 primaries), white D60
    Acescg,
}

impl From<SpaceArg> for RgbSpace {
    fn from(space: SpaceArg) -> Self {
        match space {
            SpaceArg::Srgb => Self::Srgb,
            SpaceArg::Paper => Self::Paper,
            SpaceArg::Rec2020 => Self::Rec2020,
            SpaceArg::Acescg => Self::AcesCg,
        }
    }
}

/// The name of a value as the command line spells it.
#[must_use]
pub fn spelled(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
