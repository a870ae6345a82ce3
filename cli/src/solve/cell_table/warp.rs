//! The warp of a cell's table: nodes of half vectors lie where its curved facets have their normals.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use crate::solve::cell_table::flat::are_parallel;
use crate::solve::mesh_scene::MeshScene;

/// Intervals of the densities over u and over v.
const INTERVALS: usize = 32;
/// Share of the nodes that follow the normals of facets. The others lie evenly, for light of several hits.
const BY_NORMALS: f64 = 0.7;

/// Densities over u = √(2θ_m/π) and v = (φ_m + π)/2π for the half vectors of a cell, at equally spaced knots. Facets
/// weigh by their area as seen from above; flat ones, whose lobes stand apart, do not count. In an isotropic table
/// azimuths count from that of the light, and are all alike.
pub(super) fn densities(mesh_scene: &MeshScene<'_>, flat: &[DVec3], isotropic: bool) -> [Vec<f32>; 2] {
    let mut parts = [vec![0.0; INTERVALS + 1], vec![0.0; INTERVALS + 1]];
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
        add(&mut parts[1], v, normal.z * twice.length(), true);
    }
    if isotropic {
        parts[1].fill(0.0);
    }
    parts.map(|parts| {
        let sum: f64 = parts.iter().sum();
        let mean = |part: f64| if sum > 0.0 { BY_NORMALS * part * INTERVALS as f64 / sum } else { BY_NORMALS };
        parts.into_iter().map(|part| (mean(part) + 1.0 - BY_NORMALS) as f32).collect()
    })
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
