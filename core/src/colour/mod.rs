//! Spectral reflectance to colour: CIE 1931 2° observer, illuminants E and D65, RGB spaces.
//!
//! XYZ = Σ w_i ρ(λ_i), where the weights w hold the observer, the illuminant and the grid of wavelengths, scaled so that
//! ρ = 1 has Y = 1. Linear RGB follows by a 3×3 matrix and may be negative: a table keeps such values, only pictures clip.

mod cie;

use cie::{CIE_1931, CIE_1931_FIRST_NM, D65, D65_FIRST_NM, D65_STEP_NM};

/// First and last wavelength of the sums, nm.
pub const VISIBLE_NM: [u16; 2] = [380, 780];

/// The light that falls on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Illuminant {
    /// Daylight of 6504 K.
    #[default]
    D65,
    /// Equal energy at every wavelength, the paper's choice.
    E,
}

impl Illuminant {
    /// Relative power at an integer wavelength in [`VISIBLE_NM`].
    fn power(self, nm: u16) -> f64 {
        match self {
            Self::E => 1.0,
            Self::D65 => {
                let from_first = usize::from(nm) - D65_FIRST_NM;
                let (i, rest) = (from_first / D65_STEP_NM, from_first % D65_STEP_NM);
                let at = |i: usize| D65.get(i.min(D65.len() - 1)).copied().unwrap_or(0.0);
                at(i) + (at(i + 1) - at(i)) * rest as f64 / D65_STEP_NM as f64
            }
        }
    }
}

/// How a sum over 1 nm becomes a sum over the wavelengths at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quadrature {
    /// ρ is interpolated to 1 nm by cubics through four neighbours, and held beyond the ends. A flat ρ is exact.
    #[default]
    Interpolated,
    /// The observer is sampled at the wavelengths, as the paper does (section 4.4). White depends on the samples.
    Sampled,
}

/// A colour space with linear components. Its white D65 is (0.95047, 1, 1.08883).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RgbSpace {
    /// IEC 61966-2-1 primaries, white D65.
    #[default]
    Srgb,
    /// ITU-R BT.2020 primaries, white D65.
    Rec2020,
    /// ACES AP1 primaries, white D60; Bradford adaptation from D65.
    AcesCg,
    /// The matrix that the paper prints (its section 3.2; SMPTE-C, with 1.0511 probably a misprint of 1.0501).
    Paper,
}

impl RgbSpace {
    /// The matrix from XYZ, row by row.
    #[must_use]
    pub fn matrix(self) -> [[f64; 3]; 3] {
        match self {
            Self::Srgb => [
                [3.240_454_2, -1.537_138_5, -0.498_531_4],
                [-0.969_266_0, 1.876_010_8, 0.041_556_0],
                [0.055_643_4, -0.204_025_9, 1.057_225_2],
            ],
            Self::Rec2020 => [
                [1.716_510_7, -0.355_641_7, -0.253_345_5],
                [-0.666_693_0, 1.616_502_2, 0.015_768_8],
                [0.017_643_6, -0.042_779_8, 0.942_305_1],
            ],
            Self::AcesCg => [
                [1.660_520_5, -0.315_329_8, -0.241_493_3],
                [-0.659_940_9, 1.608_420_0, 0.017_297_5],
                [0.009_009_5, -0.003_578_9, 0.913_839_2],
            ],
            Self::Paper => [[3.5064, -1.74, -0.5441], [-1.069, 1.9777, 0.0352], [0.0563, -0.197, 1.0511]],
        }
    }

    /// Linear RGB of a colour.
    #[must_use]
    pub fn from_xyz(self, xyz: [f64; 3]) -> [f64; 3] {
        self.matrix().map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
    }
}

/// Why no weights could be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColourError {
    /// No wavelengths, or `weights` of another length.
    Shape,
    /// Wavelengths must be positive and increase: the first that does not.
    NotIncreasing {
        /// Index of the wavelength.
        index: usize,
    },
    /// No wavelength to which the observer responds.
    Invisible,
}

impl core::fmt::Display for ColourError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Shape => write!(f, "no wavelengths"),
            Self::NotIncreasing { index } => write!(f, "wavelength {} is not positive or does not increase", index + 1),
            Self::Invisible => write!(f, "none of the wavelengths is visible (380 to 780 nm)"),
        }
    }
}

impl core::error::Error for ColourError {}

/// x̄ȳz̄ times illuminant at an integer wavelength.
fn response(illuminant: Illuminant, nm: u16) -> [f64; 3] {
    let observer = usize::from(nm).checked_sub(CIE_1931_FIRST_NM).and_then(|i| CIE_1931.get(i));
    observer.map_or([0.0; 3], |xyz| xyz.map(|x| x * illuminant.power(nm)))
}

/// The same between integer wavelengths, linear; zero outside [`VISIBLE_NM`].
fn response_between(illuminant: Illuminant, nm: f64) -> [f64; 3] {
    let [first, last] = VISIBLE_NM;
    if !(nm >= f64::from(first) && nm <= f64::from(last)) {
        return [0.0; 3];
    }
    let below = (libm::floor(nm) as u16).min(last - 1);
    let w = nm - f64::from(below);
    let (a, b) = (response(illuminant, below), response(illuminant, below + 1));
    core::array::from_fn(|c| a[c] + w * (b[c] - a[c]))
}

/// Weights w such that XYZ = Σ w_i ρ(λ_i), with Y = 1 for ρ = 1.
///
/// `wavelengths_nm` increases strictly; `weights` has as many elements.
///
/// # Errors
/// [`ColourError`].
pub fn xyz_weights(
    wavelengths_nm: &[f64],
    illuminant: Illuminant,
    quadrature: Quadrature,
    weights: &mut [[f64; 3]],
) -> Result<(), ColourError> {
    if wavelengths_nm.is_empty() || weights.len() != wavelengths_nm.len() {
        return Err(ColourError::Shape);
    }
    let mut last = 0.0;
    let mut increases = |nm: f64| nm > core::mem::replace(&mut last, nm) && nm.is_finite();
    if let Some(index) = wavelengths_nm.iter().position(|&nm| !increases(nm)) {
        return Err(ColourError::NotIncreasing { index });
    }
    match quadrature {
        Quadrature::Sampled => {
            for (weight, &nm) in weights.iter_mut().zip(wavelengths_nm) {
                *weight = response_between(illuminant, nm);
            }
        }
        Quadrature::Interpolated => {
            weights.fill([0.0; 3]);
            for nm in VISIBLE_NM[0]..=VISIBLE_NM[1] {
                let response = response(illuminant, nm);
                let (from, kernel) = cubic(wavelengths_nm, f64::from(nm));
                for (weight, share) in weights.iter_mut().skip(from).zip(kernel) {
                    *weight = core::array::from_fn(|c| weight[c] + share * response[c]);
                }
            }
        }
    }
    let luminance: f64 = weights.iter().map(|w| w[1]).sum();
    if luminance <= 0.0 {
        return Err(ColourError::Invisible);
    }
    for weight in weights {
        *weight = weight.map(|w| w / luminance);
    }
    Ok(())
}

/// The Lagrange polynomial through the four samples around x (fewer if there are fewer): first sample, and shares.
fn cubic(samples: &[f64], x: f64) -> (usize, [f64; 4]) {
    let order = samples.len().min(4);
    let (Some(&first), Some(&last)) = (samples.first(), samples.last()) else { return (0, [0.0; 4]) };
    let x = x.max(first).min(last);
    let above = samples.partition_point(|&s| s < x);
    let from = above.saturating_sub(order / 2).min(samples.len() - order);
    let nodes = samples.iter().skip(from).take(order);
    let mut shares = [0.0; 4];
    for (share, &node) in shares.iter_mut().zip(nodes.clone()) {
        *share = nodes.clone().filter(|&&other| other != node).map(|other| (x - other) / (node - other)).product();
    }
    (from, shares)
}

/// XYZ of a reflectance spectrum under weights made by [`xyz_weights`].
#[must_use]
pub fn xyz(weights: &[[f64; 3]], reflectance: impl IntoIterator<Item = f64>) -> [f64; 3] {
    weights.iter().zip(reflectance).fold([0.0; 3], |sum, (w, rho)| core::array::from_fn(|c| sum[c] + w[c] * rho))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights<const N: usize>(
        grid: [f64; N],
        illuminant: Illuminant,
        quadrature: Quadrature,
    ) -> Result<[[f64; 3]; N], ColourError> {
        let mut weights = [[0.0; 3]; N];
        xyz_weights(&grid, illuminant, quadrature, &mut weights).map(|()| weights)
    }

    #[test]
    fn white_is_white_on_any_grid() {
        // The 1 nm sums from 380 to 780 nm miss the tabulated white by this much.
        const SUMS: f64 = 3e-4;
        for space in [RgbSpace::Srgb, RgbSpace::Rec2020, RgbSpace::AcesCg] {
            for rgb in [
                space.from_xyz(xyz(
                    &weights([400.0, 500.0, 610.0], Illuminant::D65, Quadrature::Interpolated).unwrap(),
                    [1.0; 3],
                )),
                space.from_xyz(xyz(&weights([550.0], Illuminant::D65, Quadrature::Interpolated).unwrap(), [1.0])),
            ] {
                assert!(rgb.iter().all(|c| (c - 1.0).abs() < SUMS), "{space:?} {rgb:?}");
            }
        }
    }

    #[test]
    fn the_papers_matrix_makes_white_pink() {
        let w = weights([550.0], Illuminant::E, Quadrature::Interpolated).unwrap();
        let rgb = RgbSpace::Paper.from_xyz(xyz(&w, [1.0]));
        for (got, want) in rgb.into_iter().zip([1.222, 0.944, 0.910]) {
            assert!((got - want).abs() < 6e-4, "{rgb:?}"); // the published digits
        }
    }

    #[test]
    fn cubics_are_exact_for_cubics() {
        let samples = [400.0, 411.0, 450.0, 460.0, 500.0, 570.0];
        let f = |x: f64| 1.0 + x * (2e-3 - x * (1e-5 - 3e-8 * x));
        for x in [400.0, 405.0, 455.0, 530.0, 570.0] {
            let (from, shares) = cubic(&samples, x);
            let got: f64 = shares.iter().zip(&samples[from..]).map(|(share, &s)| share * f(s)).sum();
            assert!((got - f(x)).abs() < 1e-12, "{x}: {got}");
        }
    }

    #[test]
    fn what_cannot_be_weighed_is_refused() {
        assert_eq!(
            weights([500.0, 500.0], Illuminant::E, Quadrature::Sampled),
            Err(ColourError::NotIncreasing { index: 1 })
        );
        assert_eq!(weights([-1.0], Illuminant::E, Quadrature::Sampled), Err(ColourError::NotIncreasing { index: 0 }));
        assert_eq!(weights([900.0, 950.0], Illuminant::E, Quadrature::Sampled), Err(ColourError::Invisible));
        assert_eq!(xyz_weights(&[], Illuminant::E, Quadrature::Sampled, &mut []), Err(ColourError::Shape));
    }
}
