//! Lanes in which rays are traced through tilted facets.

use crate::simd::common::Common;
use crate::simd::lanes::{F32, F64, Lanes};
use crate::simd::registers::Registers;

/// [`Lanes`] of rays, and those of what all their wavelengths may have in common.
///
/// [`F32`] and [`F64`] refract each wavelength by its own index. [`Registers`] hold many wavelengths in media that do
/// not disperse: one path serves all of them, and so does one Fresnel coefficient of a bare facet.
pub trait RayLanes: Lanes {
    /// Indices of media and wavevectors, in double precision or more.
    type Wavevector: Lanes<Precise = Self::Wavevector>;
    /// Directions, and what follows from them alone, in the precision of the lanes or more.
    type Direction: Lanes<Precise = Self::Wavevector>;

    /// The wavevector's lanes of an index. Where one lane stands for all, it is the middle one.
    fn wavevector(index: Self::Precise) -> Self::Wavevector;
    /// A wavevector's lanes for each wavelength.
    fn precise(wavevector: Self::Wavevector) -> Self::Precise;
    /// A direction's lanes for each wavelength.
    fn spread(direction: Self::Direction) -> Self;

    /// A wavevector's lanes for each wavelength, in the precision of the lanes.
    #[inline]
    fn narrowed(wavevector: Self::Wavevector) -> Self {
        Self::spread(Self::Direction::narrow(wavevector))
    }
}

impl RayLanes for F32 {
    type Wavevector = Self::Precise;
    type Direction = Self;

    #[inline]
    fn wavevector(index: Self::Precise) -> Self::Wavevector {
        index
    }
    #[inline]
    fn precise(wavevector: Self::Wavevector) -> Self::Precise {
        wavevector
    }
    #[inline]
    fn spread(direction: Self) -> Self {
        direction
    }
}

impl RayLanes for F64 {
    type Wavevector = Self;
    type Direction = Self;

    #[inline]
    fn wavevector(index: Self) -> Self {
        index
    }
    #[inline]
    fn precise(wavevector: Self) -> Self {
        wavevector
    }
    #[inline]
    fn spread(direction: Self) -> Self {
        direction
    }
}

impl<V: Lanes, const N: usize> RayLanes for Registers<V, N> {
    type Wavevector = Common;
    type Direction = Common;

    #[inline]
    fn wavevector(index: Self::Precise) -> Common {
        Common::splat(index.lane(Self::WIDTH / 2))
    }
    #[inline]
    fn precise(wavevector: Common) -> Self::Precise {
        Self::Precise::splat(wavevector.lane(0))
    }
    #[inline]
    fn spread(direction: Common) -> Self {
        Self::splat(direction.lane(0))
    }
}
