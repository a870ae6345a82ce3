//! Solid angles that nodes of the warped square stand for.

use super::angles::{level, polar};
use super::layout::ScatterLayout;
use super::warp::{HalfVectorWarp, Piece, plain_solid_angle};
use crate::simd::lanes::sqrtf;
use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};
use glam::Vec3;

/// Places and weights of Gauss's rule of three points on [0, 1].
const RULE: [[f32; 2]; 3] = [[0.112_701_67, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_35, 5.0 / 18.0]];

/// Half vectors of one θ_m.
#[derive(Clone, Copy)]
struct Ring {
    /// Part of the way from one column of nodes to the next.
    right: f32,
    sin: f32,
    cos: f32,
    /// Solid angle of outgoing directions over wi·m and over dv, with the weight of the rule.
    solid_angle: f32,
    /// First and last v of those that reflect above the horizon; they may be one turn off.
    above: [f32; 2],
}

/// Calls `add(node, Ω)` several times for each node of the square, so that the sums of Ω are ∫ t(ω_o) dω_o over the
/// outgoing directions above the horizon, for the node's interpolation weight t (its tent) and light from `wi`. The
/// sums over all nodes add up to the solid angle of the hemisphere, 2π.
///
/// `origin` is the azimuth from which φ_m counts: 0, or that of `wi` in isotropic tables. Half vectors of the polar
/// angle θ_m reflect light of θ_i above the horizon where cos(φ_m − φ_i) > −cot θ_i cot 2θ_m: all up to
/// θ_m = (90° − θ_i)/2, and none from (90° + θ_i)/2 on. The integral is Gauss's rule of 3 × 3 points in each piece of
/// the plain square between nodes, knots of the warp and these angles; along v it ends at the horizon. The sum over all
/// nodes errs by 4·10⁻⁴ at 89°, and by less than 10⁻⁴ up to 76°; the part of a node that the horizon cuts, by some
/// percent of what the node has without it, which its neighbours have instead.
pub fn tent_solid_angles(
    layout: &ScatterLayout,
    warp: &HalfVectorWarp<'_>,
    wi: Vec3,
    origin: f32,
    mut add: impl FnMut(usize, f32),
) {
    let [columns, rows] = layout.square_sides();
    let theta = polar(wi);
    let edge = |theta: f32| sqrtf(theta * FRAC_2_PI).min(1.0);
    let [all, some] = [edge(0.5 * (FRAC_PI_2 - theta).max(0.0)), edge(0.5 * (FRAC_PI_2 + theta))];
    for Piece { interval: column, from, to } in warp.pieces(0, columns - 1) {
        for (from, to, cut) in [(from, to.min(all), false), (from.max(all), to.min(some), true)] {
            if from >= to {
                continue;
            }
            let rings = RULE.map(|[place, weight]| {
                // Points gather where the circle above the horizon shrinks to nothing or to less than all, as a root.
                let (place, weight) = match cut {
                    true if to >= some => (place * (2.0 - place), weight * 2.0 * (1.0 - place)),
                    true if from <= all => (place * place, weight * 2.0 * place),
                    _ => (place, weight),
                };
                let u = from + place * (to - from);
                let right = warp.place(0, u) * (columns - 1) as f32 - column as f32;
                let (sin, cos) = libm::sincosf(u * u * FRAC_PI_2);
                let solid_angle = plain_solid_angle(u, sin) * weight * (to - from);
                let above = if cut { above(wi, origin, sin, cos) } else { [0.0, 1.0] };
                Ring { right, sin, cos, solid_angle, above }
            });
            for piece in warp.pieces(1, rows) {
                let row = piece.interval;
                let corners = between_nodes(warp, wi, origin, piece, rows as f32, &rings);
                let next = if row + 1 < rows { row + 1 } else { 0 };
                let nodes = [(row, column), (row, column + 1), (next, column), (next, column + 1)];
                for ((row, column), corner) in nodes.into_iter().zip(corners) {
                    add((row * columns + column) as usize, corner);
                }
            }
        }
    }
}

/// First and last v at which half vectors of this sine and cosine of θ_m reflect above the horizon.
fn above(wi: Vec3, origin: f32, sin: f32, cos: f32) -> [f32; 2] {
    // cos(φ_m − φ_i) at the horizon is a quotient of these.
    let (part, whole) = (-wi.z * (2.0 * cos * cos - 1.0), level(wi) * 2.0 * sin * cos);
    let half = if part.abs() < whole { libm::acosf(part / whole) } else { 0.5 * PI * (1.0 - part.signum()) };
    let middle = libm::atan2f(wi.y, wi.x) - origin;
    [middle - half, middle + half].map(|phi| phi / TAU + 0.5)
}

/// Parts of the solid angle of a piece that are its nodes': left and right in its row, then in the next of `rows`.
fn between_nodes(
    warp: &HalfVectorWarp<'_>,
    wi: Vec3,
    origin: f32,
    piece: Piece,
    rows: f32,
    rings: &[Ring; RULE.len()],
) -> [f32; 4] {
    let azimuths = |from: f32, to: f32| {
        RULE.map(|[place, weight]| {
            let v = from + place * (to - from);
            let (sin, cos) = libm::sincosf(TAU * v - PI + origin);
            [warp.place(1, v) * rows - piece.interval as f32, cos * wi.x + sin * wi.y, weight * (to - from)]
        })
    };
    let mut corners = [0.0; 4];
    let mut add = |ring: &Ring, azimuths: &[[f32; 3]; RULE.len()]| {
        let [mut sum, mut upper_sum] = [0.0; 2];
        for &[upper, along, weight] in azimuths {
            let part = weight * (ring.sin * along + ring.cos * wi.z).max(0.0);
            sum += part;
            upper_sum += upper * part;
        }
        let parts = [sum - upper_sum, upper_sum].map(|part| (part * ring.solid_angle).max(0.0));
        let right = ring.right.clamp(0.0, 1.0);
        for (corner, part) in corners.as_chunks_mut::<2>().0.iter_mut().zip(parts) {
            *corner = [corner[0] + part * (1.0 - right), corner[1] + part * right];
        }
    };
    let whole = azimuths(piece.from, piece.to);
    for ring in rings {
        let [first, last] = ring.above;
        // The circle may be met before, here or after.
        for turn in [-1.0, 0.0, 1.0] {
            let (from, to) = (piece.from.max(first + turn), piece.to.min(last + turn));
            if from == piece.from && to == piece.to {
                add(ring, &whole);
            } else if from < to {
                add(ring, &azimuths(from, to));
            }
        }
    }
    corners
}
