//! Tabulated distributions of normals.
//!
//! With t = sin²θ_m, cos θ_m dω_m = dt dφ/2: over t and φ the density of normals per area of the surface is D/2 itself.
//! D is bilinear between nodes at t = (k/rings)⁴ and at equal steps of φ, so it is drawn from exactly, by the roots of
//! two quadratic equations. The nodes follow narrow lobes and long tails.
//!
//! Of the visible area σ(w) = ∫ D (w·m)⁺ dω_m, what varies slowly is kept: the squared roughness e of the GGX facets of
//! which the direction sees as much, e = 4 σ (σ − cos θ)/sin²θ. It is cubic between nodes at cos θ = (i/64)².

use super::error::FinishError;
use super::limits::{MAX_RINGS, MAX_SECTORS};
use crate::simd::lanes::{sqrt, sqrtf};
use core::f32::consts::TAU;
use glam::Vec3;
use libm::{acos, cos, cosf, sin, sinf};

/// Minimum number of sectors, except for 1.
const MIN_SECTORS: usize = 4;
/// Maximum mean slope: a surface's own normal is the mean of its facets.
const MAX_TILT: f64 = 0.02;
/// Steps of √cos θ between nodes of visible areas. A node beyond the last, where cos θ = 1, serves interpolation.
const VIEWS: usize = 64;
const VIEW_ROWS: usize = VIEWS + 2;

/// Tabulated density D of the normals of facets.
///
/// It holds D at `rings` + 1 angles θ_m, with sin²θ_m = (k/rings)⁴, and at `sectors` azimuths φ_m = 2π j/sectors. A
/// surface that is equally rough in all directions has one sector. D is scaled so that ∫ D cos θ_m dω_m = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetTable<'a> {
    rings: usize,
    sectors: usize,
    /// D, `[ring][sector]`.
    density: &'a [f32],
    /// Probability of normals within each ring.
    within: &'a [f32],
    /// Integral of D over the sectors to each, in units of a sector, `[ring][sector]`.
    turned: &'a [f32],
    /// The squared roughness e of directions, `[step][sector]`.
    seen: &'a [f32],
}

impl<'a> FacetTable<'a> {
    /// Number of elements that [`FacetTable::new`] needs as memory.
    #[must_use]
    pub fn required_len([rings, sectors]: [usize; 2]) -> usize {
        (rings + 1) * (2 * sectors + 1) + VIEW_ROWS * sectors
    }

    /// sin²θ_m of the nodes of a ring.
    #[must_use]
    pub fn sin_square(rings: usize, ring: usize) -> f64 {
        let part = ring as f64 / rings as f64;
        part * part * part * part
    }

    /// Table of D in any unit at its nodes, `density[ring][sector]`, computed in `memory`, which has
    /// [`FacetTable::required_len`] elements. It takes time in proportion to the rings and to the square of the
    /// sectors: 0.2 s for 96 rings of 72 sectors.
    ///
    /// # Errors
    /// [`FinishError::Size`] unless there are 1 to [`MAX_RINGS`] rings, 1 or 4 to [`MAX_SECTORS`] sectors, a density
    /// for each node and enough memory; [`FinishError::Density`] where D is negative, not finite or nowhere positive;
    /// [`FinishError::Tilt`] for normals whose mean slope is above 0.02.
    pub fn new(size: [usize; 2], density: &[f32], memory: &'a mut [f32]) -> Result<Self, FinishError> {
        let [rings, sectors] = size;
        check_size(size, memory.len())?;
        if density.len() != (rings + 1) * sectors {
            return Err(FinishError::Size);
        }
        if !density.iter().all(|d| d.is_finite() && *d >= 0.0) {
            return Err(FinishError::Density);
        }
        let (nodes, rest) = memory.split_at_mut(density.len());
        let (within, rest) = rest.split_at_mut(rings + 1);
        let (turned, seen) = rest.split_at_mut(density.len());
        // All sectors of the first ring are one direction.
        let rows = density.chunks_exact(sectors);
        let mean = |row: &[f32]| row.iter().map(|d| f64::from(*d)).sum::<f64>() / sectors as f64;
        let (mut sum, mut before) = (0.0, [0.0; 2]);
        for (ring, row) in rows.clone().enumerate() {
            let [t, mean] = [Self::sin_square(rings, ring), mean(row)];
            sum += core::f64::consts::FRAC_PI_2 * (mean + before[1]) * (t - before[0]);
            within[ring] = sum as f32;
            before = [t, mean];
        }
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(FinishError::Density);
        }
        within.iter_mut().for_each(|sum_to| *sum_to = (f64::from(*sum_to) / sum) as f32);
        for (ring, row) in rows.enumerate() {
            let pole = mean(row);
            let nodes = &mut nodes[ring * sectors..][..sectors];
            for (node, d) in nodes.iter_mut().zip(row) {
                *node = (if ring == 0 { pole } else { f64::from(*d) } / sum) as f32;
            }
            let mut sum = 0.0;
            for (j, turned) in turned[ring * sectors..][..sectors].iter_mut().enumerate() {
                sum += 0.5 * (f64::from(nodes[j]) + f64::from(nodes[(j + 1) % sectors]));
                *turned = sum as f32;
            }
        }
        look(size, nodes, seen)?;
        if !memory.iter().all(|x| x.is_finite()) {
            return Err(FinishError::Density);
        }
        Self::of(size, memory)
    }

    /// Table in memory that [`FacetTable::new`] filled earlier.
    ///
    /// Numbers that it did not compute make a surface without meaning, but no panic.
    ///
    /// # Errors
    /// [`FinishError::Size`] for other sizes.
    pub fn of(size: [usize; 2], memory: &'a [f32]) -> Result<Self, FinishError> {
        let [rings, sectors] = size;
        check_size(size, memory.len())?;
        let (density, rest) = memory.split_at((rings + 1) * sectors);
        let (within, rest) = rest.split_at(rings + 1);
        let (turned, seen) = rest.split_at((rings + 1) * sectors);
        Ok(Self { rings, sectors, density, within, turned, seen })
    }

    /// Number of rings and of sectors.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.rings, self.sectors]
    }

    /// D at the nodes, `[ring][sector]`.
    #[must_use]
    pub fn nodes(&self) -> &'a [f32] {
        self.density
    }

    /// sin²θ_m of a ring.
    #[inline]
    fn t(&self, ring: usize) -> f32 {
        let part = single(ring) / single(self.rings);
        let square = part * part;
        square * square
    }

    /// D along a vector above the horizon whose squared length is known.
    #[inline(never)]
    pub(super) fn density_along(&self, m: Vec3, length_square: f32) -> f32 {
        let t = ((m.x * m.x + m.y * m.y) / length_square).min(1.0);
        let ring = whole(sqrtf(sqrtf(t)) * single(self.rings)).min(self.rings - 1);
        let [low, high] = [self.t(ring), self.t(ring + 1)];
        let part = ((t - low) / (high - low)).clamp(0.0, 1.0);
        let (first, second) = (ring * self.sectors, (ring + 1) * self.sectors);
        let between = |j: usize| mix(at(self.density, first + j), at(self.density, second + j), part);
        if self.sectors == 1 {
            return between(0);
        }
        let (j, turned) = self.sector(m);
        mix(between(j), between(if j + 1 < self.sectors { j + 1 } else { 0 }), turned)
    }

    /// Sector of a vector's azimuth, and the part of it that is passed.
    #[inline]
    fn sector(&self, w: Vec3) -> (usize, f32) {
        let at = turn(w.x, w.y) * single(self.sectors);
        let j = whole(at).min(self.sectors - 1);
        (j, at - single(j))
    }

    /// Visible area of a direction.
    #[inline(never)]
    pub(super) fn visible_area(&self, w: Vec3) -> f32 {
        let place = sqrtf(w.z.clamp(0.0, 1.0)) * VIEWS as f32;
        let row = whole(place).min(VIEWS - 1);
        let weights = cubic(place - single(row));
        // e is an even function of √cos θ.
        let rows = [if row == 0 { 1 } else { row - 1 }, row, row + 1, row + 2].map(|row| row * self.sectors);
        let along = |j: usize| {
            let [a, b, c, d] = rows.map(|row| at(self.seen, row + j));
            (weights[0] * a + weights[1] * b) + (weights[2] * c + weights[3] * d)
        };
        let square = if self.sectors == 1 {
            along(0)
        } else {
            let (j, part) = self.sector(w);
            let [a, b, c, d] = cubic(part);
            let after = |j: usize| if j + 1 < self.sectors { j + 1 } else { 0 };
            let before = if j == 0 { self.sectors - 1 } else { j - 1 };
            (a * along(before) + b * along(j)) + (c * along(after(j)) + d * along(after(after(j))))
        };
        let seen = w.z * w.z + square * (w.x * w.x + w.y * w.y);
        // Interpolation may overshoot; the area of both directions together stays positive.
        0.5 * (w.z + sqrtf(seen.max(0.25 * w.z * w.z)))
    }

    /// Density with which [`FacetTable::draw`] draws a normal `m` that `wi` sees, by D there. `m` has the squared
    /// length that is given.
    #[inline(never)]
    pub(super) fn pdf(&self, wi: Vec3, m: Vec3, length_square: f32, density: f32) -> f32 {
        let across = wi.x * m.x + wi.y * m.y;
        let turned =
            if across > wi.z * m.z { self.density_along(Vec3::new(-m.x, -m.y, m.z), length_square) } else { 0.0 };
        (density + turned) * m.z / sqrtf(length_square)
    }

    /// Draws a normal by D cos θ_m, and turns it by half a turn about z if `wi` does not see it.
    pub(super) fn draw(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        let ring = self.within.partition_point(|sum| *sum <= u[0]).min(self.rings).saturating_sub(1);
        let last = self.sectors - 1;
        let ends_of = |of: &[f32], j: usize| [ring, ring + 1].map(|ring| at(of, ring * self.sectors + j));
        let [low, high] = [ring, ring + 1].map(|ring| at(self.within, ring));
        let part = linear_root(ends_of(self.turned, last), (u[0] - low) / (high - low));
        let t = mix(self.t(ring), self.t(ring + 1), part);
        let between = |of: &[f32], j: usize| {
            let [low, high] = ends_of(of, j);
            mix(low, high, part)
        };
        let to = |j: usize| between(self.turned, j);
        // The first sector whose end lies beyond.
        let wanted = u[1] * to(last);
        let (mut from, mut count) = (0, last);
        while count > 0 {
            let half = count / 2;
            if to(from + half) <= wanted {
                from += half + 1;
                count -= half + 1;
            } else {
                count = half;
            }
        }
        let passed = if from == 0 { 0.0 } else { to(from - 1) };
        let ends = [from, if from == last { 0 } else { from + 1 }].map(|j| between(self.density, j));
        let turned = linear_root(ends, (wanted - passed) / (to(from) - passed));
        let phi = TAU * (from as f32 + turned) / self.sectors as f32;
        let (sin, cos) = (sqrtf(t), sqrtf((1.0 - t).max(0.0)));
        let m = Vec3::new(sin * cosf(phi), sin * sinf(phi), cos);
        if wi.dot(m) < 0.0 { Vec3::new(-m.x, -m.y, m.z) } else { m }
    }
}

fn check_size([rings, sectors]: [usize; 2], memory: usize) -> Result<(), FinishError> {
    let is_one = sectors == 1 || (MIN_SECTORS..=MAX_SECTORS).contains(&sectors);
    let fits = (1..=MAX_RINGS).contains(&rings) && is_one && memory == FacetTable::required_len([rings, sectors]);
    fits.then_some(()).ok_or(FinishError::Size)
}

/// Value of an index; 0 beyond the end, which no checked table asks for: the library has no panics.
#[inline]
fn at(values: &[f32], index: usize) -> f32 {
    values.get(index).copied().unwrap_or(0.0)
}

/// A number of nodes; 32 bits convert faster than 64.
#[inline]
fn single(count: usize) -> f32 {
    count as u32 as f32
}

/// Whole part of a number of nodes; 0 for NaN.
#[inline]
fn whole(at: f32) -> usize {
    (at as i32).max(0) as usize
}

#[inline]
fn mix(a: f32, b: f32, part: f32) -> f32 {
    a + part * (b - a)
}

/// Weights of four equally spaced nodes between the second and the third (Catmull & Rom).
#[inline]
fn cubic(x: f32) -> [f32; 4] {
    let (square, cube) = (x * x, x * x * x);
    [
        -0.5 * cube + square - 0.5 * x,
        1.5 * cube - 2.5 * square + 1.0,
        -1.5 * cube + 2.0 * square + 0.5 * x,
        0.5 * cube - 0.5 * square,
    ]
}

/// Place in [0, 1] up to which a density that is linear between two ends holds a part `u` of all.
#[inline]
fn linear_root([a, b]: [f32; 2], u: f32) -> f32 {
    let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
    let root = sqrtf((a * a * (1.0 - u) + b * b * u).max(0.0));
    let divisor = a + root;
    if divisor > 0.0 { ((a + b) * u / divisor).min(1.0) } else { u }
}

/// Azimuth of a vector as a part of a turn, in [0, 1], with an error below 5e-7 turns.
///
/// The arctangent of up to 1 is an odd polynomial, fitted by least squares with weights that make the largest error
/// smallest.
#[inline]
fn turn(x: f32, y: f32) -> f32 {
    const COEFFICIENTS: [f32; 6] =
        [-1.865_130_6e-3, 8.379_018e-3, -1.852_979e-2, 3.080_288_5e-2, -5.293_856_4e-2, 0.159_151_32];
    let (long, short) = if x.abs() > y.abs() { (x.abs(), y.abs()) } else { (y.abs(), x.abs()) };
    let ratio = short / long.max(f32::MIN_POSITIVE);
    let square = ratio * ratio;
    let eighth = ratio * COEFFICIENTS.into_iter().fold(0.0, |sum, c| sum * square + c);
    let quarter = if x.abs() > y.abs() { eighth } else { 0.25 - eighth };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if y < 0.0 { 1.0 - half } else { half }
}

/// Computes the squared roughness e of directions.
///
/// What a direction w does not see, ∫ D (w·m)⁻ dω_m = σ − w·∫ D m dω_m, is summed over cos θ_m by four Gauss nodes in
/// each ring, and exactly over φ_m, where D is linear between sectors: the integral of a tent times (a + b cos φ)⁻ is
/// the second difference of its second antiderivative.
fn look([rings, sectors]: [usize; 2], nodes: &[f32], seen: &mut [f32]) -> Result<(), FinishError> {
    let tilt = mean_slope([rings, sectors], nodes);
    let is_level = tilt.iter().all(|slope| slope.abs() <= MAX_TILT);
    if !is_level {
        return Err(FinishError::Tilt);
    }
    let step = core::f64::consts::TAU / sectors as f64;
    for row in 0..VIEWS {
        let part = row as f64 / VIEWS as f64;
        let cos_w = part * part;
        let sin_w = sqrt(1.0 - cos_w * cos_w);
        let mut unseen = [0.0; MAX_SECTORS];
        over_rings(rings, |ring, part, cos_m, weight| {
            let (a, b) = (cos_w * cos_m, sin_w * sqrt(1.0 - cos_m * cos_m));
            if b <= a {
                return;
            }
            let hidden = Hidden::new(a, b);
            let density = |j: usize| {
                let [low, high] = [nodes[ring * sectors + j], nodes[(ring + 1) * sectors + j]].map(f64::from);
                low + part * (high - low)
            };
            if sectors == 1 {
                unseen[0] += weight * density(0) * hidden.whole();
                return;
            }
            let mut tents = [0.0; MAX_SECTORS];
            for (d, tent) in tents.iter_mut().take(sectors).enumerate() {
                let at = step * d as f64 - core::f64::consts::PI;
                *tent = (hidden.twice(at - step) - 2.0 * hidden.twice(at) + hidden.twice(at + step)) / step;
            }
            for j in 0..sectors {
                // The azimuth from the direction to the normal is (j − of) sectors; `at` above is less by half a turn.
                let density = weight * density(j);
                if density > 0.0 {
                    let (before, after) = tents[..sectors].split_at(j + 1);
                    let turned = before.iter().rev().chain(after.iter().rev());
                    unseen.iter_mut().zip(turned).for_each(|(unseen, tent)| *unseen += density * tent);
                }
            }
        });
        for (j, unseen) in unseen.iter().take(sectors).enumerate() {
            let phi = step * j as f64;
            let more = sin_w * (tilt[0] * cos(phi) + tilt[1] * sin(phi)) + unseen;
            seen[row * sectors + j] = (4.0 * (cos_w + more) * more / (sin_w * sin_w)) as f32;
        }
    }
    for row in VIEWS..VIEW_ROWS {
        for j in 0..sectors {
            let [first, second, third] = [3, 2, 1].map(|before| seen[(row - before) * sectors + j]);
            seen[row * sectors + j] = 3.0 * (third - second) + first;
        }
    }
    Ok(())
}

/// Calls `of` with the ring, the part of the way to the next, cos θ_m and the weight of each node of a quadrature over
/// cos θ_m.
fn over_rings(rings: usize, mut of: impl FnMut(usize, f64, f64, f64)) {
    /// Gauss nodes in [−1, 1] and their weights.
    const GAUSS: [[f64; 2]; 4] = [
        [-0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
        [-0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
        [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
        [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
    ];
    for ring in 0..rings {
        let [low, high] = [ring, ring + 1].map(|ring| FacetTable::sin_square(rings, ring));
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
fn mean_slope([rings, sectors]: [usize; 2], nodes: &[f32]) -> [f64; 2] {
    let mut slope = [0.0; 2];
    if sectors == 1 {
        return slope;
    }
    let step = core::f64::consts::TAU / sectors as f64;
    // Integral of a tent times a cosine, over the cosine at the tent's middle.
    let tent = 2.0 * (1.0 - cos(step)) / step;
    over_rings(rings, |ring, part, cos_m, weight| {
        let scale = weight * tent * sqrt(1.0 - cos_m * cos_m);
        for j in 0..sectors {
            let [low, high] = [nodes[ring * sectors + j], nodes[(ring + 1) * sectors + j]].map(f64::from);
            let phi = step * j as f64;
            let density = scale * (low + part * (high - low));
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
