//! The format of the MERL BRDF database (Matusik et al. 2003): RGB of an isotropic BRDF over half and difference
//! angles.
//!
//! The file holds three 32-bit sizes 90, 90, 180 and three planes of 64-bit numbers, R, G, B, all little endian: 34 992
//! 012 bytes. The place of a value is φ_d + 180 (θ_d + 90 θ_h), with θ_h in bins of sqrt(θ_h), and φ_d in [0, π) since
//! f is taken as reciprocal. A value is f over the scale of its channel, taken at the middle of its bin in the bin's
//! own coordinates, or at the horizon where only part of the bin lies above it. Negative components (out of gamut) and
//! pairs below the horizon are 0.

use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

use glam::DVec3;

use super::Reflection;
use super::reflection::{Evaluator, LobeWidth, ReflectionKind};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::Table;

const THETA_H: usize = 90;
const THETA_D: usize = 90;
const PHI_D: usize = 180;
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Smallest cosine at which the BRDF is evaluated.
const MIN_COS: f64 = 1e-3;
/// Cosine at the middle of a bin below which no part of the bin lies above the horizon: bins of θ_d are 1° high, those
/// of θ_h at most 2°.
const MIN_MIDDLE_COS: f64 = -0.03;

/// The pair of directions at a place among bins: whole numbers are their edges.
fn directions([h, d, p]: [f64; 3]) -> [DVec3; 2] {
    let theta_h = (h / THETA_H as f64).powi(2) * FRAC_PI_2;
    let theta_d = d / THETA_D as f64 * FRAC_PI_2;
    let phi_d = p / PHI_D as f64 * PI;
    let difference = direction(theta_d, phi_d);
    let (sin, cos) = theta_h.sin_cos();
    // Rotates the normal to the half vector.
    let turned = |w: DVec3| DVec3::new(cos * w.x + sin * w.z, w.y, cos * w.z - sin * w.x);
    [turned(difference), turned(DVec3::new(-difference.x, -difference.y, difference.z))]
}

/// The bytes of the MERL file of a table, and how far interpolation between its bins is off for a table of scattered
/// light.
///
/// # Errors
/// An anisotropic table, one of diffraction orders, a table without colours, or a width that is missing or has no use.
pub fn encode(table: &Table, width: LobeWidth) -> Result<(Vec<u8>, Option<Residual>)> {
    if matches!(table, Table::Orders(_)) {
        return Err(Error::failed(
            "the table holds diffraction orders, which depend on the azimuth, and MERL's format does not; export a bsdf with \
             --spread",
        ));
    }
    let reflection = Reflection::new(table, width, true)?;
    reflection.check_isotropic()?;
    if let ReflectionKind::Scatter(lookup, _) = reflection.kind()
        && let layout = lookup.layout()
        && !layout.is_isotropic()
    {
        return Err(Error::failed(format_args!(
            "the table is anisotropic ({} incident azimuths), which MERL's format cannot hold; export a bsdf, or estimate with \
             --incident {}x1, which averages around the normal",
            layout.incident_sides()[1],
            layout.incident_sides()[0]
        )));
    }
    let count = THETA_H * THETA_D * PHI_D;
    let mut bytes = Vec::with_capacity(12 + 24 * count);
    for size in [THETA_H, THETA_D, PHI_D] {
        bytes.extend(u32::try_from(size).unwrap_or(0).to_le_bytes());
    }
    let mut evaluator = reflection.evaluator();
    let colours: Vec<[f64; 3]> = (0..count)
        .map(|place| {
            let bin = [place / (THETA_D * PHI_D), place / PHI_D % THETA_D, place % PHI_D];
            colour(&mut evaluator, directions(bin.map(|bin| bin as f64 + 0.5)))
        })
        .collect();
    for c in 0..3 {
        bytes.extend(colours.iter().flat_map(|colour| (colour[c].max(0.0) / SCALE[c]).to_le_bytes()));
    }
    let residual = matches!(reflection.kind(), ReflectionKind::Scatter(..)).then(|| residual(&mut evaluator, &colours));
    Ok((bytes, residual))
}

/// The mean of f(wi, wo) and f(wo, wi), which the format does not tell apart.
fn colour(evaluator: &mut Evaluator<'_>, [wi, wo]: [DVec3; 2]) -> [f64; 3] {
    if wi.z < MIN_MIDDLE_COS || wo.z < MIN_MIDDLE_COS {
        return [0.0; 3];
    }
    let lifted = |w: DVec3| DVec3::new(w.x, w.y, w.z.max(MIN_COS)).normalize();
    let (wi, wo) = (lifted(wi), lifted(wo));
    let mut ways = [[0.0; 3]; 2];
    evaluator.eval(wi, wo, &mut ways[0]);
    evaluator.eval(wo, wi, &mut ways[1]);
    std::array::from_fn(|c| 0.5 * (ways[0][c] + ways[1][c]))
}

/// Relative difference between a table and a file that is interpolated linearly at the corners of its bins, halfway
/// between their middles, where f is above 1 % of its peak there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// Root of the mean square.
    pub rms: f64,
    /// 99th percentile.
    pub percentile_99: f64,
}

impl fmt::Display for Residual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [rms, most] = [self.rms, self.percentile_99].map(|x| 100.0 * x);
        write!(
            f,
            "halfway between its bins f differs from the table by {rms:.2} % (root mean square), {most:.1} % at most for 99 %"
        )
    }
}

/// Corners of bins that are compared: every third along each axis.
const EVERY: usize = 3;
/// Share of the peak above which a value is compared.
const FLOOR: f64 = 0.01;

/// Compares a file's colours with the table halfway between its bins.
fn residual(evaluator: &mut Evaluator<'_>, colours: &[[f64; 3]]) -> Residual {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for h in (1..THETA_H).step_by(EVERY) {
        for d in (1..THETA_D).step_by(EVERY) {
            for p in (1..PHI_D).step_by(EVERY) {
                let pair = directions([h, d, p].map(|corner| corner as f64));
                if pair.iter().any(|w| w.z <= MIN_COS) {
                    continue;
                }
                let exact = colour(evaluator, pair);
                let corner = |i: usize| ((h - (i & 1)) * THETA_D + d - (i >> 1 & 1)) * PHI_D + p - (i >> 2);
                let mean = |c: usize| (0..8).map(|i| colours[corner(i)][c].max(0.0)).sum::<f64>() / 8.0;
                found.extend((0..3).map(|c| [exact[c].max(0.0), mean(c)]));
            }
        }
    }
    let peak = found.iter().map(|[exact, _]| *exact).fold(0.0, f64::max);
    let mut differences: Vec<f64> = found
        .into_iter()
        .filter(|[exact, _]| *exact > FLOOR * peak)
        .map(|[exact, mean]| (mean / exact - 1.0).abs())
        .collect();
    differences.sort_by(f64::total_cmp);
    let count = differences.len();
    let rms = (differences.iter().map(|x| x * x).sum::<f64>() / count.max(1) as f64).sqrt();
    Residual { rms, percentile_99: differences.get(count * 99 / 100).copied().unwrap_or(0.0) }
}
