//! Lanes that count the operations on them. Running the core's own code once with these tells how many floating-point
//! operations a wavelength costs.

use std::array;
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use goniochrome::simd::lanes::Lanes;
use goniochrome::simd::ray_lanes::RayLanes;

/// A kind of operation that is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Sums, products, negations, comparisons, choices, roundings, conversions: one operation each.
    Simple,
    /// Product and sum in one: two operations.
    Fused,
    /// Quotients.
    Divide,
    /// Square roots.
    Root,
    /// Exponentials.
    Exponential,
}

/// All kinds of operations, in the order of [`Counts`].
pub const OPERATIONS: [Operation; 5] =
    [Operation::Simple, Operation::Fused, Operation::Divide, Operation::Root, Operation::Exponential];

/// How often each operation was done, in working and in double precision.
pub type Counts = [[u64; 2]; OPERATIONS.len()];

thread_local! {
    static COUNTS: Cell<Counts> = const { Cell::new([[0; 2]; OPERATIONS.len()]) };
}

/// A vector of one lane that counts operations in this thread. `PRECISE` ones are the companions in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Counted<const PRECISE: bool>(f64);

/// Counts the operations of `work` in this thread.
pub fn count(work: impl FnOnce()) -> Counts {
    let before = COUNTS.get();
    work();
    let after = COUNTS.get();
    array::from_fn(|i| array::from_fn(|precise| after[i][precise] - before[i][precise]))
}

impl<const PRECISE: bool> Counted<PRECISE> {
    fn done(operation: Operation, result: f64) -> Self {
        let mut counts = COUNTS.get();
        counts[operation as usize][usize::from(PRECISE)] += 1;
        COUNTS.set(counts);
        Self(result)
    }
}

impl<const PRECISE: bool> Add for Counted<PRECISE> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::done(Operation::Simple, self.0 + other.0)
    }
}

impl<const PRECISE: bool> Sub for Counted<PRECISE> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::done(Operation::Simple, self.0 - other.0)
    }
}

impl<const PRECISE: bool> Mul for Counted<PRECISE> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::done(Operation::Simple, self.0 * other.0)
    }
}

impl<const PRECISE: bool> Div for Counted<PRECISE> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        Self::done(Operation::Divide, self.0 / other.0)
    }
}

impl<const PRECISE: bool> Neg for Counted<PRECISE> {
    type Output = Self;
    fn neg(self) -> Self {
        Self::done(Operation::Simple, -self.0)
    }
}

impl<const PRECISE: bool> AddAssign for Counted<PRECISE> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const PRECISE: bool> Lanes for Counted<PRECISE> {
    type Precise = Counted<true>;
    type Register = Self;
    const WIDTH: usize = 1;
    const UNIT_ROUNDOFF: f64 = if PRECISE { f64::EPSILON / 2.0 } else { f32::EPSILON as f64 / 2.0 };

    fn register(&self, _: usize) -> Self {
        *self
    }
    fn set_register(&mut self, _: usize, register: Self) {
        *self = register;
    }
    fn splat(x: f64) -> Self {
        Self(x)
    }
    fn from_fn(mut f: impl FnMut(usize) -> f64) -> Self {
        Self(f(0))
    }
    fn lane(self, i: usize) -> f64 {
        if i == 0 { self.0 } else { f64::NAN }
    }
    fn narrow(precise: Counted<true>) -> Self {
        Self::done(Operation::Simple, precise.0)
    }
    fn widen(self) -> Counted<true> {
        Counted::<true>::done(Operation::Simple, self.0)
    }
    fn mul_add(self, m: Self, a: Self) -> Self {
        Self::done(Operation::Fused, self.0.mul_add(m.0, a.0))
    }
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        Self::done(Operation::Fused, (-self.0).mul_add(m.0, a.0))
    }
    fn sqrt(self) -> Self {
        Self::done(Operation::Root, self.0.sqrt())
    }
    fn abs(self) -> Self {
        Self::done(Operation::Simple, self.0.abs())
    }
    fn round(self) -> Self {
        Self::done(Operation::Simple, self.0.round_ties_even())
    }
    fn exp(self) -> Self {
        Self::done(Operation::Exponential, self.0.exp())
    }
    fn max(self, other: Self) -> Self {
        Self::done(Operation::Simple, self.0.max(other.0))
    }
    fn min(self, other: Self) -> Self {
        Self::done(Operation::Simple, self.0.min(other.0))
    }
    fn select_lt(self, bound: Self, then: Self, otherwise: Self) -> Self {
        let chosen = if self.0 < bound.0 { then.0 } else { otherwise.0 };
        // A comparison and a choice.
        Self::done(Operation::Simple, Self::done(Operation::Simple, chosen).0)
    }
    fn mask_le(self, other: Self) -> u64 {
        u64::from(Self::done(Operation::Simple, self.0).0 <= other.0)
    }
    fn any_above(self, bound: f64) -> bool {
        Self::done(Operation::Simple, self.0).0 > bound
    }
}

impl<const PRECISE: bool> RayLanes for Counted<PRECISE> {
    type Wavevector = Counted<true>;
    type Direction = Self;
    type Light = Self;

    fn wavevector(index: Counted<true>) -> Counted<true> {
        index
    }
    fn precise(wavevector: Counted<true>) -> Counted<true> {
        wavevector
    }
    fn spread(direction: Self) -> Self {
        direction
    }
    fn spread_register(direction: Self, _: usize) -> Self {
        direction
    }
    fn light(number: Self) -> Self {
        number
    }
    fn each(light: Self) -> Self {
        light
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_operation_counts_once_where_it_is_done() {
        let x = Counted::<false>::splat(2.0);
        let counts = count(|| {
            let _ = x.mul_add(x, x) / x;
            let _ = Counted::<true>::splat(3.0).sqrt() + Counted::<true>::one();
        });
        assert_eq!(counts, [[0, 1], [1, 0], [1, 0], [0, 1], [0, 0]]);
    }
}
