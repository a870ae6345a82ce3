//! An interface between two media, and Fresnel's reflection and transmission of a plane wave there.
//!
//! The amplitude of an s wave is that of its electric field, the amplitude of a p wave that of its magnetic field; both
//! fields are perpendicular to the plane of incidence. The admittance is κ = q_n for s and κ = q_n/η² for p. Then both
//! polarisations obey r = (κ₁ − κ₂)/(κ₁ + κ₂) and t = 1 + r, and a wave of amplitude a carries the power |a|² Re κ
//! through the plane. Total internal reflection, absorbing media and metals need no special case.

use crate::optics::medium::MediumIndex;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;

/// A medium or a mirror below an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Below {
    /// A medium of the scene.
    Medium(MediumIndex),
    /// A perfect mirror: the limit of infinite conductivity, r_s = −1 and r_p = +1 at every angle and wavelength.
    Mirror,
}

/// The pair of media that a plane divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The medium on the side to which the normal points.
    pub above: MediumIndex,
    /// The medium or mirror on the other side.
    pub below: Below,
}

/// The model of light: a ray carries fields, or the paper's weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Model {
    /// Signed complex amplitudes of s and p; power is |Σ|².
    #[default]
    Physical,
    /// Shimada & Kawaguchi taken literally (sections 3.1, 3.2): a ray's weight is multiplied by the unpolarised Fresnel
    /// ratios R and 1 − R, its phase comes from the optical path alone, and the flux is |Σ|.
    Paper,
}

impl Model {
    /// The factor σ between reflection from below and reflection from above, r' = σr. Transmission is t = 1 − σr
    /// downwards and t' = 1 − r upwards in both models.
    #[must_use]
    pub fn reversal(self) -> f64 {
        match self {
            Self::Physical => -1.0,
            Self::Paper => 1.0,
        }
    }
}

/// A plane wave of given tangential wavevector in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave<V: Lanes> {
    /// The component q_n of the wavevector along the normal, in units of k₀. Where the wave travels, Re q_n ≥ 0; where
    /// it decays, Im q_n ≥ 0; where q_t is real, both ([`ComplexLanes::sqrt_outgoing`]).
    pub normal: ComplexLanes<V::Precise>,
    /// The admittance κ of each polarisation.
    pub admittance: Polarised<ComplexLanes<V>>,
}

impl<V: Lanes> Wave<V> {
    /// The wave in a medium of index η whose tangential wavevector q_t has the square q_t·q_t.
    #[inline]
    pub fn new(eta: ComplexLanes<V::Precise>, tangential_squared: ComplexLanes<V::Precise>) -> Self {
        Self::of_square(eta, eta.square() - tangential_squared)
    }

    /// The wave in a medium of index η whose normal wavevector has the square q_n².
    #[inline]
    pub(crate) fn of_square(eta: ComplexLanes<V::Precise>, normal_squared: ComplexLanes<V::Precise>) -> Self {
        Self::with_normal(eta, normal_squared.sqrt_outgoing())
    }

    /// The wave in a film of index η whose tangential wavevector q_t has the square q_t·q_t.
    ///
    /// At a film's critical angle, q_n → 0, its two waves grow like 1/q_n and cancel: amplitudes lose u/q_n for a unit
    /// roundoff u, until 0/0 is left. So q_n² is kept at 2u|η|² or more away from 0, which acts like a rounding of η. A
    /// substrate needs no such care, and it would show there: R of a substrate has the slope of √ at its critical
    /// angle.
    #[inline]
    pub fn in_film(eta: ComplexLanes<V::Precise>, tangential_squared: ComplexLanes<V::Precise>) -> Self {
        Self::film_of_square(eta, eta.square() - tangential_squared)
    }

    /// The wave in a film of index η whose normal wavevector has the square q_n².
    #[inline(always)] // As a call it would pass eight vectors through memory.
    pub(crate) fn film_of_square(eta: ComplexLanes<V::Precise>, mut normal_squared: ComplexLanes<V::Precise>) -> Self {
        let min = Self::min_in_film(eta);
        let size = normal_squared.norm();
        normal_squared.re = size.select_lt(min, min, normal_squared.re);
        normal_squared.im = size.select_lt(min, V::Precise::zero(), normal_squared.im);
        Self::with_normal(eta, normal_squared.sqrt_upper())
    }

    /// The smallest |q_n²| of [`Wave::in_film`].
    #[inline]
    pub(crate) fn min_in_film(eta: ComplexLanes<V::Precise>) -> V::Precise {
        eta.norm_sqr() * V::Precise::splat(2.0 * V::UNIT_ROUNDOFF)
    }

    /// The wave of normal wavevector q_n in a medium of index η.
    #[inline]
    pub fn with_normal(eta: ComplexLanes<V::Precise>, normal: ComplexLanes<V::Precise>) -> Self {
        let p = normal.div_or_zero(eta.square());
        Self { normal, admittance: Polarised { s: ComplexLanes::narrow(normal), p: ComplexLanes::narrow(p) } }
    }

    /// A placeholder for memory that is written before it is read.
    pub fn none() -> Self {
        Self { normal: ComplexLanes::zero(), admittance: Polarised::both(ComplexLanes::zero()) }
    }
}

/// Fresnel's reflection coefficient r = (κ₁ − κ₂)/(κ₁ + κ₂) of each polarisation; `far` is `None` for a mirror.
#[inline]
pub fn fresnel<V: Lanes>(
    near: Polarised<ComplexLanes<V>>,
    far: Option<Polarised<ComplexLanes<V>>>,
) -> Polarised<ComplexLanes<V>> {
    let one = ComplexLanes::one();
    match far {
        Some(far) => near.zip(far, |k1, k2| (k1 - k2).div_or_zero(k1 + k2)),
        None => Polarised { s: -one, p: one },
    }
}

/// Reflection coefficient r of a wave that comes from `above`; in the paper's model the unpolarised ratio R, the same
/// for s and p. `below` is `None` for a mirror.
#[inline]
pub fn reflection<V: Lanes>(model: Model, above: &Wave<V>, below: Option<&Wave<V>>) -> Polarised<ComplexLanes<V>> {
    let r = fresnel(above.admittance, below.map(|below| below.admittance));
    match model {
        Model::Physical => r,
        Model::Paper => {
            let power = r.map(ComplexLanes::norm_sqr);
            Polarised::both(ComplexLanes::real((power.s + power.p) * V::splat(0.5)))
        }
    }
}

/// Transmission coefficient 1 − σr of an interface of reflection r, with the factor σ of [`Model::reversal`].
#[inline]
pub fn transmission<V: Lanes>(r: ComplexLanes<V>, reversal: V) -> ComplexLanes<V> {
    ComplexLanes::new(reversal.neg_mul_add(r.re, V::one()), -(reversal * r.im))
}

/// Net power that flows down through a plane in a medium of admittance κ, where waves of amplitude `down` and `up`
/// overlap. The second term is the power that the two waves exchange in an absorbing medium.
#[inline]
pub fn flux<V: Lanes>(admittance: ComplexLanes<V>, down: ComplexLanes<V>, up: ComplexLanes<V>) -> V {
    let exchange = (up * down.conj()).im;
    admittance.re * (down.norm_sqr() - up.norm_sqr()) + admittance.im * (exchange + exchange)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::lanes::F64;
    use libm::{asin, atan, cos, sin};
    use num_complex::Complex64;

    fn wave(eta: Complex64, sin_theta: f64) -> Wave<F64> {
        Wave::new(ComplexLanes::from_fn(|_| eta), ComplexLanes::real(<F64 as Lanes>::splat(sin_theta * sin_theta)))
    }

    /// Error bound of a few roundings of numbers near 1.
    const ROUNDINGS: f64 = 1e-15;

    #[test]
    fn reflection_matches_fresnel_in_angles() {
        let (n, theta) = (1.5, 0.7);
        let refracted = asin(sin(theta) / n);
        let r = reflection(Model::Physical, &wave(1.0.into(), sin(theta)), Some(&wave(n.into(), sin(theta))));
        let (ci, ct) = (cos(theta), cos(refracted));
        assert!((r.s.lane(0).re - (ci - n * ct) / (ci + n * ct)).abs() < ROUNDINGS);
        assert!((r.p.lane(0).re - (n * ci - ct) / (n * ci + ct)).abs() < ROUNDINGS);
    }

    #[test]
    fn brewsters_angle_does_not_reflect_p() {
        let sin_theta = sin(atan(1.5));
        let r = reflection(Model::Physical, &wave(1.0.into(), sin_theta), Some(&wave(1.5.into(), sin_theta)));
        assert!(r.p.lane(0).norm() < ROUNDINGS);
    }

    #[test]
    fn total_internal_reflection_keeps_all_power() {
        let q_t = 1.5 * sin(1.0);
        let r = reflection(Model::Physical, &wave(1.5.into(), q_t), Some(&wave(1.0.into(), q_t)));
        for r in [r.s, r.p] {
            assert!((r.lane(0).norm_sqr() - 1.0).abs() < ROUNDINGS);
        }
    }

    #[test]
    fn flux_is_continuous_across_an_interface() {
        let (above, below) = (wave(Complex64::new(1.3, 0.4), 0.5), wave(Complex64::new(0.2, 3.0), 0.5));
        let r = reflection(Model::Physical, &above, Some(&below));
        for (r, k1, k2) in
            [(r.s, above.admittance.s, below.admittance.s), (r.p, above.admittance.p, below.admittance.p)]
        {
            let (one, t) = (ComplexLanes::one(), transmission(r, -F64::one()));
            let into = Lanes::lane(flux(k1, one, r), 0);
            let out = Lanes::lane(flux(k2, t, ComplexLanes::zero()), 0);
            assert!((into - out).abs() < 4.0 * ROUNDINGS, "{into} {out}");
        }
    }

    #[test]
    fn a_very_good_conductor_tends_to_the_mirror() {
        let (theta, k) = (0.6, 1e9);
        let above = wave(1.0.into(), sin(theta));
        let mirror = reflection(Model::Physical, &above, None);
        let metal = reflection(Model::Physical, &above, Some(&wave(Complex64::new(0.0, k), sin(theta))));
        assert!((mirror.s.lane(0) - metal.s.lane(0)).norm() < 4.0 / k);
        assert!((mirror.p.lane(0) - metal.p.lane(0)).norm() < 4.0 / k);
    }
}
