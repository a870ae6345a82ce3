//! What directions see of tabulated facets, computed when a table is made.
//!
//! Of the visible area σ(w) = ∫ D (w·m)⁺ dω_m, what varies slowly is kept: the squared roughness e of the GGX facets of
//! which the direction sees as much, e = 4 σ (σ − cos θ)/sin²θ.

use super::error::FinishError;
use super::facet_layout::{FacetLayout, VIEWS};
use super::limits::MAX_SECTORS;
use crate::simd::lanes::sqrt;
use libm::{acos, cos, sin};

/// Maximum mean slope: a surface's own normal is the mean of its facets.
const MAX_TILT: f64 = 0.02;
/// Rows of e for each that is integrated; the rest are cubic between those.
const FINER: usize = 4;

/// Gauss nodes in [−1, 1] and their weights.
pub(super) const GAUSS: [[f64; 2]; 4] = [
    [-0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
    [-0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
    [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
];

/// Computes the squared roughness e of directions, all rows of it, of D in rows of `layout`.
///
/// What a direction w does not see, ∫ D (w·m)⁻ dω_m = σ − w·∫ D m dω_m, is summed over cos θ_m by four Gauss nodes in
/// each ring, and exactly over φ_m, where D is linear between sectors: the integral of a tent times (a + b cos φ)⁻ is
/// the second difference of its second antiderivative.
///
/// # Errors
/// [`FinishError::Tilt`] for normals with a mean slope.
pub(super) fn look(layout: FacetLayout, nodes: &[f32], seen: &mut [f32]) -> Result<(), FinishError> {
    let tilt = mean_slope(layout, nodes);
    let is_level = tilt.iter().all(|slope| slope.abs() <= MAX_TILT);
    if !is_level {
        return Err(FinishError::Tilt);
    }
    let (sectors, view) = (layout.sectors, layout.view());
    for (row, seen) in seen.chunks_exact_mut(view).enumerate().take(VIEWS).step_by(FINER) {
        let part = row as f64 / VIEWS as f64;
        let cos_w = part * part;
        let sin_w = sqrt(1.0 - cos_w * cos_w);
        let unseen = unseen(layout, nodes, [cos_w, sin_w]);
        let e = |j: usize| {
            let phi = layout.step() * j as f64;
            let more = sin_w * (tilt[0] * cos(phi) + tilt[1] * sin(phi)) + unseen[j];
            (4.0 * (cos_w + more) * more / (sin_w * sin_w)) as f32
        };
        // A row begins with the last sector where it goes around.
        let first = if sectors == 1 { 0 } else { sectors - 1 };
        seen.iter_mut().enumerate().for_each(|(place, seen)| *seen = e((first + place) % sectors));
    }
    for column in 0..view {
        refine(seen, column, view);
    }
    Ok(())
}

/// Fills a column of e, of which every fourth row but the last is known.
fn refine(seen: &mut [f32], column: usize, view: usize) {
    let place = |row: usize| row * view + column;
    // Beyond the last row that is known, e goes on as a parabola.
    let beyond = |[first, second, third]: [f32; 3]| 3.0 * (third - second) + first;
    seen[place(VIEWS)] = beyond([3, 2, 1].map(|back| seen[place(VIEWS - back * FINER)]));
    let after = beyond([2, 1, 0].map(|back| seen[place(VIEWS - back * FINER)]));
    for row in (0..VIEWS).step_by(FINER) {
        // e is an even function of √cos θ.
        let before = if row == 0 { FINER } else { row - FINER };
        let [a, b, c] = [before, row, row + FINER].map(|row| seen[place(row)]);
        let d = if row + 2 * FINER <= VIEWS { seen[place(row + 2 * FINER)] } else { after };
        for step in 1..FINER {
            let [wa, wb, wc, wd] = cubic(step as f32 / FINER as f32);
            seen[place(row + step)] = (a * wa + b * wb) + (c * wc + d * wd);
        }
    }
}

/// Weights of four equally spaced nodes at a part of the way from the second to the third (Catmull & Rom).
#[inline]
pub(super) fn cubic(x: f32) -> [f32; 4] {
    let (square, cube) = (x * x, x * x * x);
    [
        -0.5 * cube + square - 0.5 * x,
        1.5 * cube - 2.5 * square + 1.0,
        -1.5 * cube + 2.0 * square + 0.5 * x,
        0.5 * cube - 0.5 * square,
    ]
}

/// ∫ D (w·m)⁻ dω_m for directions w of one cos θ and sin θ, of each sector's azimuth.
fn unseen(layout: FacetLayout, nodes: &[f32], [cos_w, sin_w]: [f64; 2]) -> [f64; MAX_SECTORS] {
    let (sectors, step) = (layout.sectors, layout.step());
    let mut unseen = [0.0; MAX_SECTORS];
    over_rings(layout, |ring, part, cos_m, weight| {
        let (a, b) = (cos_w * cos_m, sin_w * sqrt(1.0 - cos_m * cos_m));
        if b <= a {
            return;
        }
        let hidden = Hidden::new(a, b);
        if sectors == 1 {
            unseen[0] += weight * between(layout, nodes, ring, part, 0) * hidden.whole();
            return;
        }
        let mut tents = [0.0; MAX_SECTORS];
        for (d, tent) in tents.iter_mut().take(sectors).enumerate() {
            let at = step * d as f64 - core::f64::consts::PI;
            *tent = (hidden.twice(at - step) - 2.0 * hidden.twice(at) + hidden.twice(at + step)) / step;
        }
        for j in 0..sectors {
            // The azimuth from the direction to the normal is (j − of) sectors; `at` above is less by half a turn.
            let density = weight * between(layout, nodes, ring, part, j);
            if density > 0.0 {
                let (before, after) = tents[..sectors].split_at(j + 1);
                let turned = before.iter().rev().chain(after.iter().rev());
                unseen.iter_mut().zip(turned).for_each(|(unseen, tent)| *unseen += density * tent);
            }
        }
    });
    unseen
}

/// D of a sector, a part of the way from a ring to the next.
fn between(layout: FacetLayout, nodes: &[f32], ring: usize, part: f64, sector: usize) -> f64 {
    let [low, high] = [ring, ring + 1].map(|ring| f64::from(nodes[ring * layout.ring() + sector]));
    low + part * (high - low)
}

/// Calls `of` with the ring, the part of the way to the next, cos θ_m and the weight of each node of a quadrature over
/// cos θ_m.
fn over_rings(layout: FacetLayout, mut of: impl FnMut(usize, f64, f64, f64)) {
    for ring in 0..layout.rings {
        let [low, high] = [ring, ring + 1].map(|ring| layout.sin_square(ring));
        let [from, to] = [low, high].map(|t| sqrt(1.0 - t));
        // from − to, without cancellation near the pole.
        let width = (high - low) / (from + to);
        for [x, weight] in GAUSS {
            let cos_m = from - 0.5 * (1.0 + x) * width;
            let part = 0.5 * (1.0 + x) * (from + cos_m) / (from + to);
            of(ring, part, cos_m, 0.5 * width * weight);
        }
    }
}

/// Components of ∫ D m dω_m along x and y, for D of which ∫ D cos θ_m dω_m = 1.
fn mean_slope(layout: FacetLayout, nodes: &[f32]) -> [f64; 2] {
    let mut slope = [0.0; 2];
    if layout.sectors == 1 {
        return slope;
    }
    let step = layout.step();
    // Integral of a tent times a cosine, over the cosine at the tent's middle.
    let tent = 2.0 * (1.0 - cos(step)) / step;
    over_rings(layout, |ring, part, cos_m, weight| {
        let scale = weight * tent * sqrt(1.0 - cos_m * cos_m);
        for j in 0..layout.sectors {
            let phi = step * j as f64;
            let density = scale * between(layout, nodes, ring, part, j);
            slope[0] += density * cos(phi);
            slope[1] += density * sin(phi);
        }
    });
    slope
}

/// The second antiderivative of (b cos ψ − a)⁺ over ψ in [−π, π], for b > a ≥ 0: 0 before its support.
struct Hidden {
    a: f64,
    b: f64,
    /// End of the support.
    end: f64,
    constants: [f64; 2],
}

impl Hidden {
    fn new(a: f64, b: f64) -> Self {
        let end = acos(a / b);
        let slope = b * sin(end) - a * end;
        Self { a, b, end, constants: [a + 0.5 * a * end * end + slope * end, slope] }
    }

    /// Integral over all ψ.
    fn whole(&self) -> f64 {
        2.0 * self.constants[1]
    }

    fn twice(&self, psi: f64) -> f64 {
        let inside = psi.clamp(-self.end, self.end);
        let [constant, slope] = self.constants;
        let at = constant + inside * (slope - 0.5 * self.a * inside) - self.b * cos(inside);
        at + self.whole() * (psi - self.end).max(0.0)
    }
}
