//! The tracing of one incident direction of a table.

use std::f64::consts::TAU;

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::table::{FacetLobe, HalfVectorGrid, HalfVectorWarp, LobeDirection, ScatterLayout};

use crate::solve::batches::{BATCHES, sequence};
use crate::solve::cell_table::node_areas::{NodeAreas, level_columns};
use crate::solve::cell_table::record::DirectionRecord;
use crate::solve::cell_table::request::TableRequest;
use crate::solve::cell_table::starts::starts;
use crate::solve::cell_table::sums::DirectionSums;
use crate::solve::groups::Group;
use crate::solve::scatter::{Adding, BinLight, Coherence, Paths, RayLight, Tally, Tracing, Workspace, trace_rays};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::Energy;
use crate::table::statistics::MeanWithError;

/// The largest number of starting rays for one incident direction that a target error asks for.
pub const MAX_RAYS: u32 = 1 << 22;

/// The largest number of starting rays that are divided into strata together; more come in several such sets. Their
/// candidates take 6 MiB.
const MAX_STRATA: u32 = 1 << 14;

/// Azimuths of the light over which an isotropic table is averaged.
const AZIMUTHS: u32 = 32;

/// The sums that a table can hold: those of [`Adding`] without diffraction orders.
#[derive(Clone, Copy)]
pub(super) enum TableSum {
    /// Starting rays add as powers.
    Powers(Paths),
    /// Fields of all starting rays add in boxes.
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

/// The places in which a table counts its light.
#[derive(Clone, Copy)]
pub(super) struct Places<'w> {
    pub layout: ScatterLayout,
    pub warp: HalfVectorWarp<'w>,
    pub lobes: &'w [FacetLobe],
}

/// The lobes above the horizon for light from `wi`, as [`HalfVectorGrid`] takes them.
#[must_use]
pub fn lobe_directions(lobes: &[FacetLobe], wi: DVec3) -> Vec<LobeDirection> {
    let leaving = |(lobe, map): (usize, &FacetLobe)| {
        let direction = map.direction(wi.as_vec3())?.as_dvec3().normalize();
        Some(LobeDirection { direction, lobe })
    };
    let mut found: Vec<_> = lobes.iter().enumerate().filter_map(leaving).collect();
    found.sort_by(|a, b| a.direction.x.total_cmp(&b.direction.x));
    found
}

/// A thread that traces incident directions, with its memory for the tracer.
pub(super) struct TableWorker<'w, V: RayLanes> {
    pub cell: MeshCell<'w>,
    pub groups: &'w [Group<'w, V>],
    pub request: &'w TableRequest<'w>,
    pub places: Places<'w>,
    pub sum: TableSum,
    /// Slots in which waves wait to merge, where starting rays interfere.
    pub slots: usize,
    pub memory: Workspace<V>,
}

impl<V: RayLanes> TableWorker<'_, V> {
    /// Traces one incident direction into its record.
    pub fn trace_direction(&mut self, incident: usize, record: &mut DirectionRecord<'_>) {
        // Each direction has scramblings of its own, so that the errors of neighbours are independent.
        let seed = self.request.tracing.seed.wrapping_mul(0x9e37_79b9).wrapping_add(incident as u32);
        match self.sum {
            TableSum::Powers(paths) => self.add_powers(incident, seed, paths, record),
            TableSum::Fields => self.add_fields(incident, seed, record),
        }
    }

    /// Whether a standard error is small enough, or so many rays are the last that may be traced.
    fn is_done(&self, std_error: f64, rays: u64) -> bool {
        self.request.target_error.is_none_or(|target| std_error <= target) || rays > u64::from(MAX_RAYS / 2)
    }

    /// Azimuths from which the light of an incident direction comes: in an isotropic table all around the normal.
    fn azimuths(&self, incident: usize) -> Vec<f64> {
        if self.places.layout.is_isotropic() {
            (0..AZIMUTHS).map(|i| TAU * (f64::from(i) + 0.5) / f64::from(AZIMUTHS)).collect()
        } else {
            vec![self.places.layout.incident(incident)[1]]
        }
    }

    /// Traces starting rays that add as powers.
    fn add_powers(&mut self, incident: usize, seed: u32, paths: Paths, record: &mut DirectionRecord<'_>) {
        let (request, places) = (self.request, self.places);
        let theta = places.layout.incident(incident)[0];
        let azimuths = self.azimuths(incident);
        let level = level_columns(&places.layout, incident);
        let mut sums = DirectionSums::new(request.weights.len(), places.layout.places(), level);
        let whole: f64 = request.weights.iter().map(|weight| weight[1]).sum();
        let mut pass = 0;
        let mut rays = request.tracing.rays;
        loop {
            let of_azimuth = (rays / azimuths.len() as u32).max(2).next_multiple_of(2);
            for (place, &phi) in azimuths.iter().enumerate() {
                let wi = direction(theta, phi);
                let lobes = lobe_directions(places.lobes, wi);
                let grid = HalfVectorGrid::new(places.layout, places.warp, wi, &lobes);
                let sequence = sequence(seed, pass).wrapping_add((place as u32).wrapping_mul(0x85eb_ca77));
                for set in 0..of_azimuth.div_ceil(MAX_STRATA) {
                    let count = MAX_STRATA.min(of_azimuth - set * MAX_STRATA);
                    let sequence = sequence.wrapping_add(set.wrapping_mul(0xc2b2_ae3d));
                    let starts = starts(&self.cell, &places.warp, wi, count, sequence);
                    self.add_pairs(paths, wi, &grid, sequence, &starts, &mut sums);
                }
            }
            *record.energy = sums.energy(whole);
            if self.is_done(record.energy.reflected.std_error, sums.rays()) {
                break;
            }
            (pass, rays) = (pass + 1, u32::try_from(sums.rays()).unwrap_or(MAX_RAYS));
        }
        let per_ray = 1.0 / sums.rays() as f64;
        let places = places.layout.places();
        for (wavelength, values) in record.values.chunks_mut(places).enumerate() {
            values.iter_mut().zip(sums.powers(wavelength)).for_each(|(value, power)| *value = (power * per_ray) as f32);
        }
        for (place, error) in record.error.iter_mut().enumerate() {
            *error = sums.error(place) as f32;
        }
        let node_areas = NodeAreas::new(&self.places.layout, &self.places.warp, incident);
        record.values.chunks_mut(places).chain([&mut *record.error]).for_each(|powers| node_areas.divide(powers));
    }

    /// Adds the powers of starting rays, in pairs of neighbouring strata, at all wavelengths.
    fn add_pairs(
        &mut self,
        paths: Paths,
        wi: DVec3,
        grid: &HalfVectorGrid<'_>,
        sequence: u32,
        starts: &[[f64; 2]],
        sums: &mut DirectionSums,
    ) {
        let nodes = self.places.layout.node_count();
        for (pair, points) in (0u32..).zip(starts.as_chunks::<2>().0) {
            let mut first = 0;
            for (media, wavelengths) in self.groups {
                let light = RayLight { cell: self.cell, media: *media, wi, paths, grid, sequence };
                let weights = &self.request.weights[first..first + wavelengths.len()];
                for (half, &point) in points.iter().enumerate() {
                    let mut ray = sums.ray(half == 1, first, weights, nodes);
                    let start = std::iter::once((2 * pair + half as u32, point));
                    let unseen = trace_rays(&light, start, &mut self.memory, &mut ray);
                    ray.end(&unseen);
                }
                first += wavelengths.len();
            }
            sums.end_pair();
        }
    }

    /// Traces starting rays whose fields add.
    fn add_fields(&self, incident: usize, seed: u32, record: &mut DirectionRecord<'_>) {
        let Self { cell, slots, request, places, .. } = *self;
        let count = places.layout.places();
        let theta = places.layout.incident(incident)[0];
        let azimuths = self.azimuths(incident);
        let whole: f64 = request.weights.iter().map(|weight| weight[1]).sum();
        let mut rays = request.tracing.rays;
        loop {
            let of_batch = (rays / azimuths.len() as u32 / BATCHES).max(1);
            record.values.fill(0.0);
            let mut batches = vec![Tally::new(count); BATCHES as usize];
            let share = 1.0 / azimuths.len() as f64;
            for (place, &phi) in azimuths.iter().enumerate() {
                let wi = direction(theta, phi);
                let lobes = lobe_directions(places.lobes, wi);
                let grid = HalfVectorGrid::new(places.layout, places.warp, wi, &lobes);
                let seed = sequence(seed, place as u32);
                let tracing = Tracing { seed, threads: 1, ..request.tracing };
                let light = BinLight { grid: &grid, cell, slots, wi, rays: of_batch, tracing };
                let mut wavelength = 0;
                for (media, wavelengths) in self.groups {
                    let found = light.tallies(*media, wavelengths.len(), &|| ());
                    for w in 0..wavelengths.len() {
                        let weight = request.weights[wavelength][1] * share;
                        let values = &mut record.values[wavelength * count..][..count];
                        for (sum, own) in batches.iter_mut().zip(&found) {
                            sum.add(&own[w], weight);
                            let per_batch = share / f64::from(BATCHES);
                            values.iter_mut().zip(&own[w].bins).for_each(|(v, p)| *v += (p * per_batch) as f32);
                        }
                        wavelength += 1;
                    }
                }
            }
            let mean = |of: &dyn Fn(&Tally) -> f64| MeanWithError::over(batches.iter().map(of));
            *record.energy = Energy {
                reflected: mean(&|batch| batch.reflected),
                transmitted: mean(&|batch| batch.transmitted).value,
                absorbed: mean(&|batch| batch.absorbed).value,
                truncated: mean(&|batch| batch.truncated).value,
                imbalance: mean(&|b| whole - b.reflected - b.transmitted - b.absorbed - b.truncated),
                without_interference: 0.0,
                rays: u64::from(of_batch) * u64::from(BATCHES) * azimuths.len() as u64,
            };
            for (place, error) in record.error.iter_mut().enumerate() {
                *error = mean(&|batch| batch.bins[place]).std_error as f32;
            }
            if self.is_done(record.energy.reflected.std_error, record.energy.rays) {
                break;
            }
            rays = 2 * u32::try_from(record.energy.rays).unwrap_or(MAX_RAYS);
        }
        let node_areas = NodeAreas::new(&places.layout, &places.warp, incident);
        record.values.chunks_mut(count).chain([&mut *record.error]).for_each(|powers| node_areas.divide(powers));
    }
}
