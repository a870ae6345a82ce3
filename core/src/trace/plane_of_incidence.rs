//! ŝ, the normal of the plane of incidence at a facet, also where light arrives along the facet's normal.
//!
//! At normal incidence s and p are alike and the plane of incidence is arbitrary: any tangent serves as ŝ. Each
//! function has its own threshold, since each takes directions of another precision.

use crate::simd::complex::ComplexLanes;
use crate::simd::lanes::Lanes;
use crate::simd::vector::{RealLanes, VectorLanes};
use glam::DVec3;

/// Largest |q_t|² of a wavevector, in units of k₀², that counts as normal incidence.
const MAX_NORMAL_TANGENTIAL_SQUARED: f64 = 1e-20;
/// Largest sine of the angle between a real direction and the normal, in unit roundoffs, that counts as normal
/// incidence.
const MAX_NORMAL_SINE: f64 = 64.0;

/// ŝ of a plane wave, for its complex wavevector: ŝ·ŝ = 1 and ŝ·N = ŝ·q = 0. It is any tangent at normal incidence.
#[inline]
pub(super) fn s_axis_of_wave<V: Lanes>(normal: DVec3, wavevector: &VectorLanes<V>) -> VectorLanes<V> {
    let n = VectorLanes::<V>::splat(normal);
    let s = n.cross(*wavevector);
    let length_squared = s.dot(s);
    let tangent = VectorLanes::<V>::splat(normal.any_orthonormal_vector());
    let small = V::splat(MAX_NORMAL_TANGENTIAL_SQUARED);
    let magnitude = length_squared.norm_sqr();
    let root = length_squared.sqrt_upper();
    let unit = s.scale(ComplexLanes::one().div_or_zero(root));
    let select = |a: ComplexLanes<V>, b: ComplexLanes<V>| ComplexLanes {
        re: magnitude.select_lt(small * small, b.re, a.re),
        im: magnitude.select_lt(small * small, b.im, a.im),
    };
    unit.zip(tangent, select)
}

/// ŝ of a path, for its real unit direction d: the unit vector along N × d, or any tangent at normal incidence. Also
/// returns the squared sine of the angle of incidence.
#[inline]
pub(super) fn s_axis_of_path<V: Lanes>(normal: DVec3, direction: RealLanes<V>) -> (RealLanes<V>, V) {
    let s = RealLanes::<V>::splat(normal).cross(direction);
    let sin_squared = s.dot(s);
    let small = MAX_NORMAL_SINE * V::UNIT_ROUNDOFF;
    let small = V::splat(small * small);
    let unit = s.scale(V::one() / sin_squared.max(small).sqrt());
    let tangent = RealLanes::<V>::splat(normal.any_orthonormal_vector());
    (unit.zip(tangent, |unit, tangent| sin_squared.select_lt(small, tangent, unit)), sin_squared)
}
