//! Sums over the starting rays of one incident direction.

use glam::DVec3;

use crate::solve::batches::BATCHES;
use crate::solve::cell_table::request::TableRequest;
use crate::solve::scatter::Tally;

/// Sums of one incident direction over its starting rays.
pub(super) struct DirectionSums {
    /// Power as `[wavelength][bin]`, in bins relative to the incident azimuth.
    pub power: Vec<f64>,
    /// Sums of each batch, weighted by luminance.
    pub batches: Vec<Tally>,
}

/// A batch of starting rays of one incident direction.
#[derive(Clone, Copy)]
pub(super) struct IncidentBatch {
    pub number: usize,
    /// The column of bins that holds the incident azimuth, which is relative column 0.
    pub first: usize,
    pub wi: DVec3,
    pub rays: f64,
}

impl DirectionSums {
    /// Sums without light.
    pub fn new(wavelengths: usize, bins: usize) -> Self {
        Self { power: vec![0.0; wavelengths * bins], batches: vec![Tally::new(bins); BATCHES as usize] }
    }

    /// Adds the means over a batch's starting rays at one wavelength.
    pub fn add(&mut self, request: &TableRequest<'_>, batch: &IncidentBatch, wavelength: usize, tally: &Tally) {
        let bins = request.layout.bins();
        let (count, columns) = (bins.count(), bins.phi as usize);
        let weight = request.weights[wavelength][1] * batch.rays;
        let luminance = &mut self.batches[batch.number];
        luminance.reflected += weight * tally.reflected;
        luminance.transmitted += weight * tally.transmitted;
        luminance.absorbed += weight * tally.absorbed;
        luminance.truncated += weight * tally.truncated;
        luminance.without_interference += weight * tally.without_interference;
        let power = &mut self.power[wavelength * count..][..count];
        for (bin, &counted) in tally.bins.iter().enumerate().filter(|(_, counted)| **counted != 0.0) {
            let column = bin % columns;
            let relative = bin - column + (column + columns - batch.first) % columns;
            power[relative] += counted * batch.rays;
            luminance.bins[relative] += weight * counted;
        }
    }
}
