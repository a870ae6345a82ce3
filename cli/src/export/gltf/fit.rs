//! The fit of `KHR_materials_iridescence` to exact colours.

use super::film::{Base, SingleFilm};
use super::iridescence::{eval_iridescence, schlick};
use super::simplex::minimise;
use crate::colour::difference::{Lab, Summary, delta_e, lab};

/// Largest angle at which colours are compared, in degrees.
pub const MAX_DEG: u16 = 85;

/// The angles at which colours are compared: whole degrees from 0 to [`MAX_DEG`].
#[must_use]
pub fn angles() -> Vec<f64> {
    (0..=MAX_DEG).map(f64::from).collect()
}

/// The parameters of a material, whose colour at an angle, under a punctual light or in an environment, is
/// [`Parameters::rgb`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// The parameter `iridescenceFactor`.
    pub factor: f64,
    /// The parameter `iridescenceIor`.
    pub ior: f64,
    /// The parameter `iridescenceThicknessMaximum`.
    pub thickness_nm: f64,
    /// The `ior` of `KHR_materials_ior`, or the base colour of a metal.
    pub base: Base,
}

/// Largest refractive index of film and base in the search.
const MAX_IOR: f64 = 4.0;

/// Rounds a parameter to the digits that are written; the residual is that of the rounded parameters.
#[must_use]
pub fn round(x: f64) -> f64 {
    const DIGITS: f64 = 1e5;
    (x * DIGITS).round() / DIGITS
}

impl Parameters {
    /// The parameters of a film's own values.
    #[must_use]
    pub fn of(film: &SingleFilm) -> Self {
        Self { factor: 1.0, ior: film.ior, thickness_nm: film.thickness_nm, base: film.base }.rounded()
    }

    fn rounded(self) -> Self {
        let base = match self.base {
            Base::Dielectric { ior } => Base::Dielectric { ior: round(ior) },
            Base::Metal { f0 } => Base::Metal { f0: f0.map(round) },
        };
        Self { factor: round(self.factor), ior: round(self.ior), thickness_nm: round(self.thickness_nm), base }
    }

    /// Specular reflectance at an angle in linear sRGB: Schlick's formula mixed with the iridescent one by the factor.
    #[must_use]
    pub fn rgb(&self, theta_deg: f64) -> [f32; 3] {
        let cos = theta_deg.to_radians().cos() as f32;
        let f0 = match self.base {
            Base::Dielectric { ior } => [((ior - 1.0) / (ior + 1.0)).powi(2) as f32; 3],
            Base::Metal { f0 } => f0.map(|f0| f0 as f32),
        };
        let film = eval_iridescence(1.0, self.ior as f32, cos, self.thickness_nm as f32, f0);
        let factor = self.factor as f32;
        std::array::from_fn(|c| {
            let bare = schlick(f0[c], cos);
            bare + factor * (film[c] - bare)
        })
    }

    /// ΔE2000 from exact colours at [`angles`].
    #[must_use]
    pub fn differences(&self, exact: &[Lab]) -> Vec<f64> {
        let colour = |theta| lab(self.rgb(theta).map(f64::from));
        angles().into_iter().zip(exact).map(|(theta, exact)| delta_e(colour(theta), *exact)).collect()
    }
}

/// Fits the parameters of a film to exact colours at [`angles`]; returns them with their differences.
///
/// The fit has the smallest mean square of ΔE2000 that is found from the film's own values and from films up to 30 %
/// thinner or thicker; more starts find nothing better. The film's own values are kept if the eye sees no difference.
#[must_use]
pub fn fit(film: &SingleFilm, exact: &[Lab]) -> (Parameters, Summary) {
    let thickest = 2.0 * film.thickness_nm + 100.0;
    let best = match film.base {
        Base::Dielectric { ior } => search(
            film,
            exact,
            [to_unit(ior)],
            |[factor, film, thickness, base]| Parameters {
                factor,
                ior: from_unit(film),
                thickness_nm: thickness * thickest,
                base: Base::Dielectric { ior: from_unit(base) },
            },
            thickest,
        ),
        Base::Metal { f0 } => search(
            film,
            exact,
            f0,
            |[factor, film, thickness, r, g, b]| Parameters {
                factor,
                ior: from_unit(film),
                thickness_nm: thickness * thickest,
                base: Base::Metal { f0: [r, g, b] },
            },
            thickest,
        ),
    };
    /// Difference in the root mean square of ΔE2000 that is not seen; a just noticeable difference is 1.
    const UNSEEN: f64 = 0.05;
    let rms = |parameters: &Parameters| (cost(parameters, exact) / exact.len() as f64).sqrt();
    let own = Parameters::of(film);
    let best = if rms(&own) <= rms(&best) + UNSEEN { own } else { best };
    (best, Summary::of(&best.differences(exact)))
}

/// The coordinate in [0, 1] of a refractive index.
fn to_unit(ior: f64) -> f64 {
    ((ior - 1.0) / (MAX_IOR - 1.0)).clamp(0.0, 1.0)
}

/// The refractive index of a coordinate in [0, 1].
fn from_unit(x: f64) -> f64 {
    1.0 + x * (MAX_IOR - 1.0)
}

/// The sum of squares of ΔE2000.
fn cost(parameters: &Parameters, exact: &[Lab]) -> f64 {
    parameters.differences(exact).iter().map(|d| d * d).sum()
}

/// Searches the best parameters in the unit cube of N coordinates, of which the last are those of the base.
fn search<const BASE: usize, const N: usize>(
    film: &SingleFilm,
    exact: &[Lab],
    base: [f64; BASE],
    parameters: impl Fn([f64; N]) -> Parameters,
    thickest: f64,
) -> Parameters {
    /// First step as a fraction of the allowed range; a film of a few hundred nm changes its colours every 20 nm.
    const STEP: f64 = 0.05;
    /// Size of the last simplex, finer than the digits that are written.
    const WIDTH: f64 = 1e-6;
    const ITERATIONS: usize = 600;
    const SCALES: [f64; 7] = [1.0, 0.7, 0.8, 0.9, 1.1, 1.2, 1.3];
    let of = |point: &[f64; N]| cost(&parameters(*point), exact);
    let mut best: (f64, [f64; N]) = (f64::INFINITY, [0.0; N]);
    for scale in SCALES {
        let mut start = [1.0; N];
        start[1] = to_unit(film.ior);
        start[2] = scale * film.thickness_nm / thickest;
        start[3..].copy_from_slice(&base);
        let found = minimise(of, start, STEP, WIDTH, ITERATIONS);
        if found.0 < best.0 {
            best = found;
        }
    }
    // A simplex that has collapsed too early finds the rest from where it stands.
    let (_, best) = minimise(of, best.1, STEP, WIDTH, ITERATIONS);
    parameters(best).rounded()
}
