//! Phase factors exp(2πi x) of an optical path x in wavelengths, that is, in turns of the phase.
//!
//! A phase k₀L in single precision is wrong by 5e-4 at a path of 400 µm. Here the path is divided by λ in double
//! precision and reduced to [−½, ½]. The phase factor then has the absolute accuracy of the lanes, whatever the length
//! of the path.

use crate::simd::complex::ComplexLanes;
use crate::simd::lanes::Lanes;
use core::f64::consts::TAU;

/// Error bound of the real and of the imaginary part of [`cis`], in unit roundoffs.
///
/// Terms: the truncated series stays below 0.5, the rounded argument adds π/4 · 1.5, and the last steps of Horner's
/// scheme add 2. Together they make 3.7, held by 4.
pub const CIS_ERROR: f64 = 4.0;

/// Coefficients of the cosine's series: 1/k! with alternating signs, k = 2, 4, … On |y| ≤ π/4 the first omitted term is
/// y¹⁸/18! < 3e-18 in double precision and y¹⁰/10! < 3e-8 in single precision.
const COS_TERMS: [f64; 8] = [
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40320.0,
    -1.0 / 3628800.0,
    1.0 / 479001600.0,
    -1.0 / 87178291200.0,
    1.0 / 20922789888000.0,
];
/// Coefficients of the sine's series: 1/k! with alternating signs, k = 3, 5, …
const SIN_TERMS: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362880.0,
    -1.0 / 39916800.0,
    1.0 / 6227020800.0,
    -1.0 / 1307674368000.0,
    1.0 / 355687428096000.0,
];

/// Error of [`TAU`]: 2π − [`TAU`].
const TAU_LOW: f64 = 2.449_293_598_294_706_4e-16;

/// Number of terms of the series that lanes of this precision need.
const fn series_terms<V: Lanes>() -> usize {
    if V::UNIT_ROUNDOFF > 1e-10 { 4 } else { 8 }
}

/// The series 1 − y²/(n (n + 1)) (1 − y²/((n + 2)(n + 3)) (1 − …)): cos y for n = 1, sin y/y for n = 2.
///
/// It serves lanes of more digits than doubles, to which the coefficients in [`COS_TERMS`] are rounded. The first
/// omitted terms are y²⁴/24! < 5e-27 and y²⁴/25! < 2e-28.
fn nested_series<V: Lanes>(y2: V, n: u32) -> V {
    const TERMS: u32 = 11;
    (0..TERMS).rev().fold(V::one(), |sum, term| {
        let k = n + 2 * term;
        V::one() - sum * y2 / V::splat(f64::from(k * (k + 1)))
    })
}

/// 2π to the precision of the lanes.
#[inline]
fn tau<V: Lanes>() -> V {
    V::splat(TAU) + V::splat(TAU_LOW)
}

/// The phase factor cos 2πx + i sin 2πx for x in [−½, ½], each part to within [`CIS_ERROR`] unit roundoffs.
#[inline]
pub fn cis<V: Lanes>(turn: V) -> ComplexLanes<V> {
    let mut out = ComplexLanes::zero();
    for index in 0..V::REGISTERS {
        out.set_register(index, cis_of_register(turn.register(index)));
    }
    out
}

/// [`cis`] of lanes that stay in registers.
#[inline]
fn cis_of_register<V: Lanes>(turn: V) -> ComplexLanes<V> {
    // The nearest number of quarter turns, −2 … 2, and the angle y that is left, at most π/4.
    let quarters = (turn * V::splat(4.0)).round();
    let y = quarters.neg_mul_add(V::splat(0.25), turn) * tau();
    let y2 = y * y;
    let (cos, sin) = if V::UNIT_ROUNDOFF < f64::EPSILON / 2.0 {
        (nested_series(y2, 1), nested_series(y2, 2) * y)
    } else {
        let series = |terms: &[f64; 8]| {
            let terms = &terms[..series_terms::<V>()];
            terms.iter().rev().fold(V::zero(), |sum, &term| sum.mul_add(y2, V::splat(term)))
        };
        (series(&COS_TERMS).mul_add(y2, V::one()), (series(&SIN_TERMS) * y2).mul_add(y, y))
    };

    let half = V::splat(0.5);
    let odd = (quarters.abs() - V::one()).abs(); // 0 where the quarters are odd
    let (c, s) = (odd.select_lt(half, -sin, cos), odd.select_lt(half, cos, sin));
    // One quarter: (−sin, cos). Two or minus two: (−cos, −sin). Minus one: (sin, −cos).
    let flip = V::splat(1.5).select_lt(quarters.abs(), V::one(), V::zero())
        + quarters.select_lt(-half, V::one(), V::zero()) * odd.select_lt(half, V::one(), V::zero());
    let sign = half.select_lt(flip, -V::one(), V::one());
    ComplexLanes::new(c * sign, s * sign)
}

/// The propagation factor exp(2πi z) of a complex path z in wavelengths, Im z ≥ 0: phase and attenuation.
#[inline]
pub fn propagate<V: Lanes>(turns: ComplexLanes<V::Precise>) -> ComplexLanes<V> {
    let phase = propagate_real(turns.re);
    if turns.im.any_above(0.0) { phase.scale(attenuation(turns)) } else { phase }
}

/// The propagation factor exp(2πi x) of a real path x in wavelengths: a phase.
#[inline]
pub fn propagate_real<V: Lanes>(turns: V::Precise) -> ComplexLanes<V> {
    cis(V::narrow(turns - turns.round()))
}

/// The attenuation exp(−2π Im z) of the amplitude along a complex path z in wavelengths.
#[inline]
pub fn attenuation<V: Lanes>(turns: ComplexLanes<V::Precise>) -> V {
    V::narrow(turns.im * -tau::<V::Precise>()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::double_double::DoubleDouble;
    use crate::simd::lanes::{F32, F64};
    use num_complex::Complex64;

    fn worst_error<V: Lanes>() -> f64 {
        let steps = 20_000;
        (0..=steps).fold(0.0, |worst: f64, i| {
            let turn = V::splat(f64::from(i) / f64::from(steps) - 0.5);
            let exact = Complex64::cis(TAU * turn.lane(0));
            let got = cis(turn).lane(0);
            worst.max((got.re - exact.re).abs()).max((got.im - exact.im).abs())
        })
    }

    #[test]
    fn cis_keeps_its_stated_bound() {
        for (name, worst, roundoff) in
            [("f32", worst_error::<F32>(), F32::UNIT_ROUNDOFF), ("f64", worst_error::<F64>(), F64::UNIT_ROUNDOFF)]
        {
            assert!(worst <= CIS_ERROR * roundoff, "{name}: {} roundoffs", worst / roundoff);
        }
    }

    #[test]
    fn lanes_of_twice_the_digits_keep_theirs() {
        type V = DoubleDouble;
        let bound = CIS_ERROR * V::UNIT_ROUNDOFF;
        for i in -50..=50 {
            let turn = V::splat(f64::from(i)) / V::splat(200.0);
            let (once, twice) = (cis(turn), cis(turn + turn));
            let off = once.square() - twice;
            assert!(off.re.abs().lane(0) <= 4.0 * bound && off.im.abs().lane(0) <= 4.0 * bound, "{i}: {off:?}");
            assert!((once.norm_sqr() - V::one()).abs().lane(0) <= 2.0 * bound);
        }
        // Twelve twelfths of a turn.
        let twelfth = cis(V::one() / V::splat(12.0));
        let full = (0..12).fold(ComplexLanes::one(), |product, _| product * twelfth);
        assert!((full - ComplexLanes::one()).norm().lane(0) <= 12.0 * bound);
    }

    #[test]
    fn long_paths_lose_nothing() {
        // 400 µm of n = 1.5 at 555 nm; single precision alone would lose 5e-4.
        let turns = 1.5 * 400_000.0 / 555.0;
        type Precise = <F32 as Lanes>::Precise;
        let path = ComplexLanes::<Precise>::real(Precise::splat(turns));
        let got = propagate::<F32>(path).lane(0);
        let exact = Complex64::cis(TAU * (turns - libm::rint(turns)));
        assert!((got - exact).norm() <= 2.0 * CIS_ERROR * F32::UNIT_ROUNDOFF, "{got} {exact}");
    }

    #[test]
    fn an_opaque_path_attenuates_to_zero_without_overflow() {
        let path = ComplexLanes::<F64>::new(F64::splat(3.3), F64::splat(1e6));
        assert_eq!(propagate::<F64>(path).lane(0), Complex64::new(0.0, 0.0));
    }
}
