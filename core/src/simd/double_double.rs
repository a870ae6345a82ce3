//! Lanes of twice the digits of double precision: each number is the unevaluated sum of two doubles.
//!
//! They serve what double precision cannot resolve: resonances whose stored energy is 10⁵ times the incident energy,
//! and the neighbourhood of a film's critical angle. They take 17 times the instructions of [`F64`]. Products are split
//! by Dekker's method, which needs no fused multiply-add, so that every machine gives the same digits.
//!
//! Source: T. J. Dekker, "A floating-point technique for extending the available precision", Numer. Math. 18 (1971);
//! the algorithms are those of Y. Hida, X. S. Li and D. H. Bailey, "Library for double-double and quad-double
//! arithmetic" (2007).

use core::f64::consts::LN_2;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use crate::simd::lanes::{F64, Lanes, one_register};

/// Lanes of the width of [`F64`] whose numbers have about 100 bits and the range of doubles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    high: F64,
    /// Rest of the number, at most half a unit in the last place of `high`.
    low: F64,
}

/// The rounded sum a + b and its rounding error, exactly.
#[inline]
fn two_sum(a: F64, b: F64) -> (F64, F64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// The rounded sum a + b and its rounding error, exactly, where |a| ≥ |b|.
#[inline]
fn fast_two_sum(a: F64, b: F64) -> (F64, F64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Splits a into two halves of 26 bits each.
#[inline]
fn split(a: F64) -> (F64, F64) {
    const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;
    let scaled = a * F64::splat(SPLITTER);
    let high = scaled - (scaled - a);
    (high, a - high)
}

/// The rounded product a b and its rounding error, exactly where nothing underflows.
#[inline]
fn two_product(a: F64, b: F64) -> (F64, F64) {
    let product = a * b;
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    (product, ((a1 * b1 - product) + a1 * b0 + a0 * b1) + a0 * b0)
}

impl DoubleDouble {
    /// The number a + b in every lane, exactly.
    #[must_use]
    pub fn sum_of(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(F64::splat(a), F64::splat(b));
        Self { high, low }
    }

    #[inline]
    fn from_high(high: F64) -> Self {
        Self { high, low: Lanes::zero() }
    }

    /// Multiplies by a power of two, or by 0, exactly.
    #[inline]
    fn scaled(self, by: F64) -> Self {
        Self { high: self.high * by, low: self.low * by }
    }

    /// `then` where `condition` < 0, otherwise `otherwise`.
    #[inline]
    fn select(condition: F64, then: Self, otherwise: Self) -> Self {
        let pick = |a: F64, b: F64| Lanes::select_lt(condition, Lanes::zero(), a, b);
        Self { high: pick(then.high, otherwise.high), low: pick(then.low, otherwise.low) }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, small) = two_sum(self.low, other.low);
        let (high, error) = fast_two_sum(high, error + low);
        let (high, low) = fast_two_sum(high, error + small);
        Self { high, low }
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (product, error) = two_product(self.high, other.high);
        let (high, low) = fast_two_sum(product, error + (self.high * other.low + self.low * other.high));
        Self { high, low }
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    /// Long division by three digits of 53 bits.
    #[inline]
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let rest = self - other * Self::from_high(first);
        let second = rest.high / other.high;
        let rest = rest - other * Self::from_high(second);
        let third = rest.high / other.high;
        let (high, low) = fast_two_sum(first, second);
        Self { high, low } + Self::from_high(third)
    }
}

impl AddAssign for DoubleDouble {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Lanes for DoubleDouble {
    type Precise = Self;
    one_register!();
    const WIDTH: usize = F64::WIDTH;
    /// 2⁻⁸⁰, the accuracy of the series in [`crate::simd::phase`], the least accurate operation. Sums and products keep
    /// 2⁻¹⁰⁴.
    const UNIT_ROUNDOFF: f64 = 1.0 / (1u128 << 80) as f64;

    #[inline]
    fn splat(x: f64) -> Self {
        Self::from_high(F64::splat(x))
    }
    #[inline]
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self {
        Self::from_high(<F64 as Lanes>::from_fn(f))
    }
    /// The number in lane `i`, rounded to a double.
    #[inline]
    fn lane(self, i: usize) -> f64 {
        Lanes::lane(self.high, i)
    }
    #[inline]
    fn narrow(precise: Self) -> Self {
        precise
    }
    #[inline]
    fn widen(self) -> Self {
        self
    }
    #[inline]
    fn mul_add(self, m: Self, a: Self) -> Self {
        self * m + a
    }
    #[inline]
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        a - self * m
    }
    /// The square root by one Newton step from the root of the high part.
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.high.sqrt();
        let rest = self - Self::from_high(root) * Self::from_high(root);
        let positive = Self::from_high(root) + Self::from_high(rest.high / (root + root));
        Self::select(-root, positive, Self::from_high(root))
    }
    #[inline]
    fn abs(self) -> Self {
        Self::select(self.high, -self, self)
    }
    #[inline]
    fn round(self) -> Self {
        let near = Lanes::round(self.high);
        let rest = (self.high - near) + self.low;
        Self::from_high(near) + Self::from_high(Lanes::round(rest))
    }
    /// The exponential e^x = 2^k (e^y)^64 with |y| ≤ ln 2/128; the first omitted term is y¹²/12! < 1e-35.
    fn exp(self) -> Self {
        /// Error of [`LN_2`]: ln 2 − [`LN_2`].
        const LN_2_LOW: f64 = 2.319_046_813_846_299_6e-17;
        const HALVINGS: usize = 6;
        const TERMS: u32 = 11;
        let k = Lanes::round(self.high * F64::splat(1.0 / LN_2));
        let y = (self - Self::from_high(k) * Self::sum_of(LN_2, LN_2_LOW))
            .scaled(F64::splat(1.0 / f64::from(1u32 << HALVINGS)));
        let mut sum = Self::one();
        for term in (1..=TERMS).rev() {
            sum = Self::one() + y * sum / Self::splat(f64::from(term));
        }
        for _ in 0..HALVINGS {
            sum = sum * sum;
        }
        sum.scaled(<F64 as Lanes>::from_fn(|lane| libm::ldexp(1.0, Lanes::lane(k, lane) as i32)))
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        self.select_lt(other, other, self)
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        self.select_lt(other, self, other)
    }
    #[inline]
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
        Self::select((self - bound).high, then, otherwise)
    }
    #[inline]
    fn mask_le(self, other: Self) -> u64 {
        Lanes::mask_le((self - other).high, Lanes::zero())
    }
    #[inline]
    fn any_above(self, bound: f64) -> bool {
        (self - Self::splat(bound)).high.any_above(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{E, SQRT_2};

    /// The magnitude of lane 0, as a double.
    fn size(x: DoubleDouble) -> f64 {
        x.abs().lane(0)
    }

    fn number(high: f64, low: f64) -> DoubleDouble {
        DoubleDouble::sum_of(high, low)
    }

    /// Relative error of a sum, product, quotient or root: a few times 2⁻¹⁰⁴.
    const ROUNDING: f64 = 8.0 / (1u128 << 104) as f64;

    #[test]
    fn sums_and_products_keep_what_a_double_drops() {
        let (one, tiny) = (DoubleDouble::one(), DoubleDouble::splat(1e-25));
        assert_eq!((one + tiny - one).lane(0), 1e-25);
        let third = one / DoubleDouble::splat(3.0);
        assert!(size(third + third + third - one) <= ROUNDING);
        // (1 + 2⁻⁵²)² = 1 + 2⁻⁵¹ + 2⁻¹⁰⁴.
        let next = DoubleDouble::splat(1.0 + f64::EPSILON);
        assert_eq!((next * next - number(1.0, 2.0 * f64::EPSILON)).lane(0), f64::EPSILON * f64::EPSILON);
        for x in [0.3, 7.25, 1e-9, 3e8] {
            let (x, y) = (number(x, x * 1e-17), number(1.7, -3e-17));
            assert!(size(x / y * y - x) <= ROUNDING * size(x));
            assert!(size(x.sqrt() * x.sqrt() - x) <= ROUNDING * size(x));
            assert!(size(x.mul_add(y, -x) - (x * y - x)) == 0.0 && size(x.neg_mul_add(y, x) - (x - x * y)) == 0.0);
        }
        assert_eq!(DoubleDouble::zero().sqrt(), DoubleDouble::zero());
    }

    #[test]
    fn numbers_that_differ_in_the_last_digit_alone_have_an_order() {
        let (less, more) = (number(1.0, 1e-20), number(1.0, 2e-20));
        assert_eq!(less.max(more), more);
        assert_eq!(less.min(more), less);
        assert_eq!(less.select_lt(more, less, more), less);
        assert_eq!(more.select_lt(less, less, more), more);
        assert!(less.any_above(1.0) && !(-less).any_above(-1.0));
        assert_eq!(less.mask_le(more), (1 << DoubleDouble::WIDTH) - 1);
        assert_eq!(more.mask_le(less), 0);
        assert_eq!(number(-1.0, -1e-20).abs(), less);
    }

    #[test]
    fn rounding_looks_at_both_parts() {
        const LARGE: f64 = 9_007_199_254_740_992.0;
        for (high, low, want) in [(-7.0, -1e-17, -7.0), (0.2, 0.0, 0.0), (3.7, 1e-17, 4.0), (LARGE, 0.2, LARGE)] {
            assert_eq!(number(high, low).round(), DoubleDouble::splat(want), "{high} {low}");
        }
        assert_eq!(number(LARGE, 0.8).round(), number(LARGE, 1.0));
    }

    #[test]
    fn exponentials_multiply_as_they_must() {
        for x in [0.0, -1e-3, -0.7, -3.0, -40.0, -300.0] {
            let x = number(x, x * 1e-17);
            assert!(size(x.exp() * (-x).exp() - DoubleDouble::one()) <= 1e3 * ROUNDING, "{x:?}");
        }
        assert!((DoubleDouble::one().exp().lane(0) - E).abs() <= f64::EPSILON);
        assert!((DoubleDouble::splat(2.0).sqrt().lane(0) - SQRT_2).abs() <= f64::EPSILON);
        assert_eq!(DoubleDouble::splat(-1e7).exp().lane(0), 0.0);
    }
}
