//! The axes along which Fresnel's formulas act, and fields along them.
//!
//! Fields of many wavelengths are taken apart and put together register by register.

use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::ray_lanes::RayLanes;
use crate::simd::vector::{RealLanes, VectorLanes};

/// Amplitudes along ŝ and along p̂, or coefficients of these.
type Amplitudes<V> = Polarised<ComplexLanes<<V as RayLanes>::Light>>;

/// Axes ŝ and p̂ of a field: real vectors where the light travels without loss.
pub(super) enum Axes<V: RayLanes> {
    Real([RealLanes<V::Direction>; 2]),
    Complex([VectorLanes<V::Direction>; 2]),
}

impl<V: RayLanes> Axes<V> {
    #[inline]
    pub(super) fn new(s: VectorLanes<V::Wavevector>, p: VectorLanes<V::Wavevector>) -> Self {
        let imaginary = |axis: VectorLanes<V::Wavevector>| axis.x.im.abs() + axis.y.im.abs() + axis.z.im.abs();
        if (imaginary(s) + imaginary(p)).any_above(0.0) {
            Self::Complex([s, p].map(VectorLanes::narrow))
        } else {
            Self::Real([s, p].map(|axis| axis.map(|c| V::Direction::narrow(c.re))))
        }
    }

    /// Components of a field along ŝ and p̂.
    #[inline]
    pub(super) fn components(&self, field: &VectorLanes<V::Light>) -> Polarised<ComplexLanes<V::Light>> {
        let mut out = Polarised::both(ComplexLanes::zero());
        for index in 0..V::Light::REGISTERS {
            let e = field.register(index);
            let [s, p] = match self {
                Self::Real(axes) => axes.map(|axis| e.dot_lanes(axis.map(|c| V::spread_register(c, index)))),
                Self::Complex(axes) => axes.map(|axis| e.dot(axis.map(|c| c.map(|x| V::spread_register(x, index))))),
            };
            out.s.set_register(index, s);
            out.p.set_register(index, p);
        }
        out
    }

    /// Field with these components, each times a coefficient.
    #[inline]
    pub(super) fn field(&self, components: &Amplitudes<V>, coefficients: &Amplitudes<V>) -> VectorLanes<V::Light> {
        VectorLanes::from_registers(|index| {
            let s = components.s.register(index) * coefficients.s.register(index);
            let p = components.p.register(index) * coefficients.p.register(index);
            match self {
                Self::Real(axes) => {
                    let [s_axis, p_axis] = axes.map(|axis| axis.map(|c| V::spread_register(c, index)));
                    s_axis.map(|axis| s.scale(axis)) + p_axis.map(|axis| p.scale(axis))
                }
                Self::Complex(axes) => {
                    let [s_axis, p_axis] = axes.map(|axis| axis.map(|c| c.map(|x| V::spread_register(x, index))));
                    s_axis.scale(s) + p_axis.scale(p)
                }
            }
        })
    }
}
