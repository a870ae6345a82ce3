//! Stacks, scenes, stages and clocks that several benches share.

pub mod clock;
pub mod counted;
pub mod criterion;
pub mod stages;

use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium, MediumIndex};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::Lanes;
use goniochrome::trace::waves::Limits;
use goniochrome_cli::scene::{Scene, parse};
use num_complex::Complex64;

/// Number of planes for which the benches have memory.
pub const MAX_PLANES: usize = 64;

/// Limits of a sum hit by hit that leave 1e-5 in reflectance.
pub const LIMITS: Limits = Limits { in_flight: 1e-12, ..Limits::SINGLE };

/// A planar stack and the few media that its layers name.
#[derive(Debug, Clone)]
pub struct Layered {
    /// Complex index n + ik of each medium.
    pub media: Vec<Complex64>,
    /// The medium from which light comes.
    pub ambient: MediumIndex,
    /// The layers, from the top.
    pub layers: Vec<Film>,
    /// The medium below.
    pub substrate: MediumIndex,
}

/// The stack of [`twenty_layers`]: 1.73 + 0.01i, 80 nm, and 1.40, 100 nm, in turn, on 1.56 + 0.06i.
#[must_use]
pub fn beetle() -> Layered {
    let layer = |i: usize| match i % 2 {
        0 => Film { medium: 1, thickness_nm: 80.0 },
        _ => Film { medium: 2, thickness_nm: 100.0 },
    };
    Layered {
        media: vec![1.0.into(), Complex64::new(1.73, 0.01), 1.4.into(), Complex64::new(1.56, 0.06)],
        ambient: 0,
        layers: (0..20).map(layer).collect(),
        substrate: 3,
    }
}

/// The scene of `tests/data/twenty_layers.toml`: high contrast, half of its layers absorbing.
///
/// # Panics
/// Never: the scene is good.
#[must_use]
pub fn twenty_layers() -> Scene {
    parse("twenty-layers", include_str!("../../tests/data/twenty_layers.toml")).expect("a good scene")
}

/// Layers of index 1.56 and 1.0 in turn, 100 nm each, on 1.56.
#[must_use]
pub fn contrast(layers: usize) -> Layered {
    let layer = |i: usize| Film { medium: MediumIndex::from(i.is_multiple_of(2)), thickness_nm: 100.0 };
    Layered { media: vec![1.0.into(), 1.56.into()], ambient: 0, layers: (0..layers).map(layer).collect(), substrate: 1 }
}

impl Layered {
    /// Calls `f` with this stack and its media at one group of wavelengths.
    ///
    /// # Panics
    /// If a medium is not passive, or there are more than [`MAX_PLANES`] planes.
    pub fn with<V: Lanes, R>(&self, wavelengths_nm: &[f64], f: impl FnOnce(Stack<'_>, &MediaLanes<'_, V>) -> R) -> R {
        let media: Vec<Medium<'_>> =
            self.media.iter().map(|&eta| Medium::constant(eta).expect("a passive medium")).collect();
        let mut eta = vec![ComplexLanes::zero(); media.len()];
        let lanes = MediaLanes::evaluate(&media, wavelengths_nm, &mut eta).expect("constant media hold everywhere");
        let mut arrays = StackArrays::<MAX_PLANES>::new();
        let below = Below::Medium(self.substrate);
        let stack =
            Stack::new(self.ambient, self.layers.iter().copied(), below, arrays.memory()).expect("the stack fits");
        f(stack, &lanes)
    }

    /// Calls `f` with this stack, prepared for one angle and group of wavelengths.
    ///
    /// # Panics
    /// If a medium is not passive, or there are more than [`MAX_PLANES`] planes.
    pub fn with_prepared<V: Lanes, R>(
        &self,
        sin_theta: f64,
        wavelengths_nm: &[f64],
        f: impl FnOnce(&PreparedStack<'_, V>) -> R,
    ) -> R {
        self.with::<V, _>(wavelengths_nm, |stack, media| {
            let mut memory = Box::new(PreparedStackArrays::<V, MAX_PLANES>::new());
            f(&PreparedStack::new(stack, media, sin_theta, Model::Physical, memory.memory()))
        })
    }
}

/// A wavelength for each lane: 450 nm and up, in steps of 10 nm.
#[must_use]
pub fn group<V: Lanes>() -> Vec<f64> {
    (0..V::WIDTH).map(|i| 450.0 + 10.0 * i as f64).collect()
}
