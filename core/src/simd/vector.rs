//! Vectors whose components hold one number per wavelength: complex ones for wavevectors and electric fields, real ones
//! for the directions of light that does not interfere.

use crate::simd::complex::ComplexLanes;
use crate::simd::lanes::Lanes;
use core::ops::{Add, Mul, Sub};
use glam::DVec3;

/// A vector of three components in the surface frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector<T> {
    /// Component along the tangent.
    pub x: T,
    /// Component along the binormal.
    pub y: T,
    /// Component along the macroscopic normal.
    pub z: T,
}

/// A complex vector for each wavelength of a group.
pub type VectorLanes<V> = Vector<ComplexLanes<V>>;

/// A real vector for each wavelength of a group.
pub type RealLanes<V> = Vector<V>;

/// Arithmetic that a [`Vector`] needs of its components: lanes, or complex numbers of lanes.
pub trait Component: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The sum self · m + a.
    fn mul_add(self, m: Self, a: Self) -> Self;
    /// The difference a − self · m.
    fn neg_mul_add(self, m: Self, a: Self) -> Self;
}

impl<V: Lanes> Component for V {
    #[inline]
    fn mul_add(self, m: Self, a: Self) -> Self {
        Lanes::mul_add(self, m, a)
    }
    #[inline]
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        Lanes::neg_mul_add(self, m, a)
    }
}

impl<V: Lanes> Component for ComplexLanes<V> {
    #[inline]
    fn mul_add(self, m: Self, a: Self) -> Self {
        self.mul_add(m, a)
    }
    #[inline]
    fn neg_mul_add(self, m: Self, a: Self) -> Self {
        self.neg_mul_add(m, a)
    }
}

impl<T: Component> Vector<T> {
    /// The scalar product Σ aᵢbᵢ, without conjugation: q·q = η² holds for this product.
    #[inline]
    pub fn dot(self, other: Self) -> T {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// The vector product a × b.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.z.neg_mul_add(other.y, self.y * other.z),
            y: self.x.neg_mul_add(other.z, self.z * other.x),
            z: self.y.neg_mul_add(other.x, self.x * other.y),
        }
    }

    /// Multiplies each component by a number.
    #[inline]
    pub fn scale(self, by: T) -> Self {
        self.map(|component| component * by)
    }

    /// Applies f to each component.
    #[inline]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Vector<U> {
        Vector { x: f(self.x), y: f(self.y), z: f(self.z) }
    }

    /// Applies f to each pair of components.
    #[inline]
    pub fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        Self { x: f(self.x, other.x), y: f(self.y, other.y), z: f(self.z, other.z) }
    }
}

impl<T: Component> Add for Vector<T> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Component> Sub for Vector<T> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<V: Lanes> VectorLanes<V> {
    /// Copies a real vector to every lane.
    pub fn splat(v: DVec3) -> Self {
        RealLanes::<V>::splat(v).map(ComplexLanes::real)
    }

    /// The vector 0.
    pub fn zero() -> Self {
        Self { x: ComplexLanes::zero(), y: ComplexLanes::zero(), z: ComplexLanes::zero() }
    }

    /// Rounds [`Lanes::Precise`] lanes to the precision of `V`.
    #[inline]
    pub fn narrow(precise: VectorLanes<V::Precise>) -> Self {
        precise.map(ComplexLanes::narrow)
    }

    /// The scalar product with a real vector.
    #[inline]
    pub fn dot_real(self, v: DVec3) -> ComplexLanes<V> {
        self.dot_lanes(RealLanes::<V>::splat(v))
    }

    /// The scalar product with a real vector for each lane.
    #[inline]
    pub fn dot_lanes(self, v: RealLanes<V>) -> ComplexLanes<V> {
        ComplexLanes { re: self.map(|c| c.re).dot(v), im: self.map(|c| c.im).dot(v) }
    }

    /// The sum self + v·by with a real vector v.
    #[inline]
    pub fn add_scaled(self, v: DVec3, by: ComplexLanes<V>) -> Self {
        let along = |c: ComplexLanes<V>, v: f64| c + by.scale(V::splat(v));
        Self { x: along(self.x, v.x), y: along(self.y, v.y), z: along(self.z, v.z) }
    }

    /// The squared norm Σ |aᵢ|².
    #[inline]
    pub fn norm_sqr(self) -> V {
        let mut out = V::zero();
        for index in 0..V::REGISTERS {
            let Vector { x, y, z } = self.register(index);
            out.set_register(index, x.norm_sqr() + y.norm_sqr() + z.norm_sqr());
        }
        out
    }

    /// The vector with each component multiplied by a complex number.
    #[inline]
    pub fn times(self, factor: ComplexLanes<V>) -> Self {
        Self::from_registers(|index| self.register(index).scale(factor.register(index)))
    }

    /// A part of the lanes: see [`Lanes::register`].
    #[inline]
    pub fn register(&self, index: usize) -> VectorLanes<V::Register> {
        Vector { x: self.x.register(index), y: self.y.register(index), z: self.z.register(index) }
    }

    /// Vector of the parts `of` its lanes.
    #[inline]
    pub fn from_registers(of: impl Fn(usize) -> VectorLanes<V::Register>) -> Self {
        let mut out = Self::zero();
        for index in 0..V::REGISTERS {
            let Vector { x, y, z } = of(index);
            out.x.set_register(index, x);
            out.y.set_register(index, y);
            out.z.set_register(index, z);
        }
        out
    }

    /// The real part of the vector in one lane.
    pub fn direction(self, lane: usize) -> DVec3 {
        self.map(|c| c.re).lane(lane)
    }
}

impl<V: Lanes> RealLanes<V> {
    /// Copies a vector to every lane.
    #[inline]
    pub fn splat(v: DVec3) -> Self {
        Self { x: V::splat(v.x), y: V::splat(v.y), z: V::splat(v.z) }
    }

    /// The sum self + v·by.
    #[inline]
    pub fn add_scaled(self, v: Self, by: V) -> Self {
        self.zip(v, |component, v| v.mul_add(by, component))
    }

    /// The vector scaled to length 1, and 0 where its length is 0.
    #[inline]
    pub fn normalize_or_zero(self) -> Self {
        let square = self.dot(self);
        self.scale(V::zero().select_lt(square, V::one() / square.sqrt(), V::zero()))
    }

    /// The vector in one lane.
    #[inline]
    pub fn lane(self, lane: usize) -> DVec3 {
        DVec3::new(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::lanes::F64;
    use num_complex::Complex64;

    fn vector(v: [Complex64; 3]) -> VectorLanes<F64> {
        let [x, y, z] = v.map(|c| ComplexLanes::from_fn(|_| c));
        VectorLanes { x, y, z }
    }

    #[test]
    fn products_match_their_definitions() {
        let c = Complex64::new;
        let (a, b) = ([c(1.0, 2.0), c(-0.5, 0.1), c(0.3, -1.0)], [c(0.2, 0.0), c(1.5, -2.0), c(-1.0, 0.7)]);
        let (va, vb) = (vector(a), vector(b));
        let near = |got: ComplexLanes<F64>, want: Complex64| assert!((got.lane(0) - want).norm() < 1e-14);
        near(va.dot(vb), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        let cross = va.cross(vb);
        near(cross.x, a[1] * b[2] - a[2] * b[1]);
        near(cross.y, a[2] * b[0] - a[0] * b[2]);
        near(cross.z, a[0] * b[1] - a[1] * b[0]);
        near(va.dot_real(DVec3::new(1.0, -2.0, 0.5)), a[0] - 2.0 * a[1] + 0.5 * a[2]);
        let real = |v: [Complex64; 3]| RealLanes::<F64>::splat(DVec3::from_array(v.map(|c| c.re)));
        let (ra, rb) = (real(a), real(b));
        assert!((Lanes::lane(ra.dot(rb), 0) - ra.lane(0).dot(rb.lane(0))).abs() < 1e-14);
        assert!((ra.cross(rb).lane(0) - ra.lane(0).cross(rb.lane(0))).length() < 1e-14);
        near(va.dot_lanes(rb), a[0] * b[0].re + a[1] * b[1].re + a[2] * b[2].re);
        let norm = a.iter().map(|c| c.norm_sqr()).sum::<f64>();
        assert!((Lanes::lane(va.norm_sqr(), 0) - norm).abs() < 1e-14);
    }
}
