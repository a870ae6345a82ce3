//! Importance sampling of outgoing directions.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::{GridNode, ScatterLayout};
use super::scatter::{Place, ScatterTable, divisor};
use super::tents::tent_solid_angles;
use super::values::Values;
use glam::Vec3;

/// Importance sampler of a [`ScatterTable`], without its lobes.
///
/// It first draws a node of the warped square, with a probability proportional to the mean of |s| over the channels
/// times the solid angle that the node stands for, and then a place in the node's tent, which is its interpolation
/// weight in [`ScatterTable::eval`]. The density over the square is therefore the bilinear interpolation of the nodes'
/// probabilities divided by their areas: it integrates to 1, and is positive wherever any channel of s is not 0 and
/// wherever a direction is drawn. Between incident directions the density is the mixture of theirs, with their
/// interpolation weights times what each reflects. A surface that reflects nothing is sampled evenly.
///
/// Some places of the square are half vectors that reflect below the horizon. A draw there is a sample without light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSampler<'a> {
    table: ScatterTable<'a>,
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
        Ok(Self { table: *table, cumulative: Values::Numbers(memory) })
    }

    /// Checks cumulative probabilities that were computed earlier.
    ///
    /// # Errors
    /// [`TableError::Length`] unless there are [`ScatterSampler::required_len`] numbers, and [`TableError::NotFinite`]
    /// at the first incident direction whose numbers are not sound.
    pub(super) fn of(cumulative: Values<'a>, table: ScatterTable<'a>) -> Result<Self, TableError> {
        let layout = table.layout();
        let required = Self::required_len(&layout);
        if cumulative.len() != required {
            return Err(TableError::Length { required });
        }
        let sampler = Self { table, cumulative };
        match (0..layout.incident_count()).find(|&incident| !sampler.is_sound(incident)) {
            Some(incident) => Err(TableError::NotFinite { index: incident * stride(&layout) }),
            None => Ok(sampler),
        }
    }

    /// Whether an incident direction reflects a finite power, and its probabilities are not negative and add up to 1.
    fn is_sound(&self, incident: usize) -> bool {
        let [columns, rows] = self.sides();
        let memory = self.of_incident(incident);
        let ends_at_1 = |sums: Values<'_>| {
            let mut last = 0.0;
            sums.iter().all(|sum| core::mem::replace(&mut last, sum) <= sum) && last == 1.0
        };
        let reflected = memory.at(0);
        let of_row = |row| memory.part(1 + rows + row * columns, columns);
        // The square covers 2π at most, and cos θ_i is 0.017 at least.
        (0.0..=400.0 * MAX_MAGNITUDE).contains(&reflected)
            && ends_at_1(memory.part(1, rows))
            && (0..rows).all(|row| ends_at_1(of_row(row)))
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.cumulative
    }

    /// Numbers of columns (along x) and rows (along y) of the square.
    #[inline]
    fn sides(&self) -> [usize; 2] {
        self.table.layout().square_sides().map(|side| side as usize)
    }

    /// Fraction of the light from `wi` that the table reflects without its lobes: the mean of |s| over the channels,
    /// summed over the square. It serves to choose between lobes and [`ScatterSampler::sample`].
    #[must_use]
    pub fn reflected(&self, wi: Vec3) -> f32 {
        let power = |node: &GridNode| node.weight * self.of_incident(node.index).at(0);
        self.table.layout().incident_nodes(wi).iter().map(power).sum()
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
        let memory = self.of_incident(chosen);
        let [columns, rows] = self.sides();
        let row = invert_cdf(memory.part(1, rows), &mut u0);
        let column = invert_cdf(memory.part(1 + rows + row * columns, columns), &mut u1);
        let x = column as f32 + end_tent(u1, column == 0, column + 1 == columns);
        let y = row as f32 + tent(u0);
        let place = [x / columns.saturating_sub(1).max(1) as f32, y / rows.max(1) as f32];
        let place = [place[0], place[1] - libm::floorf(place[1])];
        let (m, solid_angle) = self.table.warp().half_vector(place, self.table.origin(wi));
        let cos_d = wi.dot(m);
        let wo = 2.0 * cos_d * m - wi;
        let density = self.over_square(&mixture, &self.table.layout().square_nodes(place[0], place[1]));
        let pdf = density / (solid_angle * cos_d);
        (cos_d > 0.0 && wo.z > 0.0 && pdf > 0.0 && pdf.is_finite()).then(|| (wo.normalize(), pdf))
    }

    /// Density per solid angle with which [`ScatterSampler::sample`] draws `wo` for `wi`; 0 if either is below the
    /// horizon. Over the hemisphere it integrates to 1 less the fraction of draws below the horizon.
    #[must_use]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        let Some(Place { nodes, solid_angle, .. }) = self.table.place(wi, wo) else { return 0.0 };
        let pdf = self.over_square(&self.mixture(wi), &nodes) / solid_angle;
        if pdf.is_finite() { pdf } else { 0.0 }
    }

    /// Density over the square at a place between `nodes`.
    fn over_square(&self, mixture: &[GridNode; 4], nodes: &[GridNode; 4]) -> f32 {
        let [columns, rows] = self.sides();
        let mut density = 0.0;
        for incident in mixture.iter().filter(|incident| incident.weight > 0.0) {
            let memory = self.of_incident(incident.index);
            for node in nodes {
                let (row, column) = (node.index / columns.max(1), node.index % columns.max(1));
                let of_row = memory.part(1 + rows + row * columns, columns);
                let probability = probability_at(memory.part(1, rows), row) * probability_at(of_row, column);
                // The first and the last column have half a tent.
                let half = column == 0 || column + 1 == columns;
                density += incident.weight * node.weight * probability * if half { 2.0 } else { 1.0 };
            }
        }
        density * columns.saturating_sub(1) as f32 * rows as f32
    }

    /// Interpolation nodes for `wi`, weighted by what each incident direction reflects; the weights add up to 1.
    fn mixture(&self, wi: Vec3) -> [GridNode; 4] {
        let nodes = self.table.layout().incident_nodes(wi);
        let power = |node: GridNode| node.weight * self.of_incident(node.index).at(0);
        let sum: f32 = nodes.map(power).iter().sum();
        if sum > 0.0 { nodes.map(|node| GridNode { weight: power(node) / sum, ..node }) } else { nodes }
    }

    /// Numbers of an incident direction.
    fn of_incident(&self, incident: usize) -> Values<'a> {
        let stride = stride(&self.table.layout());
        self.cumulative.part(incident * stride, stride)
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
    let (head, nodes) = memory.split_at_mut(1 + rows);
    tent_solid_angles(&layout, &table.warp(), wi, table.origin(wi), |node, solid_angle| {
        if let Some(part) = nodes.get_mut(node) {
            *part += solid_angle;
        }
    });
    for (node, part) in nodes.iter_mut().enumerate() {
        *part *= table.at(incident, node).map(|s| s.abs() * per_channel).sum::<f32>();
    }
    let (total, row_sums) = head.split_at_mut(1);
    let mut whole = 0.0;
    for (row, sum) in nodes.chunks_exact_mut(columns.max(1)).zip(row_sums.iter_mut()) {
        let reflected = row.iter().map(|&part| f64::from(part)).sum::<f64>();
        accumulate(row, reflected);
        *sum = reflected as f32;
        whole += reflected;
    }
    accumulate(row_sums, whole);
    if let [total] = total {
        *total = whole as f32;
    }
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

/// Probability of one index.
fn probability_at(cumulative: Values<'_>, index: usize) -> f32 {
    cumulative.at(index) - probability_before(cumulative, index)
}

/// Probability of all indices before one.
fn probability_before(cumulative: Values<'_>, index: usize) -> f32 {
    index.checked_sub(1).map_or(0.0, |index| cumulative.at(index))
}

/// Inverts a cumulative distribution: returns the first index whose sum is larger than `u`, and makes `u` uniform in
/// [0, 1) again. An index of probability 0 has the sum of the one before it, so it is never the first.
fn invert_cdf(cumulative: Values<'_>, u: &mut f32) -> usize {
    let (mut index, mut last) = (0, cumulative.len().saturating_sub(1));
    while index < last {
        let middle = index.midpoint(last);
        if cumulative.at(middle) <= *u { index = middle + 1 } else { last = middle }
    }
    let width = probability_at(cumulative, index);
    *u = if width > 0.0 { inside_unit((*u - probability_before(cumulative, index)) / width) } else { 0.5 };
    index
}

/// Draws from a tent over (−1, 1) by a uniform number.
fn tent(u: f32) -> f32 {
    if u < 0.5 { libm::sqrtf(2.0 * u) - 1.0 } else { 1.0 - libm::sqrtf(2.0 - 2.0 * u) }
}

/// Draws from the tent of a column; the first and the last have its inner half alone.
fn end_tent(u: f32, first: bool, last: bool) -> f32 {
    if first {
        1.0 - libm::sqrtf(1.0 - u)
    } else if last {
        libm::sqrtf(u) - 1.0
    } else {
        tent(u)
    }
}
