//! RGL's tensor file (Dupuy and Jakob 2018): Mitsuba 3's `measured`, pbrt-v4, powitacq.
//!
//! Half vectors lie on a unit square: u = sqrt(2 θ_m/π) on the last axis, v = (φ_m + π)/2π, where φ_m counts from φ_i for
//! isotropic tables. `vndf` warps a uniform square onto it, `luminance` refines the warp, and `spectra` (or `rgb`) hold
//! f cos θ_o · 4σ/D on the square before the warp, so that f cos θ_o = spectra · `ndf`/(4 `sigma`). The parameters θ_i, φ_i
//! are the table's incident directions: f counts as reciprocal, since renderers take them as the viewer's.
//!
//! A mirror-like table becomes GGX facets: D, σ and the visible normals are the lobe's own, and what is left is smooth. For
//! tilted facets D = 1, σ = 1/4, and the "visible normals" are the table's own luminance, so that samples follow it.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::Reflection;
use super::reflection::Kind;
use super::warp::Warp;
use crate::error::Result;
use crate::parallel;
use crate::table_file::Table;

/// Samples of D and σ over θ: interpolation of D at α = 0.001 errs by 1e-4.
const FINE: usize = 4096;
/// Values of `spectra`: 256 MiB.
const MOST_VALUES: usize = 1 << 26;
/// Side of the spectra's square; a lobe leaves them smooth, a table has kinks at its bins.
const LOBE_SIDE: usize = 32;
const SCATTER_SIDE: [usize; 2] = [16, 128];
/// `vndf` over (θ_m, φ_m).
const LOBE_NORMALS: [usize; 2] = [256, 64];
const SCATTER_NORMALS: [usize; 2] = [96, 96];
/// Share of a uniform density in the warp: dim directions keep samples of the spectra.
const LOBE_FLOOR: f64 = 0.02;
const SCATTER_FLOOR: f64 = 0.3;
/// Directions at 90° see nothing.
const LAST_DEG: f64 = 89.9;

/// A field of the file.
struct Field {
    name: &'static str,
    shape: Vec<usize>,
    values: Values,
}

enum Values {
    Bytes(Vec<u8>),
    Singles(Vec<f32>),
}

/// The parameters of one slice.
#[derive(Clone, Copy)]
struct Incident {
    theta: f64,
    phi: f64,
    isotropic: bool,
}

impl Incident {
    fn direction(self) -> DVec3 {
        spherical(self.theta, self.phi)
    }

    /// The half vector at a point of the square.
    fn half_vector(self, [u, v]: [f64; 2]) -> DVec3 {
        let origin = if self.isotropic { self.phi } else { 0.0 };
        spherical(u * u * FRAC_PI_2, TAU * v - PI + origin)
    }

    /// |dω_o| over the square's area.
    fn jacobian(self, [u, v]: [f64; 2]) -> f64 {
        let m = self.half_vector([u, v]);
        8.0 * PI * PI * u * (u * u * FRAC_PI_2).sin() * self.direction().dot(m).max(0.0)
    }
}

fn spherical(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

/// f cos θ_o in each channel. Below the horizon, where renderers ask for nothing but interpolate, it goes on as an odd
/// function, which keeps the values just above exact.
fn projected(reflection: &Reflection, wi: DVec3, m: DVec3, out: &mut [f64]) {
    let wo = 2.0 * wi.dot(m) * m - wi;
    let above = DVec3::new(wo.x, wo.y, wo.z.abs().max(1e-6));
    if let Kind::Lobe { ggx, .. } = reflection.kind() {
        reflection.reflectance(wi.dot(m), out);
        let lobe = ggx.density(m.z) * ggx.masking(wi.z, above.z);
        out.iter_mut().for_each(|value| *value *= lobe);
    } else {
        reflection.eval(wi, above, out);
    }
    out.iter_mut().for_each(|value| *value *= above.z.copysign(wo.z));
}

/// The incident directions of the file.
fn axes(reflection: &Reflection) -> (Vec<f64>, Vec<f64>) {
    let (steps, columns) = match reflection.kind() {
        Kind::Lobe { .. } => (64, None),
        // Every row of the table, and three places between two.
        Kind::Scatter(layout) => (4 * layout.theta() as usize, (layout.phi() > 1).then_some(*layout)),
    };
    let theta = (0..=steps).map(|i| (90.0 * i as f64 / steps as f64).min(LAST_DEG).to_radians()).collect();
    let Some(layout) = columns else { return (theta, vec![0.0]) };
    // Lobes turn with the light, but half vectors count from the tangent: two places for each outgoing bin.
    let places = 2 * layout.bins().phi;
    let phi = (0..=places).map(|i| TAU * f64::from(i) / f64::from(places) - PI).collect();
    (theta, phi)
}

/// What one incident direction adds to the file.
struct Slice<'f> {
    normals: &'f mut [f32],
    luminance: &'f mut [f32],
    spectra: &'f mut [f32],
}

/// Fills a slice.
fn fill(reflection: &Reflection, incident: Incident, side: usize, slice: Slice<'_>) {
    let wi = incident.direction();
    let [columns, rows] = normals(reflection);
    let mut values = vec![0.0; reflection.channels];
    let at = |i: usize, count: usize| i as f64 / (count - 1) as f64;
    let mean = |values: &[f64]| (values.iter().sum::<f64>() / values.len() as f64).max(0.0);
    let mut density: Vec<f64> = (0..rows * columns)
        .map(|i| {
            let place = [at(i % columns, columns), at(i / columns, rows)];
            let (m, jacobian) = (incident.half_vector(place), incident.jacobian(place));
            match reflection.kind() {
                Kind::Lobe { ggx, .. } => jacobian * ggx.density(m.z),
                Kind::Scatter(_) => {
                    projected(reflection, wi, m, &mut values);
                    jacobian * mean(&values)
                }
            }
        })
        .collect();
    let floor = if matches!(reflection.kind(), Kind::Lobe { .. }) { LOBE_FLOOR } else { SCATTER_FLOOR };
    let floor = (floor * mean(&density)).max(f64::MIN_POSITIVE);
    density.iter_mut().for_each(|density| *density += floor);
    slice.normals.iter_mut().zip(&density).for_each(|(out, density)| *out = (*density / floor) as f32);

    let warp = Warp::new(&density, columns);
    let area = side * side;
    for i in 0..area {
        let (place, density) = warp.sample([at(i % side, side), at(i / side, side)]);
        let m = incident.half_vector(place);
        projected(reflection, wi, m, &mut values);
        slice.luminance[i] = (mean(&values) * incident.jacobian(place) / density) as f32;
        let scale = match reflection.kind() {
            Kind::Lobe { ggx, .. } => 4.0 * ggx.visible_area(wi.z) / ggx.density(m.z),
            Kind::Scatter(_) => 1.0,
        };
        for (c, value) in values.iter().enumerate() {
            slice.spectra[c * area + i] = (value * scale) as f32;
        }
    }
    // A black direction still needs a density.
    if slice.luminance.iter().all(|value| *value <= 0.0) {
        slice.luminance.fill(1.0);
    }
    let least = 1e-4 * slice.luminance.iter().sum::<f32>() / area as f32;
    slice.luminance.iter_mut().for_each(|value| *value = value.max(least));
}

fn normals(reflection: &Reflection) -> [usize; 2] {
    if matches!(reflection.kind(), Kind::Lobe { .. }) { LOBE_NORMALS } else { SCATTER_NORMALS }
}

/// The bytes of the file.
///
/// # Errors
/// A roughness that is missing or has no use.
pub fn encode(table: &Table, roughness: Option<f64>, rgb: bool) -> Result<Vec<u8>> {
    let reflection = Reflection::new(table, roughness, rgb)?;
    let (theta, phi) = axes(&reflection);
    let (slices, channels) = (theta.len() * phi.len(), reflection.channels);
    let side = match reflection.kind() {
        Kind::Lobe { .. } => LOBE_SIDE,
        Kind::Scatter(_) => {
            let [least, most] = SCATTER_SIDE;
            (MOST_VALUES / (slices * channels)).isqrt().clamp(least, most)
        }
    };
    let [columns, rows] = normals(&reflection);
    let area = side * side;
    let mut vndf = vec![0.0; slices * rows * columns];
    let mut luminance = vec![0.0; slices * area];
    let mut spectra = vec![0.0; slices * channels * area];
    let work = vndf.chunks_mut(rows * columns).zip(luminance.chunks_mut(area)).zip(spectra.chunks_mut(channels * area));
    let work = work.map(|((normals, luminance), spectra)| Slice { normals, luminance, spectra }).enumerate();
    parallel::for_each(
        parallel::available(),
        work,
        || (),
        |(), (i, slice)| {
            let (theta, phi_i) = (theta[i % theta.len()], phi[i / theta.len()]);
            fill(&reflection, Incident { theta, phi: phi_i, isotropic: phi.len() == 1 }, side, slice);
        },
    );
    let (ndf, sigma) = facets(&reflection);
    let singles = |name, shape: Vec<usize>, values| Field { name, shape, values: Values::Singles(values) };
    let narrow = |values: &[f64]| values.iter().map(|x| *x as f32).collect::<Vec<f32>>();
    let description = format!("{}, goniochrome {}", table.name(), env!("CARGO_PKG_VERSION")).into_bytes();
    let grid = [phi.len(), theta.len()];
    let mut fields = vec![
        Field { name: "description", shape: vec![description.len()], values: Values::Bytes(description) },
        Field { name: "jacobian", shape: vec![1], values: Values::Bytes(vec![1]) },
        singles("theta_i", vec![theta.len()], narrow(&theta)),
        singles("phi_i", vec![phi.len()], narrow(&phi)),
        singles("ndf", vec![2, ndf.len() / 2], ndf),
        singles("sigma", vec![2, sigma.len() / 2], sigma),
        singles("vndf", [&grid[..], &[rows, columns]].concat(), vndf),
        singles("luminance", [&grid[..], &[side, side]].concat(), luminance),
        singles(if rgb { "rgb" } else { "spectra" }, [&grid[..], &[channels, side, side]].concat(), spectra),
    ];
    if !rgb {
        let wavelengths = narrow(&reflection.wavelength_nm);
        fields.push(singles("wavelengths", vec![wavelengths.len()], wavelengths));
    }
    Ok(file(&fields))
}

/// D and σ over θ, the same in both rows, since neither depends on φ.
fn facets(reflection: &Reflection) -> (Vec<f32>, Vec<f32>) {
    let Kind::Lobe { ggx, .. } = reflection.kind() else { return (vec![1.0; 4], vec![0.25; 4]) };
    let cos = (0..FINE).map(|i| ((i as f64 / (FINE - 1) as f64).powi(2) * FRAC_PI_2).cos());
    let twice = |row: Vec<f32>| row.repeat(2);
    let density = cos.clone().map(|cos| ggx.density(cos) as f32).collect();
    (twice(density), twice(cos.map(|cos| ggx.visible_area(cos) as f32).collect()))
}

/// Header, table of fields, and each field at a multiple of 8 bytes.
fn file(fields: &[Field]) -> Vec<u8> {
    let mut header = b"tensor_file\0\x01\x00".to_vec();
    header.extend((fields.len() as u32).to_le_bytes());
    let entry = |field: &Field| 2 + field.name.len() + 2 + 1 + 8 + 8 * field.shape.len();
    let mut offset = (header.len() + fields.iter().map(entry).sum::<usize>()).next_multiple_of(8);
    let start = offset;
    for field in fields {
        header.extend((field.name.len() as u16).to_le_bytes());
        header.extend(field.name.as_bytes());
        header.extend((field.shape.len() as u16).to_le_bytes());
        let (kind, length) = match &field.values {
            Values::Bytes(bytes) => (1, bytes.len()),
            Values::Singles(values) => (10, 4 * values.len()),
        };
        header.push(kind);
        header.extend((offset as u64).to_le_bytes());
        field.shape.iter().for_each(|side| header.extend((*side as u64).to_le_bytes()));
        offset += length.next_multiple_of(8);
    }
    header.resize(start, 0);
    for field in fields {
        match &field.values {
            Values::Bytes(bytes) => header.extend(bytes),
            Values::Singles(values) => values.iter().for_each(|value| header.extend(value.to_le_bytes())),
        }
        header.resize(header.len().next_multiple_of(8), 0);
    }
    header
}
