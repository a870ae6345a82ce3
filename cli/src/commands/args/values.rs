//! Values that options of several commands take.

use std::str::FromStr;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use glam::DVec3;
use goniochrome::colour::{Illuminant, RgbSpace};
use goniochrome::microfacet::Distribution;
use goniochrome::optics::interface::Model;

use crate::colour::{SPACES, space_name};
use crate::export::bsdf::Gamut;
use crate::obj::Axes;
use crate::render::tone::ToneMap;
use crate::scene::{DISTRIBUTIONS, LEAST_ROUGHNESS, named};
use crate::solve::precision::Precision;
use crate::solve::scatter::Coherence;
use crate::solve::spectra::Method;
use crate::solve::waves::OrderMethod;
use crate::support::direction::direction;
use crate::table::finish::FinishChoice;

/// The values of `--model`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum ModelArg {
    /// Waves add as complex amplitudes of s and p light; the power is |Σ|²
    Physical,
    /// Waves are weighted by Fresnel's power ratios, as the paper writes; the power is |Σ|
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

/// The values of `--body`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum BodyArg {
    /// A film in one clear medium: the light that it does not reflect goes on straight
    Sheet,
    /// The surface of a body: reflected light alone is seen
    Solid,
}

/// The values of `--illuminant`.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum IlluminantArg {
    /// Daylight of 6504 K
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

/// The values of `--space`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SpaceArg(pub RgbSpace);

impl ValueEnum for SpaceArg {
    fn value_variants<'a>() -> &'a [Self] {
        const VARIANTS: &[SpaceArg] =
            &[SpaceArg(SPACES[0]), SpaceArg(SPACES[1]), SpaceArg(SPACES[2]), SpaceArg(SPACES[3])];
        VARIANTS
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            RgbSpace::Srgb => "Linear sRGB (Rec. 709 primaries), white D65",
            RgbSpace::Paper => "The matrix printed in the paper",
            RgbSpace::Rec2020 => "Linear Rec. 2020, white D65",
            RgbSpace::AcesCg => "ACEScg (AP1 primaries), white D60",
        };
        Some(PossibleValue::new(space_name(self.0)).help(help))
    }
}

impl From<SpaceArg> for RgbSpace {
    fn from(space: SpaceArg) -> Self {
        space.0
    }
}

/// Implements clap's `ValueEnum` for a type of another module, which does not depend on the command line: variant,
/// name, help.
macro_rules! value_enum {
    ($type:ty: $($variant:ident => $name:expr, $help:literal;)+) => {
        impl ValueEnum for $type {
            fn value_variants<'a>() -> &'a [Self] {
                &[$(Self::$variant),+]
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                let (name, help) = match self {
                    $(Self::$variant => ($name, $help),)+
                };
                Some(PossibleValue::new(name).help(help))
            }
        }
    };
}

value_enum! { Method:
    Stack => "stack", "The closed form of the planar stack";
    Trace => "trace", "Ray splitting, every loop summed exactly";
    Hits => "hits", "Ray splitting hit by hit; samples that do not converge in time fall back to closed loops, and are counted";
}

value_enum! { OrderMethod:
    Waves => "waves", "Maxwell's equations, for s and p, reflected and transmitted orders, with an error bar";
    Rays => "rays", "Rays that interfere: physical optics, for features much larger than the wavelength; reflection only";
}

value_enum! { Precision:
    F32 => "f32", "Single precision: R and T of planar scenes to 1e-5; samples that need more digits are computed with more";
    F64 => "f64", "Double precision: R and T of planar scenes to 1e-11; samples that need more digits are computed with more";
}

value_enum! { Coherence:
    Ray => Coherence::Ray.name(), "Paths of one starting ray that leave within 40 degrees interfere; starting rays add as powers";
    None => Coherence::None.name(), "Nothing interferes: all paths add as powers, as in geometric optics";
    Bin => Coherence::Bin.name(), "All paths that leave in one bin interfere, whatever their starting ray: the paper's section 2.2, literally";
    Cell => Coherence::Cell.name(), "All light interferes: the period is one field, which leaves in diffraction orders";
}

value_enum! { Gamut:
    Clip => "clip", "Negative components become 0: no light is negative";
    Keep => "keep", "They stay, so that sums over light keep their colour; Mitsuba warns of them";
}

value_enum! { Axes:
    ZUp => "z-up", "z, as everywhere in this program";
    YUp => "y-up", "y, as modelling programs export unless told otherwise: x, y, z become x, −z, y";
}

value_enum! { ToneMap:
    None => "none", "No curve; colours out of range are desaturated, then scaled, as in every picture of this program";
    Reinhard => "reinhard", "Reinhard's curve on luminance, L (1 + L/16)/(1 + L): radiance 4 becomes white";
    Filmic => "filmic", "A film-like curve for each of R, G and B (Narkowicz's fit of ACES): highlights bleach";
}

/// Parses a number above 0.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be positive".into()) }
}

/// Ends of the range of `--spread`, in degrees: a narrower lobe falls between the samples of a file, a wider one is no
/// longer that of an order.
const SPREAD_DEG: [f64; 2] = [0.5, 30.0];

/// Parses `--spread`.
pub(super) fn spread(text: &str) -> Result<f64, String> {
    let [least, most] = SPREAD_DEG;
    match text.parse::<f64>() {
        Ok(degrees) if (least..=most).contains(&degrees) => Ok(degrees),
        Ok(_) => Err(format!("must lie in [{least}, {most}] degrees")),
        Err(error) => Err(error.to_string()),
    }
}

/// Roughness along x and along y: one number, or two such as `0.1,0.4`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughnessArg(pub [f64; 2]);

impl FromStr for RoughnessArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let part = |text: &str| {
            let alpha = text.trim().parse::<f64>().map_err(|error| error.to_string())?;
            if alpha > 0.0 && alpha < LEAST_ROUGHNESS {
                return Err(format!("must be at least {LEAST_ROUGHNESS}: a smoother lobe is a mirror"));
            }
            if alpha > 0.0 && alpha <= 1.0 { Ok(alpha) } else { Err("must lie in (0, 1]".into()) }
        };
        let (x, y) = text.split_once(',').unwrap_or((text, text));
        Ok(Self([part(x)?, part(y)?]))
    }
}

/// Parses the `--roughness` of a picture, which may be 0.
pub(super) fn roughness_or_mirror(text: &str) -> Result<RoughnessArg, String> {
    if text.parse() == Ok(0.0) { Ok(RoughnessArg([0.0; 2])) } else { text.parse() }
}

/// What `--roughness`, `--distribution` and `--energy-compensation` ask for.
#[must_use]
pub fn finish_choice(
    roughness: Option<RoughnessArg>,
    distribution: Option<Distribution>,
    energy_compensation: Option<bool>,
) -> FinishChoice {
    FinishChoice { roughness: roughness.map(|RoughnessArg(alpha)| alpha), distribution, energy_compensation }
}

/// Parses `--distribution`.
pub(super) fn distribution(text: &str) -> Result<Distribution, String> {
    named(&DISTRIBUTIONS, text).ok_or_else(|| "expected ggx or beckmann".into())
}

/// A direction above the surface, as polar angle and azimuth in degrees, such as `30,180`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectionArg(pub [f64; 2]);

impl DirectionArg {
    /// Checks the angles.
    ///
    /// # Errors
    /// A direction at or below the horizon, an azimuth that is not finite.
    pub fn new(theta_deg: f64, phi_deg: f64) -> Result<Self, String> {
        if !(0.0..90.0).contains(&theta_deg) {
            return Err(format!("θ = {theta_deg} is not above the horizon; it must lie in [0, 90) degrees"));
        }
        if !phi_deg.is_finite() {
            return Err(format!("φ = {phi_deg} is not finite"));
        }
        Ok(Self([theta_deg, phi_deg]))
    }

    /// The unit vector.
    #[must_use]
    pub fn vector(self) -> DVec3 {
        let [theta, phi] = self.0.map(f64::to_radians);
        direction(theta, phi)
    }
}

impl FromStr for DirectionArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        match text.split_once(',').map(|(theta, phi)| (number(theta), number(phi))) {
            Some((Some(theta), Some(phi))) => Self::new(theta, phi),
            _ => Err("expected THETA,PHI in degrees such as 30,180".into()),
        }
    }
}

/// Numbers of bins, incident directions or half vectors along both angles, such as `8x16`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bins(pub [u32; 2]);

impl FromStr for Bins {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let part = |text: &str| text.parse::<u32>().ok().filter(|n| (1..=1024).contains(n));
        match text.split_once('x').map(|(cos, phi)| (part(cos), part(phi))) {
            Some((Some(cos), Some(phi))) => Ok(Self([cos, phi])),
            _ => Err("expected two numbers such as 8x16, each from 1 to 1024".into()),
        }
    }
}

/// The name of a value on the command line.
#[must_use]
pub fn spelled(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
