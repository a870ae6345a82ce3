//! The tracing of one incident direction of a table.

use std::ops::Range;

use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::simd::lanes::Lanes;

use crate::solve::batches::{BATCHES, rays_per_batch, sequence};
use crate::solve::cell_table::request::TableRequest;
use crate::solve::cell_table::sums::{DirectionSums, IncidentBatch};
use crate::solve::groups::Group;
use crate::solve::scatter::{Adding, BinLight, Coherence, Paths, ScatterRequest, Tally, Workspace, trace_batch};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::Energy;
use crate::table::statistics::MeanWithError;

/// The largest number of starting rays for one incident direction that a target error asks for.
pub const MAX_RAYS: u32 = 1 << 22;

/// The sums that a table can hold: those of [`Adding`] without diffraction orders.
#[derive(Clone, Copy)]
pub(super) enum TableSum {
    /// Starting rays add as powers.
    Powers(Paths),
    /// Fields of all starting rays add in bins.
    Fields,
}

/// The sum that a coherence asks for; refuses diffraction orders.
pub(super) fn table_sum(coherence: Coherence) -> Result<TableSum> {
    match coherence.adding() {
        Adding::Powers(paths) => Ok(TableSum::Powers(paths)),
        Adding::Fields => Ok(TableSum::Fields),
        Adding::Orders => Err(Error::usage(format_args!(
            "--coherence {}: a table of scattered light holds no diffraction orders; use orders, or scatter with this option, for \
             one direction of the light, and estimate for a table of orders",
            coherence.name()
        ))),
    }
}

/// A thread that traces incident directions, with its memory for the tracer.
pub(super) struct TableWorker<'w, V: Lanes> {
    pub cell: MeshCell<'w>,
    pub groups: &'w [Group<'w, V>],
    pub request: &'w TableRequest<'w>,
    pub sum: TableSum,
    /// Slots in which waves wait to merge, where starting rays interfere.
    pub slots: usize,
    pub memory: Workspace<V>,
}

impl<V: Lanes> TableWorker<'_, V> {
    /// Traces one incident direction into its rows of the table.
    pub fn trace_direction(&mut self, incident: usize, brdf: &mut [f32], error: &mut [f32]) -> Energy {
        let request = self.request;
        let (bins, wavelengths) = (error.len(), brdf.len() / error.len());
        let mut sums = DirectionSums::new(wavelengths, bins);
        // Each direction has scramblings of its own, so that the errors of neighbours are independent.
        let seed = request.tracing.seed.wrapping_mul(0x9e37_79b9).wrapping_add(incident as u32);
        let tracing = ScatterRequest { seed, threads: 1, ..request.tracing };
        let (mut from, mut to) = (0, rays_per_batch(request.tracing.rays));
        loop {
            match self.sum {
                TableSum::Powers(paths) => {
                    for number in 0..BATCHES as usize {
                        self.add_powers(&tracing, paths, incident, number, from..to, &mut sums);
                    }
                }
                TableSum::Fields => {
                    sums = DirectionSums::new(wavelengths, bins);
                    to = self.add_fields(&tracing, incident, to, &mut sums);
                }
            }
            let reflected = MeanWithError::over(sums.batches.iter().map(|batch| batch.reflected / f64::from(to)));
            let good = request.target_error.is_none_or(|target| reflected.std_error <= target);
            if good || to > MAX_RAYS / BATCHES / 2 {
                break;
            }
            (from, to) = (to, 2 * to);
        }
        self.divide(&sums, to, brdf, error)
    }

    /// Divides the sums over `to` starting rays of each batch into f, its errors and the energy.
    fn divide(
        &self,
        DirectionSums { power, batches }: &DirectionSums,
        to: u32,
        brdf: &mut [f32],
        error: &mut [f32],
    ) -> Energy {
        let (request, bins) = (self.request, error.len());
        let per_ray = 1.0 / f64::from(to);
        let solid_angle: Vec<f64> = (0..bins).map(|bin| request.layout.bins().projected_solid_angle(bin)).collect();
        for (brdf, power) in brdf.chunks_mut(bins).zip(power.chunks(bins)) {
            for ((f, power), solid_angle) in brdf.iter_mut().zip(power).zip(&solid_angle) {
                // Where starting rays interfere, a bin without light holds noise of either sign.
                *f = (power * per_ray / f64::from(BATCHES) / solid_angle).max(0.0) as f32;
            }
        }
        for (bin, error) in error.iter_mut().enumerate() {
            let spread = MeanWithError::over(batches.iter().map(|batch| batch.bins[bin] * per_ray));
            *error = (spread.std_error / solid_angle[bin]) as f32;
        }
        let mean = |of: &dyn Fn(&Tally) -> f64| MeanWithError::over(batches.iter().map(|batch| of(batch) * per_ray));
        let whole: f64 = request.weights.iter().map(|weight| weight[1]).sum::<f64>() * f64::from(to);
        Energy {
            reflected: mean(&|batch| batch.reflected),
            transmitted: mean(&|batch| batch.transmitted).value,
            absorbed: mean(&|batch| batch.absorbed).value,
            truncated: mean(&|batch| batch.truncated).value,
            imbalance: mean(&|b| whole - b.reflected - b.transmitted - b.absorbed - b.truncated),
            without_interference: mean(&|batch| batch.without_interference).value,
            rays: u64::from(to) * u64::from(BATCHES),
        }
    }

    /// The batch `number` of an incident direction. In an isotropic table each batch comes from an azimuth of its own.
    fn batch(&self, incident: usize, number: usize, rays: u32) -> IncidentBatch {
        let layout = self.request.layout;
        let columns = layout.bins().phi as usize;
        let first = match layout.phi() {
            1 => number * columns / BATCHES as usize,
            _ => layout.first_bin(incident % layout.phi() as usize),
        };
        let theta = layout.incident(incident)[0];
        let phi = std::f64::consts::TAU * (first as f64 + 0.5) / columns as f64;
        let wi = direction(theta, phi);
        IncidentBatch { number, first, wi, rays: f64::from(rays) }
    }

    /// Adds the powers of the starting rays `rays` of one batch.
    fn add_powers(
        &mut self,
        tracing: &ScatterRequest,
        paths: Paths,
        incident: usize,
        number: usize,
        rays: Range<u32>,
        sums: &mut DirectionSums,
    ) {
        let batch = self.batch(incident, number, rays.end - rays.start);
        let bins = tracing.bins.count();
        let mut wavelength = 0;
        for (media, wavelengths) in self.groups {
            let mut tallies = vec![Tally::new(bins); wavelengths.len()];
            let (rays, memory) = (rays.clone(), &mut self.memory);
            let sequence = sequence(tracing.seed, number as u32);
            trace_batch(self.cell, *media, batch.wi, sequence, rays, paths, tracing.bins, memory, &mut tallies);
            for tally in tallies {
                sums.add(self.request, &batch, wavelength, &tally);
                wavelength += 1;
            }
        }
    }

    /// Adds the fields of `rays` starting rays of each batch. Returns how many rays were traced: each azimuth of an
    /// isotropic table needs one in each of its own batches.
    fn add_fields(&self, tracing: &ScatterRequest, incident: usize, rays: u32, sums: &mut DirectionSums) -> u32 {
        let Self { cell, slots, .. } = *self;
        let grid = tracing.bins;
        let isotropic = self.request.layout.phi() == 1;
        let rays = if isotropic { rays.div_ceil(BATCHES) * BATCHES } else { rays };
        let batches: Vec<IncidentBatch> =
            (0..BATCHES as usize).map(|number| self.batch(incident, number, rays)).collect();
        let mut place = 0;
        for (media, wavelengths) in self.groups {
            if isotropic {
                for batch in &batches {
                    let seed = sequence(tracing.seed, batch.number as u32);
                    let request = ScatterRequest { seed, ..*tracing };
                    let light = BinLight { grid, cell, slots, wi: batch.wi, rays: rays / BATCHES, request: &request };
                    let found = light.tallies(*media, wavelengths.len(), &|| ());
                    for w in 0..wavelengths.len() {
                        sums.add(self.request, batch, place + w, &Tally::mean(found.iter().map(|own| &own[w])));
                    }
                }
            } else {
                let light = BinLight { grid, cell, slots, wi: batches[0].wi, rays, request: tracing };
                let found = light.tallies(*media, wavelengths.len(), &|| ());
                for (batch, own) in batches.iter().zip(&found) {
                    own.iter().enumerate().for_each(|(w, tally)| sums.add(self.request, batch, place + w, tally));
                }
            }
            place += wavelengths.len();
        }
        rays
    }
}
