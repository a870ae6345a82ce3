//! Weights that turn a reflectance spectrum into XYZ.

use super::cubic::SpectrumCubic;
use super::illuminant::Illuminant;
use super::observer::{CIE_1931, CIE_1931_FIRST_NM};

/// First and last wavelength of the integrals over the visible range, in nanometres.
pub const VISIBLE_NM: [u16; 2] = [380, 780];

/// Rule that replaces the integral over the wavelength by a sum over the given wavelengths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quadrature {
    /// Exact integral of interpolated functions: ρ is piecewise cubic ([`SpectrumCubic`]) and constant beyond the ends;
    /// observer and illuminant are linear between whole nanometres. Every sample counts on any grid, and a flat ρ is
    /// exact.
    #[default]
    Interpolated,
    /// Observer and illuminant sampled at the given wavelengths, as in the paper (section 4.4). White depends on the
    /// samples.
    Sampled,
}

/// An error in the arguments of [`xyz_weights`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColourError {
    /// There are no wavelengths, or `weights` has another length.
    Shape,
    /// A wavelength is not positive, not finite or not larger than the one before.
    NotIncreasing {
        /// Index of the first such wavelength.
        index: usize,
    },
    /// The observer responds to none of the wavelengths.
    Invisible,
}

impl core::fmt::Display for ColourError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Shape => write!(f, "there are no wavelengths, or not as many weights"),
            Self::NotIncreasing { index } => write!(f, "wavelength {} is not positive or does not increase", index + 1),
            Self::Invisible => write!(f, "none of the wavelengths is visible (380 to 780 nm)"),
        }
    }
}

impl core::error::Error for ColourError {}

/// Product of x̄ȳz̄ and the illuminant at a whole wavelength in nanometres.
fn response(illuminant: Illuminant, nm: u16) -> [f64; 3] {
    let observer = usize::from(nm).checked_sub(CIE_1931_FIRST_NM).and_then(|i| CIE_1931.get(i));
    observer.map_or([0.0; 3], |xyz| xyz.map(|x| x * illuminant.power(nm)))
}

/// Product of x̄ȳz̄ and the illuminant at any wavelength, linear between whole ones; 0 outside [`VISIBLE_NM`].
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

/// Computes weights w such that XYZ = Σ w_i ρ(λ_i), with Y = 1 for ρ = 1.
///
/// `wavelengths_nm` are positive and increase strictly; `weights` has as many elements.
///
/// # Errors
/// [`ColourError::Shape`] if there are no wavelengths or the lengths differ, [`ColourError::NotIncreasing`] at the
/// first wavelength that is not positive, finite and larger than the one before, and [`ColourError::Invisible`] if none
/// lies in [`VISIBLE_NM`].
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

/// Adds to each sample's weight the integral of the sample's share in ρ times the response.
fn integrate(samples: &[f64], illuminant: Illuminant, weights: &mut [[f64; 3]]) {
    let [from, to] = VISIBLE_NM.map(f64::from);
    let last = samples.len().saturating_sub(1);
    let (Some(&lowest), Some(&highest)) = (samples.first(), samples.last()) else { return };
    let mut pieces = Pieces::new(illuminant);
    let mut span = |cubic: SpectrumCubic, a: f64, b: f64| {
        // The CIE's sum over whole nanometres is the trapezoidal rule plus half of the values at the two ends. With
        // these halves a flat spectrum has the published white.
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

/// Adds integrals over a cubic's four samples to the weights of those samples.
fn add(weights: &mut [[f64; 3]], cubic: &SpectrumCubic, sums: [[f64; 3]; 4]) {
    for (sum, index) in sums.into_iter().zip(cubic.index()) {
        if let Some(weight) = weights.get_mut(index) {
            *weight = core::array::from_fn(|c| weight[c] + sum[c]);
        }
    }
}

/// Integrator that goes from one whole nanometre to the next, since the response is linear between them.
struct Pieces {
    illuminant: Illuminant,
    /// Whole nanometre at which the interval of `response` starts.
    nm: u16,
    /// Response at the start and at the end of the interval.
    response: [[f64; 3]; 2],
}

/// Abscissas in (0, 1) and weights of Gauss's rule of three points. It is exact to degree 5; a cubic times a line has
/// degree 4.
const GAUSS: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

impl Pieces {
    fn new(illuminant: Illuminant) -> Self {
        Self { illuminant, nm: u16::MAX, response: [[0.0; 3]; 2] }
    }

    /// Integrals of a cubic's four shares times the response from `a` to `b`, both in [`VISIBLE_NM`].
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

/// XYZ of a reflectance spectrum, by weights from [`xyz_weights`].
#[must_use]
pub fn xyz(weights: &[[f64; 3]], reflectance: impl IntoIterator<Item = f64>) -> [f64; 3] {
    weights.iter().zip(reflectance).fold([0.0; 3], |sum, (w, rho)| core::array::from_fn(|c| sum[c] + w[c] * rho))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::RgbSpace;

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
        // Sums in steps of 1 nm from 380 to 780 nm differ from the tabulated white by this much.
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
        // A spectral line of 0.2 nm between 550 and 551 nm. A sum over whole nanometres misses it; its integral is its
        // area.
        let grid: [f64; 401 + 9] = core::array::from_fn(|i| match i {
            0..=170 => 380.0 + i as f64,
            171..=179 => 550.1 + 0.1 * (i - 171) as f64,
            _ => 371.0 + i as f64,
        });
        let w = weights(grid, Illuminant::E, Quadrature::Interpolated).unwrap();
        let line = |nm: f64| (1.0 - (nm - 550.5).abs() / 0.2).max(0.0);
        let got = xyz(&w, grid.map(line));
        /// Expected Y: area of the triangle times ȳ(550.5 nm) over Σ ȳ.
        const WANTED: f64 = 0.2 * 0.995 / 106.857;
        /// Relative error, since the cubics round the triangle's corners.
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
    fn unusable_wavelengths_are_refused() {
        assert_eq!(
            weights([500.0, 500.0], Illuminant::E, Quadrature::Sampled),
            Err(ColourError::NotIncreasing { index: 1 })
        );
        assert_eq!(weights([-1.0], Illuminant::E, Quadrature::Sampled), Err(ColourError::NotIncreasing { index: 0 }));
        assert_eq!(weights([900.0, 950.0], Illuminant::E, Quadrature::Sampled), Err(ColourError::Invisible));
        assert_eq!(xyz_weights(&[], Illuminant::E, Quadrature::Sampled, &mut []), Err(ColourError::Shape));
    }
}
