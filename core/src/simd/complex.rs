//! Complex numbers of one number per wavelength, and pairs of quantities for the two polarisations.

use crate::simd::lanes::Lanes;
use core::ops::{Add, AddAssign, Mul, Neg, Sub};
use num_complex::Complex64;

/// One complex number for each wavelength of a group.
///
/// `num_complex` requires its scalars to be `Num`, which SIMD lanes cannot be; names here follow that crate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexLanes<V> {
    /// Real part.
    pub re: V,
    /// Imaginary part.
    pub im: V,
}

impl<V: Lanes> ComplexLanes<V> {
    /// The number re + i·im.
    #[inline]
    pub fn new(re: V, im: V) -> Self {
        Self { re, im }
    }

    /// The real number re + 0i.
    #[inline]
    pub fn real(re: V) -> Self {
        Self { re, im: V::zero() }
    }

    /// The number 0.
    #[inline]
    pub fn zero() -> Self {
        Self::real(V::zero())
    }

    /// The number 1.
    #[inline]
    pub fn one() -> Self {
        Self::real(V::one())
    }

    /// Fills each lane `i` with `f(i)`.
    pub fn from_fn(mut f: impl FnMut(usize) -> Complex64) -> Self {
        Self { re: V::from_fn(|i| f(i).re), im: V::from_fn(|i| f(i).im) }
    }

    /// The number in lane `i`.
    pub fn lane(self, i: usize) -> Complex64 {
        Complex64::new(self.re.lane(i), self.im.lane(i))
    }

    /// Rounds [`Lanes::Precise`] lanes to the precision of `V`.
    #[inline]
    pub fn narrow(precise: ComplexLanes<V::Precise>) -> Self {
        Self { re: V::narrow(precise.re), im: V::narrow(precise.im) }
    }

    /// Applies f to both parts.
    #[inline]
    pub fn map<U>(self, f: impl Fn(V) -> U) -> ComplexLanes<U> {
        ComplexLanes { re: f(self.re), im: f(self.im) }
    }

    /// A part of the lanes: see [`Lanes::register`].
    #[inline]
    pub fn register(&self, index: usize) -> ComplexLanes<V::Register> {
        ComplexLanes { re: self.re.register(index), im: self.im.register(index) }
    }

    /// Replaces a part of the lanes.
    #[inline]
    pub fn set_register(&mut self, index: usize, register: ComplexLanes<V::Register>) {
        self.re.set_register(index, register.re);
        self.im.set_register(index, register.im);
    }

    /// The complex conjugate.
    #[inline]
    pub fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// The squared magnitude |z|².
    #[inline]
    pub fn norm_sqr(self) -> V {
        self.re.mul_add(self.re, self.im * self.im)
    }

    /// The magnitude |z|; squares must not overflow.
    #[inline]
    pub fn norm(self) -> V {
        self.norm_sqr().sqrt()
    }

    /// The product z · x with a real x.
    #[inline]
    pub fn scale(self, x: V) -> Self {
        Self { re: self.re * x, im: self.im * x }
    }

    /// The square z².
    #[inline]
    pub fn square(self) -> Self {
        let cross = self.re * self.im;
        Self { re: self.im.neg_mul_add(self.im, self.re * self.re), im: cross + cross }
    }

    /// The sum self · m + a.
    #[inline]
    pub fn mul_add(self, m: Self, a: Self) -> Self {
        Self {
            re: self.im.neg_mul_add(m.im, self.re.mul_add(m.re, a.re)),
            im: self.im.mul_add(m.re, self.re.mul_add(m.im, a.im)),
        }
    }

    /// The difference a − self · m.
    #[inline]
    pub fn neg_mul_add(self, m: Self, a: Self) -> Self {
        Self {
            re: self.im.mul_add(m.im, self.re.neg_mul_add(m.re, a.re)),
            im: self.im.neg_mul_add(m.re, self.re.neg_mul_add(m.im, a.im)),
        }
    }

    /// The quotient self / d, and 0 where d = 0: two media of equal index whose wave runs along the plane do not
    /// reflect.
    #[inline]
    pub fn div_or_zero(self, d: Self) -> Self {
        let norm = d.norm_sqr();
        // Below the smallest normal number 1/norm may be infinite, and 0 times it NaN.
        let min_normal =
            V::splat(if V::UNIT_ROUNDOFF > f64::EPSILON { f32::MIN_POSITIVE.into() } else { f64::MIN_POSITIVE });
        let scale = min_normal.select_lt(norm, V::one() / norm, V::zero());
        (self * d.conj()).scale(scale)
    }

    /// The square root that belongs to a wave that leaves an interface: the one with Re ≥ 0 where the real part of self
    /// is positive and the wave travels, and the one with Im ≥ 0 elsewhere, where the wave decays.
    ///
    /// If the wave's tangential part is real, Im self ≥ 0, and one root meets both conditions. Where light from an
    /// absorbing body meets a tilted facet, the tangential part is complex. A transmitted wave that travels may then
    /// grow across its direction, as does the light from parts that lie nearer to the body's entrance.
    #[inline]
    pub fn sqrt_outgoing(self) -> Self {
        let upper = self.sqrt_upper();
        let zero = V::zero();
        let sign = upper.re.select_lt(zero, zero.select_lt(self.re, -V::one(), V::one()), V::one());
        upper.scale(sign)
    }

    /// The square root with Im ≥ 0, and with Re ≥ 0 where Im = 0: that of a wave that decays, or travels, away.
    #[inline]
    pub fn sqrt_upper(self) -> Self {
        let zero = V::zero();
        if !self.im.abs().any_above(0.0) {
            return Self { re: self.re.max(zero).sqrt(), im: (-self.re).max(zero).sqrt() };
        }
        // The larger part comes from a sum without cancellation, the smaller from Im z = 2 Re √z Im √z.
        let half = V::splat(0.5);
        let large = ((self.norm() + self.re.abs()) * half).sqrt();
        let small = zero.select_lt(large, half * self.im / large, zero);
        let sign = self.im.select_lt(zero, -V::one(), V::one());
        Self { re: self.re.select_lt(zero, small, large * sign), im: self.re.select_lt(zero, large, small.abs()) }
    }
}

impl<V: Lanes> Add for ComplexLanes<V> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl<V: Lanes> AddAssign for ComplexLanes<V> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<V: Lanes> Sub for ComplexLanes<V> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl<V: Lanes> Mul for ComplexLanes<V> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.im.neg_mul_add(other.im, self.re * other.re),
            im: self.im.mul_add(other.re, self.re * other.im),
        }
    }
}

impl<V: Lanes> Neg for ComplexLanes<V> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

/// A quantity for each of the two polarisations of the electric field.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Polarised<T> {
    /// Field perpendicular to the plane of incidence.
    pub s: T,
    /// Field parallel to the plane of incidence.
    pub p: T,
}

impl<T: Copy> Polarised<T> {
    /// Gives both polarisations one value.
    #[inline]
    pub fn both(x: T) -> Self {
        Self { s: x, p: x }
    }

    /// Applies f to each polarisation.
    #[inline]
    pub fn map<U>(self, f: impl Fn(T) -> U) -> Polarised<U> {
        Polarised { s: f(self.s), p: f(self.p) }
    }

    /// Applies f to each polarisation of the two quantities.
    #[inline]
    pub fn zip<U: Copy, W>(self, other: Polarised<U>, f: impl Fn(T, U) -> W) -> Polarised<W> {
        Polarised { s: f(self.s, other.s), p: f(self.p, other.p) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::lanes::{F32, F64};

    const SAMPLES: [Complex64; 8] = [
        Complex64::new(1.3, 0.2),
        Complex64::new(-0.4, 1.1),
        Complex64::new(-2.0, -0.7),
        Complex64::new(0.0, 3.0),
        Complex64::new(2.25, 1e-9),
        Complex64::new(-0.5, 0.0),
        Complex64::new(5.0, -2.0),
        Complex64::new(0.3, 0.0),
    ];

    fn matches_num_complex<V: Lanes>() {
        let a = ComplexLanes::<V>::from_fn(|i| SAMPLES[i % 8]);
        let b = ComplexLanes::<V>::from_fn(|i| SAMPLES[(i + 3) % 8]);
        for i in 0..V::WIDTH {
            let (x, y) = (SAMPLES[i % 8], SAMPLES[(i + 3) % 8]);
            // Sums of at most four rounded products of rounded operands.
            let bound = 16.0 * V::UNIT_ROUNDOFF * (1.0 + x.norm()) * (1.0 + y.norm());
            let close = |got: ComplexLanes<V>, want: Complex64| {
                assert!((got.lane(i) - want).norm() <= bound, "lane {i}: {:?} for {want}", got.lane(i));
            };
            close(a * b, x * y);
            close(a.mul_add(b, a), x * y + x);
            close(a.neg_mul_add(b, b), y - x * y);
            close(a.square(), x * x);
            close(a.div_or_zero(b) * b, x);
            let root = a.sqrt_upper();
            close(root * root, x);
            assert!(root.lane(i).im >= 0.0 && (root.lane(i).im > 0.0 || root.lane(i).re >= 0.0), "{:?}", root.lane(i));
        }
    }

    #[test]
    fn complex_lanes_match_num_complex() {
        matches_num_complex::<F32>();
        matches_num_complex::<F64>();
        matches_num_complex::<<F32 as Lanes>::Precise>();
    }

    #[test]
    fn the_outgoing_root_travels_on_or_decays() {
        for (re, im) in [(2.0, 1e-3), (2.0, -1e-3), (2.0, 0.0), (-2.0, 1e-3), (-2.0, -1e-3), (-2.0, 0.0)] {
            let z = Complex64::new(re, im);
            let root = ComplexLanes::<F64>::from_fn(|_| z).sqrt_outgoing().lane(0);
            assert!((root * root - z).norm() < 1e-15, "{root}");
            assert!(if re > 0.0 { root.re > 0.0 } else { root.im > 0.0 }, "{root}");
        }
    }

    #[test]
    fn roots_of_real_lanes_are_purely_real_or_imaginary() {
        let z = ComplexLanes::<F64>::from_fn(|i| Complex64::new(i as f64 - 2.0, 0.0));
        for i in 0..F64::WIDTH {
            let root = z.sqrt_upper().lane(i);
            assert!(root.re.min(root.im) == 0.0, "{root}");
        }
    }

    #[test]
    fn zero_over_zero_is_zero() {
        let zero = ComplexLanes::<F32>::zero();
        assert_eq!(zero.div_or_zero(zero), zero);
    }
}
