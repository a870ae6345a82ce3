//! Tabulated distributions of normals.
//!
//! With t = sin²θ_m, cos θ_m dω_m = dt dφ/2: over t and φ the density of normals per area of the surface is D/2 itself.
//! D is bilinear between nodes at t = (k/rings)⁴ and at equal steps of φ, so it is drawn from exactly, by the roots of
//! two quadratic equations. The nodes follow narrow lobes and long tails.
//!
//! The squared roughness e that a direction sees is linear between nodes at cos θ = (i/256)², and cubic over φ.

use super::error::FinishError;
use super::facet_layout::{FacetLayout, VIEWS};
use super::visible::{cubic, look};
use crate::simd::lanes::sqrtf;
use crate::values::Values;
use core::f32::consts::TAU;
use glam::Vec3;
use libm::{cosf, sinf};
use wide::f32x4;

/// Largest magnitude of a number of a table: products of two, and of one with the inverse of both directions' least
/// cosines, stay in single precision. D is far below it, as ∫ D cos θ_m dω_m = 1.
const MAX_NUMBER: f32 = 1e18;

/// Tabulated density D of the normals of facets.
///
/// It holds D at `rings` + 1 angles θ_m, with sin²θ_m = (k/rings)⁴, and at `sectors` azimuths φ_m = 2π j/sectors. A
/// surface that is equally rough in all directions has one sector. D is scaled so that ∫ D cos θ_m dω_m = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetTable<'a> {
    layout: FacetLayout,
    values: Values<'a>,
    /// Number of rings, and its fourth power.
    rings: f32,
    rings_fourth: f32,
    /// Place of the numbers e, and how many a row has.
    seen: usize,
    view: usize,
}

/// What a table says of a pair of directions.
pub(super) struct Pair {
    /// Half the length of the sum.
    pub cos_d: f32,
    /// D of the half vector.
    pub density: f32,
    /// Density with which [`FacetTable::draw`] draws the half vector, over 4 cos θ_d.
    pub pdf: f32,
    /// Visible areas of both directions.
    pub areas: [f32; 2],
}

/// Where a pair of directions lies among a table's nodes.
struct Places {
    /// Ring, and the part of the way to the next.
    ring: usize,
    outward: f32,
    /// Where rows of e of both directions begin, and the parts of the way to the next.
    rows: [usize; 2],
    parts: [f32; 2],
}

impl<'a> FacetTable<'a> {
    /// Number of elements that [`FacetTable::new`] needs as memory; 0 for numbers of rings and sectors that it refuses.
    #[must_use]
    pub fn required_len(size: [usize; 2]) -> usize {
        FacetLayout::new(size).map_or(0, FacetLayout::len)
    }

    /// sin²θ_m of the nodes of a ring.
    #[must_use]
    pub fn sin_square(rings: usize, ring: usize) -> f64 {
        FacetLayout { rings, sectors: 1 }.sin_square(ring)
    }

    /// Table of D in any unit at its nodes, `density[ring][sector]`, computed in `memory`, which has
    /// [`FacetTable::required_len`] elements. It takes time in proportion to the rings and to the square of the
    /// sectors: 0.2 s for 96 rings of 72 sectors.
    ///
    /// # Errors
    /// [`FinishError::Size`] unless there are 1 to [`MAX_RINGS`](super::MAX_RINGS) rings, 1 or 4 to
    /// [`MAX_SECTORS`](super::MAX_SECTORS) sectors, a density for each node and enough memory;
    /// [`FinishError::Density`] where D is negative, not finite or nowhere positive; [`FinishError::Tilt`] for normals
    /// whose mean slope is above 0.02.
    pub fn new(size: [usize; 2], density: &[f32], memory: &'a mut [f32]) -> Result<Self, FinishError> {
        let layout = FacetLayout::new(size)?;
        let FacetLayout { rings, sectors } = layout;
        if density.len() != (rings + 1) * sectors || memory.len() != layout.len() {
            return Err(FinishError::Size);
        }
        if !density.iter().all(|d| d.is_finite() && *d >= 0.0) {
            return Err(FinishError::Density);
        }
        let (nodes, rest) = memory.split_at_mut(layout.seen());
        let (seen, rest) = rest.split_at_mut(layout.within() - layout.seen());
        let (within, turned) = rest.split_at_mut(rings + 1);
        // All sectors of the first ring are one direction.
        let rows = density.chunks_exact(sectors);
        let mean = |row: &[f32]| row.iter().map(|d| f64::from(*d)).sum::<f64>() / sectors as f64;
        let (mut sum, mut before) = (0.0, [0.0; 2]);
        for (ring, row) in rows.clone().enumerate() {
            let [t, mean] = [layout.sin_square(ring), mean(row)];
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
            let nodes = &mut nodes[ring * layout.ring()..][..layout.ring()];
            for (node, d) in nodes.iter_mut().zip(row.iter().cycle()) {
                *node = (if ring == 0 { pole } else { f64::from(*d) } / sum) as f32;
            }
            let mut sum = 0.0;
            for (j, turned) in turned[ring * sectors..][..sectors].iter_mut().enumerate() {
                sum += 0.5 * (f64::from(nodes[j]) + f64::from(nodes[(j + 1) % nodes.len()]));
                *turned = sum as f32;
            }
        }
        look(layout, nodes, seen)?;
        Self::of_values(size, Values::Numbers(memory))
    }

    /// Table in memory that [`FacetTable::new`] filled earlier.
    ///
    /// Numbers that it did not compute make a surface without meaning, but no panic, and no values that are not finite.
    ///
    /// # Errors
    /// [`FinishError::Size`] for other sizes, [`FinishError::Density`] for a number beyond 10¹⁸ or not finite, or a
    /// negative D.
    pub fn of(size: [usize; 2], memory: &'a [f32]) -> Result<Self, FinishError> {
        Self::of_values(size, Values::Numbers(memory))
    }

    pub(crate) fn of_values(size: [usize; 2], values: Values<'a>) -> Result<Self, FinishError> {
        let layout = FacetLayout::new(size)?;
        if values.len() != layout.len() {
            return Err(FinishError::Size);
        }
        let is_positive = values.part(0, layout.seen()).iter().all(|d| d >= 0.0);
        let fits = is_positive && values.first_beyond(MAX_NUMBER).is_none();
        let rings = single(layout.rings);
        let (square, seen, view) = (rings * rings, layout.seen(), layout.view());
        let table = Self { layout, values, rings, rings_fourth: square * square, seen, view };
        fits.then_some(table).ok_or(FinishError::Density)
    }

    /// All numbers, as in the memory of [`FacetTable::new`].
    pub(crate) fn values(&self) -> Values<'a> {
        self.values
    }

    /// Number of rings and of sectors.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.layout.rings, self.layout.sectors]
    }

    /// D at the nodes, `[ring][sector]`.
    pub fn nodes(&self) -> impl Iterator<Item = f32> + use<'a> {
        let Self { layout, values, .. } = *self;
        (0..=layout.rings).flat_map(move |ring| values.part(ring * layout.ring(), layout.sectors).iter())
    }

    /// D along a vector above the horizon.
    pub(super) fn density_along(&self, m: Vec3) -> f32 {
        self.pair([m; 2], m).density
    }

    /// Visible area of a direction.
    pub(super) fn visible_area(&self, w: Vec3) -> f32 {
        self.pair([w; 2], w).areas[0]
    }

    /// Looks up two directions above the horizon, of which the sum is known.
    #[inline(always)]
    pub(super) fn pair(&self, [wi, wo]: [Vec3; 2], sum: Vec3) -> Pair {
        // All roots that can be drawn at once.
        let level = sum.x * sum.x + sum.y * sum.y;
        let roots = f32x4::new([level, level + sum.z * sum.z, wi.z, wo.z]).sqrt();
        let [level, length, root_i, root_o] = roots.to_array();
        let over = 1.0 / length;
        let (sin, cos) = (level * over, sum.z * over);
        // Of a normal that wi does not see, draw takes the one that is turned by half a turn.
        let is_twin = wi.x * sum.x + wi.y * sum.y > wi.z * sum.z;
        let [density, twin, area_i, area_o] = if self.layout.sectors == 1 {
            let [density, area_i, area_o] = self.even(sin, [root_i, root_o], [wi.z, wo.z]);
            [density, density, area_i, area_o]
        } else {
            let [x, y] = [[sum.x, wi.x, wo.x, -sum.x], [sum.y, wi.y, wo.y, -sum.y]].map(f32x4::new);
            self.around(sin, [root_i, root_o], x, y, [wi.z, wo.z])
        };
        let pdf = 0.5 * (density + if is_twin { twin } else { 0.0 }) * cos * over;
        Pair { cos_d: (0.5 * length).min(1.0), density, pdf, areas: [area_i, area_o] }
    }

    /// D at t, and the visible areas of two cosines, of facets that are equally rough in all directions.
    #[inline(always)]
    fn even(&self, sin: f32, roots: [f32; 2], cos: [f32; 2]) -> [f32; 3] {
        let Places { ring, outward, rows, parts } = self.places(sin, roots);
        let [nodes, of_i, of_o] = self.values.arrays([ring, rows[0], rows[1]]);
        let mix = |[low, high]: [f32; 2], part| mix(low, high, part);
        let [area_i, area_o] = areas(cos, [mix(of_i, parts[0]), mix(of_o, parts[1])]);
        [mix(nodes, outward), area_i, area_o]
    }

    /// D of the first lane and, half a turn on, of the last; the visible areas of the directions in the lanes between.
    #[inline(never)]
    fn around(&self, sin: f32, roots: [f32; 2], x: f32x4, y: f32x4, cos: [f32; 2]) -> [f32; 4] {
        let Self { layout, values, .. } = *self;
        let Places { ring, outward, rows, parts } = self.places(sin, roots);
        let sectors = single(layout.sectors);
        let turned = turns(x, y) * sectors;
        let before = turned.fast_min(f32x4::splat(sectors - 0.5)).fast_trunc_int();
        let [passed_m, passed_i, passed_o, passed_twin] = (turned - before.round_float()).to_array();
        let [m, i, o, twin] = before.to_array().map(|sector| sector as u32 as usize);
        let (inner, outer) = (ring * layout.ring(), (ring + 1) * layout.ring());
        let nodes = values.arrays([inner + m, outer + m, inner + twin, outer + twin]);
        let [inner, outer, inner_twin, outer_twin]: [[f32; 2]; 4] = nodes;
        let density = |inner: [f32; 2], outer: [f32; 2], passed: f32| {
            mix(mix(inner[0], outer[0], outward), mix(inner[1], outer[1], outward), passed)
        };
        let [row_i, row_o] = [rows[0] + i, rows[1] + o];
        let rows = [row_i, row_i + layout.view(), row_o, row_o + layout.view()];
        let [low_i, high_i, low_o, high_o] = values.arrays(rows).map(f32x4::new);
        let e = |low: f32x4, high: f32x4, part: f32, passed: f32| {
            ((low + (high - low) * part) * f32x4::new(cubic(passed))).reduce_add()
        };
        let of_both = [e(low_i, high_i, parts[0], passed_i), e(low_o, high_o, parts[1], passed_o)];
        let [area_i, area_o] = areas(cos, of_both);
        [density(inner, outer, passed_m), density(inner_twin, outer_twin, passed_twin), area_i, area_o]
    }

    /// Places among rings of sin θ_m, and among rows of e of the roots of two cosines: R √sin θ_m and 256 √cos θ.
    #[inline(always)]
    fn places(&self, sin: f32, [root_i, root_o]: [f32; 2]) -> Places {
        const ROWS: f32 = VIEWS as f32;
        let sin = sin.min(1.0);
        let counts = f32x4::new([self.rings, ROWS, ROWS, ROWS]);
        let at = f32x4::new([sqrtf(sin), root_i, root_o, 0.0]) * counts;
        let nodes = at.fast_min(counts - f32x4::HALF).fast_trunc_int();
        let before = nodes.round_float();
        let [_, part_i, part_o, _] = (at - before).to_array();
        let [ring, row_i, row_o, _] = nodes.to_array().map(|node| node as u32 as usize);
        // With t = sin², the part of the way from a ring k to the next is (t R⁴ − k⁴)/((k + 1)⁴ − k⁴).
        let [k, ..] = before.to_array();
        let k_square = k * k;
        let apart = (k + k + 1.0) * (2.0 * (k_square + k) + 1.0);
        let outward = ((sin * sin * self.rings_fourth - k_square * k_square) / apart).clamp(0.0, 1.0);
        let rows = [row_i, row_o].map(|row| self.seen + row * self.view);
        Places { ring, outward, rows, parts: [part_i, part_o] }
    }

    /// Draws a normal by D cos θ_m, and turns it by half a turn about z if `wi` does not see it.
    pub(super) fn draw(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        let FacetLayout { rings, sectors } = self.layout;
        let (within, turned) = (self.layout.within(), self.layout.turned());
        let within = |ring: usize| self.values.at(within + ring);
        let ring = first(rings, |ring| within(ring + 1) > u[0]).min(rings - 1);
        let [low, high] = [within(ring), within(ring + 1)];
        let last = sectors - 1;
        // Integrals over sectors, at both rings and between them.
        let ends = |j: usize| [ring, ring + 1].map(|ring| self.values.at(turned + ring * sectors + j));
        let part = linear_root(ends(last), (u[0] - low) / (high - low));
        let [inner, outer] = [ring, ring + 1].map(|ring| self.layout.sin_square(ring) as f32);
        let t = mix(inner, outer, part);
        let to = |j: usize| {
            let [low, high] = ends(j);
            mix(low, high, part)
        };
        // The first sector whose end lies beyond.
        let wanted = u[1] * to(last);
        let from = first(last, |j| to(j) > wanted);
        let passed = if from == 0 { 0.0 } else { to(from - 1) };
        let step = 1.0 / single(sectors);
        let ends = [from, from + 1].map(|j| {
            let from = ring * self.layout.ring() + if sectors == 1 { 0 } else { j };
            mix(self.values.at(from), self.values.at(from + self.layout.ring()), part)
        });
        let turned = linear_root(ends, (wanted - passed) / (to(from) - passed));
        let phi = TAU * step * (single(from) + turned);
        let (sin, cos) = (sqrtf(t), sqrtf((1.0 - t).max(0.0)));
        let m = Vec3::new(sin * cosf(phi), sin * sinf(phi), cos);
        if wi.dot(m) < 0.0 { Vec3::new(-m.x, -m.y, m.z) } else { m }
    }
}

/// First of `count` indices of which a condition holds that holds of all after it; `count` if it holds of none.
fn first(mut count: usize, is_beyond: impl Fn(usize) -> bool) -> usize {
    let mut from = 0;
    while count > 0 {
        let half = count / 2;
        if is_beyond(from + half) {
            count = half;
        } else {
            from += half + 1;
            count -= half + 1;
        }
    }
    from
}

/// A number of nodes; 32 bits convert faster than 64.
#[inline]
fn single(count: usize) -> f32 {
    count as u32 as f32
}

/// Visible areas of two directions, by their cosines and the squared roughnesses that they see.
#[inline]
fn areas(cos: [f32; 2], e: [f32; 2]) -> [f32; 2] {
    let [[cos_i, cos_o], [e_i, e_o]] = [cos, e];
    let (cos, e) = (f32x4::new([cos_i, cos_o, 1.0, 1.0]), f32x4::new([e_i, e_o, 0.0, 0.0]));
    let square = cos * cos;
    let seen = square + e * (f32x4::ONE - square);
    // Interpolation may overshoot; the area of both directions together stays positive.
    let [area_i, area_o, ..] = ((cos + seen.fast_max(square * 0.25).sqrt()) * 0.5).to_array();
    [area_i, area_o]
}

#[inline]
fn mix(a: f32, b: f32, part: f32) -> f32 {
    a + part * (b - a)
}

/// Place in [0, 1] up to which a density that is linear between two ends holds a part `u` of all.
#[inline]
fn linear_root([a, b]: [f32; 2], u: f32) -> f32 {
    let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
    let root = sqrtf((a * a * (1.0 - u) + b * b * u).max(0.0));
    let divisor = a + root;
    if divisor > 0.0 { ((a + b) * u / divisor).min(1.0) } else { u }
}

/// Azimuths of vectors as parts of a turn, in [0, 1], with an error below 5e-7 turns.
///
/// The arctangent of up to 1 is an odd polynomial, fitted by least squares with weights that make the largest error
/// smallest. There are no branches, which random directions would mispredict.
#[inline]
fn turns(x: f32x4, y: f32x4) -> f32x4 {
    const COEFFICIENTS: [f32; 6] =
        [-1.865_130_6e-3, 8.379_018e-3, -1.852_979e-2, 3.080_288_5e-2, -5.293_856_4e-2, 0.159_151_32];
    let (across, along) = (y.abs(), x.abs());
    let ratio = across.fast_min(along) / across.fast_max(along).fast_max(f32x4::splat(f32::MIN_POSITIVE));
    let square = ratio * ratio;
    let eighth = ratio * COEFFICIENTS.into_iter().fold(f32x4::ZERO, |sum, c| sum * square + f32x4::splat(c));
    let quarter = along.simd_gt(across).select(eighth, f32x4::splat(0.25) - eighth);
    let half = x.simd_lt(f32x4::ZERO).select(f32x4::HALF - quarter, quarter);
    y.simd_lt(f32x4::ZERO).select(f32x4::ONE - half, half)
}
