//! Visible normals of Beckmann's distribution.
//!
//! On a surface of roughness 1, the slopes that a direction sees have the density P(x, y) ∝ (cos θ − x sin θ)⁺
//! exp(−x² − y²), with x in the plane of the direction (Heitz & d'Eon 2014, section 3). y is drawn by the inverse of
//! erf, x by bisection and Newton steps on its cumulative distribution.

use super::exponential::decay;
use crate::simd::lanes::sqrtf;
use libm::{erff, logf};
use wide::f32x4;

/// 1/√π.
const INV_SQRT_PI: f32 = 0.564_189_6;

/// Draws the two slopes that a direction with such a cotangent of θ sees, on a surface of roughness 1, by `u` in [0,
/// 1)².
pub(super) fn visible_slope(cot_theta: f32, u: [f32; 2]) -> [f32; 2] {
    [slope_towards(cot_theta, u[0]), erf_inverse(2.0 * u[1] - 1.0)]
}

/// Integral of (a − x) exp(−x²)/√π over x from −∞ to `to`, for the cotangent a.
fn cumulative(a: f32, to: f32) -> f32 {
    0.5 * a * (1.0 + erff(to)) + 0.5 * INV_SQRT_PI * decay(to * to)
}

/// Inverse of the cumulative distribution of the slope x ≤ a in the plane of the direction.
fn slope_towards(a: f32, u: f32) -> f32 {
    /// Slopes beyond ±4 have a share of 1e-8.
    const LIMIT: f32 = 4.0;
    let (mut low, mut high) = (-LIMIT, a.min(LIMIT));
    let wanted = u * cumulative(a, high);
    let mut x = 0.5 * (low + high);
    // A Newton step that leaves the bracket is replaced by its middle: each step halves it, or converges squarely.
    for _ in 0..32 {
        let excess = cumulative(a, x) - wanted;
        if excess > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let slope = (a - x) * INV_SQRT_PI * decay(x * x);
        let newton = x - excess / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        let done = (next - x).abs() <= 1e-6 * (1.0 + x.abs());
        x = next;
        if done {
            break;
        }
    }
    x
}

/// Inverse of erf, with a relative error of some 1e-6 (Giles, "Approximating the erfinv function", 2010, for single
/// precision). It is finite: the argument is held within ±(1 − 6e-8).
fn erf_inverse(x: f32) -> f32 {
    let x = x.clamp(-1.0 + f32::EPSILON / 2.0, 1.0 - f32::EPSILON / 2.0);
    let w = -logf((1.0 - x) * (1.0 + x));
    let polynomial = |w: f32, coefficients: [f32; 9]| coefficients.into_iter().fold(0.0, |sum, c| sum * w + c);
    let ratio = if w < 5.0 {
        polynomial(
            w - 2.5,
            [
                2.810_226_4e-8,
                3.432_739_4e-7,
                -3.523_387_7e-6,
                -4.391_506_5e-6,
                2.185_808_7e-4,
                -1.253_725e-3,
                -4.177_681_6e-3,
                0.246_640_73,
                1.501_409_4,
            ],
        )
    } else {
        polynomial(
            sqrtf(w) - 3.0,
            [
                -2.002_142_6e-4,
                1.009_505_6e-4,
                1.349_343_2e-3,
                -3.673_428_4e-3,
                5.739_507_7e-3,
                -7.622_461_3e-3,
                9.438_870_5e-3,
                1.001_674,
                2.832_976_8,
            ],
        )
    };
    ratio * x
}

/// cos θ (1 + Λ) of Smith's Λ, the areas of the facets that up to four directions see, by cos θ and (sin θ α(φ))².
///
/// With s = sin θ α(φ) and a = cos θ/s, the area is cos θ + s (exp(−a²)/√π − a erfc a)/2. Of the bracket, in units of
/// its value at a = 0, the power −1/16 is nearly a polynomial. Fitted by least squares, with weights that make the
/// largest error smallest, degree 5 leaves a relative error of the area of 5e-7.
#[inline]
pub(super) fn visible_areas(cos: f32x4, square: f32x4) -> f32x4 {
    const COEFFICIENTS: [f32; 6] = [3.710_458e-4, 6.573_206e-4, 9.582_191e-3, 4.177_057_2e-2, 0.110_781_36, 1.0];
    /// Beyond this a, the bracket is below 1e-29.
    const END: f32 = 8.0;
    let root = square.max(f32x4::splat(f32::MIN_POSITIVE)).sqrt();
    let a = (cos / root).min(f32x4::splat(END));
    let base = COEFFICIENTS.into_iter().fold(f32x4::ZERO, |sum, c| sum * a + f32x4::splat(c));
    let square = base * base;
    let fourth = square * square;
    let eighth = fourth * fourth;
    cos + f32x4::splat(0.5 * INV_SQRT_PI) * root / (eighth * eighth)
}

/// The density of normals over that along z, by cos²θ_m tan²θ_m, in units of the roughness, and cos²θ_m.
#[inline]
pub(super) fn density(stretched: f32, cos_square: f32) -> f32 {
    let inverse = 1.0 / cos_square;
    decay(stretched * inverse) * (inverse * inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_of_erf_is_its_inverse() {
        // Rounding of erf, whose derivative falls to 2e-7/√π·10 at the ends of what is tried.
        const ROUNDING: f32 = 4e-7;
        for i in 1..2000 {
            let x = i as f32 / 1000.0 - 1.0;
            assert!((erff(erf_inverse(x)) - x).abs() <= ROUNDING, "{x}");
        }
        assert!(erf_inverse(1.0).is_finite() && erf_inverse(-1.0).is_finite());
    }

    #[test]
    fn the_visible_area_is_that_of_beckmanns_facets() {
        /// The polynomial's error, 5e-7; its rounding, half a unit and a quarter, to the power of 16, 1.4e-6; rounding
        /// of the powers, 15 halves, 9e-7; of the argument, its square and the sum, 2e-7.
        const BOUND: f64 = 3e-6;
        let mut worst = 0.0f64;
        for i in 0..20_000 {
            let theta = f64::from(i) / 20_000.0 * core::f64::consts::FRAC_PI_2;
            for alpha in [0.001, 0.03, 0.2, 1.0] {
                let (cos, root) = (libm::cos(theta) as f32, (libm::sin(theta) * alpha) as f32);
                let (z, s) = (f64::from(cos), f64::from(root));
                let a = z / s;
                let exact = if s > 0.0 {
                    0.5 * (z * (1.0 + libm::erf(a)) + s * libm::exp(-a * a) / libm::sqrt(core::f64::consts::PI))
                } else {
                    z
                };
                let [area, ..] = visible_areas(f32x4::splat(cos), f32x4::splat(root * root)).to_array();
                worst = worst.max((f64::from(area) / exact - 1.0).abs());
            }
        }
        assert!(worst <= BOUND, "{worst:e}");
    }

    #[test]
    fn slopes_towards_a_direction_invert_their_cumulative_distribution() {
        for a in [1e-4f32, 0.1, 1.0, 3.0, 100.0] {
            let whole = cumulative(a, a.min(4.0));
            for i in 0..=100 {
                let u = i as f32 / 101.0;
                let x = slope_towards(a, u);
                // Rounding of three terms of the cumulative distribution.
                let error = (cumulative(a, x) / whole - u).abs();
                assert!(x <= a && error <= 2e-6, "{a} {u}: {x} {error}");
            }
        }
    }
}
