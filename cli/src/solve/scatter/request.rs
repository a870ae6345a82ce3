//! The request for scattering of one direction of the light, and its result.

use goniochrome::measure::bins::DirectionBins;

use crate::solve::precision::Precision;
use crate::solve::scatter::coherence::Coherence;
use crate::table::statistics::MeanWithError;

/// How the starting rays of a cell are traced.
#[derive(Clone, Copy, Debug)]
pub struct Tracing {
    /// Which exits interfere.
    pub coherence: Coherence,
    /// Starting rays over the period, of each direction of the light.
    pub rays: u32,
    /// Seed of the scrambled Sobol sequence.
    pub seed: u32,
    /// Single or double precision.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

/// A request for the scattering of light from one direction.
#[derive(Clone, Copy, Debug)]
pub struct ScatterRequest<G = DirectionBins> {
    /// Which exits interfere.
    pub coherence: Coherence,
    /// Starting rays over the period.
    pub rays: u32,
    /// Seed of the scrambled Sobol sequence.
    pub seed: u32,
    /// Bins of directions in which exits are counted: even ones, or any other grid.
    pub bins: G,
    /// Single or double precision.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

impl<G> ScatterRequest<G> {
    /// How the starting rays are traced, without the bins.
    #[must_use]
    pub fn tracing(&self) -> Tracing {
        let &Self { coherence, rays, seed, precision, threads, bins: _ } = self;
        Tracing { coherence, rays, seed, precision, threads }
    }
}

/// The light scattered from one direction at one wavelength, as fractions of the incident power, unpolarised.
#[derive(Clone, Debug, PartialEq)]
pub struct Scattered {
    /// Light that leaves through the top.
    pub reflected: MeanWithError,
    /// Light that leaves through the bottom, in all directions.
    pub transmitted: MeanWithError,
    /// Light that media absorb on the way.
    pub absorbed: MeanWithError,
    /// Light of rays that were dropped or lost: the error bar.
    pub truncated: MeanWithError,
    /// The power balance: 1 less reflected, transmitted, absorbed and truncated light. It is rounding alone for
    /// coherence `none`; where paths interfere, power balances only on average.
    pub imbalance: MeanWithError,
    /// Share of starting rays whose interfering waves do not converge and which were traced without interference:
    /// waves in absorbing bodies narrower than a wavelength may meet loops of gain above 1.
    pub without_interference: MeanWithError,
    /// Light that leaves through the top in each bin.
    pub bins: Vec<MeanWithError>,
}
