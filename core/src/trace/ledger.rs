//! Sum of the rays that leave a planar cell, and the ledger of power.

use crate::geometry::side::Side;
use crate::optics::stack::Response;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::trace::waves::Sink;

/// Sink for the rays of a planar cell. All rays that leave on one side have the same direction, so they add as
/// amplitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular<V> {
    above: Polarised<ComplexLanes<V>>,
    below: Polarised<ComplexLanes<V>>,
}

impl<V: Lanes> Specular<V> {
    /// Empty sums.
    #[must_use]
    pub fn new() -> Self {
        let zero = Polarised::both(ComplexLanes::zero());
        Self { above: zero, below: zero }
    }

    /// Sums of the amplitudes that have left.
    #[must_use]
    pub fn response(&self) -> Response<V> {
        Response { reflection: self.above, transmission: self.below }
    }
}

impl<V: Lanes> Default for Specular<V> {
    fn default() -> Self {
        Self::new()
    }
}

impl<V: Lanes> Sink<Side, Polarised<ComplexLanes<V>>> for Specular<V> {
    #[inline]
    fn exit(&mut self, side: Side, field: Polarised<ComplexLanes<V>>) {
        let sum = match side {
            Side::Above => &mut self.above,
            Side::Below => &mut self.below,
        };
        *sum = sum.zip(field, |a, b| a + b);
    }
}

/// Power balance of a trace: reflected + transmitted + absorbed + imbalance = 1 for each polarisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger<V> {
    /// Power that leaves on the side of the light.
    pub reflected: Polarised<V>,
    /// Power that enters the substrate.
    pub transmitted: Polarised<V>,
    /// Power that is absorbed inside the cell, computed from the fields there.
    pub absorbed: Polarised<V>,
    /// Error due to rays that were not followed: the largest difference of `reflected` and `transmitted`, over s and p,
    /// from their values with all loops closed in the same precision. It includes the rounding errors of a long sum. It
    /// is 0 if loops are closed.
    pub truncated: V,
    /// Difference between 1 and the sum of the other terms, due to rounding and to rays that were not followed. The
    /// paper's model does not conserve power.
    pub imbalance: Polarised<V>,
}

impl<V: Lanes> Ledger<V> {
    /// Ledger of the given terms, with the imbalance that makes their sum 1.
    pub fn new(reflected: Polarised<V>, transmitted: Polarised<V>, absorbed: Polarised<V>, truncated: V) -> Self {
        let imbalance_of = |r: V, t: V, a: V| V::one() - r - t - a;
        let imbalance = Polarised {
            s: imbalance_of(reflected.s, transmitted.s, absorbed.s),
            p: imbalance_of(reflected.p, transmitted.p, absorbed.p),
        };
        Self { reflected, transmitted, absorbed, truncated, imbalance }
    }
}
