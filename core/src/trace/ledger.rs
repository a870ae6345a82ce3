//! Sinks: how rays that leave a cell add up, and the ledger of their power.

use crate::geometry::side::Side;
use crate::optics::stack::Response;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::trace::waves::Sink;

/// The sink of a planar cell: all rays that leave on one side have one direction, so they add as amplitudes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular<V> {
    above: Polarised<ComplexLanes<V>>,
    below: Polarised<ComplexLanes<V>>,
}

impl<V: Lanes> Specular<V> {
    /// Nothing has left yet.
    #[must_use]
    pub fn new() -> Self {
        let nothing = Polarised::both(ComplexLanes::zero());
        Self { above: nothing, below: nothing }
    }

    /// The sums.
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

/// Where the power of a trace went: reflected + transmitted + absorbed + imbalance = 1 per polarisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ledger<V> {
    /// Left on the side of the light.
    pub reflected: Polarised<V>,
    /// Entered the substrate.
    pub transmitted: Polarised<V>,
    /// Lost inside the cell, from the fields there.
    pub absorbed: Polarised<V>,
    /// The error bar of rays that were not followed: the largest difference of `reflected` and `transmitted`, of s and
    /// p, from their values with all loops closed in the same precision. It includes what a long sum lost by rounding.
    /// 0 where loops are closed.
    pub truncated: V,
    /// What is missing: rounding, and what rays that were not followed would change. The paper's model does not
    /// conserve power.
    pub imbalance: Polarised<V>,
}

impl<V: Lanes> Ledger<V> {
    /// Closes the ledger.
    pub fn new(reflected: Polarised<V>, transmitted: Polarised<V>, absorbed: Polarised<V>, truncated: V) -> Self {
        let remainder = |r: V, t: V, a: V| V::one() - r - t - a;
        let imbalance = Polarised {
            s: remainder(reflected.s, transmitted.s, absorbed.s),
            p: remainder(reflected.p, transmitted.p, absorbed.p),
        };
        Self { reflected, transmitted, absorbed, truncated, imbalance }
    }
}
