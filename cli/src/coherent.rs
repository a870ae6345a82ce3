//! The two coherences in which starting rays interfere with each other: `bin`, the paper's section 2.2 taken literally, and
//! `cell`, diffraction orders collected into bins. Both compute in double precision.

use glam::DVec3;
use goniochrome::bins::BinFields;
use goniochrome::complex::Polarised;
use goniochrome::lanes::{F64, Lanes};
use goniochrome::polygons::{Field, Incident, Polygons, free_slot};
use goniochrome::sampling::sobol;
use goniochrome::trace::trace;
use goniochrome::vector::VectorLanes;

use crate::bumpy::Bumpy;
use crate::diffraction::{self, orders};
use crate::error::Result;
use crate::groups::Groups;
use crate::parallel;
use crate::scatter::{BATCHES, Estimate, Request, Scattered, WAVES, refuse_divergence, states};

/// Sums over the starting rays of one batch.
#[derive(Clone)]
struct Batch {
    fields: Vec<Field<F64>>,
    truncated: f64,
    absorbed: f64,
}

/// Light from `wi` at one wavelength, with coherence `bin`.
///
/// # Errors
/// As [`crate::scatter::scatter`].
pub fn scatter_bins(bumpy: &Bumpy<'_>, wi: DVec3, wavelength_nm: f64, request: &Request) -> Result<Scattered> {
    let mut buffer = bumpy.buffer();
    let cell = bumpy.cell(&mut buffer)?;
    let media = bumpy.media();
    let wavelengths = [wavelength_nm];
    let mut groups = Groups::<F64>::new(media.len(), &wavelengths);
    let groups = groups
        .evaluate(&media, cell.above(), &wavelengths)
        .map_err(|(index, error)| bumpy.medium_error(index, &error))?;
    let (media, _) = groups[0];
    let incident = Incident::new(wi, media.eta()[usize::from(cell.above())]);
    let rays = (request.rays / BATCHES).max(1);

    let nothing: Field<F64> = Polarised::both(VectorLanes::zero());
    let fields = vec![nothing; BinFields::<F64>::required_len(request.bins)];
    let mut batches = vec![Batch { fields, truncated: 0.0, absorbed: 0.0 }; BATCHES as usize];
    parallel::for_each(
        request.threads,
        batches.iter_mut().zip(0u32..),
        || vec![free_slot::<F64>(); states(bumpy)],
        |slots, (Batch { fields, truncated, absorbed }, batch)| {
            let mut polygons = Polygons::new(cell, media, incident);
            let mut sink = BinFields::new(fields, request.bins, &media, incident.wavevector());
            let mut dropped = F64::zero();
            for ray in 0..rays {
                let [u, v] = sobol(ray, request.seed.wrapping_mul(BATCHES).wrapping_add(batch));
                match polygons.start(u, v) {
                    Some((state, field)) => {
                        sink.begin(state.point_nm());
                        dropped += trace(&mut polygons, state, field, slots, WAVES, &mut sink).truncated;
                    }
                    None => dropped += F64::one(),
                }
            }
            *truncated = Lanes::lane(dropped + polygons.lost(), 0) / f64::from(rays);
            let Polarised { s, p } = polygons.absorbed();
            *absorbed = 0.5 * Lanes::lane(s + p, 0) / f64::from(rays);
        },
    );

    // Unpolarised power of a sum of fields over a number of starting rays.
    let power =
        |field: &Field<F64>, rays: f64| 0.5 * Lanes::lane(field.s.norm_sqr() + field.p.norm_sqr(), 0) / (rays * rays);
    let count = f64::from(BATCHES);
    let bin = |place: usize| {
        let whole = batches.iter().fold(nothing, |sum, batch| sum.zip(batch.fields[place], |a, b| a + b));
        let value = power(&whole, f64::from(rays) * count);
        let each = batches.iter().map(|batch| power(&batch.fields[place], f64::from(rays)));
        let excess = each.sum::<f64>() / count - value;
        Estimate::of_square(value, excess, count)
    };
    let half = request.bins.count();
    let bins: Vec<Estimate> = (0..half).map(bin).collect();
    let mean = |of: fn(&Batch) -> f64| Estimate { value: batches.iter().map(of).sum::<f64>() / count, std_error: 0.0 };
    let reflected = total(bins.iter().copied());
    let transmitted = total((half..2 * half).map(bin));
    let (truncated, absorbed) = (mean(|batch| batch.truncated), mean(|batch| batch.absorbed));
    let imbalance = rest(reflected, transmitted, absorbed, truncated);
    let without_interference = Estimate::default();
    let found = Scattered { reflected, transmitted, absorbed, truncated, imbalance, without_interference, bins };
    refuse_divergence(bumpy, &found)?;
    Ok(found)
}

/// Light from `wi` at one wavelength, with coherence `cell`: reflected orders, each in the bin of its direction. Transmitted
/// orders are not computed: what is not reflected is left as imbalance.
///
/// # Errors
/// As [`orders`].
pub fn scatter_orders(
    bumpy: &Bumpy<'_>,
    wi: DVec3,
    wavelength_nm: f64,
    request: &Request,
    hits: u32,
) -> Result<Scattered> {
    let how =
        diffraction::Request { rays: request.rays, seed: request.seed, most: None, hits, threads: request.threads };
    let found = orders(bumpy, wi, &[wavelength_nm], &how)?;
    let mut bins = vec![Estimate::default(); request.bins.count()];
    for order in &found {
        let bin = &mut bins[request.bins.index(order.direction)];
        let (s, p) = (order.efficiency.s, order.efficiency.p);
        bin.value += 0.5 * (s.value + p.value);
        bin.std_error = bin.std_error.hypot(0.5 * s.std_error.hypot(p.std_error));
    }
    let reflected = total(bins.iter().copied());
    let none = Estimate::default();
    let imbalance = rest(reflected, none, none, none);
    Ok(Scattered {
        reflected,
        transmitted: none,
        absorbed: none,
        truncated: none,
        imbalance,
        without_interference: none,
        bins,
    })
}

/// The sum of independent estimates.
fn total(parts: impl Iterator<Item = Estimate>) -> Estimate {
    parts.fold(Estimate::default(), |sum, part| Estimate {
        value: sum.value + part.value,
        std_error: sum.std_error.hypot(part.std_error),
    })
}

/// What is missing from 1.
fn rest(reflected: Estimate, transmitted: Estimate, absorbed: Estimate, truncated: Estimate) -> Estimate {
    let all = total([reflected, transmitted, absorbed, truncated].into_iter());
    Estimate { value: 1.0 - all.value, std_error: all.std_error }
}
