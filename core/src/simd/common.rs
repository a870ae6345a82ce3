//! One number for all wavelengths, where lanes would repeat it.

use crate::simd::lanes::{Lanes, one_register, sqrt};
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Lanes that all hold the same number, in double precision: the directions of light in media that do not disperse.
///
/// It has one lane, and any number of a lane is that one.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Common(f64);

/// Implements operators of [`Common`].
macro_rules! operators {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for Common {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(f64::$method(self.0, other.0))
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl Neg for Common {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Common {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Lanes for Common {
    type Precise = Self;
    one_register!();
    const WIDTH: usize = 1;
    const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

    #[inline]
    fn splat(x: f64) -> Self {
        Self(x)
    }
    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        Self(f(0))
    }
    #[inline]
    fn lane(self, _: usize) -> f64 {
        self.0
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
    #[inline]
    fn sqrt(self) -> Self {
        Self(sqrt(self.0))
    }
    #[inline]
    fn abs(self) -> Self {
        Self(libm::fabs(self.0))
    }
    #[inline]
    fn round(self) -> Self {
        Self(libm::rint(self.0))
    }
    #[inline]
    fn exp(self) -> Self {
        Self(libm::exp(self.0))
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        if other.0 > self.0 { other } else { self }
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        if other.0 < self.0 { other } else { self }
    }
    #[inline]
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
        if self.0 < bound.0 { then } else { otherwise }
    }
    #[inline]
    fn mask_le(self, other: Self) -> u64 {
        u64::from(self.0 <= other.0)
    }
    #[inline]
    fn any_above(self, bound: f64) -> bool {
        self.0 > bound
    }
}
