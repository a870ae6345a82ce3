//! The request for the table of a cell, and the identity of its checkpoint.

use goniochrome::colour::RgbSpace;
use goniochrome::table::ScatterLayout;

use crate::scene::Scene;
use crate::solve::checkpoint::Identity;
use crate::solve::scatter::ScatterRequest;

/// A request for the table of a cell. The bins of `tracing` must be those of the layout.
#[derive(Clone, Copy, Debug)]
pub struct TableRequest<'r> {
    /// The grid of directions.
    pub layout: ScatterLayout,
    /// Rays of each incident direction, seed, coherence, precision and threads.
    pub tracing: ScatterRequest,
    /// The standard error of the albedo below which an incident direction is finished: its rays double until then, up
    /// to [`MAX_RAYS`](crate::solve::cell_table::MAX_RAYS).
    pub target_error: Option<f64>,
    /// Weights of XYZ for each wavelength.
    pub weights: &'r [[f64; 3]],
    /// The space of RGB.
    pub space: RgbSpace,
    /// Whether f(wi, wo) and f(wo, wi) are averaged: see [`reciprocal`](crate::solve::cell_table::reciprocal).
    pub reciprocal: bool,
}

impl TableRequest<'_> {
    /// The identity of a checkpoint: everything that decides its numbers. The number of threads does not, nor does what
    /// is done to the finished table.
    #[must_use]
    pub fn identity(&self, scene: &Scene, wavelength_nm: &[f64]) -> Identity {
        let Self { layout, tracing, target_error, weights, .. } = self;
        let ScatterRequest { coherence, rays, seed, bins, precision, threads: _ } = tracing;
        let options = (layout, coherence, rays, seed, bins, precision, target_error);
        Identity::of_scene(scene).and("options", &options).and("wavelengths and illuminant", &(wavelength_nm, weights))
    }
}
