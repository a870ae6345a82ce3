//! Diffraction orders of polygon cells: starting rays over the period as one coherent field.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::measure::orders::{Order, Orders, max_order};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, Slot, trace};

use crate::solve::groups::Groups;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::Precision;
use crate::solve::scatter::{BATCHES, MAX_TRUNCATED, refuse_divergence, refuse_truncation, states};
use crate::support::error::{Error, Result};
use crate::support::memory::expect_list;
use crate::support::parallel;
use crate::table::statistics::MeanWithError;

/// What to compute.
#[derive(Clone, Copy, Debug)]
pub struct OrdersRequest {
    /// Starting rays over the period.
    pub rays: u32,
    /// Of the scrambled sequence.
    pub seed: u32,
    /// Largest |m| and |n|; `None` for all that travel.
    pub max_order: Option<i32>,
    /// Hits after which rays are dropped: 1 is single scattering.
    pub hits: u32,
    /// Single or double.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

/// One order at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffracted {
    /// (m, n).
    pub index: [i32; 2],
    /// Vacuum wavelength.
    pub wavelength_nm: f64,
    /// Unit vector.
    pub direction: DVec3,
    /// Angle from the normal.
    pub theta_deg: f64,
    /// Efficiency for s and p light.
    pub efficiency: Polarised<MeanWithError>,
}

/// Light that the orders of one wavelength leave out, as a fraction of what comes, unpolarised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Of rays that met nothing, were lost through a hole, or found no room.
    pub lost: f64,
    /// In flight to a further facet after the last hit.
    pub in_flight: f64,
}

impl LeftOut {
    /// The error bar: what single scattering leaves out by definition does not count.
    #[must_use]
    pub fn truncated(&self, hits: u32) -> f64 {
        self.lost + if hits == SINGLE_SCATTERING { 0.0 } else { self.in_flight }
    }
}

/// The reflected orders of light from one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Diffraction {
    /// By index, then by wavelength.
    pub orders: Vec<Diffracted>,
    /// One for each wavelength.
    pub left_out: Vec<LeftOut>,
}

impl Diffraction {
    /// The largest of a quantity over wavelengths.
    #[must_use]
    pub fn worst(&self, of: impl Fn(&LeftOut) -> f64) -> f64 {
        self.left_out.iter().map(of).fold(0.0, f64::max)
    }

    /// What single scattering leaves out, in words, where it is more than a result may hide.
    #[must_use]
    pub fn single_scattering(&self, hits: u32) -> Option<String> {
        let share = self.worst(|left_out| left_out.in_flight);
        (hits == SINGLE_SCATTERING && share > MAX_TRUNCATED)
            .then(|| format!("single scattering: {share:.1e} of the light meets the surface again and is left out"))
    }
}

/// [`OrdersRequest::hits`] of single scattering.
const SINGLE_SCATTERING: u32 = 1;

/// Hits for a scene: physical optics of one rough surface holds for single scattering, since between its facets, often
/// narrower than a wavelength, light does not travel as rays. Layers need their bounces.
#[must_use]
pub fn default_hits(mesh_scene: &MeshScene<'_>) -> u32 {
    const LAYERED: u32 = 64;
    if mesh_scene.interface_count() == 1 { SINGLE_SCATTERING } else { LAYERED }
}

/// Orders that are computed at most; a period of 20 µm has some thousands.
const MAX_ORDERS: usize = 16_384;
/// Waves in flight below this power are dropped.
const IN_FLIGHT: f64 = 1e-10;

/// The reflected orders that travel, of light from the unit direction `wi`. `progress` is told of each of the batches
/// of each [`groups`] wavelengths.
///
/// # Errors
/// A mesh that the core refuses, a medium without data at a wavelength, more orders than are computed or memory holds,
/// more light left out than [`MAX_TRUNCATED`].
pub fn orders(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &OrdersRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Diffraction> {
    match request.precision {
        Precision::F32 => run::<F32>(mesh_scene, wi, wavelength_nm, request, progress),
        Precision::F64 => run::<F64>(mesh_scene, wi, wavelength_nm, request, progress),
    }
}

/// Groups into which [`orders`] parts so many wavelengths.
#[must_use]
pub fn groups(wavelengths: usize, precision: Precision) -> usize {
    wavelengths.div_ceil(match precision {
        Precision::F32 => F32::WIDTH,
        Precision::F64 => F64::WIDTH,
    })
}

fn run<V: Lanes>(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &OrdersRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Diffraction> {
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let media = mesh_scene.media();
    let mut groups = Groups::<V>::new(media.len(), wavelength_nm);
    let groups = groups
        .evaluate(&media, cell.above(), wavelength_nm)
        .map_err(|(index, error)| mesh_scene.scene().medium_error(index, &error))?;
    let mut found = Diffraction { orders: Vec::new(), left_out: Vec::new() };
    for (media, wavelengths) in &groups {
        let light = Light { cell, media: *media, wavelengths, wi, states: states(mesh_scene) };
        light.add(request, progress, &mut found)?;
    }
    found.orders.sort_by_key(|order| order.index);
    let worst = found.left_out.iter().copied().fold(LeftOut::default(), |worst, left_out| {
        if left_out.truncated(request.hits) > worst.truncated(request.hits) { left_out } else { worst }
    });
    refuse_divergence(mesh_scene, worst.truncated(request.hits))?;
    let remedy = match worst.in_flight > worst.lost {
        true => "orders --hits follows it further",
        false => "its surfaces may cut through one another: correct the mesh",
    };
    refuse_truncation(mesh_scene, worst.truncated(request.hits), remedy)?;
    Ok(found)
}

/// Light at one group of wavelengths.
struct Light<'l, V: Lanes> {
    cell: MeshCell<'l>,
    media: MediaLanes<'l, V>,
    wavelengths: &'l [f64],
    wi: DVec3,
    states: usize,
}

/// Sums over the starting rays of one batch.
struct Batch<V: Lanes> {
    orders: Vec<Order<V>>,
    lost: V,
    in_flight: V,
}

impl<V: Lanes> Light<'_, V> {
    /// Traces all batches and adds what they found.
    fn add(&self, request: &OrdersRequest, progress: &(dyn Fn() + Sync), found: &mut Diffraction) -> Result<()> {
        let blank = self.blank(request)?;
        expect_list::<Order<V>>(&[blank.len(), BATCHES as usize], "all orders that travel")?;
        let rays = (request.rays / BATCHES).max(1);
        let batch = |_| Batch { orders: blank.clone(), lost: V::zero(), in_flight: V::zero() };
        let mut batches: Vec<Batch<V>> = (0..BATCHES).map(batch).collect();
        parallel::for_each(
            request.threads,
            batches.iter_mut().zip(0u32..),
            || vec![free_slot::<V>(); self.states],
            |slots, (sums, batch)| {
                self.trace(request, rays, batch, slots, sums);
                progress();
            },
        );
        let rays = f64::from(rays);
        found.left_out.extend((0..self.wavelengths.len()).map(|lane| {
            let mean = |of: fn(&Batch<V>) -> V| {
                batches.iter().map(|batch| of(batch).lane(lane)).sum::<f64>() / (rays * batches.len() as f64)
            };
            LeftOut { lost: mean(|batch| batch.lost), in_flight: mean(|batch| batch.in_flight) }
        }));
        summarise(&batches, self.wavelengths, rays, &mut found.orders);
        Ok(())
    }

    /// The orders that travel at some of the wavelengths, without any light.
    fn blank(&self, request: &OrdersRequest) -> Result<Vec<Order<V>>> {
        let eta = self.eta();
        let shortest = self.wavelengths.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.cell.period_nm().map(|period| {
            let all = max_order(period, eta.re.lane(0), shortest);
            request.max_order.map_or(all, |max| max.min(all))
        });
        let mut blank = Vec::new();
        for m in -most[0]..=most[0] {
            for n in -most[1]..=most[1] {
                let order = Order::<V>::new([m, n], self.wi, self.cell.period_nm(), eta, &self.media);
                if order.cos_theta.any_above(0.0) {
                    if blank.len() == MAX_ORDERS {
                        return Err(Error::failed(format_args!(
                            "more than {MAX_ORDERS} orders travel at {shortest} nm; orders --max-order keeps to some of them"
                        )));
                    }
                    blank.push(order);
                }
            }
        }
        Ok(blank)
    }

    fn eta(&self) -> ComplexLanes<V::Precise> {
        self.media.eta()[usize::from(self.cell.above())]
    }

    fn trace(
        &self,
        request: &OrdersRequest,
        rays: u32,
        batch: u32,
        slots: &mut [Slot<WaveState<V>, WaveField<V>>],
        sums: &mut Batch<V>,
    ) {
        let mut polygons = CoherentMesh::new(self.cell, self.media, IncidentWave::new(self.wi, self.eta()));
        let mut sink = Orders::new(&mut sums.orders, self.wi, self.eta(), &self.media);
        let limits = Limits { in_flight: IN_FLIGHT, generations: request.hits };
        for ray in 0..rays {
            let [u, v] = sobol(ray, request.seed.wrapping_mul(BATCHES).wrapping_add(batch));
            match polygons.start(u, v) {
                Some((state, field)) => {
                    sink.begin(state.point_nm());
                    sums.in_flight += trace(&mut polygons, state, field, slots, limits, &mut sink).truncated;
                }
                None => sums.lost += V::one(),
            }
        }
        sums.lost += polygons.lost();
    }
}

/// Efficiencies of the coherent sum over all batches, with the standard error that the batches' spread tells.
fn summarise<V: Lanes>(batches: &[Batch<V>], wavelengths: &[f64], rays: f64, found: &mut Vec<Diffracted>) {
    for (place, first) in batches[0].orders.iter().enumerate() {
        let mut whole = *first;
        for batch in &batches[1..] {
            whole.add(&batch.orders[place]);
        }
        let count = batches.len() as f64;
        for (lane, &wavelength_nm) in wavelengths.iter().enumerate() {
            let cos_theta = whole.cos_theta.lane(lane);
            if cos_theta <= 0.0 {
                continue;
            }
            let estimate = |of: &dyn Fn(Polarised<V>) -> V| {
                let value = of(whole.efficiency(rays * count)).lane(lane);
                let batch = |batch: &Batch<V>| of(batch.orders[place].efficiency(rays)).lane(lane);
                let excess = batches.iter().map(batch).sum::<f64>() / count - value;
                MeanWithError::of_square(value, excess, count)
            };
            let direction = whole.wavevector.direction(lane).normalize();
            found.push(Diffracted {
                index: whole.index,
                wavelength_nm,
                direction,
                theta_deg: direction.x.hypot(direction.y).atan2(direction.z).to_degrees(),
                efficiency: Polarised { s: estimate(&|e| e.s), p: estimate(&|e| e.p) },
            });
        }
    }
}
