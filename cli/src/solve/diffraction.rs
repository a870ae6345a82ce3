//! Diffraction orders of cells of polygons: starting rays over the period make one coherent field.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::measure::orders::{Order, Orders, max_order};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::Lanes;
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, free_slot};
use goniochrome::trace::sobol::sobol;
use goniochrome::trace::waves::{Limits, Slot, trace};

use crate::solve::batches::{BATCHES, rays_per_batch, sequence};
use crate::solve::groups::Groups;
use crate::solve::mesh_scene::MeshScene;
use crate::solve::precision::{Precision, in_lanes};
use crate::solve::truncation::{MAX_TRUNCATED, refuse_divergence, refuse_truncation};
use crate::solve::wave_limits::slots_without_fallback;
use crate::support::error::{Error, Result};
use crate::support::memory::expect_list;
use crate::support::parallel;
use crate::table::statistics::MeanWithError;

/// A request for diffraction orders.
#[derive(Clone, Copy, Debug)]
pub struct OrdersRequest {
    /// Starting rays over the period.
    pub rays: u32,
    /// Seed of the scrambled Sobol sequence.
    pub seed: u32,
    /// Largest |m| and |n|; `None` for all orders that propagate.
    pub max_order: Option<i32>,
    /// Hits after which rays are dropped: 1 is single scattering.
    pub hits: u32,
    /// Single or double precision.
    pub precision: Precision,
    /// Worker threads; the result does not depend on it.
    pub threads: usize,
}

/// A diffraction order at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diffracted {
    /// The order (m, n).
    pub index: [i32; 2],
    /// Vacuum wavelength.
    pub wavelength_nm: f64,
    /// Unit vector in which the order leaves.
    pub direction: DVec3,
    /// Angle between the direction and the normal.
    pub theta_deg: f64,
    /// Efficiency for s and p light.
    pub efficiency: Polarised<MeanWithError>,
}

/// Light that the orders of one wavelength leave out, as a fraction of the incident power, unpolarised.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Light of rays that hit nothing, left through a hole, or found no free slot.
    pub lost: f64,
    /// Light still in flight to a further facet after the last hit.
    pub in_flight: f64,
}

impl LeftOut {
    /// The error bar. Light that single scattering leaves out by definition does not count.
    #[must_use]
    pub fn truncated(&self, hits: u32) -> f64 {
        self.lost + if hits == SINGLE_SCATTERING { 0.0 } else { self.in_flight }
    }
}

/// The reflected orders for light from one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Diffraction {
    /// Orders sorted by index, then by wavelength.
    pub orders: Vec<Diffracted>,
    /// Light left out at each wavelength.
    pub left_out: Vec<LeftOut>,
}

impl Diffraction {
    /// The largest of a quantity over wavelengths.
    #[must_use]
    pub fn worst(&self, of: impl Fn(&LeftOut) -> f64) -> f64 {
        self.left_out.iter().map(of).fold(0.0, f64::max)
    }

    /// A warning where single scattering leaves out more light than a result may hide.
    #[must_use]
    pub fn single_scattering_warning(&self, hits: u32) -> Option<String> {
        let share = self.worst(|left_out| left_out.in_flight);
        (hits == SINGLE_SCATTERING && share > MAX_TRUNCATED)
            .then(|| format!("single scattering: {share:.1e} of the light meets the surface again and is left out"))
    }
}

/// The number of [`OrdersRequest::hits`] that means single scattering.
const SINGLE_SCATTERING: u32 = 1;

/// The default number of hits for a scene. Physical optics of one rough surface holds for single scattering: its facets
/// are often narrower than a wavelength, and between them light does not travel as rays. Layers need their bounces.
#[must_use]
pub fn default_hits(mesh_scene: &MeshScene<'_>) -> u32 {
    const LAYERED: u32 = 64;
    if mesh_scene.interface_count() == 1 { SINGLE_SCATTERING } else { LAYERED }
}

/// The largest number of orders that are computed; a period of 20 µm has some thousands.
const MAX_ORDERS: usize = 16_384;
/// The power below which waves in flight are dropped.
const MIN_IN_FLIGHT: f64 = 1e-10;

/// The reflected orders that propagate, for light from the unit direction `wi`. `progress` is called after each batch
/// of each [group](crate::solve::groups::group_count) of wavelengths.
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
    in_lanes!(request.precision, V => run::<V>(mesh_scene, wi, wavelength_nm, request, progress))
}

fn run<V: RayLanes<Light = V>>(
    mesh_scene: &MeshScene<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    request: &OrdersRequest,
    progress: &(dyn Fn() + Sync),
) -> Result<Diffraction> {
    let mut buffer = mesh_scene.buffer();
    let cell = mesh_scene.cell(&mut buffer)?;
    let mut groups = Groups::<V>::new(mesh_scene.scene(), wavelength_nm);
    let groups = groups.evaluate(mesh_scene.scene(), cell.above(), wavelength_nm)?;
    let mut found = Diffraction { orders: Vec::new(), left_out: Vec::new() };
    for (media, wavelengths) in &groups {
        let light = OrderLight { cell, media: *media, wavelengths, wi, slots: slots_without_fallback(mesh_scene) };
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

/// Light from one direction at one group of wavelengths.
struct OrderLight<'l, V: RayLanes<Light = V>> {
    cell: MeshCell<'l>,
    media: MediaLanes<'l, V>,
    wavelengths: &'l [f64],
    wi: DVec3,
    /// Slots in which waves wait to merge.
    slots: usize,
}

/// Sums over the starting rays of one batch.
struct OrderSums<V: RayLanes<Light = V>> {
    orders: Vec<Order<V>>,
    lost: V,
    in_flight: V,
}

impl<V: RayLanes<Light = V>> OrderLight<'_, V> {
    /// Traces all batches and adds their orders to `found`.
    fn add(&self, request: &OrdersRequest, progress: &(dyn Fn() + Sync), found: &mut Diffraction) -> Result<()> {
        let blank = self.blank(request)?;
        expect_list::<Order<V>>(&[blank.len(), BATCHES as usize], "all orders that travel")?;
        let rays = rays_per_batch(request.rays);
        let batch = |_| OrderSums { orders: blank.clone(), lost: V::zero(), in_flight: V::zero() };
        let mut batches: Vec<OrderSums<V>> = (0..BATCHES).map(batch).collect();
        parallel::for_each(
            request.threads,
            batches.iter_mut().zip(0u32..),
            || vec![free_slot::<V>(); self.slots],
            |slots, (sums, batch)| {
                self.trace(request, rays, batch, slots, sums);
                progress();
            },
        );
        let rays = f64::from(rays);
        found.left_out.extend((0..self.wavelengths.len()).map(|lane| {
            let mean = |of: fn(&OrderSums<V>) -> V| {
                batches.iter().map(|batch| of(batch).lane(lane)).sum::<f64>() / (rays * batches.len() as f64)
            };
            LeftOut { lost: mean(|batch| batch.lost), in_flight: mean(|batch| batch.in_flight) }
        }));
        summarise(&batches, self.wavelengths, rays, &mut found.orders);
        Ok(())
    }

    /// The orders that propagate at some of the wavelengths, still without light.
    fn blank(&self, request: &OrdersRequest) -> Result<Vec<Order<V>>> {
        let eta = self.eta();
        let shortest = self.wavelengths.iter().copied().fold(f64::INFINITY, f64::min);
        let max = self.cell.period_nm().map(|period| {
            let all = max_order(period, eta.re.lane(0), shortest);
            request.max_order.map_or(all, |limit| limit.min(all))
        });
        let mut blank = Vec::new();
        for m in -max[0]..=max[0] {
            for n in -max[1]..=max[1] {
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

    /// The index of the medium that light arrives in.
    fn eta(&self) -> ComplexLanes<V::Precise> {
        self.media.eta()[usize::from(self.cell.above())]
    }

    /// Traces the starting rays of one batch.
    fn trace(
        &self,
        request: &OrdersRequest,
        rays: u32,
        batch: u32,
        slots: &mut [Slot<WaveState<V>, WaveField<V>>],
        sums: &mut OrderSums<V>,
    ) {
        let mut coherent = CoherentMesh::new(self.cell, self.media, IncidentWave::new(self.wi, self.eta()));
        let mut sink = Orders::new(&mut sums.orders, self.wi, self.eta(), &self.media);
        let limits = Limits { in_flight: MIN_IN_FLIGHT, generations: request.hits };
        for ray in 0..rays {
            let [u, v] = sobol(ray, sequence(request.seed, batch));
            match coherent.start(u, v) {
                Some((state, field)) => {
                    sink.begin(state.point_nm());
                    sums.in_flight += trace(&mut coherent, state, field, slots, limits, &mut sink).truncated;
                }
                None => sums.lost += V::one(),
            }
        }
        sums.lost += coherent.lost();
    }
}

/// Adds to `found` the efficiencies of the coherent sum over all batches, with standard errors from the spread of the
/// batches.
fn summarise<V: RayLanes<Light = V>>(
    batches: &[OrderSums<V>],
    wavelengths: &[f64],
    rays: f64,
    found: &mut Vec<Diffracted>,
) {
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
                let batch = |batch: &OrderSums<V>| of(batch.orders[place].efficiency(rays)).lane(lane);
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
