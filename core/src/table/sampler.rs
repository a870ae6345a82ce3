//! Importance sampling of outgoing directions.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::{GridNode, ScatterLayout};
use super::scatter::{ScatterTable, divisor};
use super::tents::tent_solid_angles;
use super::warp::HalfVectorWarp;
use crate::simd::lanes::sqrtf;
use crate::values::Values;
use glam::Vec3;

/// Importance sampler of a [`ScatterTable`], without its lobes.
///
/// It first draws a node of the warped square, with a probability proportional to the mean of |s| over the channels
/// times the solid angle that the node stands for, and then a place in the node's tent, which is its interpolation
/// weight in [`ScatterTable::eval`]. The density over the square is therefore the bilinear interpolation of the nodes'
/// probabilities divided by their areas: it integrates to 1, and is positive wherever any channel of s is not 0 and
/// wherever a direction is drawn. Between incident directions the density is the mixture of theirs, with their
/// interpolation weights times what each reflects. A surface that reflects nothing is sampled over all of the square.
///
/// Some places of the square are half vectors that reflect below the horizon. A draw there is a sample without light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSampler<'a> {
    layout: ScatterLayout,
    warp: HalfVectorWarp<'a>,
    /// Numbers of each incident direction: what it reflects, without lobes; cumulative probabilities of the rows;
    /// cumulative probabilities of the nodes in each row.
    cumulative: Values<'a>,
}

impl<'a> ScatterSampler<'a> {
    /// Number of elements that [`ScatterSampler::new`] needs as memory.
    #[must_use]
    pub fn required_len(layout: &ScatterLayout) -> usize {
        layout.incident_count() * stride(layout)
    }

    /// Computes the cumulative probabilities of a table in `memory`, which has [`ScatterSampler::required_len`]
    /// elements.
    ///
    /// # Errors
    /// [`TableError::Length`] if `memory` has another length.
    pub fn new(table: &ScatterTable<'a>, memory: &'a mut [f32]) -> Result<Self, TableError> {
        let layout = table.layout();
        let required = Self::required_len(&layout);
        if memory.len() != required {
            return Err(TableError::Length { required });
        }
        for (incident, memory) in memory.chunks_exact_mut(stride(&layout)).enumerate() {
            fill(table, incident, memory);
        }
        Ok(Self { layout, warp: table.warp(), cumulative: Values::Numbers(memory) })
    }

    /// Checks cumulative probabilities that were computed earlier.
    ///
    /// # Errors
    /// [`TableError::Length`] unless there are [`ScatterSampler::required_len`] numbers, and [`TableError::NotFinite`]
    /// at the first incident direction whose numbers are not sound.
    pub(super) fn of(cumulative: Values<'a>, table: &ScatterTable<'a>) -> Result<Self, TableError> {
        let layout = table.layout();
        let required = Self::required_len(&layout);
        if cumulative.len() != required {
            return Err(TableError::Length { required });
        }
        let sampler = Self { layout, warp: table.warp(), cumulative };
        match (0..layout.incident_count()).find(|&incident| !sampler.is_sound(incident)) {
            Some(incident) => Err(TableError::NotFinite { index: incident * stride(&layout) }),
            None => Ok(sampler),
        }
    }

    /// Whether an incident direction reflects a finite power, and its probabilities are not negative and add up to 1.
    fn is_sound(&self, incident: usize) -> bool {
        let [columns, rows] = self.sides();
        let ends_at_1 = |from, count| {
            let mut last = 0.0;
            let sums = self.cumulative.part(from, count);
            sums.iter().all(|sum| core::mem::replace(&mut last, sum) <= sum) && last == 1.0
        };
        // The square covers 2π at most, and cos θ_i is 0.017 at least.
        (0.0..=400.0 * MAX_MAGNITUDE).contains(&self.power(incident))
            && ends_at_1(self.rows_of(incident), rows)
            && (0..rows).all(|row| ends_at_1(self.nodes_of(incident, row), columns))
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.cumulative
    }

    /// Numbers of columns (along x) and rows (along y) of the square.
    #[inline]
    fn sides(&self) -> [usize; 2] {
        self.layout.square_sides().map(|side| side as usize)
    }

    /// Fraction of the light from `wi` that the table reflects without its lobes: the mean of |s| over the channels,
    /// summed over the square, over cos θ_i. It serves to choose between lobes and [`ScatterSampler::sample`].
    #[must_use]
    pub fn reflected(&self, wi: Vec3) -> f32 {
        self.layout.incident_nodes(wi).iter().map(|node| node.weight * self.power(node.index)).sum()
    }

    /// Draws an outgoing direction for light from `wi`, by `u` uniform in [0, 1)²; returns the direction and its
    /// density per solid angle, which is positive. `None` if `wi` is below the horizon, or the direction drawn is: that
    /// is a sample without light, and counts.
    #[must_use]
    pub fn sample(&self, wi: Vec3, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let above = wi.z > 0.0;
        if !above {
            return None;
        }
        let [mut u0, mut u1] = u.map(inside_unit);
        let mixture = self.mixture(wi);
        // The first number chooses the incident direction, then the row, then the position in the row's tent: each
        // choice leaves a uniform number for the next.
        let [GridNode { index: mut chosen, .. }, ..] = mixture;
        let mut from = 0.0;
        for node in mixture.iter().filter(|node| node.weight > 0.0) {
            chosen = node.index;
            if u0 < from + node.weight {
                u0 = inside_unit((u0 - from) / node.weight);
                break;
            }
            from += node.weight;
        }
        let [columns, rows] = self.sides();
        let row = self.invert(self.rows_of(chosen), rows, &mut u0);
        let column = self.invert(self.nodes_of(chosen, row), columns, &mut u1);
        let x = column as f32 + end_tent(u1, column == 0, column + 1 == columns);
        let y = row as f32 + tent(u0);
        let (x, y) = (x / columns.saturating_sub(1).max(1) as f32, y / rows.max(1) as f32);
        let (m, solid_angle) = self.warp.half_vector([x, y - libm::floorf(y)], self.layout.origin(wi));
        let cos_d = wi.dot(m);
        let wo = 2.0 * cos_d * m - wi;
        let pdf = self.over_square(&mixture, x, y) / (solid_angle * cos_d);
        let drawn = cos_d > 0.0 && wo.z > 0.0 && pdf > 0.0 && pdf.is_finite();
        drawn.then(|| (wo.normalize_or_zero(), pdf))
    }

    /// Density per solid angle with which [`ScatterSampler::sample`] draws `wo` for `wi`; 0 if either is below the
    /// horizon. Over the hemisphere it integrates to 1 less the fraction of draws below the horizon. At the pole, for
    /// `wo` exactly opposite in azimuth and equal in polar angle, the density is not finite, and 0 is returned.
    #[must_use]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        let above = wi.z > 0.0 && wo.z > 0.0;
        if !above {
            return 0.0;
        }
        let warped = self.warp.warped(wi, wo, self.layout.origin(wi));
        let [x, y] = warped.place;
        let pdf = self.over_square(&self.mixture(wi), x, y) / warped.solid_angle;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// Density over the square at a place.
    #[inline]
    fn over_square(&self, mixture: &[GridNode; 4], x: f32, y: f32) -> f32 {
        let [columns, rows] = self.sides();
        let [along_x, along_y] = self.layout.square_axes(x, y);
        // The first and the last column have half a tent.
        let along_x = along_x.map(|GridNode { index, weight }| {
            let half = index == 0 || index + 1 == columns;
            GridNode { index, weight: if half { 2.0 * weight } else { weight } }
        });
        let mut density = 0.0;
        for incident in mixture.iter().filter(|incident| incident.weight > 0.0) {
            for row in along_y {
                let nodes = self.nodes_of(incident.index, row.index);
                let of_row: f32 = along_x.iter().map(|node| node.weight * self.probability(nodes, node.index)).sum();
                density +=
                    incident.weight * row.weight * self.probability(self.rows_of(incident.index), row.index) * of_row;
            }
        }
        density * (columns.saturating_sub(1) * rows) as f32
    }

    /// Interpolation nodes for `wi`, weighted by what each incident direction reflects; the weights add up to 1.
    #[inline]
    fn mixture(&self, wi: Vec3) -> [GridNode; 4] {
        let nodes = self.layout.incident_nodes(wi);
        let powers = nodes.map(|node| if node.weight > 0.0 { node.weight * self.power(node.index) } else { 0.0 });
        let sum: f32 = powers.iter().sum();
        if sum > 0.0 { core::array::from_fn(|i| GridNode { weight: powers[i] / sum, ..nodes[i] }) } else { nodes }
    }

    /// What an incident direction reflects, without lobes.
    #[inline]
    fn power(&self, incident: usize) -> f32 {
        self.cumulative.at(incident * stride(&self.layout))
    }

    /// Index of the cumulative probabilities of an incident direction's rows.
    #[inline]
    fn rows_of(&self, incident: usize) -> usize {
        incident * stride(&self.layout) + 1
    }

    /// Index of the cumulative probabilities of the nodes in a row.
    #[inline]
    fn nodes_of(&self, incident: usize, row: usize) -> usize {
        let [columns, rows] = self.sides();
        self.rows_of(incident) + rows + row * columns
    }

    /// Probability of one index among cumulative ones that begin at `from`.
    #[inline]
    fn probability(&self, from: usize, index: usize) -> f32 {
        self.cumulative.at(from + index) - self.before(from, index)
    }

    /// Probability of all indices before one.
    #[inline]
    fn before(&self, from: usize, index: usize) -> f32 {
        if index == 0 { 0.0 } else { self.cumulative.at(from + index - 1) }
    }

    /// Inverts `count` cumulative probabilities that begin at `from`: returns the first index whose sum is larger than
    /// `u`, and makes `u` uniform in [0, 1) again. An index of probability 0 has the sum of the one before it, so it is
    /// never the first.
    #[inline]
    fn invert(&self, from: usize, count: usize, u: &mut f32) -> usize {
        // Halves without branches, which random numbers would mispredict.
        let (mut index, mut left) = (0, count);
        while left > 1 {
            let half = left / 2;
            index += if self.cumulative.at(from + index + half - 1) <= *u { half } else { 0 };
            left -= half;
        }
        let before = self.before(from, index);
        let width = self.cumulative.at(from + index) - before;
        *u = if width > 0.0 { inside_unit((*u - before) / width) } else { 0.5 };
        index
    }
}

/// Largest single-precision number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// Clamps a uniform number to [2⁻⁴⁶, 1 − 2⁻²⁴]. An exact 0 could draw what is less probable than 2⁻⁴⁶, whose density
/// would be 0 in single precision.
fn inside_unit(u: f32) -> f32 {
    const MIN: f32 = f32::EPSILON * f32::EPSILON;
    if u > MIN { u.min(BELOW_ONE) } else { MIN }
}

/// How many numbers each incident direction has.
fn stride(layout: &ScatterLayout) -> usize {
    1 + layout.square_sides()[1] as usize + layout.node_count()
}

/// Computes the numbers of an incident direction.
fn fill(table: &ScatterTable<'_>, incident: usize, memory: &mut [f32]) {
    let layout = table.layout();
    let [columns, rows] = layout.square_sides().map(|side| side as usize);
    let [theta, phi] = layout.incident(incident);
    let (sin, cos) = libm::sincos(theta);
    let wi = Vec3::new((sin * libm::cos(phi)) as f32, (sin * libm::sin(phi)) as f32, cos as f32);
    let per_channel = 1.0 / (table.channels() as f32 * divisor(wi));
    memory.fill(0.0);
    let [total, memory @ ..] = memory else { return };
    let Some((row_sums, nodes)) = memory.split_at_mut_checked(rows) else { return };
    tent_solid_angles(&layout, &table.warp(), wi, layout.origin(wi), |node, solid_angle| {
        if let Some(part) = nodes.get_mut(node) {
            *part += solid_angle;
        }
    });
    for (node, part) in nodes.iter_mut().enumerate() {
        let mean: f32 = table.at(incident, node).map(|s| s.abs() * per_channel).sum();
        // Between incident directions the horizon leaves nodes that it hides from this one, and they may hold light.
        let lit = table.at(incident, node).any(|s| s != 0.0);
        *part = if lit { (*part * mean).max(f32::MIN_POSITIVE) } else { 0.0 };
    }
    let mut whole = 0.0;
    for (row, sum) in nodes.chunks_exact_mut(columns.max(1)).zip(row_sums.iter_mut()) {
        let reflected = row.iter().map(|&part| f64::from(part)).sum::<f64>();
        accumulate(row, reflected);
        *sum = reflected as f32;
        whole += reflected;
    }
    accumulate(row_sums, whole);
    *total = whole as f32;
}

/// Replaces parts by the cumulative shares of their sum `whole`; by even ones if they add up to nothing.
fn accumulate(parts: &mut [f32], whole: f64) {
    let count = parts.len() as f64;
    let lit = parts.iter().filter(|part| **part > 0.0).count();
    let mut sum = 0.0;
    for part in &mut *parts {
        sum += if whole > 0.0 { share(f64::from(*part), whole, lit) } else { 1.0 / count };
        *part = sum.min(1.0) as f32;
    }
    // The last part with light ends at 1, and so do those after it.
    let end = parts.last().copied().unwrap_or(0.0);
    parts.iter_mut().filter(|part| **part == end).for_each(|part| *part = 1.0);
}

/// Probability of a part of a sum that has `lit` parts other than 0. Each of those gets 2⁻²³, and the remainder in
/// proportion to its size: a smaller probability would be lost in the cumulative sums of single precision, and what is
/// reflected there would never be drawn.
fn share(part: f64, whole: f64, lit: usize) -> f64 {
    const MIN: f64 = f32::EPSILON as f64;
    if part > 0.0 { (part / whole + MIN) / (1.0 + lit as f64 * MIN) } else { 0.0 }
}

/// Draws from a tent over (−1, 1) by a uniform number.
fn tent(u: f32) -> f32 {
    if u < 0.5 { sqrtf(2.0 * u) - 1.0 } else { 1.0 - sqrtf(2.0 - 2.0 * u) }
}

/// Draws from the tent of a column; the first and the last have its inner half alone.
fn end_tent(u: f32, first: bool, last: bool) -> f32 {
    if first {
        1.0 - sqrtf(1.0 - u)
    } else if last {
        sqrtf(u) - 1.0
    } else {
        tent(u)
    }
}
