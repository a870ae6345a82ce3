//! Distributions of the normals of a mesh.
//!
//! A facet of area A counts at its normal by A cos θ_m, the area that it covers. It is shared among the four nodes
//! around, by the weights of bilinear interpolation, so that no area is lost and the means of sin²θ_m and of φ_m stay.
//! Near the pole, where sectors are narrower than rings, the nodes of a ring share with their neighbours as far as
//! rings are apart.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use goniochrome::microfacet::FacetTable;

use super::owned::OwnedFacets;
use crate::scene::mesh::Mesh;

/// Facets for each node of a table, on average: their noise is then a third.
const FACETS_PER_NODE: usize = 9;
/// Fewest and most rings and sectors, and most rings of a table without sectors.
const LEAST: [usize; 2] = [16, 12];
const MOST: [usize; 2] = [96, 72];
const MOST_RINGS: usize = 256;

/// Table of the normals of a mesh over a plane, or, if `isotropic`, of their mean over all azimuths.
///
/// The mean slope is subtracted: a surface's own normal is the mean of its facets.
///
/// # Errors
/// A message for a mesh with facets that face down, or without any that face up.
pub(super) fn facets(mesh: &Mesh, isotropic: bool) -> Result<OwnedFacets, String> {
    let mut slopes = Vec::with_capacity(mesh.triangles.len());
    let (mut sum, mut whole) = ([0.0; 2], 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.vertices.map(|vertex| DVec3::from(mesh.vertices[vertex as usize]));
        let normal = (b - a).cross(c - a);
        let steep = normal.z.abs() <= 1e-9 * normal.length();
        if normal.z < 0.0 && !steep {
            return Err(format!(
                "line {}: a facet faces down; a finish has facets that face up, as those of a height field",
                triangle.line
            ));
        }
        if steep {
            continue;
        }
        let slope = [normal.x / normal.z, normal.y / normal.z];
        slopes.push((slope, normal.z));
        whole += normal.z;
        sum = [sum[0] + normal.x, sum[1] + normal.y];
    }
    if slopes.is_empty() {
        return Err("no facet faces up; a finish has facets over a plane".to_owned());
    }
    let mean = sum.map(|sum| sum / whole);
    let size = if isotropic {
        [(slopes.len() / FACETS_PER_NODE).clamp(LEAST[0], MOST_RINGS), 1]
    } else {
        let side = ((slopes.len() / FACETS_PER_NODE) as f64).sqrt();
        [0, 1].map(|i| (side as usize).clamp(LEAST[i], MOST[i]))
    };
    let mut covered = vec![0.0; (size[0] + 1) * size[1]];
    for ([x, y], area) in slopes {
        share(size, [x - mean[0], y - mean[1]], area / whole, &mut covered);
    }
    let density = density(size, covered);
    OwnedFacets::new(size, &density).map_err(|error| error.to_string())
}

/// Shares the area of a facet of a slope among nodes.
fn share([rings, sectors]: [usize; 2], [x, y]: [f64; 2], area: f64, covered: &mut [f64]) {
    let square = x * x + y * y;
    let t = square / (1.0 + square);
    let ring = ((t.sqrt().sqrt() * rings as f64) as usize).min(rings - 1);
    let [low, high] = [ring, ring + 1].map(|ring| FacetTable::sin_square(rings, ring));
    let outward = ((t - low) / (high - low)).clamp(0.0, 1.0);
    let at = (y.atan2(x) / TAU).rem_euclid(1.0) * sectors as f64;
    let sector = (at as usize).min(sectors - 1);
    let turned = at - sector as f64;
    for (ring, part) in [(ring, 1.0 - outward), (ring + 1, outward)] {
        covered[ring * sectors + sector] += area * part * (1.0 - turned);
        covered[ring * sectors + (sector + 1) % sectors] += area * part * turned;
    }
}

/// D at the nodes, from the area that each covers.
fn density([rings, sectors]: [usize; 2], mut covered: Vec<f64>) -> Vec<f32> {
    let t = |ring: usize| FacetTable::sin_square(rings, ring);
    for (ring, row) in covered.chunks_exact_mut(sectors).enumerate() {
        let (inner, outer) = (ring.saturating_sub(1), (ring + 1).min(rings));
        // ∫ cos θ_m dω_m of the node's interpolation weight: over t and φ, half.
        let solid = 0.5 * 0.5 * (t(outer) - t(inner)) * TAU / sectors as f64;
        row.iter_mut().for_each(|area| *area /= solid);
        let apart = (t(outer).sqrt() - t(inner).sqrt()) / (outer - inner) as f64;
        let reach = if ring == 0 { PI } else { (apart / t(ring).sqrt()).min(PI) };
        spread(row, reach * sectors as f64 / TAU);
    }
    covered.into_iter().map(|density| density as f32).collect()
}

/// Means over a ring, weighted by a tent that reaches a number of sectors.
fn spread(row: &mut [f64], reach: f64) {
    let sectors = row.len();
    if reach <= 1.0 || sectors == 1 {
        return;
    }
    let weight = |d: usize| (1.0 - d.min(sectors - d) as f64 / reach).max(0.0);
    let sum: f64 = (0..sectors).map(weight).sum();
    let before = row.to_vec();
    for (j, mean) in row.iter_mut().enumerate() {
        *mean = before.iter().enumerate().map(|(i, x)| weight((j + sectors - i) % sectors) * x).sum::<f64>() / sum;
    }
}
