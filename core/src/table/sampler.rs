//! Importance sampling of outgoing directions.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::{GridNode, ScatterLayout, azimuth, polar};
use super::scatter::ScatterTable;
use super::values::Values;
use core::f32::consts::TAU;
use glam::Vec3;

/// Importance sampler of a [`ScatterTable`].
///
/// It first draws a bin, with a probability proportional to the mean of |f| over the channels times cos θ_o, and then a
/// direction from the bin's tent, which is the bin's interpolation weight in [`ScatterTable::eval`]. The density is
/// therefore the bilinear interpolation of the bins' probabilities divided by their solid angle: it integrates to 1,
/// and is positive wherever any channel of f is not 0 and wherever a direction is drawn. Between incident directions
/// the density is the mixture of theirs, with their interpolation weights times what each reflects. A surface that
/// reflects nothing is sampled by the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSampler<'a> {
    layout: ScatterLayout,
    /// Numbers of each incident direction: what it reflects; cumulative probabilities of the rows; cumulative
    /// probabilities of the columns in each row.
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
    pub fn new(table: &ScatterTable<'_>, memory: &'a mut [f32]) -> Result<Self, TableError> {
        let layout = table.layout();
        let required = Self::required_len(&layout);
        if memory.len() != required {
            return Err(TableError::Length { required });
        }
        for (incident, memory) in memory.chunks_exact_mut(stride(&layout)).enumerate() {
            fill(table, incident, memory);
        }
        Ok(Self { layout, cumulative: Values::Numbers(memory) })
    }

    /// Checks cumulative probabilities that were computed earlier.
    ///
    /// # Errors
    /// [`TableError::Length`] unless there are [`ScatterSampler::required_len`] numbers, and [`TableError::NotFinite`]
    /// at the first incident direction whose numbers are not sound.
    pub(super) fn of(cumulative: Values<'a>, layout: ScatterLayout) -> Result<Self, TableError> {
        let required = Self::required_len(&layout);
        if cumulative.len() != required {
            return Err(TableError::Length { required });
        }
        let sampler = Self { layout, cumulative };
        match (0..layout.incident_count()).find(|&incident| !sampler.is_sound(incident)) {
            Some(incident) => Err(TableError::NotFinite { index: incident * stride(&layout) }),
            None => Ok(sampler),
        }
    }

    /// Whether an incident direction reflects a finite power, and its probabilities are not negative and add up to 1.
    fn is_sound(&self, incident: usize) -> bool {
        let [rows, columns] = self.sides();
        let memory = self.of_incident(incident);
        let ends_at_1 = |sums: Values<'_>| {
            let mut last = 0.0;
            sums.iter().all(|sum| core::mem::replace(&mut last, sum) <= sum) && last == 1.0
        };
        let reflected = memory.at(0);
        let of_row = |row| memory.part(1 + rows + row * columns, columns);
        // The integral of cos θ dω over a hemisphere is π; the sum over bins is slightly larger.
        (0.0..=4.0 * MAX_MAGNITUDE).contains(&reflected)
            && ends_at_1(memory.part(1, rows))
            && (0..rows).all(|row| ends_at_1(of_row(row)))
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.cumulative
    }

    /// Numbers of rows and columns of outgoing bins.
    #[inline]
    fn sides(&self) -> [usize; 2] {
        let bins = self.layout.bins();
        [bins.cos as usize, bins.phi as usize]
    }

    /// Draws an outgoing direction for light from `wi`, by `u` uniform in [0, 1)²; returns the direction and its
    /// density per solid angle. `None` if `wi` is below the horizon.
    #[must_use]
    pub fn sample(&self, wi: Vec3, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let above = wi.z > 0.0;
        if !above {
            return None;
        }
        let [mut u0, mut u1] = u.map(inside_unit);
        let nodes = self.mixture(wi);
        // The first number chooses the incident direction, then the row, then the position in the row's tent: each
        // choice leaves a uniform number for the next.
        let [GridNode { index: mut chosen, .. }, ..] = nodes;
        let mut from = 0.0;
        for node in nodes.iter().filter(|node| node.weight > 0.0) {
            chosen = node.index;
            if u0 < from + node.weight {
                u0 = inside_unit((u0 - from) / node.weight);
                break;
            }
            from += node.weight;
        }
        let memory = self.of_incident(chosen);
        let [rows, columns] = self.sides();
        let row = invert_cdf(memory.part(1, rows), &mut u0);
        let column = invert_cdf(memory.part(1 + rows + row * columns, columns), &mut u1);
        let place = row as f32 + 0.5 + row_tent(u0, row == 0, row + 1 == rows, tent_end(rows));
        // cos θ stays below 1: along the normal there is no azimuth, and the column would be lost.
        let cos = (place / rows as f32).clamp(f32::MIN_POSITIVE, BELOW_ONE);
        let phi = azimuth(wi) + TAU * (column as f32 + tent(u1, tent_end(columns))) / columns as f32;
        let sin = libm::sqrtf((1.0 - cos * cos).max(0.0));
        let wo = Vec3::new(sin * libm::cosf(phi), sin * libm::sinf(phi), cos);
        Some((wo, self.pdf(wi, wo)))
    }

    /// Density per solid angle with which [`ScatterSampler::sample`] draws `wo` for `wi`; 0 if either is below the
    /// horizon.
    #[must_use]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        let Some((_, outgoing)) = self.layout.nodes(wi, wo) else { return 0.0 };
        let per_bin = self.layout.bins().count() as f32 / TAU;
        let [rows, columns] = self.sides();
        let mut density = 0.0;
        for GridNode { index, weight } in self.mixture(wi) {
            let memory = self.of_incident(index);
            for o in outgoing {
                let (row, column) = (o.index / columns.max(1), o.index % columns.max(1));
                let of_row = memory.part(1 + rows + row * columns, columns);
                let probability = probability_at(memory.part(1, rows), row) * probability_at(of_row, column);
                density += weight * o.weight * probability;
            }
        }
        density * per_bin
    }

    /// Interpolation nodes for `wi`, weighted by what each incident direction reflects; the weights add up to 1.
    fn mixture(&self, wi: Vec3) -> [GridNode; 4] {
        let nodes = self.layout.incident_nodes(polar(wi), azimuth(wi));
        let power = |node: GridNode| node.weight * self.of_incident(node.index).at(0);
        let sum: f32 = nodes.map(power).iter().sum();
        if sum > 0.0 { nodes.map(|node| GridNode { weight: power(node) / sum, ..node }) } else { nodes }
    }

    /// Numbers of an incident direction.
    fn of_incident(&self, incident: usize) -> Values<'a> {
        let stride = stride(&self.layout);
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
    1 + layout.bins().cos as usize + layout.bins().count()
}

/// Computes the numbers of an incident direction.
fn fill(table: &ScatterTable<'_>, incident: usize, memory: &mut [f32]) {
    let layout = table.layout();
    let (rows, columns) = (layout.bins().cos as usize, layout.bins().phi as usize);
    let per_channel = 1.0 / table.channels() as f64;
    let mean = |bin| table.pair(incident, bin).map(|f| f64::from(f.abs())).sum::<f64>() * per_channel;
    let cos = |row: usize| (row as f64 + 0.5) / rows as f64;
    // Adds a part to a sum, and counts the parts that are not 0.
    let add = |(sum, lit): (f64, usize), part: f64| (sum + part, lit + usize::from(part > 0.0));
    let of_row = |row: usize| (0..columns).map(|column| mean(row * columns + column) * cos(row)).fold((0.0, 0), add);
    let (total, lit_rows) = (0..rows).map(|row| of_row(row).0).fold((0.0, 0), add);
    let mut put = |place: usize, sum: f64| {
        if let Some(memory) = memory.get_mut(place) {
            *memory = sum as f32;
        }
    };
    put(0, total * core::f64::consts::TAU / (rows * columns) as f64);
    let mut sum = 0.0;
    for row in 0..rows {
        let (here, lit) = of_row(row);
        sum += if total > 0.0 { share(here, total, lit_rows) } else { 2.0 * cos(row) / rows as f64 };
        put(1 + row, sum);
        let mut sum = 0.0;
        for column in 0..columns {
            let probability = || share(mean(row * columns + column) * cos(row), here, lit);
            sum += if here > 0.0 { probability() } else { 1.0 / columns as f64 };
            put(1 + rows + row * columns + column, sum);
        }
        put(rows + (row + 1) * columns, 1.0);
    }
    put(rows, 1.0);
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

/// Half width of a bin's tent, in bins, among `count` bins. It ends just before the middle of the next bin, where the
/// tent is 0: rounding could move a direction drawn there beyond it.
///
/// An azimuth passes through a sine, a cosine and an arc tangent, and another azimuth is added to it and subtracted.
/// These are seven roundings of numbers below 4π, each by at most 2⁻²⁴ of the number: together less than 8 · 2⁻²³ of a
/// full circle. A cosine is rounded less. The fraction of directions that are moved is the square of the width that is
/// cut off: 10⁻⁶ for 1024 bins, 4 · 10⁻⁹ for 64.
fn tent_end(count: usize) -> f32 {
    1.0 - 8.0 * f32::EPSILON * count as f32
}

/// Draws from a tent over (−`end`, `end`), where `end` is nearly 1, by a uniform number.
fn tent(u: f32, end: f32) -> f32 {
    let position = if u < 0.5 { libm::sqrtf(2.0 * u) - 1.0 } else { 1.0 - libm::sqrtf(2.0 - 2.0 * u) };
    position.max(-end).min(end)
}

/// Draws from the tent of a row. In the first and the last row its outer half is flat and half as wide.
fn row_tent(u: f32, first: bool, last: bool, end: f32) -> f32 {
    if (first && u < 0.5) || (last && u >= 0.5) { u - 0.5 } else { tent(u, end) }
}
