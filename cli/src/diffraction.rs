//! Diffraction orders of polygon cells: starting rays over the period as one coherent field.

use glam::DVec3;
use goniochrome::complex::Polarised;
use goniochrome::lanes::{F64, Lanes};
use goniochrome::medium::MediaLanes;
use goniochrome::mesh::MeshCell;
use goniochrome::orders::{Order, Orders, largest_order};
use goniochrome::polygons::{Incident, Polygons, free_slot};
use goniochrome::sampling::sobol;
use goniochrome::trace::{Limits, trace};

use crate::bumpy::Bumpy;
use crate::error::{Error, Result};
use crate::groups::Groups;
use crate::parallel;
use crate::scatter::{BATCHES, Estimate, states};

/// What to compute.
#[derive(Clone, Copy, Debug)]
pub struct Request {
    /// Starting rays over the period.
    pub rays: u32,
    /// Of the scrambled sequence.
    pub seed: u32,
    /// Largest |m| and |n|; `None` for all that travel.
    pub most: Option<i32>,
    /// Hits after which rays are dropped: 1 is single scattering.
    pub hits: u32,
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
    pub efficiency: Polarised<Estimate>,
}

/// Hits for a scene: physical optics of one rough surface holds for single scattering, since between its facets, often
/// narrower than a wavelength, light does not travel as rays. Layers need their bounces.
#[must_use]
pub fn default_hits(bumpy: &Bumpy<'_>) -> u32 {
    const LAYERED: u32 = 64;
    if bumpy.interface_count() == 1 { 1 } else { LAYERED }
}

/// A warning where physical optics is asked for too much: periods of under 5 wavelengths, whose features are no wider than one
/// or two. Gratings of 7.7 wavelengths still agree with rigorous solvers, a compact disc's 2.5 to 3.6 do not.
#[must_use]
pub fn unreliable(bumpy: &Bumpy<'_>, wavelength_nm: &[f64]) -> Option<String> {
    const FEWEST_WAVELENGTHS: f64 = 5.0;
    let period = bumpy.structured_period_nm();
    let longest = wavelength_nm.iter().copied().fold(0.0, f64::max);
    (period < FEWEST_WAVELENGTHS * longest).then(|| {
        format!(
            "{}: a period of {period} nm is less than {FEWEST_WAVELENGTHS} wavelengths of {longest} nm; directions are exact, but \
             efficiencies are unreliable, off by up to 0.2",
            bumpy.scene().name
        )
    })
}

/// Orders that are computed at most; a period of 20 µm has some thousands.
const MOST_ORDERS: usize = 16_384;
/// Waves in flight below this power are dropped.
const IN_FLIGHT: f64 = 1e-10;

/// The reflected orders that travel, of light from the unit direction `wi`.
///
/// # Errors
/// A mesh that the core refuses, a medium without data at a wavelength, more orders than are computed.
pub fn orders(bumpy: &Bumpy<'_>, wi: DVec3, wavelength_nm: &[f64], request: &Request) -> Result<Vec<Diffracted>> {
    let mut buffer = bumpy.buffer();
    let cell = bumpy.cell(&mut buffer)?;
    let media = bumpy.media();
    let mut groups = Groups::<F64>::new(media.len(), wavelength_nm);
    let groups = groups
        .evaluate(&media, cell.above(), wavelength_nm)
        .map_err(|(index, error)| bumpy.medium_error(index, &error))?;
    let mut found = Vec::new();
    for (group, wavelengths) in &groups {
        found.extend(group_orders(cell, states(bumpy), group, wi, wavelengths, request)?);
    }
    found.sort_by_key(|order: &Diffracted| order.index);
    Ok(found)
}

fn group_orders(
    cell: MeshCell<'_>,
    states: usize,
    media: &MediaLanes<'_, F64>,
    wi: DVec3,
    wavelengths: &[f64],
    request: &Request,
) -> Result<Vec<Diffracted>> {
    let eta = media.eta()[usize::from(cell.above())];
    let shortest = wavelengths.iter().copied().fold(f64::INFINITY, f64::min);
    let most = cell.period_nm().map(|period| {
        let all = largest_order(period, Lanes::lane(eta.re, 0), shortest);
        request.most.map_or(all, |most| most.min(all))
    });
    let mut blank = Vec::new();
    for m in -most[0]..=most[0] {
        for n in -most[1]..=most[1] {
            let order = Order::<F64>::new([m, n], wi, cell.period_nm(), eta, media);
            if order.cos_theta.any_above(0.0) {
                if blank.len() == MOST_ORDERS {
                    return Err(Error::failed(format_args!(
                        "more than {MOST_ORDERS} orders travel at {shortest} nm; give --most-order"
                    )));
                }
                blank.push(order);
            }
        }
    }

    let rays = (request.rays / BATCHES).max(1);
    let mut batches: Vec<Vec<Order<F64>>> = vec![blank; BATCHES as usize];
    parallel::for_each(
        request.threads,
        batches.iter_mut().zip(0u32..),
        || vec![free_slot::<F64>(); states],
        |slots, (orders, batch)| {
            let mut polygons = Polygons::new(cell, *media, Incident::new(wi, eta));
            let mut sink = Orders::new(orders, wi, eta, media);
            for ray in 0..rays {
                let [u, v] = sobol(ray, request.seed.wrapping_mul(BATCHES).wrapping_add(batch));
                if let Some((state, field)) = polygons.start(u, v) {
                    sink.begin(state.point_nm());
                    let limits = Limits { in_flight: IN_FLIGHT, generations: request.hits };
                    trace(&mut polygons, state, field, slots, limits, &mut sink);
                }
            }
        },
    );
    Ok(summarise(&batches, wavelengths, f64::from(rays)))
}

/// Efficiencies of the coherent sum over all batches, with the standard error that the batches' spread tells.
fn summarise(batches: &[Vec<Order<F64>>], wavelengths: &[f64], rays: f64) -> Vec<Diffracted> {
    let mut found = Vec::new();
    for (place, first) in batches[0].iter().enumerate() {
        let mut whole = *first;
        for batch in &batches[1..] {
            whole.add(&batch[place]);
        }
        let count = batches.len() as f64;
        for (lane, &wavelength_nm) in wavelengths.iter().enumerate() {
            let cos_theta = Lanes::lane(whole.cos_theta, lane);
            if cos_theta <= 0.0 {
                continue;
            }
            let estimate = |of: &dyn Fn(Polarised<F64>) -> F64| {
                let value = Lanes::lane(of(whole.efficiency(rays * count)), lane);
                let batch = |order: &Vec<Order<F64>>| Lanes::lane(of(order[place].efficiency(rays)), lane);
                let excess = batches.iter().map(batch).sum::<f64>() / count - value;
                Estimate::of_square(value, excess, count)
            };
            found.push(Diffracted {
                index: whole.index,
                wavelength_nm,
                direction: whole.wavevector.direction(lane).normalize(),
                theta_deg: cos_theta.min(1.0).acos().to_degrees(),
                efficiency: Polarised { s: estimate(&|e| e.s), p: estimate(&|e| e.p) },
            });
        }
    }
    found
}
