//! Spectral reflectance to colour: CIE 1931 2° observer, illuminants E and D65, RGB spaces.
//!
//! XYZ = ∫ ρ x̄ȳz̄ S dλ / ∫ ȳ S dλ = Σ w_i ρ(λ_i), where the weights w hold the observer, the illuminant S and the grid
//! of wavelengths, so that ρ = 1 has Y = 1. Linear RGB follows by a 3×3 matrix and may be negative: a table keeps such
//! values, only pictures clip.

mod cie;
mod cubic;

pub use cubic::SpectrumCubic;

use cie::{CIE_1931, CIE_1931_FIRST_NM, D65, D65_FIRST_NM, D65_STEP_NM};

/// First and last wavelength of the integrals, nm.
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

/// How the integral over the wavelength becomes a sum over the wavelengths at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quadrature {
    /// ρ is interpolated by cubics ([`SpectrumCubic`]) and held beyond the ends; observer and illuminant are linear
    /// between whole nanometres; their product is integrated exactly. Every sample counts, on any grid, and a flat ρ is
    /// exact.
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

/// x̄ȳz̄ times illuminant at any wavelength, linear between integer ones; zero outside [`VISIBLE_NM`].
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
            integrate(wavelengths_nm, illuminant, weights);
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

/// Adds to each weight the integral of its sample's share of the spectrum times the response.
fn integrate(samples: &[f64], illuminant: Illuminant, weights: &mut [[f64; 3]]) {
    let [from, to] = VISIBLE_NM.map(f64::from);
    let last = samples.len().saturating_sub(1);
    let (Some(&lowest), Some(&highest)) = (samples.first(), samples.last()) else { return };
    let mut pieces = Pieces::new(illuminant);
    let mut span = |cubic: SpectrumCubic, a: f64, b: f64| {
        // The CIE's sum over whole nanometres is the trapezoidal rule and half of the two ends. With them a flat
        // spectrum has the published white.
        for end in VISIBLE_NM.into_iter().filter(|&nm| a < f64::from(nm) && f64::from(nm) <= b) {
            add(
                weights,
                &cubic,
                cubic.shares(f64::from(end)).map(|share| response(illuminant, end).map(|x| 0.5 * share * x)),
            );
        }
        let (a, b) = (a.max(from), b.min(to));
        if a < b {
            add(weights, &cubic, pieces.sums(&cubic, a, b));
        }
    };
    span(SpectrumCubic::constant(0), 0.0, lowest);
    for (interval, pair) in samples.windows(2).enumerate() {
        if let ([a, b], Some(cubic)) = (pair, SpectrumCubic::new(samples, interval)) {
            span(cubic, *a, *b);
        }
    }
    span(SpectrumCubic::constant(last), highest, f64::INFINITY);
}

/// Adds sums over a cubic's four samples to their weights.
fn add(weights: &mut [[f64; 3]], cubic: &SpectrumCubic, sums: [[f64; 3]; 4]) {
    for (sum, index) in sums.into_iter().zip(cubic.index()) {
        if let Some(weight) = weights.get_mut(index) {
            *weight = core::array::from_fn(|c| weight[c] + sum[c]);
        }
    }
}

/// Integration between whole nanometres, where the response is linear.
struct Pieces {
    illuminant: Illuminant,
    /// The nanometre whose response, and whose end's, are at hand.
    nm: u16,
    response: [[f64; 3]; 2],
}

/// Abscissas in (0, 1) and weights of Gauss's rule of three points. A cubic times a line is of degree 4; it is exact to
/// 5.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

impl Pieces {
    fn new(illuminant: Illuminant) -> Self {
        Self { illuminant, nm: u16::MAX, response: [[0.0; 3]; 2] }
    }

    /// The integrals of a cubic's shares times the response from `a` to `b`, both in [`VISIBLE_NM`].
    fn sums(&mut self, cubic: &SpectrumCubic, a: f64, b: f64) -> [[f64; 3]; 4] {
        let mut sums = [[0.0; 3]; 4];
        let mut low = a;
        while low < b {
            let nm = libm::floor(low) as u16;
            if nm != self.nm {
                self.nm = nm;
                self.response = [nm, nm + 1].map(|nm| response(self.illuminant, nm));
            }
            let high = b.min(f64::from(nm + 1));
            let [start, end] = self.response;
            for (t, weight) in GAUSS {
                let x = low + t * (high - low);
                let (u, width) = (x - f64::from(nm), weight * (high - low));
                let response: [f64; 3] = core::array::from_fn(|c| width * (start[c] + u * (end[c] - start[c])));
                for (sum, share) in sums.iter_mut().zip(cubic.shares(x)) {
                    *sum = core::array::from_fn(|c| sum[c] + share * response[c]);
                }
            }
            low = high;
        }
        sums
    }
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
    fn every_sample_counts_between_whole_nanometres() {
        // A line of 0.2 nm between 550 and 551 nm: a sum over whole nanometres misses it, the integral is its area.
        let grid: [f64; 401 + 9] = core::array::from_fn(|i| match i {
            0..=170 => 380.0 + i as f64,
            171..=179 => 550.1 + 0.1 * (i - 171) as f64,
            _ => 371.0 + i as f64,
        });
        let w = weights(grid, Illuminant::E, Quadrature::Interpolated).unwrap();
        let line = |nm: f64| (1.0 - (nm - 550.5).abs() / 0.2).max(0.0);
        let got = xyz(&w, grid.map(line));
        /// Area of the triangle times ȳ(550.5 nm) over Σ ȳ.
        const WANTED: f64 = 0.2 * 0.995 / 106.857;
        /// The cubics round the triangle's corners.
        const CORNERS: f64 = 0.05;
        assert!((got[1] / WANTED - 1.0).abs() < CORNERS, "{got:?}");
    }

    #[test]
    fn any_grid_integrates_a_line_alike() {
        let rho = |nm: f64| 0.2 + 1e-3 * (nm - 400.0);
        let of = |w: &[[f64; 3]], grid: &[f64]| xyz(w, grid.iter().map(|&nm| rho(nm)));
        let coarse = [380.0, 391.3, 520.0, 520.01, 520.02, 640.7, 780.0];
        let fine: [f64; 401] = core::array::from_fn(|i| 380.0 + i as f64);
        for illuminant in [Illuminant::E, Illuminant::D65] {
            let a = of(&weights(coarse, illuminant, Quadrature::Interpolated).unwrap(), &coarse);
            let b = of(&weights(fine, illuminant, Quadrature::Interpolated).unwrap(), &fine);
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
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
