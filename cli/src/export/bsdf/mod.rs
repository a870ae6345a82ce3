//! RGL's tensor file (Dupuy and Jakob 2018), which Mitsuba 3 (`measured`), pbrt-v4 and powitacq read.
//!
//! Half vectors lie on a unit square: u = sqrt(2 θ_m/π) on the last axis and v = (φ_m + π)/2π, where φ_m counts from
//! φ_i for isotropic tables. `vndf` warps a uniform square onto it, and `luminance` refines the warp. `spectra` (or
//! `rgb`) holds f cos θ_o · 4σ/D on the square before the warp, so that f cos θ_o = spectra · `ndf`/(4 `sigma`). The
//! parameters θ_i, φ_i are the table's incident directions; f is taken as reciprocal, since renderers take them as the
//! viewer's.
//!
//! A mirror-like table becomes GGX facets: D and σ are those of the lobe, and the remaining factor is smooth. For
//! tilted facets and diffraction orders D = 1 and σ = 1/4. The warp only decides where the BRDF is sampled ([`grid`]);
//! `luminance` alone makes samples follow the BRDF.

pub mod density;
pub mod grid;
pub mod tensor;
mod albedo;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use self::grid::BsdfGrid;
use self::tensor::{Field, Values};
use super::Reflection;
use super::reflection::{Evaluator, LobeWidth, ReflectionKind};
use crate::support::direction::direction;
use crate::support::error::Result;
use crate::support::memory::filled;
use crate::support::parallel;
use crate::table::Table;

/// Number of samples of D and σ over u: interpolation of D at α = 0.001 errs by 1e-4.
const FACET_SAMPLES: usize = 4096;
/// Smallest density of samples over its mean, so that samples reach every place where interpolation leaves reflection.
const MIN_LUMINANCE: f32 = 1e-4;
/// Depth below the horizon, over cos θ_i, to which a lobe is continued by its own formula, which is infinite at 1.
const MAX_EXTENSION: f64 = 0.5;

/// Computes f cos θ_o in each channel; returns whether wo is above the horizon.
///
/// Renderers do not evaluate directions below the horizon, but interpolate across it. There f cos θ_o is continued
/// without a kink: lobes by their formulas, a table, which is constant next to the horizon, as an odd function.
fn projected(evaluator: &mut Evaluator<'_>, wi: DVec3, m: DVec3, out: &mut [f64]) -> bool {
    let wo = 2.0 * wi.dot(m) * m - wi;
    if evaluator.projected_orders(wi, wo, out) {
        return wo.z > 0.0;
    }
    let cos = if let ReflectionKind::Lobe { ggx, .. } = evaluator.reflection().kind() {
        let cos = wo.z.max(-MAX_EXTENSION * wi.z);
        evaluator.reflection().reflectance(wi.dot(m), out);
        let lobe = ggx.density(m.z) * ggx.masking(wi.z, cos);
        out.iter_mut().for_each(|value| *value *= lobe);
        cos
    } else {
        let above = wo.z.abs().max(1e-6);
        evaluator.eval(wi, DVec3::new(wo.x, wo.y, above), out);
        above.copysign(wo.z)
    };
    out.iter_mut().for_each(|value| *value *= cos);
    wo.z > 0.0
}

/// The part of the file that belongs to one incident direction.
struct Slice<'f> {
    luminance: &'f mut [f32],
    spectra: &'f mut [f32],
}

/// Computes the slice of an incident direction.
fn fill(evaluator: &mut Evaluator<'_>, grid: &BsdfGrid, [theta, phi]: [f64; 2], slice: Slice<'_>) {
    let reflection = evaluator.reflection();
    let wi = direction(theta, phi);
    let origin = if grid.isotropic() { phi } else { 0.0 };
    let mut values = vec![0.0; reflection.channels];
    let area = slice.luminance.len();
    let [across, along] = &grid.nodes;
    let places = along.iter().flat_map(|v| across.iter().map(move |u| (*u, *v)));
    for (i, ((u, density_u), (v, density_v))) in places.enumerate() {
        let theta_m = u * u * FRAC_PI_2;
        let m = direction(theta_m, TAU * v - PI + origin);
        let above = projected(evaluator, wi, m, &mut values);
        // |dω_o| per area of the square, up to a constant factor.
        let jacobian = u * theta_m.sin() * wi.dot(m).max(0.0);
        // Of all densities for all channels, the root of the sum of squares has the smallest sum of variances. It is
        // also positive where components of colours out of gamut cancel each other.
        let strength = if above { values.iter().map(|value| value * value).sum::<f64>().sqrt() } else { 0.0 };
        slice.luminance[i] = (strength * jacobian / (density_u * density_v)) as f32;
        let scale = match reflection.kind() {
            ReflectionKind::Lobe { ggx, .. } => 4.0 * ggx.visible_area(wi.z) / ggx.density(m.z),
            ReflectionKind::Scatter(_) | ReflectionKind::Orders(_) => 1.0,
        };
        for (c, value) in values.iter().enumerate() {
            slice.spectra[c * area + i] = (value * scale) as f32;
        }
    }
    let exact = match reflection.kind() {
        ReflectionKind::Lobe { .. } => None,
        ReflectionKind::Scatter(_) => None,
        ReflectionKind::Orders(_) => evaluator.albedo_of_orders(wi).map(|exact| (exact, albedo::MAX_SCALE_OF_ORDERS)),
    };
    if let Some((exact, limit)) = exact {
        for (channel, exact) in slice.spectra.chunks_mut(area).zip(exact) {
            albedo::keep(channel, exact, albedo::interpolated(grid, wi, origin, channel), limit);
        }
    }
    let mean = slice.luminance.iter().sum::<f32>() / area as f32;
    // A black direction still needs a density.
    let min = if mean > 0.0 { MIN_LUMINANCE * mean } else { 1.0 };
    slice.luminance.iter_mut().for_each(|value| *value = value.max(min));
}

/// The bytes of the tensor file of a table, with its wavelengths or, with `rgb`, its colours.
///
/// # Errors
/// A width that is missing or has no use, RGB of a table without colours, or too little memory.
pub fn encode(table: &Table, width: LobeWidth, rgb: bool) -> Result<Vec<u8>> {
    let reflection = Reflection::new(table, width, rgb)?;
    let grid = BsdfGrid::new(&reflection);
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
            let incident = [grid.theta[i % grid.theta.len()], grid.phi[i / grid.theta.len()]];
            fill(evaluator, &grid, incident, slice);
        },
    );
    let (ndf, sigma) = facets(&reflection);
    let (warp, columns) = grid.warp();
    let singles = |name, shape: Vec<usize>, values| Field { name, shape, values: Values::Singles(values) };
    let narrow = |values: &[f64]| values.iter().map(|x| *x as f32).collect::<Vec<f32>>();
    let description = format!("{}, goniochrome {}", table.name(), env!("CARGO_PKG_VERSION")).into_bytes();
    let directions = [grid.phi.len(), grid.theta.len()];
    let shape = |rest: &[usize]| [&directions[..], rest].concat();
    let mut fields = vec![
        Field { name: "description", shape: vec![description.len()], values: Values::Bytes(description) },
        Field { name: "jacobian", shape: vec![1], values: Values::Bytes(vec![1]) },
        singles("theta_i", vec![grid.theta.len()], narrow(&grid.theta)),
        singles("phi_i", vec![grid.phi.len()], narrow(&grid.phi)),
        singles("ndf", vec![2, ndf.len() / 2], ndf),
        singles("sigma", vec![2, sigma.len() / 2], sigma),
        singles("vndf", shape(&[warp.len() / columns, columns]), warp.repeat(slices)),
        singles("luminance", shape(&[side, side]), luminance),
        singles(if rgb { "rgb" } else { "spectra" }, shape(&[channels, side, side]), spectra),
    ];
    if !rgb {
        let wavelengths = narrow(&reflection.wavelength_nm);
        fields.push(singles("wavelengths", vec![wavelengths.len()], wavelengths));
    }
    Ok(tensor::encode(&fields))
}

/// D and σ over θ. Both rows of each are equal, since neither depends on φ.
fn facets(reflection: &Reflection) -> (Vec<f32>, Vec<f32>) {
    let ReflectionKind::Lobe { ggx, .. } = reflection.kind() else { return (vec![1.0; 4], vec![0.25; 4]) };
    let cos = (0..FACET_SAMPLES).map(|i| ((i as f64 / (FACET_SAMPLES - 1) as f64).powi(2) * FRAC_PI_2).cos());
    let twice = |row: Vec<f32>| row.repeat(2);
    let density = cos.clone().map(|cos| ggx.density(cos) as f32).collect();
    (twice(density), twice(cos.map(|cos| ggx.visible_area(cos) as f32).collect()))
}
