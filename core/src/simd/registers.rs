//! Lanes in several registers, so that rays of many wavelengths are traced at once.

use crate::simd::lanes::Lanes;
use core::array::from_fn;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// The lanes of `N` registers, at most 64 lanes in all.
///
/// `ALIKE` changes no number, but what [`RayLanes`](crate::simd::ray_lanes::RayLanes) take to be one for all lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Registers<V, const N: usize, const ALIKE: bool = false>([V; N]);

/// Registers of wavelengths whose light differs in phase alone.
pub type Alike<V, const N: usize> = Registers<V, N, true>;

impl<V: Lanes, const N: usize, const ALIKE: bool> Registers<V, N, ALIKE> {
    #[inline]
    fn map(self, f: impl Fn(V) -> V) -> Self {
        let mut out = self;
        out.0.iter_mut().for_each(|register| *register = f(*register));
        out
    }

    #[inline]
    fn zip(self, other: Self, f: impl Fn(V, V) -> V) -> Self {
        let mut out = self;
        out.0.iter_mut().zip(other.0).for_each(|(register, b)| *register = f(*register, b));
        out
    }

    #[inline]
    fn zip3(self, b: Self, c: Self, f: impl Fn(V, V, V) -> V) -> Self {
        let mut out = self;
        out.0.iter_mut().zip(b.0).zip(c.0).for_each(|((register, b), c)| *register = f(*register, b, c));
        out
    }
}

/// Implements operators of [`Registers`] register by register.
macro_rules! operators {
    ($($operator:ident $method:ident),*) => {$(
        impl<V: Lanes, const N: usize, const ALIKE: bool> $operator for Registers<V, N, ALIKE> {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                self.zip(other, V::$method)
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div);

impl<V: Lanes, const N: usize, const ALIKE: bool> Neg for Registers<V, N, ALIKE> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.map(V::neg)
    }
}

impl<V: Lanes, const N: usize, const ALIKE: bool> AddAssign for Registers<V, N, ALIKE> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<V: Lanes, const N: usize, const ALIKE: bool> Lanes for Registers<V, N, ALIKE> {
    type Precise = Registers<V::Precise, N, ALIKE>;
    type Register = V;
    const REGISTERS: usize = N;
    const WIDTH: usize = N * V::WIDTH;
    const UNIT_ROUNDOFF: f64 = V::UNIT_ROUNDOFF;

    #[inline]
    fn register(&self, index: usize) -> V {
        self.0.get(index).copied().unwrap_or(V::zero())
    }
    #[inline]
    fn set_register(&mut self, index: usize, register: V) {
        if let Some(own) = self.0.get_mut(index) {
            *own = register;
        }
    }
    #[inline]
    fn splat(x: f64) -> Self {
        Self([V::splat(x); N])
    }
    #[inline]
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        Self(from_fn(|register| V::from_fn(|lane| f(register * V::WIDTH + lane))))
    }
    #[inline]
    fn lane(self, i: usize) -> f64 {
        self.0.get(i / V::WIDTH).map_or(f64::NAN, |register| register.lane(i % V::WIDTH))
    }
    #[inline]
    fn narrow(precise: Self::Precise) -> Self {
        let mut out = [V::zero(); N];
        out.iter_mut().zip(precise.0).for_each(|(register, precise)| *register = V::narrow(precise));
        Self(out)
    }
    #[inline]
    fn widen(self) -> Self::Precise {
        let mut out = [V::Precise::zero(); N];
        out.iter_mut().zip(self.0).for_each(|(precise, register)| *precise = register.widen());
        Registers(out)
    }
    #[inline]
    fn mul_add(self, m: Self, a: Self) -> Self {
        self.zip3(m, a, V::mul_add)
    }
    #[inline]
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        self.zip3(m, a, V::neg_mul_add)
    }
    #[inline]
    fn sqrt(self) -> Self {
        self.map(V::sqrt)
    }
    #[inline]
    fn abs(self) -> Self {
        self.map(V::abs)
    }
    #[inline]
    fn round(self) -> Self {
        self.map(V::round)
    }
    #[inline]
    fn exp(self) -> Self {
        self.map(V::exp)
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        self.zip(other, V::max)
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        self.zip(other, V::min)
    }
    #[inline]
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let mut out = self;
        let branches = bound.0.into_iter().zip(then.0).zip(otherwise.0);
        out.0.iter_mut().zip(branches).for_each(|(x, ((bound, then), or))| *x = x.select_lt(bound, then, or));
        out
    }
    #[inline]
    fn mask_le(self, other: Self) -> u64 {
        const { assert!(N * V::WIDTH <= 64) };
        let masks = self.0.into_iter().zip(other.0).map(|(a, b)| a.mask_le(b));
        masks.enumerate().fold(0, |mask, (register, bits)| mask | (bits << (register * V::WIDTH)))
    }
    #[inline]
    fn any_above(self, bound: f64) -> bool {
        self.0.iter().any(|register| register.any_above(bound))
    }
    #[inline]
    fn sum(self) -> f64 {
        self.0.into_iter().map(V::sum).sum()
    }
    #[inline]
    fn store(self, numbers: &mut [f64]) {
        self.0.into_iter().zip(numbers.chunks_mut(V::WIDTH)).for_each(|(register, numbers)| register.store(numbers));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::common::Common;
    use crate::simd::lanes::tests::matches_scalar;
    use crate::simd::lanes::{F32, F64};

    #[test]
    fn registers_and_one_number_for_all_match_scalar_arithmetic() {
        matches_scalar::<Registers<F32, 3>>();
        matches_scalar::<Registers<F64, 6>>();
        matches_scalar::<<Registers<F32, 2> as Lanes>::Precise>();
        matches_scalar::<Common>();
    }

    #[test]
    fn lanes_lie_register_by_register() {
        let lanes = Registers::<F32, 2>::from_fn(|i| i as f64);
        let mut numbers = [0.0; 2 * F32::WIDTH];
        lanes.store(&mut numbers);
        assert!(numbers.iter().enumerate().all(|(i, &x)| x.to_bits() == (i as f64).to_bits()));
        assert!((0..numbers.len()).all(|i| lanes.lane(i).to_bits() == numbers[i].to_bits()));
        let count = numbers.len() as f64;
        assert!((lanes.sum() - 0.5 * count * (count - 1.0)).abs() < 0.5);
    }
}
