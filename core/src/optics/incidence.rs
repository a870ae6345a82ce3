//! The angle of incidence, and the square q_n² of the normal wavevector that it gives in each medium.

use crate::simd::complex::ComplexLanes;
use crate::simd::lanes::Lanes;
use crate::simd::phase::cis;

/// An angle of incidence θ, stored as sin²θ = s² − c: up to 45° s = sin θ and c = 0, beyond s = 1 and c = cos²θ.
///
/// Near 90° the sine of an angle loses its digits: at 89.9° the cosine that follows from a sine in double precision is
/// wrong by 2e-11. An angle given in degrees or by its cosine loses nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incidence<P> {
    s: P,
    c: P,
}

impl<P: Lanes> Incidence<P> {
    /// The angle of incidence from degrees in [0, 90].
    #[must_use]
    pub fn from_degrees(theta_deg: f64) -> Self {
        let sine = |degrees: f64| cis(P::splat(degrees) / P::splat(360.0)).im;
        // From 45 degrees on, 90 − θ is exact.
        if theta_deg <= 45.0 { Self::steep(sine(theta_deg)) } else { Self::grazing(sine(90.0 - theta_deg)) }
    }

    /// The angle of incidence from its cosine in [0, 1].
    #[must_use]
    pub fn from_cosine(cos_theta: f64) -> Self {
        let cosine = P::splat(cos_theta);
        if cos_theta * cos_theta <= 0.5 {
            Self::grazing(cosine)
        } else {
            Self::steep(((P::one() - cosine) * (P::one() + cosine)).sqrt())
        }
    }

    /// The angle of incidence from its sine in [0, 1].
    #[must_use]
    pub fn from_sine(sin_theta: f64) -> Self {
        let sine = P::splat(sin_theta);
        if sin_theta * sin_theta <= 0.5 {
            Self::steep(sine)
        } else {
            Self { s: P::one(), c: (P::one() - sine) * (P::one() + sine) }
        }
    }

    fn steep(sine: P) -> Self {
        Self { s: sine, c: P::zero() }
    }

    fn grazing(cosine: P) -> Self {
        Self { s: P::one(), c: cosine * cosine }
    }

    /// The tangential wavevector of light of this angle in a medium of real index n.
    #[inline]
    pub(crate) fn in_medium(self, n: P) -> TangentialWave<P> {
        TangentialWave { linear: n * self.s, rest: n * n * self.c }
    }
}

/// A number is taken as sin θ.
impl<P: Lanes> From<f64> for Incidence<P> {
    fn from(sin_theta: f64) -> Self {
        Self::from_sine(sin_theta)
    }
}

/// The tangential wavevector of light of an [`Incidence`] in a medium of index n: q_t² = (n s)² − n² c.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TangentialWave<P> {
    /// n s.
    linear: P,
    /// n² c.
    rest: P,
}

impl<P: Lanes> TangentialWave<P> {
    /// The square q_n² = (η − n s)(η + n s) + n² c of the normal wavevector in a medium of index η.
    #[inline]
    pub(crate) fn normal_squared(self, eta: ComplexLanes<P>) -> ComplexLanes<P> {
        let (below, above) = (eta.re - self.linear, eta.re + self.linear);
        let cross = eta.re * eta.im;
        ComplexLanes::new(eta.im.neg_mul_add(eta.im, below.mul_add(above, self.rest)), cross + cross)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::double_double::DoubleDouble;
    use crate::simd::lanes::F64;

    /// q_n² in a medium of index n for light from a medium of index 1.3.
    fn normal_squared<P: Lanes>(incidence: Incidence<P>, n: f64) -> f64 {
        incidence.in_medium(P::splat(1.3)).normal_squared(ComplexLanes::real(P::splat(n))).re.lane(0)
    }

    /// Error bound of q_n²: square, sum and product round three times each, the sine and its angle six times.
    const ROUNDINGS: f64 = 12.0 * F64::UNIT_ROUNDOFF;

    #[test]
    fn a_normal_wavevector_keeps_its_digits_at_any_angle() {
        for theta_deg in [0.0, 1e-9, 20.0, 45.0, 45.1, 89.9, 89.999_999_999, 90.0] {
            for n in [1.3, 1.0, 2.4] {
                let exact = normal_squared(Incidence::<DoubleDouble>::from_degrees(theta_deg), n);
                let got = normal_squared(Incidence::<F64>::from_degrees(theta_deg), n);
                // If the indices differ, their squares bound what cancellation loses.
                let scale = if n == 1.3 { exact } else { n * n + 1.69 };
                assert!((got - exact).abs() <= ROUNDINGS * scale, "{theta_deg} {n}: {got:e} {exact:e}");
            }
        }
    }

    #[test]
    fn degrees_sine_and_cosine_name_the_same_angle() {
        for theta_deg in [0.0f64, 30.0, 44.0, 60.0, 85.0] {
            let (sin, cos) = (libm::sin(theta_deg.to_radians()), libm::cos(theta_deg.to_radians()));
            let all =
                [Incidence::<F64>::from_degrees(theta_deg), Incidence::from_sine(sin), Incidence::from_cosine(cos)];
            let [degrees, sine, cosine] = all.map(|incidence| normal_squared(incidence, 1.5));
            assert!((degrees - sine).abs() < 1e-15 && (degrees - cosine).abs() < 1e-15, "{degrees} {sine} {cosine}");
        }
        assert_eq!(Incidence::<F64>::from_cosine(0.0), Incidence::from_degrees(90.0));
    }
}
