//! The request for the table of a cell, and the identity of its checkpoint.

use goniochrome::colour::RgbSpace;

use crate::scene::Scene;
use crate::solve::checkpoint::Identity;
use crate::solve::scatter::Tracing;
use crate::solve::share::Share;

/// A request for the table of a cell.
#[derive(Clone, Copy, Debug)]
pub struct TableRequest<'r> {
    /// Rows in θ_i and columns in φ_i of incident directions.
    pub incident: [u32; 2],
    /// Nodes of half vectors along x and along y.
    pub half_vectors: [u32; 2],
    /// Rays of each incident direction, seed, coherence, precision and threads.
    pub tracing: Tracing,
    /// The standard error of the albedo below which an incident direction is finished: its rays double until then, up
    /// to [`MAX_RAYS`](crate::solve::cell_table::MAX_RAYS).
    pub target_error: Option<f64>,
    /// Weights of XYZ for each wavelength.
    pub weights: &'r [[f64; 3]],
    /// The space of RGB.
    pub space: RgbSpace,
    /// The share of the incident directions to compute; all others are then left out of the table.
    pub share: Option<Share>,
    /// Whether s(wi, wo) and s(wo, wi) are averaged: see [`reciprocal`](crate::solve::cell_table::reciprocal).
    pub reciprocal: bool,
}

impl TableRequest<'_> {
    /// The identity of a checkpoint: everything that decides its numbers. The number of threads does not, nor does what
    /// is done to the finished table.
    #[must_use]
    pub fn identity(&self, scene: &Scene, wavelength_nm: &[f64]) -> Identity {
        let Self { incident, half_vectors, tracing, target_error, weights, .. } = self;
        let Tracing { coherence, rays, seed, precision, threads: _ } = tracing;
        let options = (incident, half_vectors, coherence, rays, seed, precision, target_error);
        Identity::of_scene(scene).and("options", &options).and("wavelengths and illuminant", &(wavelength_nm, weights))
    }
}
