//! The parameters of `KHR_materials_iridescence` whose colours come nearest to exact ones.

use super::film::{Base, SingleFilm};
use super::iridescence::{eval_iridescence, schlick};
use super::simplex::minimise;
use crate::colour::difference::{Colour, Summary, delta_e, lab};

/// Last angle at which colours are compared, in whole degrees from 0.
pub const LAST_DEG: u16 = 85;

/// The angles at which colours are compared.
#[must_use]
pub fn angles() -> Vec<f64> {
    (0..=LAST_DEG).map(f64::from).collect()
}

/// What a material says; under a punctual light or in an environment, its colour at an angle is [`Parameters::rgb`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// `iridescenceFactor`.
    pub factor: f64,
    /// `iridescenceIor`.
    pub ior: f64,
    /// `iridescenceThicknessMaximum`.
    pub thickness_nm: f64,
    /// `ior` of `KHR_materials_ior`, or the base colour of a metal.
    pub base: Base,
}

/// Neither a film nor a base of a higher index is looked for.
const HIGHEST_IOR: f64 = 4.0;

/// To the digits that are written; the residual is that of the rounded parameters.
#[must_use]
pub fn round(x: f64) -> f64 {
    const DIGITS: f64 = 1e5;
    (x * DIGITS).round() / DIGITS
}

impl Parameters {
    /// The film's own values.
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

    /// Specular reflectance at an angle, linear sRGB: Schlick's formula mixed with the iridescent one by the factor.
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
    pub fn differences(&self, exact: &[Colour]) -> Vec<f64> {
        let colour = |theta| lab(self.rgb(theta).map(f64::from));
        angles().into_iter().zip(exact).map(|(theta, exact)| delta_e(colour(theta), *exact)).collect()
    }
}

/// The parameters of the smallest mean square of ΔE2000 from exact colours at [`angles`], found from the film's own values
/// and from films up to 30 % thinner or thicker (more starts find nothing better); and their differences. Where the own
/// values are as good as any to the eye, they stay.
#[must_use]
pub fn fit(film: &SingleFilm, exact: &[Colour]) -> (Parameters, Summary) {
    let thickest = 2.0 * film.thickness_nm + 100.0;
    let best = match film.base {
        Base::Dielectric { ior } => search(
            film,
            exact,
            [inside(ior)],
            |[factor, film, thickness, base]| Parameters {
                factor,
                ior: from_inside(film),
                thickness_nm: thickness * thickest,
                base: Base::Dielectric { ior: from_inside(base) },
            },
            thickest,
        ),
        Base::Metal { f0 } => search(
            film,
            exact,
            f0,
            |[factor, film, thickness, r, g, b]| Parameters {
                factor,
                ior: from_inside(film),
                thickness_nm: thickness * thickest,
                base: Base::Metal { f0: [r, g, b] },
            },
            thickest,
        ),
    };
    /// Of the root mean square of ΔE2000; a just noticeable difference is 1.
    const UNSEEN: f64 = 0.05;
    let rms = |parameters: &Parameters| (cost(parameters, exact) / exact.len() as f64).sqrt();
    let own = Parameters::of(film);
    let best = if rms(&own) <= rms(&best) + UNSEEN { own } else { best };
    (best, Summary::of(&best.differences(exact)))
}

/// An index as a coordinate in [0, 1], and back.
fn inside(ior: f64) -> f64 {
    ((ior - 1.0) / (HIGHEST_IOR - 1.0)).clamp(0.0, 1.0)
}

fn from_inside(x: f64) -> f64 {
    1.0 + x * (HIGHEST_IOR - 1.0)
}

fn cost(parameters: &Parameters, exact: &[Colour]) -> f64 {
    parameters.differences(exact).iter().map(|d| d * d).sum()
}

fn search<const BASE: usize, const N: usize>(
    film: &SingleFilm,
    exact: &[Colour],
    base: [f64; BASE],
    parameters: impl Fn([f64; N]) -> Parameters,
    thickest: f64,
) -> Parameters {
    /// As fractions of what is allowed; a film of a few hundred nm has colours of its own every 20 nm.
    const STEP: f64 = 0.05;
    /// Finer than the digits that are written.
    const WIDTH: f64 = 1e-6;
    const ITERATIONS: usize = 600;
    const SCALES: [f64; 7] = [1.0, 0.7, 0.8, 0.9, 1.1, 1.2, 1.3];
    let of = |point: &[f64; N]| cost(&parameters(*point), exact);
    let mut best: (f64, [f64; N]) = (f64::INFINITY, [0.0; N]);
    for scale in SCALES {
        let mut start = [1.0; N];
        start[1] = inside(film.ior);
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
