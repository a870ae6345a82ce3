//! The warp of a cell's table: nodes of half vectors lie where its curved facets have their normals.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use crate::solve::cell_table::flat::{are_parallel, is_of_lines};
use crate::solve::mesh_scene::MeshScene;

/// Intervals of the densities over u and over v.
const INTERVALS: [usize; 2] = [32, 32];
/// Intervals for surfaces of lines, whose half vectors all lie at two azimuths.
const INTERVALS_OF_LINES: [usize; 2] = [12, 64];
/// Least density over u at the normal for surfaces of lines, over its mean. The node at the normal stands for all
/// azimuths, at most of which there is no light, so its step is kept small.
const LINES_AT_NORMAL: f32 = 1.5;
/// Share of the nodes that follow the normals of facets. The others lie evenly, for light of several hits.
const BY_NORMALS: f64 = 0.7;

/// Densities over u = √(2θ_m/π) and v = (φ_m + π)/2π for the half vectors of a cell, at equally spaced knots. Facets
/// weigh by their area as seen from above; flat ones, whose lobes stand apart, do not count. In an isotropic table
/// azimuths count from that of the light, and are all alike.
///
/// The light of lines lies at one azimuth to either side, and interpolation spreads it over a step of y. There the
/// density over v is even: with 64 intervals and [`BY_NORMALS`] the knots beside the azimuth are 0.97 steps of eight
/// away. Samples of the interpolated light have therefore the weight that they should.
pub(super) fn densities(mesh_scene: &MeshScene<'_>, flat: &[DVec3], isotropic: bool) -> [Vec<f32>; 2] {
    let lines = !isotropic && is_of_lines(mesh_scene);
    let (intervals, steps) = if lines { (INTERVALS_OF_LINES, &[-1.0, 0.0, 1.0][..]) } else { (INTERVALS, &[0.0][..]) };
    let mut parts = intervals.map(|count| vec![0.0; count + 1]);
    for ([a, b, c], _, _) in mesh_scene.triangles() {
        let twice = (b - a).cross(c - a);
        let normal = twice.normalize_or_zero();
        let normal = if normal.z < 0.0 { -normal } else { normal };
        if flat.iter().any(|flat| are_parallel(*flat, normal)) {
            continue;
        }
        let theta = normal.truncate().length().atan2(normal.z);
        let v = (normal.y.atan2(normal.x) + PI) / TAU;
        add(&mut parts[0], (theta / FRAC_PI_2).sqrt(), normal.z * twice.length(), false);
        for step in steps {
            add(&mut parts[1], (v + step / intervals[1] as f64).rem_euclid(1.0), normal.z * twice.length(), true);
        }
    }
    if isotropic {
        parts[1].fill(0.0);
    }
    let mut densities = parts.map(|parts| -> Vec<f32> {
        let intervals = (parts.len() - 1) as f64;
        let sum: f64 = parts.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum();
        let mean = |part: f64| if sum > 0.0 { BY_NORMALS * part * intervals / sum } else { BY_NORMALS };
        parts.into_iter().map(|part| (mean(part) + 1.0 - BY_NORMALS) as f32).collect()
    });
    if lines {
        densities[0][0] = densities[0][0].max(LINES_AT_NORMAL);
    }
    densities
}

/// Adds a weight to the two knots beside a place in [0, 1].
fn add(parts: &mut [f64], place: f64, weight: f64, periodic: bool) {
    let last = parts.len() - 1;
    let scaled = place.clamp(0.0, 1.0) * last as f64;
    let below = (scaled as usize).min(last - 1);
    let part = scaled - below as f64;
    for (knot, share) in [(below, 1.0 - part), (below + 1, part)] {
        // An end knot stands for half an interval; on a circle both ends are one.
        let at_end = knot == 0 || knot == last;
        if at_end && periodic {
            parts[0] += share * weight;
            parts[last] += share * weight;
        } else {
            parts[knot] += share * weight * if at_end { 2.0 } else { 1.0 };
        }
    }
}
