//! The dispersion formulas of refractiveindex.info, under their numbers there.

use crate::simd::lanes::sqrt;
use libm::{exp, pow};

/// A dispersion formula of refractiveindex.info, with λ in micrometres and c₁ first. Missing trailing coefficients are
/// 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Formula {
    /// 1: n² − 1 = c₁ + Σ c₂λ²/(λ² − c₃²)
    Sellmeier,
    /// 2: n² − 1 = c₁ + Σ c₂λ²/(λ² − c₃)
    Sellmeier2,
    /// 3: n² = c₁ + Σ c₂ λ^c₃
    Polynomial,
    /// 4: n² = c₁ + c₂λ^c₃/(λ² − c₄^c₅) + c₆λ^c₇/(λ² − c₈^c₉) + Σ c₁₀ λ^c₁₁
    RefractiveIndexInfo,
    /// 5: n = c₁ + Σ c₂ λ^c₃
    Cauchy,
    /// 6: n − 1 = c₁ + Σ c₂/(c₃ − λ⁻²)
    Gases,
    /// 7: n = c₁ + c₂/(λ² − 0.028) + c₃/(λ² − 0.028)² + c₄λ² + c₅λ⁴ + c₆λ⁶
    Herzberger,
    /// 8: (n² − 1)/(n² + 2) = c₁ + c₂λ²/(λ² − c₃) + c₄λ²
    Retro,
    /// 9: n² = c₁ + c₂/(λ² − c₃) + c₄(λ − c₅)/((λ − c₅)² + c₆)
    Exotic,
    /// Absorption falling exponentially with wavelength, k = c₁ exp(−λ/c₂): melanin (Stavenga et al. 2015)
    Exponential,
}

impl Formula {
    /// The formula of a number in refractiveindex.info files, 1 to 9; `None` for other numbers.
    #[must_use]
    pub fn from_number(number: u32) -> Option<Self> {
        Some(match number {
            1 => Self::Sellmeier,
            2 => Self::Sellmeier2,
            3 => Self::Polynomial,
            4 => Self::RefractiveIndexInfo,
            5 => Self::Cauchy,
            6 => Self::Gases,
            7 => Self::Herzberger,
            8 => Self::Retro,
            9 => Self::Exotic,
            _ => return None,
        })
    }

    /// The formula's value at `um` micrometres.
    #[must_use]
    pub fn evaluate(self, c: &[f64], um: f64) -> f64 {
        let at = |i: usize| c.get(i).copied().unwrap_or(0.0);
        let tail = |from: usize| c.get(from..).unwrap_or(&[]).chunks_exact(2).map(|pair| (pair[0], pair[1]));
        let l2 = um * um;
        match self {
            Self::Sellmeier => sqrt(1.0 + at(0) + tail(1).map(|(b, l)| b * l2 / (l2 - l * l)).sum::<f64>()),
            Self::Sellmeier2 => sqrt(1.0 + at(0) + tail(1).map(|(b, l)| b * l2 / (l2 - l)).sum::<f64>()),
            Self::Polynomial => sqrt(at(0) + tail(1).map(|(a, e)| a * pow(um, e)).sum::<f64>()),
            Self::RefractiveIndexInfo => {
                let pole = |i: usize| match at(i) {
                    0.0 => 0.0,
                    a => a * pow(um, at(i + 1)) / (l2 - pow(at(i + 2), at(i + 3))),
                };
                sqrt(at(0) + pole(1) + pole(5) + tail(9).map(|(a, e)| a * pow(um, e)).sum::<f64>())
            }
            Self::Cauchy => at(0) + tail(1).map(|(a, e)| a * pow(um, e)).sum::<f64>(),
            Self::Gases => 1.0 + at(0) + tail(1).map(|(b, l)| b / (l - 1.0 / l2)).sum::<f64>(),
            Self::Herzberger => {
                let w = 1.0 / (l2 - 0.028);
                at(0) + at(1) * w + at(2) * w * w + l2 * (at(3) + l2 * (at(4) + l2 * at(5)))
            }
            Self::Retro => {
                let x = at(0) + at(1) * l2 / (l2 - at(2)) + at(3) * l2;
                sqrt((1.0 + 2.0 * x) / (1.0 - x))
            }
            Self::Exotic => {
                let d = um - at(4);
                sqrt(at(0) + at(1) / (l2 - at(2)) + at(3) * d / (d * d + at(5)))
            }
            Self::Exponential => at(0) * exp(-um / at(1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bound of the rounding of published values, which are quoted to five digits.
    const QUOTED_DIGITS: f64 = 5e-6;

    fn n(formula: Formula, coefficients: &[f64], nm: f64) -> f64 {
        formula.evaluate(coefficients, nm * 1e-3)
    }

    #[test]
    fn formulas_give_the_published_indices() {
        let silica = [0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
        assert!((n(Formula::Sellmeier, &silica, 587.6) - 1.45846).abs() < QUOTED_DIGITS);
        let bk7 = [0.0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653];
        assert!((n(Formula::Sellmeier2, &bk7, 587.5618) - 1.5168).abs() < QUOTED_DIGITS);
        let air = [0.0, 0.05792105, 238.0185, 0.00167917, 57.362];
        assert!((n(Formula::Gases, &air, 589.3) - 1.000277).abs() < 1e-6);
        let rutile = [5.913, 0.2441, 0.0, 0.0803, 1.0, 0.0, 0.0, 0.0, 1.0];
        assert!((n(Formula::RefractiveIndexInfo, &rutile, 589.3) - 2.6129).abs() < 1e-4);
    }

    #[test]
    fn formulas_reduce_to_each_other_where_they_must() {
        // Cauchy and Polynomial: n = n0 when only c1 is given; Retro: Lorentz-Lorenz of a constant.
        assert!((n(Formula::Cauchy, &[1.5, 0.01, -2.0], 500.0) - 1.54).abs() < 1e-12);
        assert!((n(Formula::Polynomial, &[2.25, 0.04, -2.0], 500.0) - sqrt(2.41)).abs() < 1e-12);
        assert!((n(Formula::Retro, &[0.25, 0.0, 0.1, 0.0], 500.0) - sqrt(2.0)).abs() < 1e-12);
        assert!((n(Formula::Exotic, &[2.25, 0.0, 0.1, 0.0, 0.0, 1.0], 500.0) - 1.5).abs() < 1e-12);
        assert!((n(Formula::Herzberger, &[1.5, 0.0, 0.0, 0.04], 500.0) - 1.51).abs() < 1e-12);
    }
}
