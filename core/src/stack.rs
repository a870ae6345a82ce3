//! A planar multilayer, and its reflection and transmission in closed form (the paper's section 4.5, "formula for
//! analysis").
//!
//! From the substrate upwards ρ_j = (r_j + ρ_{j+1} e²)/(1 + r_j ρ_{j+1} e²) with e = exp(i k₀ q_n d). |e| ≤ 1, so nothing
//! overflows for opaque layers. Numerator and denominator are carried apart and divided once at the end.
//!
//! What depends on a distinct film or a distinct pair of media is computed once per angle and group of wavelengths
//! ([`Optics`]), so a repeated layer costs a handful of multiply-adds per wavelength and polarisation.

use crate::complex::{ComplexLanes, Polarised};
use crate::interface::{Below, Interface, Model, Wave, reflection, transmission};
use crate::lanes::Lanes;
use crate::medium::{MediaLanes, MediumIndex};
use crate::turns::propagate;

/// A layer: its medium and its thickness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// The medium.
    pub medium: MediumIndex,
    /// Thickness in nanometres, ≥ 0.
    pub thickness_nm: f64,
}

/// One plane of a stack, by place in the lists of distinct interfaces and films.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boundary {
    pub(crate) interface: u32,
    /// The film below; of no meaning for the last boundary.
    pub(crate) film: u32,
}

/// Memory in which a stack of up to `boundaries.len() − 1` layers is laid out; all three of equal length suffice.
#[derive(Debug)]
pub struct StackMemory<'a> {
    /// Distinct pairs of media.
    pub interfaces: &'a mut [Interface],
    /// Distinct films.
    pub films: &'a mut [Film],
    /// One for each plane.
    pub boundaries: &'a mut [Boundary],
}

/// [`StackMemory`] for up to `N` planes, N − 1 layers.
#[derive(Clone, Copy, Debug)]
pub struct StackArrays<const N: usize> {
    interfaces: [Interface; N],
    films: [Film; N],
    boundaries: [Boundary; N],
}

impl<const N: usize> StackArrays<N> {
    /// Empty.
    #[must_use]
    pub fn new() -> Self {
        Self {
            interfaces: [Interface { above: 0, below: Below::Mirror }; N],
            films: [Film { medium: 0, thickness_nm: 0.0 }; N],
            boundaries: [Boundary { interface: 0, film: 0 }; N],
        }
    }

    /// Lends the arrays.
    pub fn memory(&mut self) -> StackMemory<'_> {
        StackMemory { interfaces: &mut self.interfaces, films: &mut self.films, boundaries: &mut self.boundaries }
    }
}

impl<const N: usize> Default for StackArrays<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Why a stack was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StackError {
    /// The memory holds `available` planes; more are needed.
    Memory {
        /// Planes for which there is room.
        available: usize,
    },
    /// A thickness that is negative, NaN or infinite.
    Thickness {
        /// Layer, from 0 at the top.
        layer: usize,
        /// The offending thickness.
        thickness_nm: f64,
    },
}

impl core::fmt::Display for StackError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Memory { available } => write!(f, "the stack has more than the {available} planes its memory holds"),
            Self::Thickness { layer, thickness_nm } => {
                write!(f, "layer {}: thickness {thickness_nm} nm must be finite and not negative", layer + 1)
            }
        }
    }
}

impl core::error::Error for StackError {}

/// A planar multilayer, checked: at least one plane, finite thicknesses.
#[derive(Clone, Copy, Debug)]
pub struct Stack<'a> {
    interfaces: &'a [Interface],
    films: &'a [Film],
    boundaries: &'a [Boundary],
    ambient: MediumIndex,
    substrate: Below,
}

/// Where `wanted` stands in `list`; appended if new.
fn intern<T: Copy + PartialEq>(list: &mut [T], len: &mut usize, wanted: T) -> Option<u32> {
    // Stacks repeat within a few layers; an unbounded search would make random stacks quadratic.
    const RECENT: usize = 64;
    let from = len.saturating_sub(RECENT);
    let found = list.iter().take(*len).enumerate().skip(from).find(|(_, x)| **x == wanted);
    let place = match found {
        Some((place, _)) => place,
        None => {
            *list.get_mut(*len)? = wanted;
            *len += 1;
            *len - 1
        }
    };
    u32::try_from(place).ok()
}

impl<'a> Stack<'a> {
    /// Lays out a stack in `memory`, from the ambient medium downwards.
    ///
    /// # Errors
    /// [`StackError`].
    pub fn new(
        ambient: MediumIndex,
        layers: impl IntoIterator<Item = Film>,
        substrate: Below,
        memory: StackMemory<'a>,
    ) -> Result<Self, StackError> {
        let StackMemory { interfaces, films, boundaries } = memory;
        let (mut interface_count, mut film_count, mut planes) = (0, 0, 0);
        let full = StackError::Memory { available: boundaries.len().min(interfaces.len()).min(films.len()) };
        let mut above = ambient;
        for (layer, film) in layers.into_iter().enumerate() {
            if !(film.thickness_nm >= 0.0 && film.thickness_nm.is_finite()) {
                return Err(StackError::Thickness { layer, thickness_nm: film.thickness_nm });
            }
            let below = Below::Medium(film.medium);
            let interface = intern(interfaces, &mut interface_count, Interface { above, below }).ok_or(full)?;
            let film_index = intern(films, &mut film_count, film).ok_or(full)?;
            *boundaries.get_mut(planes).ok_or(full)? = Boundary { interface, film: film_index };
            planes += 1;
            above = film.medium;
        }
        let last = Interface { above, below: substrate };
        let interface = intern(interfaces, &mut interface_count, last).ok_or(full)?;
        *boundaries.get_mut(planes).ok_or(full)? = Boundary { interface, film: 0 };
        let (interfaces, films, boundaries): (&'a [_], &'a [_], &'a [_]) = (interfaces, films, boundaries);
        Ok(Self {
            interfaces: interfaces.get(..interface_count).ok_or(full)?,
            films: films.get(..film_count).ok_or(full)?,
            boundaries: boundaries.get(..=planes).ok_or(full)?,
            ambient,
            substrate,
        })
    }

    /// Number of planes: layers + 1.
    #[must_use]
    pub fn planes(&self) -> usize {
        self.boundaries.len()
    }

    /// The media above and below plane `j`, 0 at the top; those of the whole stack for a plane that it does not have.
    #[must_use]
    pub fn interface(&self, j: usize) -> Interface {
        let known = self.boundaries.get(j).and_then(|boundary| self.interfaces.get(boundary.interface as usize));
        known.copied().unwrap_or(Interface { above: self.ambient, below: self.substrate })
    }

    /// The layer below plane `j`, which must not be the last; a layer of no thickness for a plane that the stack does not have.
    #[must_use]
    pub fn film(&self, j: usize) -> Film {
        let known = self.boundaries.get(j).and_then(|boundary| self.films.get(boundary.film as usize));
        known.copied().unwrap_or(Film { medium: self.ambient, thickness_nm: 0.0 })
    }

    /// The medium from which the light comes.
    #[must_use]
    pub fn ambient(&self) -> MediumIndex {
        self.ambient
    }

    /// What lies under the last plane.
    #[must_use]
    pub fn substrate(&self) -> Below {
        self.substrate
    }

    /// Media that a scene must have for this stack: one more than the largest index in use.
    #[must_use]
    pub fn media(&self) -> usize {
        let each = |i: &Interface| match i.below {
            Below::Medium(below) => below.max(i.above),
            Below::Mirror => i.above,
        };
        self.interfaces.iter().map(each).max().map_or(0, |largest| usize::from(largest) + 1)
    }
}

/// Memory for [`Optics`]: at least as many elements as the stack has media, distinct interfaces and distinct films; the
/// number of planes suffices for the last two.
#[derive(Debug)]
pub struct OpticsMemory<'m, V: Lanes> {
    /// One for each medium.
    pub waves: &'m mut [Wave<V>],
    /// One for each distinct interface.
    pub reflections: &'m mut [Polarised<ComplexLanes<V>>],
    /// One for each distinct film.
    pub propagators: &'m mut [ComplexLanes<V>],
}

/// [`OpticsMemory`] for up to `N` media, interfaces and films.
#[derive(Clone, Copy, Debug)]
pub struct OpticsArrays<V: Lanes, const N: usize> {
    waves: [Wave<V>; N],
    reflections: [Polarised<ComplexLanes<V>>; N],
    propagators: [ComplexLanes<V>; N],
}

impl<V: Lanes, const N: usize> OpticsArrays<V, N> {
    /// Empty.
    #[must_use]
    pub fn new() -> Self {
        Self {
            waves: [Wave::none(); N],
            reflections: [Polarised::both(ComplexLanes::zero()); N],
            propagators: [ComplexLanes::zero(); N],
        }
    }

    /// Lends the arrays.
    pub fn memory(&mut self) -> OpticsMemory<'_, V> {
        OpticsMemory { waves: &mut self.waves, reflections: &mut self.reflections, propagators: &mut self.propagators }
    }
}

impl<V: Lanes, const N: usize> Default for OpticsArrays<V, N> {
    fn default() -> Self {
        Self::new()
    }
}

/// A stack at one angle and one group of wavelengths: what its media, interfaces and films do to a wave.
#[derive(Clone, Copy, Debug)]
pub struct Optics<'m, V: Lanes> {
    stack: Stack<'m>,
    waves: &'m [Wave<V>],
    reflections: &'m [Polarised<ComplexLanes<V>>],
    propagators: &'m [ComplexLanes<V>],
    model: Model,
}

/// A stack's answer to a wave of unit amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<V> {
    /// Amplitude that returns, referred to the first plane.
    pub reflection: Polarised<ComplexLanes<V>>,
    /// Amplitude that arrives behind the last plane, referred to it; the magnetic field for p. Of no meaning for a mirror.
    pub transmission: Polarised<ComplexLanes<V>>,
}

/// Memory or media are fewer than a stack needs: see [`OpticsMemory`] and [`Stack::media`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooSmall;

impl core::fmt::Display for TooSmall {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the stack needs more media, or more memory for what they do")
    }
}

impl core::error::Error for TooSmall {}

impl<'m, V: Lanes> Optics<'m, V> {
    /// [`Optics::prepare`] with memory that is known to suffice.
    ///
    /// # Panics
    /// If `memory` or `media` is smaller than the stack needs ([`Stack::media`], [`Stack::planes`]).
    pub fn new(
        stack: Stack<'m>,
        media: &MediaLanes<'_, V>,
        sin_theta: f64,
        model: Model,
        memory: OpticsMemory<'m, V>,
    ) -> Self {
        Self::prepare(stack, media, sin_theta, model, memory)
            .expect("as many media and as much memory as the stack has")
    }

    /// Prepares `stack` for light that arrives at `sin_theta` = sin θ in the ambient medium, in [0, 1]; at 1, the limit of grazing
    /// incidence, all is reflected and nothing passes.
    ///
    /// # Errors
    /// [`TooSmall`].
    pub fn prepare(
        stack: Stack<'m>,
        media: &MediaLanes<'_, V>,
        sin_theta: f64,
        model: Model,
        memory: OpticsMemory<'m, V>,
    ) -> Result<Self, TooSmall> {
        let eta = |medium: MediumIndex| media.eta().get(usize::from(medium)).copied().ok_or(TooSmall);
        let tangential = eta(stack.ambient)?.re * V::Precise::splat(sin_theta);
        let tangential_squared = ComplexLanes::real(tangential * tangential);
        // Only the media of this stack; waves in others are never read.
        let waves = memory.waves.get_mut(..stack.media()).ok_or(TooSmall)?;
        let mut put =
            |medium: MediumIndex, wave| waves.get_mut(usize::from(medium)).map(|place| *place = wave).ok_or(TooSmall);
        put(stack.ambient, Wave::new(eta(stack.ambient)?, tangential_squared))?;
        if let Below::Medium(substrate) = stack.substrate {
            put(substrate, Wave::new(eta(substrate)?, tangential_squared))?;
        }
        for (place, film) in stack.films.iter().enumerate() {
            // Films of one medium that differ in thickness share its wave; a look at the last few finds most.
            let mut earlier = stack.films.iter().take(place).skip(place.saturating_sub(4));
            if !earlier.any(|earlier| earlier.medium == film.medium) {
                put(film.medium, Wave::in_film(eta(film.medium)?, tangential_squared))?;
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
        Ok(Self { stack, waves, reflections, propagators, model })
    }

    /// The stack this was made for.
    #[must_use]
    pub fn stack(&self) -> Stack<'m> {
        self.stack
    }

    // `Stack::new` and `Optics::prepare` leave no boundary without its interface, film and media. That look-ups give 0 where
    // there are none keeps panics out of programs that must not have any.

    /// r of boundary `j` for a wave from above.
    #[inline]
    pub(crate) fn reflection_at(&self, j: usize) -> Polarised<ComplexLanes<V>> {
        let interface = self.stack.boundaries.get(j).map_or(0, |boundary| boundary.interface as usize);
        self.reflections.get(interface).copied().unwrap_or_else(|| Polarised::both(ComplexLanes::zero()))
    }

    /// exp(i k₀ q_n d) of the film below boundary `j`.
    #[inline]
    pub(crate) fn propagator_below(&self, j: usize) -> ComplexLanes<V> {
        let film = self.stack.boundaries.get(j).map_or(0, |boundary| boundary.film as usize);
        self.propagators.get(film).copied().unwrap_or_else(ComplexLanes::zero)
    }

    /// κ of a medium.
    #[inline]
    pub(crate) fn admittance(&self, medium: MediumIndex) -> Polarised<ComplexLanes<V>> {
        self.waves
            .get(usize::from(medium))
            .map_or_else(|| Polarised::both(ComplexLanes::zero()), |wave| wave.admittance)
    }

    /// σ of [`Model::reversal`] in every lane.
    #[inline]
    pub(crate) fn reversal(&self) -> V {
        V::splat(self.model.reversal())
    }

    /// Which model this was prepared for.
    #[must_use]
    pub fn model(&self) -> Model {
        self.model
    }

    /// Reflection alone, in closed form.
    #[must_use]
    pub fn reflection(&self) -> Polarised<ComplexLanes<V>> {
        self.recursion::<false>().reflection
    }

    /// Reflection and transmission in closed form.
    #[must_use]
    pub fn response(&self) -> Response<V> {
        self.recursion::<true>()
    }

    /// ρ_j = [r + ρ e² (1 − (1 + σ) r)] / (1 − σ r ρ e²), which for σ = −1 is the formula at the head of this module.
    #[inline]
    fn recursion<const TRANSMISSION: bool>(&self) -> Response<V> {
        // Every factor of the denominator lies between 1 − |r| and 2: this many keep far from single precision's limits.
        const RESCALE_EVERY: usize = 8;
        let sigma = self.reversal();
        let through = V::one() + sigma;
        let boundaries = self.stack.boundaries;
        let last = boundaries.len().saturating_sub(1);

        let mut numerator = self.reflection_at(last);
        let mut denominator = Polarised::both(ComplexLanes::one());
        let mut passed = numerator.map(|r| transmission(r, sigma));
        for j in (0..last).rev() {
            let r = self.reflection_at(j);
            let e = self.propagator_below(j);
            let round_trip = e.square();
            let step = |r: ComplexLanes<V>, n: &mut ComplexLanes<V>, d: &mut ComplexLanes<V>| {
                let back = *n * round_trip;
                *n = r.mul_add(*d, back);
                *d = r.scale(-sigma).mul_add(back, *d);
                if self.model == Model::Paper {
                    *n = r.scale(through).neg_mul_add(back, *n);
                }
            };
            step(r.s, &mut numerator.s, &mut denominator.s);
            step(r.p, &mut numerator.p, &mut denominator.p);
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
            }
        }
        Response {
            reflection: numerator.zip(denominator, ComplexLanes::div_or_zero),
            transmission: passed.zip(denominator, ComplexLanes::div_or_zero),
        }
    }

    /// Power that returns for amplitude `a`: |a|², in the paper's model |a|.
    #[must_use]
    #[inline]
    pub fn reflectance(&self, a: Polarised<ComplexLanes<V>>) -> Polarised<V> {
        match self.model {
            Model::Physical => a.map(ComplexLanes::norm_sqr),
            Model::Paper => a.map(ComplexLanes::norm),
        }
    }

    /// Power that enters the substrate for amplitude `a` behind the last plane; 0 for a mirror.
    #[must_use]
    pub fn transmittance(&self, a: Polarised<ComplexLanes<V>>) -> Polarised<V> {
        match (self.stack.substrate(), self.model) {
            (Below::Mirror, _) => Polarised::both(V::zero()),
            (_, Model::Paper) => a.map(ComplexLanes::norm),
            (Below::Medium(substrate), Model::Physical) => {
                let ratio = self.admittance(substrate).zip(self.admittance(self.stack.ambient()), |below, above| {
                    // Grazing light brings no power that could pass.
                    V::zero().select_lt(above.re, below.re / above.re, V::zero())
                });
                a.zip(ratio, |a, ratio| a.norm_sqr() * ratio)
            }
        }
    }
}
