//! Coherence `bin`: the fields of all starting rays add in each bin, the paper's section 2.2 taken literally.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::measure::bins::{BinFields, DirectionGrid};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::Polarised;
use goniochrome::simd::lanes::Lanes;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::simd::vector::VectorLanes;
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Slot, trace};

use crate::solve::batches::{BATCHES, rays_per_batch, sequence};
use crate::solve::groups::Group;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::request::Tracing;
use crate::solve::scatter::tally::Tally;
use crate::solve::wave_limits::{WAVE_LIMITS, slots_without_fallback};
use crate::support::error::Result;
use crate::support::memory::expect_list;
use crate::support::parallel;

/// Light from one direction whose exits add as amplitudes in each bin.
#[derive(Clone, Copy)]
pub(crate) struct BinLight<'c, G> {
    /// Bins of the outgoing directions.
    pub grid: G,
    pub cell: MeshCell<'c>,
    /// Slots in which waves wait to merge.
    pub slots: usize,
    /// Unit vector towards the light.
    pub wi: DVec3,
    /// Starting rays of each batch.
    pub rays: u32,
    /// Seed and threads.
    pub tracing: Tracing,
}

/// Sums over the starting rays of one batch.
struct BinSums<V: RayLanes> {
    fields: Vec<WaveField<V>>,
    truncated: V,
    absorbed: V,
}

impl<'c, G: DirectionGrid + Sync> BinLight<'c, G> {
    /// Light of the requested number of starting rays, at least one in each batch.
    pub fn new(mesh_scene: &MeshScene<'_>, cell: MeshCell<'c>, wi: DVec3, grid: G, tracing: Tracing) -> Self {
        let (slots, rays) = (slots_without_fallback(mesh_scene), rays_per_batch(tracing.rays));
        Self { grid, cell, slots, wi, rays, tracing }
    }

    /// Refuses bins that memory does not hold.
    pub fn expect_room<V: RayLanes>(grid: &G) -> Result<()> {
        let fields = BinFields::<V, G>::required_len(grid);
        expect_list::<WaveField<V>>(&[fields, BATCHES as usize], "the fields of all --bins")
    }

    /// The tallies of each batch at all wavelengths.
    pub fn all_tallies<V: RayLanes>(&self, groups: &[Group<'_, V>], progress: &(dyn Fn() + Sync)) -> Vec<Vec<Tally>> {
        let mut batches: Vec<Vec<Tally>> = vec![Vec::new(); BATCHES as usize];
        for (media, wavelengths) in groups {
            let found = self.tallies(*media, wavelengths.len(), progress);
            batches.iter_mut().zip(found).for_each(|(batch, found)| batch.extend(found));
        }
        batches
    }

    /// The tallies of each batch at one group of wavelengths, as many as `media` hold. The mean over batches is the
    /// estimate, and their spread gives its standard error.
    ///
    /// The power of a bin is |F|² of the mean field F over all batches, so no batch has a power of its own. A batch
    /// gets the jackknife's pseudo-value instead, with F₋ the mean field of the other batches: K |F|² − (K − 1) |F₋|²
    /// for K batches. Their mean is free of the noise that |F|² adds (Efron, "The Jackknife, the Bootstrap and Other
    /// Resampling Plans", 1982, chapter 2).
    pub fn tallies<V: RayLanes>(
        &self,
        media: MediaLanes<'_, V>,
        wavelengths: usize,
        progress: &(dyn Fn() + Sync),
    ) -> Vec<Vec<Tally>> {
        let nothing: WaveField<V> = Polarised::both(VectorLanes::zero());
        let fields = BinFields::<V, G>::required_len(&self.grid);
        let batch = |_| BinSums { fields: vec![nothing; fields], truncated: V::zero(), absorbed: V::zero() };
        let mut batches: Vec<BinSums<V>> = (0..BATCHES).map(batch).collect();
        parallel::for_each(
            self.tracing.threads,
            batches.iter_mut().zip(0u32..),
            || vec![free_slot::<V>(); self.slots],
            |slots, (sums, batch)| {
                self.trace(media, batch, slots, sums);
                progress();
            },
        );
        let per_ray = 1.0 / f64::from(self.rays);
        let half = self.grid.count();
        let blank = |batch: &BinSums<V>| {
            let tally = |lane| Tally {
                truncated: batch.truncated.lane(lane) * per_ray,
                absorbed: batch.absorbed.lane(lane) * per_ray,
                ..Tally::new(half)
            };
            (0..wavelengths).map(tally).collect()
        };
        let mut tallies: Vec<Vec<Tally>> = batches.iter().map(blank).collect();
        for place in 0..fields {
            for lane in 0..wavelengths {
                let powers = pseudo_values(batches.iter().map(|batch| components(&batch.fields[place], lane)));
                for (tally, power) in tallies.iter_mut().zip(powers) {
                    let (tally, power) = (&mut tally[lane], power * per_ray * per_ray);
                    if place < half {
                        tally.reflected += power;
                        tally.bins[place] = power;
                    } else {
                        tally.transmitted += power;
                    }
                }
            }
        }
        tallies
    }

    /// Traces the starting rays of one batch.
    fn trace<V: RayLanes>(
        &self,
        media: MediaLanes<'_, V>,
        batch: u32,
        slots: &mut [Slot<WaveState<V>, WaveField<V::Light>>],
        BinSums { fields, truncated, absorbed }: &mut BinSums<V>,
    ) {
        let incident = IncidentWave::new(self.wi, media.eta()[usize::from(self.cell.above())]);
        let mut coherent = CoherentMesh::new(self.cell, media, incident);
        let mut sink = BinFields::new(fields, &self.grid, &media, incident.wavevector());
        for ray in 0..self.rays {
            let [u, v] = sobol(ray, sequence(self.tracing.seed, batch));
            match coherent.start(u, v) {
                Some((state, field)) => {
                    sink.begin(state.point_nm());
                    let done = trace(&mut coherent, state, field, slots, WAVE_LIMITS, &mut sink);
                    *truncated += V::each(done.truncated);
                }
                None => *truncated += V::one(),
            }
        }
        *truncated += V::each(coherent.lost());
        let Polarised { s, p } = coherent.absorbed();
        *absorbed = V::each((s + p) * V::Light::splat(0.5));
    }
}

/// Real and imaginary parts of a field at one wavelength, for s and p light.
type Components = [f64; 12];

/// The components of a field in one lane.
fn components<V: RayLanes>(field: &WaveField<V>, lane: usize) -> Components {
    let of = |e: VectorLanes<V>| [e.x.re, e.x.im, e.y.re, e.y.im, e.z.re, e.z.im].map(|part| part.lane(lane));
    let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (of(field.s), of(field.p));
    [a, b, c, d, e, f, g, h, i, j, k, l]
}

/// The jackknife's pseudo-values of the unpolarised power of a sum of fields, one for each batch, in units of the
/// squared number of rays in a batch.
fn pseudo_values(sums: impl Iterator<Item = Components> + Clone) -> impl Iterator<Item = f64> {
    let whole = sums.clone().fold([0.0; 12], |whole: Components, sum| std::array::from_fn(|i| whole[i] + sum[i]));
    let power = |field: Components| 0.5 * field.iter().map(|x| x * x).sum::<f64>();
    let count = f64::from(BATCHES);
    let all = power(whole) / count;
    sums.map(move |sum| all - power(std::array::from_fn(|i| whole[i] - sum[i])) / (count - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::statistics::MeanWithError;

    #[test]
    fn the_mean_of_the_jackknifes_values_is_the_power_less_its_noise() {
        let sums: Vec<Components> =
            (0..BATCHES).map(|b| std::array::from_fn(|i| 0.3 * i as f64 - f64::from(b * 7 % 5))).collect();
        let power = |field: &Components| 0.5 * field.iter().map(|x| x * x).sum::<f64>();
        let count = f64::from(BATCHES);
        let whole: Components = std::array::from_fn(|i| sums.iter().map(|sum| sum[i]).sum::<f64>() / count);
        let excess = sums.iter().map(power).sum::<f64>() / count - power(&whole);
        let expected = MeanWithError::of_square(power(&whole), excess, count).value;
        let found = pseudo_values(sums.iter().copied()).sum::<f64>() / count;
        assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
        let alike = pseudo_values(std::iter::repeat_n(sums[3], BATCHES as usize));
        alike.for_each(|value| assert!((value - power(&sums[3])).abs() < 1e-12 * power(&sums[3])));
    }
}
