//! A short exponential in single precision, for the tails of Beckmann's distribution.

use core::f32::consts::LOG2_E;

/// exp(−x) for x ≥ 0, with a relative error below 3e-7 up to x = 60; 0 beyond, and for NaN, so that products with it
/// stay clear of subnormal numbers, which are slow.
///
/// −x = r − n ln 2 with |r| ≤ ln 2/2. exp r is a polynomial of degree 6, whose remainder is |r|⁷/7! ≤ 1.2e-7; 2⁻ⁿ is
/// written into the exponent. ln 2 is split in two, so that n ln 2 does not round.
#[inline]
pub(super) fn decay(x: f32) -> f32 {
    /// The first 14 bits of ln 2, and the rest.
    const LN_2: [f32; 2] = [0.693_145_75, 1.428_606_8e-6];
    const END: f32 = 60.0;
    /// 1.5 · 2²³: added to a small number, it rounds it to an integer, which stands in the last bits of the sum.
    const ROUND: f32 = 12_582_912.0;
    const OVER_FACTORIALS: [f32; 5] = [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5];
    let inside = x <= END;
    let x = x.min(END);
    let rounded = x * LOG2_E + ROUND;
    let n = rounded - ROUND;
    let r = (n * LN_2[0] - x) + n * LN_2[1];
    let tail = OVER_FACTORIALS.into_iter().fold(0.0, |sum, c| sum * r + c);
    let scale = f32::from_bits(1.0f32.to_bits().wrapping_sub(rounded.to_bits() << 23));
    let value = (1.0 + (r + r * r * tail)) * scale;
    if inside { value } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_exponential_is_the_exponential() {
        /// The remainder, 1.2e-7; rounding of the sum, of the product, and of r, which is at most 0.35: half a unit
        /// each, 0.6e-7, with twice that for n ln 2 − x at a magnitude of 0.35.
        const BOUND: f64 = 3e-7;
        let mut worst = 0.0f64;
        for i in 0..=600_000 {
            let x = i as f32 * 1e-4;
            worst = worst.max((f64::from(decay(x)) / libm::exp(-f64::from(x)) - 1.0).abs());
        }
        assert!(worst <= BOUND, "{worst:e}");
        assert_eq!([decay(0.0), decay(1e9), decay(f32::INFINITY), decay(f32::NAN)], [1.0, 0.0, 0.0, 0.0]);
    }
}
