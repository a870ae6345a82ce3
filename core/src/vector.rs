//! Vectors with a number per wavelength in each component: complex ones for wavevectors and electric fields, real ones for the
//! directions of light that does not interfere.

use crate::complex::ComplexLanes;
use crate::lanes::Lanes;
use glam::DVec3;

/// A complex vector for each wavelength of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VectorLanes<V> {
    /// Along the tangent.
    pub x: ComplexLanes<V>,
    /// Along the binormal.
    pub y: ComplexLanes<V>,
    /// Along the macroscopic normal.
    pub z: ComplexLanes<V>,
}

impl<V: Lanes> VectorLanes<V> {
    /// The same real vector in every lane.
    pub fn splat(v: DVec3) -> Self {
        let real = |x| ComplexLanes::real(V::splat(x));
        Self { x: real(v.x), y: real(v.y), z: real(v.z) }
    }

    /// 0.
    pub fn zero() -> Self {
        Self { x: ComplexLanes::zero(), y: ComplexLanes::zero(), z: ComplexLanes::zero() }
    }

    /// Rounds double precision to the lanes' own.
    #[inline]
    pub fn narrow(precise: VectorLanes<V::Precise>) -> Self {
        Self {
            x: ComplexLanes::narrow(precise.x),
            y: ComplexLanes::narrow(precise.y),
            z: ComplexLanes::narrow(precise.z),
        }
    }

    /// Σ aᵢbᵢ, without conjugation: q·q = η² holds for this product.
    #[inline]
    pub fn dot(self, other: Self) -> ComplexLanes<V> {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Product with a real vector.
    #[inline]
    pub fn dot_real(self, v: DVec3) -> ComplexLanes<V> {
        let (x, y, z) = (V::splat(v.x), V::splat(v.y), V::splat(v.z));
        ComplexLanes {
            re: self.x.re.mul_add(x, self.y.re.mul_add(y, self.z.re * z)),
            im: self.x.im.mul_add(x, self.y.im.mul_add(y, self.z.im * z)),
        }
    }

    /// Product with a real vector for each lane.
    #[inline]
    pub fn dot_lanes(self, v: RealLanes<V>) -> ComplexLanes<V> {
        let [x, y, z] = [self.x, self.y, self.z];
        let real = RealLanes { x: x.re, y: y.re, z: z.re };
        let imaginary = RealLanes { x: x.im, y: y.im, z: z.im };
        ComplexLanes { re: real.dot(v), im: imaginary.dot(v) }
    }

    /// Vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.z.neg_mul_add(other.y, self.y * other.z),
            y: self.x.neg_mul_add(other.z, self.z * other.x),
            z: self.y.neg_mul_add(other.x, self.x * other.y),
        }
    }

    /// Each component times a complex number.
    #[inline]
    pub fn scale(self, by: ComplexLanes<V>) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// self + v·by for a real vector v.
    #[inline]
    pub fn add_scaled(self, v: DVec3, by: ComplexLanes<V>) -> Self {
        let along = |c: ComplexLanes<V>, v: f64| c + by.scale(V::splat(v));
        Self { x: along(self.x, v.x), y: along(self.y, v.y), z: along(self.z, v.z) }
    }

    /// Σ |aᵢ|².
    #[inline]
    pub fn norm_sqr(self) -> V {
        self.x.norm_sqr() + self.y.norm_sqr() + self.z.norm_sqr()
    }

    /// The real part in one lane.
    pub fn direction(self, lane: usize) -> DVec3 {
        DVec3::new(self.x.re.lane(lane), self.y.re.lane(lane), self.z.re.lane(lane))
    }

    /// f applied to each pair of components.
    #[inline]
    pub fn zip(self, other: Self, f: impl Fn(ComplexLanes<V>, ComplexLanes<V>) -> ComplexLanes<V>) -> Self {
        Self { x: f(self.x, other.x), y: f(self.y, other.y), z: f(self.z, other.z) }
    }
}

/// A real vector for each wavelength of a group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealLanes<V> {
    /// Along the tangent.
    pub x: V,
    /// Along the binormal.
    pub y: V,
    /// Along the macroscopic normal.
    pub z: V,
}

impl<V: Lanes> RealLanes<V> {
    /// The same vector in every lane.
    #[inline]
    pub fn splat(v: DVec3) -> Self {
        Self { x: V::splat(v.x), y: V::splat(v.y), z: V::splat(v.z) }
    }

    /// Σ aᵢbᵢ.
    #[inline]
    pub fn dot(self, other: Self) -> V {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Vector product.
    #[inline]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.z.neg_mul_add(other.y, self.y * other.z),
            y: self.x.neg_mul_add(other.z, self.z * other.x),
            z: self.y.neg_mul_add(other.x, self.x * other.y),
        }
    }

    /// Each component times a number.
    #[inline]
    pub fn scale(self, by: V) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// self + v·by.
    #[inline]
    pub fn add_scaled(self, v: Self, by: V) -> Self {
        Self { x: v.x.mul_add(by, self.x), y: v.y.mul_add(by, self.y), z: v.z.mul_add(by, self.z) }
    }

    /// The vector in one lane.
    #[inline]
    pub fn lane(self, lane: usize) -> DVec3 {
        DVec3::new(self.x.lane(lane), self.y.lane(lane), self.z.lane(lane))
    }
}

impl<V: Lanes> core::ops::Add for VectorLanes<V> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<V: Lanes> core::ops::Sub for VectorLanes<V> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F64;
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
