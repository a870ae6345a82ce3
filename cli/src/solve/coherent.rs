//! The two coherences in which starting rays interfere with each other: `bin`, the paper's section 2.2 taken literally, and
//! `cell`, diffraction orders collected into bins.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::measure::bins::BinFields;
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::Polarised;
use goniochrome::simd::lanes::Lanes;
use goniochrome::simd::vector::VectorLanes;
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Slot, trace};

use crate::solve::diffraction::{self, default_hits, orders};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{BATCHES, ScatterRequest, Scattered, Tally, WAVES, states};
use crate::support::error::Result;
use crate::support::memory::expect_list;
use crate::support::parallel;
use crate::table::statistics::MeanWithError;

/// Light of one direction whose exits add as amplitudes in each bin.
#[derive(Clone, Copy)]
pub(crate) struct BinLight<'c> {
    pub cell: MeshCell<'c>,
    /// States in which waves may wait.
    pub states: usize,
    /// Unit, towards the light.
    pub wi: DVec3,
    /// Starting rays of each batch.
    pub rays: u32,
    /// Bins, seed and threads.
    pub request: &'c ScatterRequest,
}

/// Sums over the starting rays of one batch.
struct Batch<V: Lanes> {
    fields: Vec<WaveField<V>>,
    truncated: V,
    absorbed: V,
}

impl<'c> BinLight<'c> {
    /// For as many starting rays as were asked for, at least one in each batch.
    pub fn new(mesh_scene: &MeshScene<'_>, cell: MeshCell<'c>, wi: DVec3, request: &'c ScatterRequest) -> Self {
        Self { cell, states: states(mesh_scene), wi, rays: (request.rays / BATCHES).max(1), request }
    }

    /// Refuses bins that memory does not hold.
    pub fn expect_room<V: Lanes>(request: &ScatterRequest) -> Result<()> {
        let fields = BinFields::<V>::required_len(request.bins);
        expect_list::<WaveField<V>>(&[fields, BATCHES as usize], "the fields of all --bins")
    }

    /// One tally for each batch and each of the `wavelengths` that `media` hold. The mean over batches is the estimate,
    /// and their spread tells its standard error.
    ///
    /// The power of a bin is |F|² of the mean field F over all batches, so no batch has a power of its own. A batch
    /// gets the jackknife's pseudo-value instead, with F₋ the mean field of the other batches: K |F|² − (K − 1) |F₋|²
    /// for K batches. Their mean is free of the noise that |F|² adds (Efron, "The Jackknife, the Bootstrap and Other
    /// Resampling Plans", 1982, chapter 2).
    pub fn tallies<V: Lanes>(
        &self,
        media: MediaLanes<'_, V>,
        wavelengths: usize,
        progress: &(dyn Fn() + Sync),
    ) -> Vec<Vec<Tally>> {
        let nothing: WaveField<V> = Polarised::both(VectorLanes::zero());
        let fields = BinFields::<V>::required_len(self.request.bins);
        let batch = |_| Batch { fields: vec![nothing; fields], truncated: V::zero(), absorbed: V::zero() };
        let mut batches: Vec<Batch<V>> = (0..BATCHES).map(batch).collect();
        parallel::for_each(
            self.request.threads,
            batches.iter_mut().zip(0u32..),
            || vec![free_slot::<V>(); self.states],
            |slots, (sums, batch)| {
                self.trace(media, batch, slots, sums);
                progress();
            },
        );
        let per_ray = 1.0 / f64::from(self.rays);
        let half = self.request.bins.count();
        let blank = |batch: &Batch<V>| {
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

    fn trace<V: Lanes>(
        &self,
        media: MediaLanes<'_, V>,
        batch: u32,
        slots: &mut [Slot<WaveState<V>, WaveField<V>>],
        Batch { fields, truncated, absorbed }: &mut Batch<V>,
    ) {
        let incident = IncidentWave::new(self.wi, media.eta()[usize::from(self.cell.above())]);
        let mut polygons = CoherentMesh::new(self.cell, media, incident);
        let mut sink = BinFields::new(fields, self.request.bins, &media, incident.wavevector());
        for ray in 0..self.rays {
            let [u, v] = sobol(ray, self.request.seed.wrapping_mul(BATCHES).wrapping_add(batch));
            match polygons.start(u, v) {
                Some((state, field)) => {
                    sink.begin(state.point_nm());
                    *truncated += trace(&mut polygons, state, field, slots, WAVES, &mut sink).truncated;
                }
                None => *truncated += V::one(),
            }
        }
        *truncated += polygons.lost();
        let Polarised { s, p } = polygons.absorbed();
        *absorbed = (s + p) * V::splat(0.5);
    }
}

/// Real and imaginary parts of a field at one wavelength, of s and p light.
type Components = [f64; 12];

fn components<V: Lanes>(field: &WaveField<V>, lane: usize) -> Components {
    let of = |e: VectorLanes<V>| [e.x.re, e.x.im, e.y.re, e.y.im, e.z.re, e.z.im].map(|part| part.lane(lane));
    let ([a, b, c, d, e, f], [g, h, i, j, k, l]) = (of(field.s), of(field.p));
    [a, b, c, d, e, f, g, h, i, j, k, l]
}

/// The jackknife's values of the unpolarised power of a sum of fields, one for each batch's own sum; in units of the
/// rays of a batch, squared.
fn pseudo_values(sums: impl Iterator<Item = Components> + Clone) -> impl Iterator<Item = f64> {
    let whole = sums.clone().fold([0.0; 12], |whole: Components, sum| std::array::from_fn(|i| whole[i] + sum[i]));
    let power = |field: Components| 0.5 * field.iter().map(|x| x * x).sum::<f64>();
    let count = f64::from(BATCHES);
    let all = power(whole) / count;
    sums.map(move |sum| all - power(std::array::from_fn(|i| whole[i] - sum[i])) / (count - 1.0))
}

/// Light from `wi` with coherence `cell`: reflected orders, each in the bin of its direction. Transmitted orders are
/// not computed: what is not reflected is left as imbalance.
pub(crate) fn orders_in_bins(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &ScatterRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<Scattered>> {
    let &ScatterRequest { rays, seed, precision, threads, .. } = request;
    let hits = default_hits(mesh_scene);
    let how = diffraction::OrdersRequest { rays, seed, max_order: None, hits, precision, threads };
    let found = orders(mesh_scene, wi, wavelength_nm, &how, progress)?;
    let of_wavelength = |(&nm, left_out): (&f64, &diffraction::LeftOut)| {
        let mut bins = vec![MeanWithError::default(); request.bins.count()];
        let mut reflected = MeanWithError::default();
        for order in found.orders.iter().filter(|order| order.wavelength_nm == nm) {
            let (s, p) = (order.efficiency.s, order.efficiency.p);
            for sum in [&mut bins[request.bins.index(order.direction)], &mut reflected] {
                sum.value += 0.5 * (s.value + p.value);
                sum.std_error = sum.std_error.hypot(0.5 * s.std_error.hypot(p.std_error));
            }
        }
        let truncated = MeanWithError { value: left_out.truncated(hits), std_error: 0.0 };
        let rest = 1.0 - reflected.value - truncated.value;
        let imbalance = MeanWithError { value: rest, std_error: reflected.std_error };
        let none = MeanWithError::default();
        Scattered {
            reflected,
            transmitted: none,
            absorbed: none,
            truncated,
            imbalance,
            without_interference: none,
            bins,
        }
    };
    Ok(wavelength_nm.iter().zip(&found.left_out).map(of_wavelength).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

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
