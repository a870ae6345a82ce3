//! Correction of the albedo of diffraction orders for interpolation.
//!
//! A lobe as narrow as the spacing of the file's samples loses or gains some per cent by interpolation. The spectra of
//! each incident direction are therefore scaled so that, interpolated, they reflect as much as the table does.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

/// Largest factor by which a channel is scaled. Where colours out of gamut cancel, there is no albedo to keep.
const MAX_SCALE: f64 = 2.0;
/// The two points of Gauss's quadrature on [0, 1], exact up to cubics.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// Share of an interval's density below a part of it, for a density linear between its ends: the weight of the
/// interpolation, which is linear in the warped square.
fn share([from, to]: [f64; 2], part: f64) -> f64 {
    part * (2.0 * from + part * (to - from)) / (from + to)
}

/// The albedo of one channel of the file, interpolated between its samples.
pub fn interpolated([across, along]: [&[(f64, f64)]; 2], wi: DVec3, origin: f64, samples: &[f32]) -> f64 {
    let mut total = 0.0;
    for (row, v) in along.windows(2).enumerate() {
        let height = v[1].0 - v[0].0;
        for part_v in GAUSS {
            let (sin, cos) = (TAU * (v[0].0 + part_v * height) - PI + origin).sin_cos();
            let share_v = share([v[0].1, v[1].1], part_v);
            for (column, u) in across.windows(2).enumerate() {
                let at = |row: usize, column: usize| f64::from(samples[row * across.len() + column]);
                let mix = |a: f64, b: f64| a + share_v * (b - a);
                let [left, right] = [column, column + 1].map(|column| mix(at(row, column), at(row + 1, column)));
                let width = u[1].0 - u[0].0;
                for part_u in GAUSS {
                    let place = u[0].0 + part_u * width;
                    let (sin_m, cos_m) = (place * place * FRAC_PI_2).sin_cos();
                    let m = DVec3::new(sin_m * cos, sin_m * sin, cos_m);
                    let visible = wi.dot(m);
                    if 2.0 * visible * m.z > wi.z {
                        let value = left + share([u[0].1, u[1].1], part_u) * (right - left);
                        total += width * height * place * sin_m * visible * value;
                    }
                }
            }
        }
    }
    // |dω_o| per area of the square is 8π² u sin θ_m (ω_i · m); a cell has four points.
    total * 8.0 * PI * PI / 4.0
}

/// Scales one channel from its interpolated to its exact albedo, by at most a factor of 2 either way.
pub fn keep(samples: &mut [f32], exact: f64, interpolated: f64) {
    let scale = exact / interpolated;
    if scale.is_finite() {
        let scale = scale.clamp(1.0 / MAX_SCALE, MAX_SCALE) as f32;
        samples.iter_mut().for_each(|value| *value *= scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::bsdf::density::Density;
    use crate::support::direction::direction;

    #[test]
    fn a_white_diffuse_reflector_interpolated_has_albedo_one() {
        const SIDE: usize = 64;
        let density = || [Density::uniform(), Density::uniform()];
        let nodes = density().map(|density| density.nodes(SIDE));
        for theta in [0.0, 0.7, 1.3] {
            let wi = direction(theta, 0.0);
            let cosine = |(u, v): (f64, f64)| {
                let m = direction(u * u * FRAC_PI_2, TAU * v - PI);
                ((2.0 * wi.dot(m) * m.z - wi.z) / PI) as f32
            };
            let samples: Vec<f32> =
                nodes[1].iter().flat_map(|v| nodes[0].iter().map(move |u| (u.0, v.0))).map(cosine).collect();
            let nodes = [&nodes[0][..], &nodes[1][..]];
            let albedo = interpolated(nodes, wi, 0.0, &samples);
            // Interpolation of a curved function: (π/SIDE)²/8 and similar terms.
            assert!((albedo - 1.0).abs() < 2e-3, "{theta}: {albedo}");
            let mut scaled = samples;
            keep(&mut scaled, 1.0, albedo);
            assert!((interpolated(nodes, wi, 0.0, &scaled) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_has_no_albedo_is_left_as_it_is() {
        let mut samples = [1.0, 2.0];
        keep(&mut samples, 0.0, 0.0);
        assert_eq!(samples, [1.0, 2.0]);
        keep(&mut samples, 5.0, 1.0);
        assert_eq!(samples, [MAX_SCALE as f32, 2.0 * MAX_SCALE as f32]);
    }
}
