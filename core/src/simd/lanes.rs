//! Lanes: one number for each wavelength of a group, in a SIMD register. No other file names the SIMD crates.
//!
//! Numerics are generic over [`Lanes`], which [`F32`] and [`F64`] implement. Phases need more digits than single
//! precision has. Each lane type therefore has a companion of equal width in double precision, [`Lanes::Precise`], in
//! which optical paths are formed and reduced before they are narrowed.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

#[cfg(target_feature = "avx512f")]
mod width {
    pub use wide::{f32x16 as Single, f64x8 as Double};
}
#[cfg(not(target_feature = "avx512f"))]
mod width {
    pub use wide::{f32x8 as Single, f64x4 as Double};
}

/// Single precision lanes: 16 wavelengths with AVX-512, otherwise 8.
pub type F32 = width::Single;
/// Double precision lanes: half as many wavelengths as [`F32`].
pub type F64 = width::Double;

/// √x, correctly rounded. `libm` has an instruction for it that takes hundreds of cycles beside wide registers, since
/// it keeps their upper halves.
#[inline]
pub(crate) fn sqrt(x: f64) -> f64 {
    let [root, _] = wide::f64x2::splat(x).sqrt().to_array();
    root
}

/// [`sqrt`] in single precision.
#[inline]
pub(crate) fn sqrtf(x: f32) -> f32 {
    let [root, ..] = wide::f32x4::splat(x).sqrt().to_array();
    root
}

/// Prefetches memory that will be read soon, where the machine can.
#[inline]
pub(crate) fn prefetch<T>(place: &T) {
    #[cfg(target_arch = "x86_64")]
    safe_arch::prefetch_t0(place);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// Name of the SIMD instruction set for which the crate was compiled, for `--version` and the C interface.
#[must_use]
pub const fn simd_level() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "avx512"
    } else if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
        "avx2+fma"
    } else if cfg!(target_feature = "avx") {
        "avx"
    } else if cfg!(target_feature = "sse2") {
        "sse2"
    } else if cfg!(target_feature = "neon") {
        "neon"
    } else if cfg!(target_feature = "simd128") {
        "simd128"
    } else {
        "scalar"
    }
}

/// Arithmetic on one number per wavelength, lane by lane.
pub trait Lanes:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + Send
    + Sync
    + 'static
{
    /// Lanes of equal width with at least double precision.
    type Precise: Lanes<Precise = Self::Precise>;
    /// Lanes that stay in registers through a computation: all of these, or those of a part.
    type Register: Lanes;
    /// Number of parts.
    const REGISTERS: usize = 1;
    /// Number of lanes.
    const WIDTH: usize;
    /// Half the distance from 1 to the next number, which bounds the relative error of one rounding.
    const UNIT_ROUNDOFF: f64;

    /// A part of the lanes.
    fn register(&self, index: usize) -> Self::Register;
    /// Replaces a part of the lanes.
    fn set_register(&mut self, index: usize, register: Self::Register);
    /// Copies a number to every lane.
    fn splat(x: f64) -> Self;
    /// Fills each lane `i` with `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> f64) -> Self;
    /// The number in lane `i`; NaN beyond [`Lanes::WIDTH`].
    fn lane(self, i: usize) -> f64;
    /// Rounds [`Lanes::Precise`] lanes to this precision.
    fn narrow(precise: Self::Precise) -> Self;
    /// Converts to [`Lanes::Precise`] lanes, exactly.
    fn widen(self) -> Self::Precise;
    /// self · m + a, fused where the machine can.
    fn mul_add(self, m: Self, a: Self) -> Self;
    /// a − self · m, fused where the machine can.
    fn neg_mul_add(self, m: Self, a: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// Nearest integer, ties to even.
    fn round(self) -> Self;
    /// e^self.
    fn exp(self) -> Self;
    /// The larger of the two; neither may be NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller of the two; neither may be NaN.
    fn min(self, other: Self) -> Self;
    /// `then` where self < bound, otherwise `otherwise`.
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self;
    /// A mask whose bit i is set if lane i of self does not exceed that of `other`; never for NaN.
    fn mask_le(self, other: Self) -> u64;
    /// True if any lane exceeds `bound`.
    fn any_above(self, bound: f64) -> bool;

    /// Writes the numbers of as many lanes as `numbers` has room for.
    #[inline]
    fn store(self, numbers: &mut [f64]) {
        numbers.iter_mut().take(Self::WIDTH).enumerate().for_each(|(lane, number)| *number = self.lane(lane));
    }

    /// Sum over lanes, in the precision of the lanes or more.
    fn sum(self) -> f64 {
        (0..Self::WIDTH).map(|lane| self.lane(lane)).sum()
    }

    /// 0 in every lane.
    #[inline]
    fn zero() -> Self {
        Self::splat(0.0)
    }

    /// 1 in every lane.
    #[inline]
    fn one() -> Self {
        Self::splat(1.0)
    }
}

/// The methods that [`F32`] and [`F64`] take from the SIMD crate unchanged.
/// Lanes that are one register.
macro_rules! one_register {
    () => {
        type Register = Self;

        #[inline]
        fn register(&self, _: usize) -> Self {
            *self
        }
        #[inline]
        fn set_register(&mut self, _: usize, register: Self) {
            *self = register;
        }
    };
}
pub(crate) use one_register;

macro_rules! delegate_to_wide {
    ($scalar:ty, $width:expr) => {
        const WIDTH: usize = $width;
        const UNIT_ROUNDOFF: f64 = <$scalar>::EPSILON as f64 / 2.0;

        #[inline]
        fn splat(x: f64) -> Self {
            Self::splat(x as $scalar)
        }
        #[inline]
        fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
            Self::new(core::array::from_fn(|i| f(i) as $scalar))
        }
        #[inline]
        fn lane(self, i: usize) -> f64 {
            self.to_array().get(i).map_or(f64::NAN, |&x| x as f64)
        }
        #[inline]
        fn mul_add(self, m: Self, a: Self) -> Self {
            self.mul_add(m, a)
        }
        #[inline]
        fn neg_mul_add(self, m: Self, a: Self) -> Self {
            self.mul_neg_add(m, a)
        }
        #[inline]
        fn sqrt(self) -> Self {
            self.sqrt()
        }
        #[inline]
        fn abs(self) -> Self {
            self.abs()
        }
        #[inline]
        fn round(self) -> Self {
            self.round_ties_even()
        }
        #[inline]
        fn exp(self) -> Self {
            self.exp()
        }
        #[inline]
        fn max(self, other: Self) -> Self {
            self.fast_max(other)
        }
        #[inline]
        fn min(self, other: Self) -> Self {
            self.fast_min(other)
        }
        #[inline]
        fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
            self.simd_lt(bound).select(then, otherwise)
        }
        #[inline]
        fn mask_le(self, other: Self) -> u64 {
            self.simd_le(other).to_bitmask().into()
        }
        #[inline]
        fn any_above(self, bound: f64) -> bool {
            self.simd_gt(Self::splat(bound as $scalar)).any()
        }
        #[inline]
        fn sum(self) -> f64 {
            self.reduce_add() as f64
        }
        #[inline]
        fn store(self, numbers: &mut [f64]) {
            numbers.iter_mut().zip(self.to_array()).for_each(|(number, x)| *number = x as f64);
        }
    };
}

#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_lossless,
    clippy::unnecessary_cast,
    reason = "the macro converts from either scalar type, also where it is f64 itself"
)]
impl Lanes for F32 {
    type Precise = F64Pair;
    one_register!();
    delegate_to_wide!(f32, 2 * F64::WIDTH);

    #[inline]
    fn narrow(precise: F64Pair) -> Self {
        let (low, high) = (precise.0.to_array(), precise.1.to_array());
        let mut out = [0.0f32; 2 * F64::WIDTH];
        for i in 0..F64::WIDTH {
            out[i] = low[i] as f32;
            out[i + F64::WIDTH] = high[i] as f32;
        }
        Self::new(out)
    }

    #[inline]
    fn widen(self) -> F64Pair {
        let single = self.to_array();
        F64Pair::from_fn(|i| single.get(i).map_or(f64::NAN, |&x| f64::from(x)))
    }
}

#[allow(
    clippy::cast_lossless,
    clippy::unnecessary_cast,
    reason = "the macro converts from either scalar type, also where it is f64 itself"
)]
impl Lanes for F64 {
    type Precise = Self;
    one_register!();
    delegate_to_wide!(f64, size_of::<F64>() / size_of::<f64>());

    #[inline]
    fn narrow(precise: Self) -> Self {
        precise
    }
    #[inline]
    fn widen(self) -> Self {
        self
    }
}

/// Double precision lanes of the same width as [`F32`], in two registers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct F64Pair(F64, F64);

impl F64Pair {
    #[inline]
    fn zip(self, other: Self, f: impl Fn(F64, F64) -> F64) -> Self {
        Self(f(self.0, other.0), f(self.1, other.1))
    }
}

/// Implements operators of [`F64Pair`] register by register.
macro_rules! zip_registers {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for F64Pair {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                self.zip(other, F64::$method)
            }
        }
    )*};
}

zip_registers!(Add add, Sub sub, Mul mul, Div div);

impl Neg for F64Pair {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl AddAssign for F64Pair {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Lanes for F64Pair {
    type Precise = Self;
    one_register!();
    const WIDTH: usize = F32::WIDTH;
    const UNIT_ROUNDOFF: f64 = F64::UNIT_ROUNDOFF;

    #[inline]
    fn splat(x: f64) -> Self {
        Self(F64::splat(x), F64::splat(x))
    }
    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        let low = <F64 as Lanes>::from_fn(&mut f);
        Self(low, <F64 as Lanes>::from_fn(|i| f(i + F64::WIDTH)))
    }
    #[inline]
    fn lane(self, i: usize) -> f64 {
        if i < F64::WIDTH { Lanes::lane(self.0, i) } else { Lanes::lane(self.1, i - F64::WIDTH) }
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
        Self(Lanes::mul_add(self.0, m.0, a.0), Lanes::mul_add(self.1, m.1, a.1))
    }
    #[inline]
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        Self(Lanes::neg_mul_add(self.0, m.0, a.0), Lanes::neg_mul_add(self.1, m.1, a.1))
    }
    #[inline]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt(), self.1.sqrt())
    }
    #[inline]
    fn abs(self) -> Self {
        Self(self.0.abs(), self.1.abs())
    }
    #[inline]
    fn round(self) -> Self {
        Self(Lanes::round(self.0), Lanes::round(self.1))
    }
    #[inline]
    fn exp(self) -> Self {
        Self(self.0.exp(), self.1.exp())
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        self.zip(other, <F64 as Lanes>::max)
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        self.zip(other, <F64 as Lanes>::min)
    }
    #[inline]
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
        Self(
            Lanes::select_lt(self.0, bound.0, then.0, otherwise.0),
            Lanes::select_lt(self.1, bound.1, then.1, otherwise.1),
        )
    }
    #[inline]
    fn mask_le(self, other: Self) -> u64 {
        self.0.mask_le(other.0) | (self.1.mask_le(other.1) << F64::WIDTH)
    }
    #[inline]
    fn any_above(self, bound: f64) -> bool {
        self.0.any_above(bound) || self.1.any_above(bound)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn matches_scalar<V: Lanes>() {
        let a = V::from_fn(|i| 0.75 * (i as f64) - 2.0);
        let b = V::from_fn(|i| 1.5 + i as f64);
        for i in 0..V::WIDTH {
            let (x, y) = (0.75 * (i as f64) - 2.0, 1.5 + i as f64);
            // Every operand and result is a short binary fraction or is rounded once.
            let close = |got: V, want: f64| {
                assert!((got.lane(i) - want).abs() <= 2.0 * V::UNIT_ROUNDOFF * want.abs(), "lane {i}: {got:?} {want}");
            };
            close(a + b, x + y);
            close(a - b, x - y);
            close(a * b, x * y);
            close(a / b, x / y);
            close(a.mul_add(b, a), x * y + x);
            close(a.neg_mul_add(b, a), x - x * y);
            close(b.sqrt(), libm::sqrt(y));
            close(a.abs(), x.abs());
            close(a.round(), libm::rint(x));
            close(a.max(b), x.max(y));
            close(a.min(b), x.min(y));
            assert_eq!(V::narrow(a.widen()), a);
            close(a.select_lt(V::zero(), a, b), if x < 0.0 { x } else { y });
            assert_eq!(a.mask_le(b) >> i & 1, u64::from(x <= y));
            assert_eq!(a.mask_le(a + V::splat(f64::NAN)), 0);
            assert_eq!(a.mask_le(V::splat(0.0)) >> i & 1, u64::from(x <= 0.0));
        }
        assert!(b.any_above(V::WIDTH as f64) && !b.any_above(V::WIDTH as f64 + 0.5));
    }

    #[test]
    fn every_lane_type_matches_scalar_arithmetic() {
        matches_scalar::<F32>();
        matches_scalar::<F64>();
        matches_scalar::<F64Pair>();
    }

    #[test]
    fn narrowing_keeps_the_order_of_lanes() {
        let narrow = F32::narrow(F64Pair::from_fn(|i| i as f64));
        assert_eq!(narrow, <F32 as Lanes>::from_fn(|i| i as f64));
    }

    #[test]
    fn exp_is_accurate_where_attenuation_matters() {
        // e^x with a reduction in working precision: a few roundings, plus one of x itself.
        fn worst<V: Lanes>() -> f64 {
            (0..4000).map(|i| -0.01 * f64::from(i)).fold(0.0, |worst: f64, x| {
                let x = V::splat(x).lane(0);
                worst.max((V::splat(x).exp().lane(0) - libm::exp(x)).abs())
            })
        }
        assert!(worst::<F32>() <= 4.0 * F32::UNIT_ROUNDOFF, "{}", worst::<F32>());
        assert!(worst::<F64>() <= 4.0 * F64::UNIT_ROUNDOFF, "{}", worst::<F64>());
    }
}
