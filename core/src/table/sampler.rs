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
/// of f is not 0. Between incident directions it is the mixture of theirs, by their shares times what each reflects. A
/// surface that reflects nothing is sampled by the cosine.
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
        let [mut u0, mut u1] = u.map(|u| if u > 0.0 { u.min(1.0 - 0.5 * f32::EPSILON) } else { 0.0 });
        let nodes = self.mixture(wi);
        // Which incident direction, which row, where in the row's tent: each takes its part of the first number.
        let [Node { index: mut chosen, .. }, ..] = nodes;
        let mut from = 0.0;
        for node in nodes.iter().filter(|node| node.weight > 0.0) {
            chosen = node.index;
            if u0 < from + node.weight {
                u0 = (u0 - from) / node.weight;
                break;
            }
            from += node.weight;
        }
        let memory = self.of_incident(chosen);
        let [rows, columns] = self.sides();
        let row = take(memory.part(1, rows), &mut u0);
        let column = take(memory.part(1 + rows + row * columns, columns), &mut u1);
        let cos =
            ((row as f32 + 0.5 + held_tent(u0, row == 0, row + 1 == rows)) / rows as f32).clamp(f32::MIN_POSITIVE, 1.0);
        let phi = azimuth(wi) + TAU * (column as f32 + tent(u1)) / columns as f32;
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

fn stride(layout: &ScatterLayout) -> usize {
    1 + layout.bins().cos as usize + layout.bins().count()
}

fn fill(table: &ScatterTable<'_>, incident: usize, memory: &mut [f32]) {
    let layout = table.layout();
    let (rows, columns) = (layout.bins().cos as usize, layout.bins().phi as usize);
    let per_channel = 1.0 / table.channels() as f64;
    let mean = |bin| table.pair(incident, bin).map(|f| f64::from(f.abs())).sum::<f64>() * per_channel;
    let cos = |row: usize| (row as f64 + 0.5) / rows as f64;
    let of_row = |row: usize| (0..columns).map(|column| mean(row * columns + column)).sum::<f64>() * cos(row);
    let total: f64 = (0..rows).map(of_row).sum();
    let mut put = |place: usize, sum: f64| {
        if let Some(memory) = memory.get_mut(place) {
            *memory = sum as f32;
        }
    };
    put(0, total * core::f64::consts::TAU / (rows * columns) as f64);
    let mut sum = 0.0;
    for row in 0..rows {
        let here = of_row(row);
        sum += if total > 0.0 { here / total } else { 2.0 * cos(row) / rows as f64 };
        put(1 + row, sum);
        let mut sum = 0.0;
        for column in 0..columns {
            sum += if here > 0.0 { mean(row * columns + column) * cos(row) / here } else { 1.0 / columns as f64 };
            put(1 + rows + row * columns + column, sum);
        }
        put(rows + (row + 1) * columns, 1.0);
    }
    put(rows, 1.0);
}

/// The probability of one place.
fn step(cumulative: Values<'_>, place: usize) -> f32 {
    cumulative.at(place) - before(cumulative, place)
}

/// The probability of all places before one.
fn before(cumulative: Values<'_>, place: usize) -> f32 {
    place.checked_sub(1).map_or(0.0, |place| cumulative.at(place))
}

/// Which place `u` falls on; `u` becomes uniform again in [0, 1).
fn take(cumulative: Values<'_>, u: &mut f32) -> usize {
    let (mut place, mut last) = (0, cumulative.len().saturating_sub(1));
    while place < last {
        let middle = place.midpoint(last);
        if cumulative.at(middle) <= *u { place = middle + 1 } else { last = middle }
    }
    let width = step(cumulative, place);
    *u =
        if width > 0.0 { ((*u - before(cumulative, place)) / width).clamp(0.0, 1.0 - 0.5 * f32::EPSILON) } else { 0.5 };
    place
}

/// A tent over (−1, 1) from a uniform number.
fn tent(u: f32) -> f32 {
    if u < 0.5 { libm::sqrtf(2.0 * u) - 1.0 } else { 1.0 - libm::sqrtf(2.0 - 2.0 * u) }
}

/// A tent whose outer half, in the first and the last row, is flat and half as wide.
fn held_tent(u: f32, first: bool, last: bool) -> f32 {
    if (first && u < 0.5) || (last && u >= 0.5) { u - 0.5 } else { tent(u) }
}
