//! Drawing outgoing directions as a table reflects them.

use super::layout::{azimuth, polar};
use super::{LARGEST, Node, ScatterLayout, ScatterTable, TableError, Values};
use core::f32::consts::TAU;
use glam::Vec3;

/// Importance sampling of a [`ScatterTable`].
///
/// A bin's tent, the share that [`ScatterTable::eval`] gives it, is drawn with a probability in proportion to the bin's mean
/// of |f| over the channels times cos θ_o; then a direction in the tent. The density is therefore the bilinear
/// interpolation of the bins' probabilities over their solid angle: it integrates to 1, and is positive wherever any channel
/// of f is not 0, and wherever a direction is drawn. Between incident directions it is the mixture of theirs, by their
/// shares times what each reflects. A surface that reflects nothing is sampled by the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScatterSampler<'a> {
    layout: ScatterLayout,
    /// For each incident direction: what it reflects; cumulative probabilities of the rows; of the columns in each row.
    cumulative: Values<'a>,
}

impl<'a> ScatterSampler<'a> {
    /// Length of the memory that [`ScatterSampler::new`] needs.
    #[must_use]
    pub fn required_len(layout: &ScatterLayout) -> usize {
        layout.incident_count() * stride(layout)
    }

    /// Sums the table's probabilities into `memory`.
    ///
    /// # Errors
    /// [`TableError::Length`].
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

    /// Checks sums that were made earlier, [`ScatterSampler::required_len`] of them.
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

    /// Whether an incident direction reflects a finite power and its probabilities add up to 1.
    fn is_sound(&self, incident: usize) -> bool {
        let [rows, columns] = self.sides();
        let memory = self.of_incident(incident);
        let whole = |sums: Values<'_>| {
            let mut last = 0.0;
            sums.iter().all(|sum| core::mem::replace(&mut last, sum) <= sum) && last == 1.0
        };
        let reflected = memory.at(0);
        let of_row = |row| memory.part(1 + rows + row * columns, columns);
        // ∫ cos θ dω over a hemisphere is π, and a little more in sums of bins.
        (0.0..=4.0 * LARGEST).contains(&reflected)
            && whole(memory.part(1, rows))
            && (0..rows).all(|row| whole(of_row(row)))
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.cumulative
    }

    /// Rows and columns of outgoing bins.
    #[inline]
    fn sides(&self) -> [usize; 2] {
        let bins = self.layout.bins();
        [bins.cos as usize, bins.phi as usize]
    }

    /// A direction for the light from `wi`, and its density per solid angle; `u` uniform in [0, 1)². `None` for `wi` below the
    /// horizon.
    #[must_use]
    pub fn sample(&self, wi: Vec3, u: [f32; 2]) -> Option<(Vec3, f32)> {
        let above = wi.z > 0.0;
        if !above {
            return None;
        }
        let [mut u0, mut u1] = u.map(within);
        let nodes = self.mixture(wi);
        // Which incident direction, which row, where in the row's tent: each takes its part of the first number.
        let [Node { index: mut chosen, .. }, ..] = nodes;
        let mut from = 0.0;
        for node in nodes.iter().filter(|node| node.weight > 0.0) {
            chosen = node.index;
            if u0 < from + node.weight {
                u0 = within((u0 - from) / node.weight);
                break;
            }
            from += node.weight;
        }
        let memory = self.of_incident(chosen);
        let [rows, columns] = self.sides();
        let row = invert_cdf(memory.part(1, rows), &mut u0);
        let column = invert_cdf(memory.part(1 + rows + row * columns, columns), &mut u1);
        let place = row as f32 + 0.5 + held_tent(u0, row == 0, row + 1 == rows, tent_end(rows));
        // Along the normal there is no azimuth, and the column would be lost.
        let cos = (place / rows as f32).clamp(f32::MIN_POSITIVE, BELOW_ONE);
        let phi = azimuth(wi) + TAU * (column as f32 + tent(u1, tent_end(columns))) / columns as f32;
        let sin = libm::sqrtf((1.0 - cos * cos).max(0.0));
        let wo = Vec3::new(sin * libm::cosf(phi), sin * libm::sinf(phi), cos);
        Some((wo, self.pdf(wi, wo)))
    }

    /// The density of [`ScatterSampler::sample`] per solid angle; 0 below the horizon.
    #[must_use]
    pub fn pdf(&self, wi: Vec3, wo: Vec3) -> f32 {
        let Some((_, outgoing)) = self.layout.nodes(wi, wo) else { return 0.0 };
        let per_bin = self.layout.bins().count() as f32 / TAU;
        let [rows, columns] = self.sides();
        let mut density = 0.0;
        for Node { index, weight } in self.mixture(wi) {
            let memory = self.of_incident(index);
            for o in outgoing {
                let (row, column) = (o.index / columns.max(1), o.index % columns.max(1));
                let of_row = memory.part(1 + rows + row * columns, columns);
                let probability = step(memory.part(1, rows), row) * step(of_row, column);
                density += weight * o.weight * probability;
            }
        }
        density * per_bin
    }

    /// The incident directions around `wi`, by their shares times what each reflects.
    fn mixture(&self, wi: Vec3) -> [Node; 4] {
        let nodes = self.layout.incident_nodes(polar(wi), azimuth(wi));
        let share = |node: Node| node.weight * self.of_incident(node.index).at(0);
        let sum: f32 = nodes.map(share).iter().sum();
        if sum > 0.0 { nodes.map(|node| Node { weight: share(node) / sum, ..node }) } else { nodes }
    }

    fn of_incident(&self, incident: usize) -> Values<'a> {
        let stride = stride(&self.layout);
        self.cumulative.part(incident * stride, stride)
    }
}

/// The largest number below 1.
const BELOW_ONE: f32 = 1.0 - 0.5 * f32::EPSILON;

/// A uniform number, kept between 0 and 1: what is less probable than 2⁻⁴⁶ is not drawn by an exact 0, since its
/// density could not be told from 0 in single precision.
fn within(u: f32) -> f32 {
    const ABOVE_ZERO: f32 = f32::EPSILON * f32::EPSILON;
    if u > ABOVE_ZERO { u.min(BELOW_ONE) } else { ABOVE_ZERO }
}

fn stride(layout: &ScatterLayout) -> usize {
    1 + layout.bins().cos as usize + layout.bins().count()
}

fn fill(table: &ScatterTable<'_>, incident: usize, memory: &mut [f32]) {
    let layout = table.layout();
    let (rows, columns) = (layout.bins().cos as usize, layout.bins().phi as usize);
    let per_channel = 1.0 / table.channels() as f64;
    let mean = |bin| table.pair(incident, bin).map(|f| f64::from(f.abs())).sum::<f64>() * per_channel;
    let cos = |row: usize| (row as f64 + 0.5) / rows as f64;
    // A sum, and how many of its parts are not 0.
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

/// The probability of a part of a sum, of whose parts `lit` are not 0. Each of those gets 2⁻²³ first, and the rest by
/// its size: less would be lost where probabilities are summed up in single precision, and what is reflected there
/// never drawn.
fn share(part: f64, whole: f64, lit: usize) -> f64 {
    const MIN: f64 = f32::EPSILON as f64;
    if part > 0.0 { (part / whole + MIN) / (1.0 + lit as f64 * MIN) } else { 0.0 }
}

/// The probability of one place.
fn step(cumulative: Values<'_>, place: usize) -> f32 {
    cumulative.at(place) - before(cumulative, place)
}

/// The probability of all places before one.
fn before(cumulative: Values<'_>, place: usize) -> f32 {
    place.checked_sub(1).map_or(0.0, |place| cumulative.at(place))
}

/// Which place `u` falls on, the first whose sum is larger; `u` becomes uniform again. A place without probability has
/// the sum of the one before it, and is never the first.
fn invert_cdf(cumulative: Values<'_>, u: &mut f32) -> usize {
    let (mut place, mut last) = (0, cumulative.len().saturating_sub(1));
    while place < last {
        let middle = place.midpoint(last);
        if cumulative.at(middle) <= *u { place = middle + 1 } else { last = middle }
    }
    let width = step(cumulative, place);
    *u = if width > 0.0 { within((*u - before(cumulative, place)) / width) } else { 0.5 };
    place
}

/// Where a bin's tent ends, in bins from its middle, among `count`: short of the middle of the next bin, where the tent
/// is 0 and a direction, rounded, may lie beyond it.
///
/// A direction's azimuth goes through a sine, a cosine and an arc tangent, and is added to another and taken from it:
/// seven roundings of numbers below 4π, each at most 2⁻²⁴ of them, are within 8 · 2⁻²³ of a turn. A cosine is rounded
/// less. Of the directions, the square of what is cut off is moved: 10⁻⁶ of them for 1024 bins, 4 · 10⁻⁹ for 64.
fn tent_end(count: usize) -> f32 {
    1.0 - 8.0 * f32::EPSILON * count as f32
}

/// A tent over (−`end`, `end`), where `end` is nearly 1, from a uniform number.
fn tent(u: f32, end: f32) -> f32 {
    let place = if u < 0.5 { libm::sqrtf(2.0 * u) - 1.0 } else { 1.0 - libm::sqrtf(2.0 - 2.0 * u) };
    place.max(-end).min(end)
}

/// A tent whose outer half, in the first and the last row, is flat and half as wide.
fn held_tent(u: f32, first: bool, last: bool, end: f32) -> f32 {
    if (first && u < 0.5) || (last && u >= 0.5) { u - 0.5 } else { tent(u, end) }
}
