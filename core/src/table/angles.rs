//! Angles of directions, fast, and the least cosines of tables.

use crate::simd::lanes::sqrtf;
use core::f32::consts::{FRAC_PI_2, PI};
use glam::Vec3;

/// Smallest cosine of θ_o by which tables of scattered light divide, and above which lobes of flat facets leave.
pub const MIN_COS: f32 = 1e-6;

/// Angle of the point (x, y) in radians, in [−π, π]; 0 at the origin. It errs by at most 3·10⁻⁷ and has no branches,
/// which random directions would mispredict.
#[inline]
fn atan2(y: f32, x: f32) -> f32 {
    let (across, along) = (y.abs(), x.abs());
    let steep = across > along;
    let (small, large) = if steep { (along, across) } else { (across, along) };
    let ratio = small / large.max(f32::MIN_POSITIVE);
    // atan over [0, 1]: the minimax polynomial of SLEEF (Shibata & Petrogalli 2020), in Estrin's order.
    let z = ratio * ratio;
    let (z2, z4) = (z * z, z * z * (z * z));
    let low = (-0.333_331_02 + 0.199_926_96 * z) + (-0.142_027_36 + 0.106_347_93 * z) * z2;
    let high = (-0.074_890_09 + 0.042_504_99 * z) + (-0.015_956_9 + 0.002_823_639 * z) * z2;
    let angle = ratio + ratio * z * (low + high * z4);
    let angle = if steep { FRAC_PI_2 - angle } else { angle };
    let angle = if x < 0.0 { PI - angle } else { angle };
    angle.copysign(y)
}

/// Polar angle θ of a vector of any positive length; 0 for the vector 0.
#[inline]
pub(super) fn polar(w: Vec3) -> f32 {
    atan2(level(w), w.z)
}

/// Angle of a cosine in [0, 1]: √(1 − x) times a polynomial of x (Abramowitz & Stegun 1964, 4.4.46). It errs by at most
/// 4·10⁻⁷: 2·10⁻⁸ by the polynomial, the rest by rounding of the sum, the root and the product, half a unit each.
#[inline]
pub(super) fn angle_of_cosine(cos: f32) -> f32 {
    const COEFFICIENTS: [f32; 8] = [
        -0.001_262_491_1,
        0.006_670_09,
        -0.017_088_126,
        0.030_891_88,
        -0.050_174_305,
        0.088_978_99,
        -0.214_598_8,
        FRAC_PI_2,
    ];
    sqrtf(1.0 - cos) * COEFFICIENTS.into_iter().fold(0.0, |sum, c| sum * cos + c)
}

/// Length of the tangential part of a vector.
#[inline]
pub(super) fn level(w: Vec3) -> f32 {
    sqrtf(w.x * w.x + w.y * w.y)
}

/// Azimuth φ of a vector, in [−π, π]; 0 along the normal.
#[inline]
pub(super) fn azimuth(w: Vec3) -> f32 {
    atan2(w.y, w.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_err_by_less_than_stated() {
        for i in -3000..=3000i16 {
            let exact = f64::from(i) / 3000.0 * core::f64::consts::PI;
            for length in [1e-18, 1e-3, 1.0, 7e5] {
                let (sin, cos) = libm::sincos(exact);
                let (y, x) = ((length * sin) as f32, (length * cos) as f32);
                let found = f64::from(atan2(y, x));
                let error = found - libm::atan2(y.into(), x.into());
                assert!(error.abs() < 3e-7, "{exact}: {error:e}");
            }
        }
    }

    #[test]
    fn angles_of_cosines_err_by_less_than_stated() {
        for i in 0..=10_000u16 {
            let cos = f32::from(i) / 10_000.0;
            let error = f64::from(angle_of_cosine(cos)) - libm::acos(cos.into());
            assert!(error.abs() < 4e-7, "{cos}: {error:e}");
        }
        assert_eq!(angle_of_cosine(1.0), 0.0);
    }

    #[test]
    fn axes_and_the_origin_have_exact_angles() {
        for (y, x, angle) in [
            (0.0, 0.0, 0.0),
            (0.0, -0.0, 0.0),
            (0.0, 1.0, 0.0),
            (1.0, 0.0, FRAC_PI_2),
            (0.0, -1.0, PI),
            (-0.0, -1.0, -PI),
            (-1.0, 0.0, -FRAC_PI_2),
        ] {
            assert_eq!(atan2(y, x), angle, "{y} {x}");
        }
        assert_eq!((polar(Vec3::Z), polar(Vec3::ZERO), azimuth(-Vec3::Z)), (0.0, 0.0, 0.0));
    }
}
