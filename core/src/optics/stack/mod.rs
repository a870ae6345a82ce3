//! A planar multilayer, and its reflection and transmission in closed form (the paper's section 4.5, "formula for
//! analysis").
//!
//! A [`Stack`] is the checked list of layers. A [`PreparedStack`] is a stack at one angle and one group of wavelengths.
//! It holds what depends on each distinct film and each distinct pair of media, computed once, so that a repeated layer
//! costs a few multiply-adds per wavelength and polarisation.
//!
//! The recursion runs from the substrate upwards: ρ_j = (r_j + ρ_{j+1} e²)/(1 + r_j ρ_{j+1} e²) with e = exp(i k₀ q_n
//! d).
//! |e| ≤ 1, so nothing overflows for opaque layers. Numerator and denominator are kept apart and divided once at the end.

mod prepared;

use crate::optics::interface::{Below, Interface};
use crate::optics::medium::MediumIndex;
pub(crate) use prepared::{Amplitudes, Observer};
pub use prepared::{PreparedStack, PreparedStackArrays, PreparedStackMemory, Response, TooSmall};

/// A layer of one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// Index of the medium.
    pub medium: MediumIndex,
    /// Thickness in nanometres, ≥ 0.
    pub thickness_nm: f64,
}

/// One plane of a stack, by indices in the lists of distinct interfaces and films.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boundary {
    pub(crate) interface: u32,
    /// The film below; meaningless for the last boundary.
    pub(crate) film: u32,
}

/// Memory for a stack of up to `boundaries.len() − 1` layers; three lists of equal length always suffice.
#[derive(Debug)]
pub struct StackMemory<'a> {
    /// Distinct pairs of media.
    pub interfaces: &'a mut [Interface],
    /// Distinct films.
    pub films: &'a mut [Film],
    /// Boundaries, one for each plane.
    pub boundaries: &'a mut [Boundary],
}

/// Arrays for the [`StackMemory`] of up to `N` planes, that is, N − 1 layers.
#[derive(Clone, Copy, Debug)]
pub struct StackArrays<const N: usize> {
    interfaces: [Interface; N],
    films: [Film; N],
    boundaries: [Boundary; N],
}

impl<const N: usize> StackArrays<N> {
    /// Empty arrays.
    #[must_use]
    pub fn new() -> Self {
        Self {
            interfaces: [Interface { above: 0, below: Below::Mirror }; N],
            films: [Film { medium: 0, thickness_nm: 0.0 }; N],
            boundaries: [Boundary { interface: 0, film: 0 }; N],
        }
    }

    /// Lends the arrays as memory.
    pub fn memory(&mut self) -> StackMemory<'_> {
        StackMemory { interfaces: &mut self.interfaces, films: &mut self.films, boundaries: &mut self.boundaries }
    }
}

impl<const N: usize> Default for StackArrays<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// An error in a stack, for which it is refused, or too little memory for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StackError {
    /// The stack has more planes than the memory holds.
    Memory {
        /// Number of planes that the memory holds.
        available: usize,
    },
    /// A layer has a thickness that is negative, NaN or infinite.
    Thickness {
        /// Index of the layer, from 0 at the top.
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

/// A checked planar multilayer: it has at least one plane, and finite thicknesses.
#[derive(Clone, Copy, Debug)]
pub struct Stack<'a> {
    interfaces: &'a [Interface],
    films: &'a [Film],
    boundaries: &'a [Boundary],
    ambient: MediumIndex,
    substrate: Below,
}

/// Index of `wanted` in `list`, to which it is appended if it is new; `None` if the list is full.
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
    /// [`StackError::Thickness`] for a layer whose thickness is negative or not finite, [`StackError::Memory`] if the
    /// stack has more planes than the memory holds.
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

    /// Number of planes, one more than layers.
    #[must_use]
    pub fn planes(&self) -> usize {
        self.boundaries.len()
    }

    /// The media above and below plane `j`, counted from 0 at the top; those around the whole stack beyond the last
    /// plane.
    #[must_use]
    pub fn interface(&self, j: usize) -> Interface {
        let known = self.boundaries.get(j).and_then(|boundary| self.interfaces.get(boundary.interface as usize));
        known.copied().unwrap_or(Interface { above: self.ambient, below: self.substrate })
    }

    /// The layer below plane `j`, which must not be the last; a layer of zero thickness beyond the last plane.
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

    /// The substrate: the medium or mirror under the last plane.
    #[must_use]
    pub fn substrate(&self) -> Below {
        self.substrate
    }

    /// Number of media that a scene must have for this stack: one more than the largest index in use.
    #[must_use]
    pub fn media(&self) -> usize {
        let each = |i: &Interface| match i.below {
            Below::Medium(below) => below.max(i.above),
            Below::Mirror => i.above,
        };
        self.interfaces.iter().map(each).max().map_or(0, |largest| usize::from(largest) + 1)
    }
}
