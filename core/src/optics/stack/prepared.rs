//! A stack prepared for one angle and one group of wavelengths, and its response in closed form.

use super::{Film, Stack};
use crate::optics::incidence::Incidence;
use crate::optics::interface::{Below, Model, Wave, reflection, transmission};
use crate::optics::medium::{MediaLanes, MediumIndex};
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::propagate;

/// Memory for a [`PreparedStack`]: at least as many elements as the stack has media, distinct interfaces and distinct
/// films. The number of planes suffices for the last two.
#[derive(Debug)]
pub struct PreparedStackMemory<'m, V: Lanes> {
    /// One wave for each medium.
    pub waves: &'m mut [Wave<V>],
    /// One reflection coefficient for each distinct interface.
    pub reflections: &'m mut [Polarised<ComplexLanes<V>>],
    /// One propagator for each distinct film.
    pub propagators: &'m mut [ComplexLanes<V>],
}

/// Arrays for the [`PreparedStackMemory`] of up to `N` media, interfaces and films.
#[derive(Clone, Copy, Debug)]
pub struct PreparedStackArrays<V: Lanes, const N: usize> {
    waves: [Wave<V>; N],
    reflections: [Polarised<ComplexLanes<V>>; N],
    propagators: [ComplexLanes<V>; N],
}

impl<V: Lanes, const N: usize> PreparedStackArrays<V, N> {
    /// Empty arrays.
    #[must_use]
    pub fn new() -> Self {
        Self {
            waves: [Wave::none(); N],
            reflections: [Polarised::both(ComplexLanes::zero()); N],
            propagators: [ComplexLanes::zero(); N],
        }
    }

    /// Lends the arrays as memory.
    pub fn memory(&mut self) -> PreparedStackMemory<'_, V> {
        PreparedStackMemory {
            waves: &mut self.waves,
            reflections: &mut self.reflections,
            propagators: &mut self.propagators,
        }
    }
}

impl<V: Lanes, const N: usize> Default for PreparedStackArrays<V, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A stack at one angle and one group of wavelengths: the waves in its media, the reflection coefficients of its
/// interfaces and the propagators of its films.
#[derive(Clone, Copy, Debug)]
pub struct PreparedStack<'m, V: Lanes> {
    stack: Stack<'m>,
    waves: &'m [Wave<V>],
    reflections: &'m [Polarised<ComplexLanes<V>>],
    propagators: &'m [ComplexLanes<V>],
    media: MediaLanes<'m, V>,
    model: Model,
}

/// Reflection and transmission of a wave of unit amplitude by a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<V> {
    /// Reflected amplitude, referred to the first plane.
    pub reflection: Polarised<ComplexLanes<V>>,
    /// Transmitted amplitude behind the last plane, referred to this plane; for p, of the magnetic field. Meaningless
    /// for a mirror.
    pub transmission: Polarised<ComplexLanes<V>>,
}

/// A complex amplitude for each polarisation.
pub(crate) type Amplitudes<V> = Polarised<ComplexLanes<V>>;

/// An observer of the recursion, which runs upwards; `()` observes nothing.
pub(crate) trait Observer<V: Lanes> {
    /// Receives r of the last plane, with which the recursion begins.
    fn last_plane(&mut self, r: Amplitudes<V>);
    /// Receives r of the next plane above, e of the film below it, and ρ = n/d including that plane.
    fn plane(&mut self, r: Amplitudes<V>, e: ComplexLanes<V>, n: Amplitudes<V>, d: Amplitudes<V>);
    /// Receives the factor by which n and d were multiplied.
    fn rescale(&mut self, scale: Polarised<V>);
}

impl<V: Lanes> Observer<V> for () {
    #[inline]
    fn last_plane(&mut self, _: Amplitudes<V>) {}
    #[inline]
    fn plane(&mut self, _: Amplitudes<V>, _: ComplexLanes<V>, _: Amplitudes<V>, _: Amplitudes<V>) {}
    #[inline]
    fn rescale(&mut self, _: Polarised<V>) {}
}

/// An error: there is less memory, or there are fewer media, than a stack needs; see [`PreparedStackMemory`] and
/// [`Stack::media`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooSmall;

impl core::fmt::Display for TooSmall {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the stack needs more media, or more memory, than there is")
    }
}

impl core::error::Error for TooSmall {}

impl<'m, V: Lanes> PreparedStack<'m, V> {
    /// Prepares `stack` as [`PreparedStack::prepare`] does, with media and memory that are known to suffice.
    ///
    /// # Panics
    /// If `memory` or `media` is smaller than the stack needs ([`Stack::media`], [`Stack::planes`]).
    pub fn new(
        stack: Stack<'m>,
        media: &MediaLanes<'m, V>,
        incidence: impl Into<Incidence<V::Precise>>,
        model: Model,
        memory: PreparedStackMemory<'m, V>,
    ) -> Self {
        Self::prepare(stack, media, incidence, model, memory)
            .expect("as many media and as much memory as the stack has")
    }

    /// Prepares `stack` for light that arrives in the ambient medium at an angle θ in [0°, 90°]. A number as
    /// `incidence` is sin θ. At 90°, the limit of grazing incidence, all light is reflected.
    ///
    /// # Errors
    /// [`TooSmall`] if there are fewer media or less memory than the stack needs.
    pub fn prepare(
        stack: Stack<'m>,
        media: &MediaLanes<'m, V>,
        incidence: impl Into<Incidence<V::Precise>>,
        model: Model,
        memory: PreparedStackMemory<'m, V>,
    ) -> Result<Self, TooSmall> {
        let eta = |medium: MediumIndex| media.eta().get(usize::from(medium)).copied().ok_or(TooSmall);
        let incident = incidence.into().in_medium(eta(stack.ambient)?.re);
        // Only the media of this stack: waves in other media are never read.
        let waves = memory.waves.get_mut(..stack.media()).ok_or(TooSmall)?;
        let mut set =
            |medium: MediumIndex, wave| waves.get_mut(usize::from(medium)).map(|slot| *slot = wave).ok_or(TooSmall);
        let substrate = match stack.substrate {
            Below::Medium(substrate) => substrate,
            Below::Mirror => stack.ambient,
        };
        for medium in [stack.ambient, substrate] {
            let eta = eta(medium)?;
            set(medium, Wave::of_square(eta, incident.normal_squared(eta)))?;
        }
        for (place, film) in stack.films.iter().enumerate() {
            // Films of one medium share its wave; a search of the last four finds most repetitions.
            let mut earlier = stack.films.iter().take(place).skip(place.saturating_sub(4));
            if !earlier.any(|earlier| earlier.medium == film.medium) {
                let eta = eta(film.medium)?;
                set(film.medium, Wave::film_of_square(eta, incident.normal_squared(eta)))?;
            }
        }
        let waves = &*waves;
        let wave = |medium: MediumIndex| waves.get(usize::from(medium)).ok_or(TooSmall);
        let reflections = memory.reflections.get_mut(..stack.interfaces.len()).ok_or(TooSmall)?;
        for (r, interface) in reflections.iter_mut().zip(stack.interfaces) {
            let below = match interface.below {
                Below::Medium(below) => Some(wave(below)?),
                Below::Mirror => None,
            };
            *r = reflection(model, wave(interface.above)?, below);
        }
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let propagators = memory.propagators.get_mut(..stack.films.len()).ok_or(TooSmall)?;
        for (e, film) in propagators.iter_mut().zip(stack.films) {
            let path = V::Precise::splat(film.thickness_nm) * per_wavelength;
            let mut turns = wave(film.medium)?.normal.scale(path);
            if model == Model::Paper {
                // The paper adds fluxes, which absorption weakens twice as fast as amplitudes.
                turns.im = turns.im + turns.im;
            }
            *e = propagate(turns);
        }
        Ok(Self { stack, waves, reflections, propagators, media: *media, model })
    }

    /// The stack that was prepared.
    #[must_use]
    pub fn stack(&self) -> Stack<'m> {
        self.stack
    }

    // `Stack::new` and `PreparedStack::prepare` make sure that each boundary has its interface, film and media.
    // Look-ups still return 0 beyond the end instead of panicking, which keeps panic code out of programs that must
    // have none.

    /// The reflection coefficient r of boundary `j` for a wave from above.
    #[inline]
    pub(crate) fn reflection_at(&self, j: usize) -> Amplitudes<V> {
        let interface = self.stack.boundaries.get(j).map_or(0, |boundary| boundary.interface as usize);
        self.reflections.get(interface).copied().unwrap_or_else(|| Polarised::both(ComplexLanes::zero()))
    }

    /// The propagator exp(i k₀ q_n d) of the film below boundary `j`.
    #[inline]
    pub(crate) fn propagator_below(&self, j: usize) -> ComplexLanes<V> {
        let film = self.stack.boundaries.get(j).map_or(0, |boundary| boundary.film as usize);
        self.propagators.get(film).copied().unwrap_or_else(ComplexLanes::zero)
    }

    /// The admittance κ of a medium.
    #[inline]
    pub(crate) fn admittance(&self, medium: MediumIndex) -> Polarised<ComplexLanes<V>> {
        self.waves
            .get(usize::from(medium))
            .map_or_else(|| Polarised::both(ComplexLanes::zero()), |wave| wave.admittance)
    }

    /// The factor σ of [`Model::reversal`] in every lane.
    #[inline]
    pub(crate) fn reversal(&self) -> V {
        V::splat(self.model.reversal())
    }

    /// The admittance κ below each plane, from the top; 0 for a mirror.
    pub(crate) fn admittances_below(&self) -> impl Iterator<Item = Polarised<ComplexLanes<V>>> {
        self.stack.boundaries.iter().map(|boundary| {
            match self.stack.interfaces.get(boundary.interface as usize).map(|interface| interface.below) {
                Some(Below::Medium(below)) => self.admittance(below),
                _ => Polarised::both(ComplexLanes::zero()),
            }
        })
    }

    /// The largest |r|² of the planes.
    pub(crate) fn max_reflectance(&self) -> Polarised<V> {
        self.reflections
            .iter()
            .fold(Polarised::both(V::zero()), |max, r| max.zip(r.map(ComplexLanes::norm_sqr), Lanes::max))
    }

    /// The distinct films, each with η of its medium and its wave.
    pub(crate) fn films(&self) -> impl Iterator<Item = (Film, ComplexLanes<V::Precise>, Wave<V>)> {
        let with_wave = |&film: &Film| {
            let wave = self.waves.get(usize::from(film.medium)).copied().unwrap_or_else(Wave::none);
            (film, self.media.eta_of(film.medium), wave)
        };
        self.stack.films.iter().map(with_wave)
    }

    /// The vacuum wavelengths.
    pub(crate) fn wavelength_nm(&self) -> V::Precise {
        self.media.wavelength_nm()
    }

    /// The model for which the stack was prepared.
    #[must_use]
    pub fn model(&self) -> Model {
        self.model
    }

    /// The reflected amplitude alone, in closed form.
    #[must_use]
    pub fn reflection(&self) -> Polarised<ComplexLanes<V>> {
        self.recursion::<false, _>(&mut ()).reflection
    }

    /// The reflected and the transmitted amplitude, in closed form.
    #[must_use]
    pub fn response(&self) -> Response<V> {
        self.recursion::<true, _>(&mut ())
    }

    /// The recursion ρ_j = [r + ρ e² (1 − (1 + σ) r)] / (1 − σ r ρ e²). For σ = −1 it is the formula at the head of
    /// [`crate::optics::stack`].
    #[inline]
    pub(crate) fn recursion<const TRANSMISSION: bool, O: Observer<V>>(&self, observer: &mut O) -> Response<V> {
        // Each factor of the denominator lies between 1 − |r| and 2: eight of them stay within single precision's
        // range.
        const RESCALE_EVERY: usize = 8;
        let sigma = self.reversal();
        let through = V::one() + sigma;
        let boundaries = self.stack.boundaries;
        let last = boundaries.len().saturating_sub(1);

        let mut numerator = self.reflection_at(last);
        let mut denominator = Polarised::both(ComplexLanes::one());
        let mut passed = numerator.map(|r| transmission(r, sigma));
        observer.last_plane(numerator);
        for j in (0..last).rev() {
            let r = self.reflection_at(j);
            let e = self.propagator_below(j);
            let round_trip = e.square();
            let step = |r: ComplexLanes<V>, n: &mut ComplexLanes<V>, d: &mut ComplexLanes<V>| {
                let returned = *n * round_trip;
                *n = r.mul_add(*d, returned);
                *d = r.scale(-sigma).mul_add(returned, *d);
                if self.model == Model::Paper {
                    *n = r.scale(through).neg_mul_add(returned, *n);
                }
            };
            step(r.s, &mut numerator.s, &mut denominator.s);
            step(r.p, &mut numerator.p, &mut denominator.p);
            observer.plane(r, e, numerator, denominator);
            if TRANSMISSION {
                passed = passed.zip(r, |passed, r| passed * e * transmission(r, sigma));
            }
            if j % RESCALE_EVERY == 0 {
                let scale = denominator.zip(numerator, |d, n| {
                    let size = d.re.abs() + d.im.abs() + n.norm();
                    V::one() / V::zero().select_lt(size, size, V::one())
                });
                numerator = numerator.zip(scale, ComplexLanes::scale);
                denominator = denominator.zip(scale, ComplexLanes::scale);
                passed = passed.zip(scale, ComplexLanes::scale);
                observer.rescale(scale);
            }
        }
        Response {
            reflection: numerator.zip(denominator, ComplexLanes::div_or_zero),
            transmission: passed.zip(denominator, ComplexLanes::div_or_zero),
        }
    }

    /// Reflected power for the reflected amplitude `a`: |a|², and |a| in the paper's model.
    #[must_use]
    #[inline]
    pub fn reflectance(&self, a: Polarised<ComplexLanes<V>>) -> Polarised<V> {
        match self.model {
            Model::Physical => a.map(ComplexLanes::norm_sqr),
            Model::Paper => a.map(ComplexLanes::norm),
        }
    }

    /// Power that enters the substrate for the amplitude `a` behind the last plane; 0 for a mirror.
    #[must_use]
    pub fn transmittance(&self, a: Polarised<ComplexLanes<V>>) -> Polarised<V> {
        match (self.stack.substrate(), self.model) {
            (Below::Mirror, _) => Polarised::both(V::zero()),
            (_, Model::Paper) => a.map(ComplexLanes::norm),
            (Below::Medium(substrate), Model::Physical) => {
                let ratio = self.admittance(substrate).zip(self.admittance(self.stack.ambient()), |below, above| {
                    // At grazing incidence no power arrives that could pass.
                    V::zero().select_lt(above.re, below.re / above.re, V::zero())
                });
                a.zip(ratio, |a, ratio| a.norm_sqr() * ratio)
            }
        }
    }
}
