//! Lanes in which rays are traced through tilted facets.

use crate::simd::common::Common;
use crate::simd::lanes::{F32, F64, Lanes};
use crate::simd::registers::{Alike, Registers};

/// [`Lanes`] of rays, and those of what all their wavelengths may have in common.
///
/// [`F32`] and [`F64`] refract each wavelength by its own index. [`Registers`] hold many wavelengths in media that do
/// not disperse: one path serves all of them, and so does one Fresnel coefficient of a bare facet. If nothing absorbs
/// either and no facet is coated, one amplitude serves all of them too, and only phases differ: those are the lanes of
/// [`Alike`].
pub trait RayLanes: Lanes {
    /// Indices of media and wavevectors, in double precision or more.
    type Wavevector: Lanes<Precise = Self::Wavevector>;
    /// Directions, and what follows from them alone, in the precision of the lanes or more.
    type Direction: Lanes<Precise = Self::Wavevector>;
    /// Amplitudes and powers.
    type Light: Lanes;
    /// Whether all wavelengths have one amplitude, so that a ray carries its optical path in place of its phase.
    const IS_ALIKE: bool = false;

    /// The wavevector's lanes of an index. Where one lane stands for all, it is the middle one.
    fn wavevector(index: Self::Precise) -> Self::Wavevector;
    /// A wavevector's lanes for each wavelength.
    fn precise(wavevector: Self::Wavevector) -> Self::Precise;
    /// A direction's lanes for the light of each wavelength.
    fn spread(direction: Self::Direction) -> Self::Light;
    /// A part of [`RayLanes::spread`]: see [`Lanes::register`].
    fn spread_register(direction: Self::Direction, index: usize) -> <Self::Light as Lanes>::Register;
    /// Light's lanes of a number for each wavelength. Where one lane stands for all, it is the middle one.
    fn light(number: Self) -> Self::Light;
    /// Light's lanes for each wavelength.
    fn each(light: Self::Light) -> Self;

    /// A wavevector's lanes for the light of each wavelength, in its precision.
    #[inline]
    fn narrowed(wavevector: Self::Wavevector) -> Self::Light {
        Self::spread(Self::Direction::narrow(wavevector))
    }
}

/// Implements the light of [`RayLanes`] where each wavelength has its own.
macro_rules! own_light {
    () => {
        type Light = Self;

        #[inline]
        fn light(number: Self) -> Self {
            number
        }
        #[inline]
        fn each(light: Self) -> Self {
            light
        }
    };
}

/// Implements [`RayLanes`] of one register, in which each wavelength has a direction of its own.
macro_rules! own_directions {
    ($lanes:ty) => {
        impl RayLanes for $lanes {
            type Wavevector = Self::Precise;
            type Direction = Self;
            own_light!();

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
            #[inline]
            fn spread_register(direction: Self, _: usize) -> Self {
                direction
            }
        }
    };
}

own_directions!(F32);
own_directions!(F64);

/// Implements [`RayLanes`] of registers with one wavevector.
macro_rules! common_directions {
    () => {
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
    };
}

impl<V: Lanes, const N: usize> RayLanes for Registers<V, N> {
    own_light!();
    common_directions!();

    #[inline]
    fn spread(direction: Common) -> Self {
        Self::splat(direction.lane(0))
    }
    #[inline]
    fn spread_register(direction: Common, _: usize) -> V {
        V::splat(direction.lane(0))
    }
}

impl<V: Lanes, const N: usize> RayLanes for Alike<V, N> {
    type Light = Common;
    const IS_ALIKE: bool = true;
    common_directions!();

    #[inline]
    fn spread(direction: Common) -> Common {
        direction
    }
    #[inline]
    fn spread_register(direction: Common, _: usize) -> Common {
        direction
    }
    #[inline]
    fn light(number: Self) -> Common {
        Common::splat(number.lane(Self::WIDTH / 2))
    }
    #[inline]
    fn each(light: Common) -> Self {
        Self::splat(light.lane(0))
    }
}
