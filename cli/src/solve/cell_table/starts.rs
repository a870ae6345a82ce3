//! Where the starting rays of one incident direction begin: in equal shares of the facets that they meet first.

use glam::DVec3;
use goniochrome::geometry::mesh_cell::MeshCell;
use goniochrome::table::HalfVectorWarp;
use goniochrome::trace::random::Random;
use goniochrome::trace::sobol::sobol;

/// Possible starting points for each ray.
const CANDIDATES: u32 = 16;

/// Bits of each coordinate of a place in the square of half vectors, and in the period.
const BITS: u32 = 12;

/// `count` starting points (u, v) of the period for light from `wi`, in order: neighbours in the list meet facets of
/// neighbouring normals first.
///
/// Many candidates are sorted by the normal of the facet that they meet, then by where they meet it, and divided into
/// as many equal strata as there are rays; a random candidate of each stratum starts. Lobes of single reflections then
/// hold their share of the rays to about one ray, where independent ones would err by its square root (stratified
/// sampling; Cochran, "Sampling Techniques", 1977, chapter 5).
pub(super) fn starts(
    cell: &MeshCell<'_>,
    warp: &HalfVectorWarp<'_>,
    wi: DVec3,
    count: u32,
    sequence: u32,
) -> Vec<[f64; 2]> {
    let mut candidates: Vec<(u64, [f64; 2])> = (0..count * CANDIDATES)
        .map(|i| {
            let point = sobol(i, sequence);
            let [u, v] = point;
            let Some(hit) = cell.first_hit(u, v, -wi) else { return (u64::MAX, point) };
            let normal = cell.facet(hit.facet).normal.as_vec3();
            let normal = if hit.front { normal } else { -normal };
            // Mirrored at the facet, the light has the normal as its half vector.
            let [x, y] = warp.warped(normal, normal, 0.0).place;
            (curve([x.into(), y.into()]) << (2 * BITS) | curve(point), point)
        })
        .collect();
    candidates.sort_by_key(|(key, _)| *key);
    let mut random = Random::new(count, sequence);
    candidates
        .chunks(CANDIDATES as usize)
        .map(|stratum| stratum[((random.next() * stratum.len() as f64) as usize).min(stratum.len() - 1)].1)
        .collect()
}

/// Place of a point of the unit square along Hilbert's curve, whose neighbours lie close together.
fn curve(point: [f64; 2]) -> u64 {
    let side = 1u64 << BITS;
    let [mut x, mut y] = point.map(|t| ((t * side as f64) as u64).min(side - 1));
    let mut place = 0;
    let mut half = side / 2;
    while half > 0 {
        let (right, upper) = (u64::from(x & half > 0), u64::from(y & half > 0));
        place += half * half * ((3 * right) ^ upper);
        if upper == 0 {
            if right == 1 {
                (x, y) = (side - 1 - x, side - 1 - y);
            }
            (x, y) = (y, x);
        }
        half /= 2;
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilberts_curve_visits_every_point_by_steps_of_one() {
        let side = 64u64;
        let mut points: Vec<(u64, [u64; 2])> = (0..side * side)
            .map(|i| {
                let point = [i % side, i / side];
                (curve(point.map(|t| (t as f64 + 0.5) / side as f64)), point)
            })
            .collect();
        points.sort_unstable();
        for pair in points.windows(2) {
            let [[a, b], [c, d]] = [pair[0].1, pair[1].1];
            assert_eq!(a.abs_diff(c) + b.abs_diff(d), 1, "{pair:?}");
        }
    }
}
