//! Mirror-like tables through a lobe, and diffraction orders of a width: sampled on a grid of the file's own.
//!
//! A mirror-like table becomes GGX facets: D and σ are those of the lobe, and the remaining factor is smooth. For
//! diffraction orders D = 1 and σ = 1/4. The warp only decides where the BRDF is sampled ([`BsdfGrid`]).

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;
use goniochrome::microfacet::Finish;

use super::albedo;
use super::contents::{Contents, OverSquare, raise};
use super::density::Density;
use super::grid::BsdfGrid;
use crate::export::Reflection;
use crate::export::reflection::{Evaluator, ReflectionKind};
use crate::support::direction::direction;
use crate::support::error::Result;
use crate::support::memory::filled;
use crate::support::parallel;

/// Facets of a mirror-like table in a file.
#[derive(Clone, Copy, Debug)]
struct FileFacets<'f> {
    finish: Finish<'f>,
    /// Density that all normals have besides, with energy compensation: light of several bounces over D alone would
    /// have no bound.
    even: f64,
}

impl<'f> FileFacets<'f> {
    /// Facets of a BRDF; `None` if it has none.
    fn of(reflection: &'f Reflection) -> Option<Self> {
        let ReflectionKind::Lobe { finish, .. } = reflection.kind() else { return None };
        let finish = finish.finish();
        let even =
            finish.compensation().map_or(0.0, |compensation| (compensation.mean_loss() / PI).max(f64::MIN_POSITIVE));
        Some(Self { finish, even })
    }

    /// The density by which the file divides f cos θ_o.
    fn density(&self, m: DVec3) -> f64 {
        f64::from(self.finish.density(m.as_vec3())) + self.even
    }
}

/// Computes f cos θ_o in each channel, for facets over their density D at `m`; returns whether wo is above the horizon.
///
/// Renderers do not evaluate directions below the horizon, but interpolate across it. There f cos θ_o is continued
/// without a kink: that of facets as an odd function of cos θ_o, lobes of orders by their formula.
fn projected(
    evaluator: &mut Evaluator<'_>,
    facets: Option<&FileFacets<'_>>,
    wi: DVec3,
    m: DVec3,
    out: &mut [f64],
) -> bool {
    let wo = 2.0 * wi.dot(m) * m - wi;
    if !evaluator.projected_orders(wi, wo, out) {
        let reflection = evaluator.reflection();
        reflection.reflectance(wi.dot(m), out);
        if let (ReflectionKind::Lobe { returned, .. }, Some(facets)) = (reflection.kind(), facets) {
            let raised = wo.with_z(wo.z.abs()).as_vec3();
            let lobe = f64::from(facets.finish.shadowing(wi.as_vec3(), raised)) * wo.z;
            out.iter_mut().for_each(|value| *value *= lobe);
            if let Some(compensation) = facets.finish.compensation() {
                let loss = |w: DVec3| f64::from(compensation.loss(w.z.abs() as f32));
                let (density, multiple) = (facets.density(m), loss(wi) * loss(wo) * wo.z);
                let of_facets = 1.0 - facets.even / density;
                for (value, returned) in out.iter_mut().zip(returned) {
                    *value = *value * of_facets + f64::from(*returned) * multiple / density;
                }
            }
        }
    }
    wo.z > 0.0
}

/// The part of the file that belongs to one incident direction.
struct Slice<'f> {
    luminance: &'f mut [f32],
    spectra: &'f mut [f32],
}

/// Computes the slice of an incident direction.
fn fill(evaluator: &mut Evaluator<'_>, grid: &BsdfGrid, number: usize, slice: Slice<'_>) {
    let column = number / grid.theta.len();
    let [theta, phi] = [grid.theta[number % grid.theta.len()], grid.phi[column]];
    let reflection = evaluator.reflection();
    let wi = direction(theta, phi);
    let origin = if grid.isotropic() { phi } else { 0.0 };
    let mut values = vec![0.0; reflection.channels];
    let area = slice.luminance.len();
    let [across, along] = [&grid.across.nodes, &grid.along[column].nodes];
    // D may be too small for single precision, so that nothing is divided by it.
    let facets = FileFacets::of(reflection);
    let scale = facets.map_or(1.0, |facets| 4.0 * f64::from(facets.finish.visible_area(wi.as_vec3())));
    let places = along.iter().flat_map(|v| across.iter().map(move |u| (*u, *v)));
    for (i, ((u, density_u), (v, density_v))) in places.enumerate() {
        let theta_m = u * u * FRAC_PI_2;
        let m = direction(theta_m, TAU * v - PI + origin);
        let above = projected(evaluator, facets.as_ref(), wi, m, &mut values);
        // |dω_o| per area of the square, up to a constant factor.
        let jacobian = u * theta_m.sin() * wi.dot(m).max(0.0);
        // Of all densities for all channels, the root of the sum of squares has the smallest sum of variances. It is
        // also positive where components of colours out of gamut cancel each other.
        let strength = if above { values.iter().map(|value| value * value).sum::<f64>().sqrt() } else { 0.0 };
        let density = facets.map_or(1.0, |facets| facets.density(m));
        slice.luminance[i] = (strength * density * jacobian / (density_u * density_v)) as f32;
        for (c, value) in values.iter().enumerate() {
            slice.spectra[c * area + i] = (value * scale) as f32;
        }
    }
    if let Some(exact) = evaluator.albedo_of_orders(wi) {
        for (channel, exact) in slice.spectra.chunks_mut(area).zip(exact) {
            albedo::keep(channel, exact, albedo::interpolated([across, along], wi, origin, channel));
        }
    }
    raise(slice.luminance);
}

/// Moves the samples of a smooth function so that interpolation between them is right on
/// average, instead of at the samples: linear interpolation of f errs by f″h²/12 on average over a step h, along each
/// axis. The largest errors become a quarter of what they were.
fn balance(samples: &mut [f32], grid: &BsdfGrid, channels: usize) -> Result<()> {
    let mut exact = filled(0.0, samples.len(), "the .bsdf file")?;
    exact.copy_from_slice(samples);
    let (side, theta, phi) = (grid.side(), &grid.theta, &grid.phi);
    let (area, last) = (side * side, side - 1);
    // Places of a sample's neighbours: half of f″h² of two steps of different length.
    let bend = |[before, at, after]: [usize; 3], [step, next]: [f64; 2]| {
        let [before, at, after] = [before, at, after].map(|place| f64::from(exact[place]));
        ((after - at) / next - (at - before) / step) * (step * step + next * next) / (step + next)
    };
    let work = samples.chunks_mut(area).enumerate();
    let fill = |(plane, samples): (usize, &mut [f32])| {
        let (row, column) = (plane / channels % theta.len(), plane / channels / theta.len());
        for (place, sample) in samples.iter_mut().enumerate() {
            let (u, v, at) = (place % side, place / side, plane * area + place);
            let mut sum = 0.0;
            if u > 0 && u < last {
                sum += bend([at - 1, at, at + 1], [1.0; 2]);
            }
            // v is periodic: its last row repeats the first. Where half vectors turn with the light, nodes end there.
            if grid.isotropic() || (v > 0 && v < last) {
                let [before, after] = [if v == 0 { last - 1 } else { v - 1 }, if v == last { 1 } else { v + 1 }];
                sum += bend([before, v, after].map(|v| plane * area + v * side + u), [1.0; 2]);
            }
            if row > 0 && row + 1 < theta.len() {
                let steps = [theta[row] - theta[row - 1], theta[row + 1] - theta[row]];
                sum += bend([at - channels * area, at, at + channels * area], steps);
            }
            if column > 0 && column + 1 < phi.len() {
                let turn = theta.len() * channels * area;
                sum += bend([at - turn, at, at + turn], [phi[column] - phi[column - 1]; 2]);
            }
            // Light does not become negative.
            let least = if *sample < 0.0 { f32::NEG_INFINITY } else { 0.0 };
            *sample = ((f64::from(*sample) - sum / 12.0) as f32).max(least);
        }
    };
    parallel::for_each(parallel::available(), work, || (), |(), item| fill(item));
    Ok(())
}

/// The file's numbers of a mirror-like table or of diffraction orders.
///
/// # Errors
/// Too little memory.
pub(super) fn contents(reflection: &Reflection, grid: BsdfGrid) -> Result<Contents> {
    let (slices, channels, side) = (grid.slices(), reflection.channels, grid.side());
    let area = side * side;
    let mut luminance = filled(0.0, slices * area, "the .bsdf file")?;
    let mut spectra = filled(0.0, slices * channels * area, "the .bsdf file")?;
    let work = luminance.chunks_mut(area).zip(spectra.chunks_mut(channels * area));
    let work = work.map(|(luminance, spectra)| Slice { luminance, spectra }).enumerate();
    parallel::for_each(
        parallel::available(),
        work,
        || reflection.evaluator(),
        |evaluator, (i, slice)| {
            fill(evaluator, &grid, i, slice);
        },
    );
    if let ReflectionKind::Lobe { .. } = reflection.kind() {
        balance(&mut spectra, &grid, channels)?;
    }
    let (density_of_facets, visible_area) = match FileFacets::of(reflection) {
        Some(facets) => {
            let finish = facets.finish;
            let density = |theta, phi| facets.density(direction(theta, phi));
            let visible_area = |theta, phi| finish.visible_area(direction(theta, phi).as_vec3()).into();
            match finish.alpha() {
                Some(alpha) if !grid.isotropic() => {
                    let alpha = alpha.map(f64::from);
                    (OverSquare::of_facets(alpha, density), OverSquare::of_facets(alpha, visible_area))
                }
                _ => {
                    let at_x = |of: &dyn Fn(f64, f64) -> f64| OverSquare::isotropic(|theta| of(theta, 0.0));
                    (at_x(&density), at_x(&visible_area))
                }
            }
        }
        None => (OverSquare::isotropic(|_| 1.0), OverSquare::isotropic(|_| 0.25)),
    };
    let singles = |density: &Density| density.0.iter().map(|d| *d as f32).collect::<Vec<_>>();
    let across = singles(&grid.across.density);
    let along = grid.along.iter().map(|axis| singles(&axis.density)).collect();
    let (theta, phi) = (grid.theta, grid.phi);
    Ok(Contents { theta, phi, across, along, side, luminance, values: spectra, density_of_facets, visible_area })
}
