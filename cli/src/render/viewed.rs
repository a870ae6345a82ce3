//! A table of scattered light as one viewer sees it: interpolated once over the table's incident directions, then
//! looked up and sampled many times.
//!
//! The table's incident direction is the viewer, in evaluation and in sampling: f is reciprocal. s = f cos θ_i cos θ_o
//! and the sampling density are bilinear over the warped square of half vectors. Sampling inverts the integrals of this
//! density over the rows, then over the two rows around the place: a continuous map of the unit square, which keeps
//! well spread points well spread.

use glam::Vec3;
use goniochrome::table::{GridNode, ScatterLayout, ScatterSampler, ScatterTable};

use crate::support::error::{Error, Result};
use crate::support::memory::filled;

/// A table of scattered light with the density by which it is sampled.
#[derive(Debug)]
pub(super) struct SampledTable<'a> {
    pub table: ScatterTable<'a>,
    /// s of each channel, then the density over the square times what is reflected: `[incident][node][channel]`.
    nodes: Vec<f32>,
}

impl<'a> SampledTable<'a> {
    /// Adds densities, those of [`ScatterSampler`], to the values of a table, `[incident][place][channel]`.
    ///
    /// # Errors
    /// Too little memory.
    pub fn new(table: ScatterTable<'a>, values: &[f32]) -> Result<Self> {
        let (layout, channels) = (table.layout(), table.channels());
        let what = "sampling the table";
        let mut sums = filled(0.0, ScatterSampler::required_len(&layout), what)?;
        ScatterSampler::new(&table, &mut sums).map_err(Error::failed)?;
        let mut nodes = filled(0.0, layout.incident_count() * layout.node_count() * (channels + 1), what)?;
        let [columns, rows] = sides(&layout);
        let of_incident = layout.node_count() * (channels + 1);
        let incidents = nodes.chunks_mut(of_incident).zip(sums.chunks(1 + rows + rows * columns));
        for ((nodes, sums), values) in incidents.zip(values.chunks(layout.places() * channels)) {
            let reflected = sums[0];
            let (of_rows, of_columns) = sums[1..].split_at(rows);
            for (node, out) in nodes.chunks_mut(channels + 1).enumerate() {
                let (row, column) = (node / columns, node % columns);
                let share = difference(of_rows, row) * difference(&of_columns[row * columns..], column);
                // The first and the last column have half a tent.
                let half = if column == 0 || column + 1 == columns { 2.0 } else { 1.0 };
                out[..channels].copy_from_slice(&values[node * channels..][..channels]);
                out[channels] = reflected * share * half * (columns - 1) as f32 * rows as f32;
            }
        }
        Ok(Self { table, nodes })
    }
}

/// A [`SampledTable`] as one viewer sees it.
#[derive(Debug, Default)]
pub(super) struct ViewedTable {
    viewer: Vec3,
    /// Azimuth from which half vectors count.
    origin: f32,
    /// s of each channel over cos θ_i, then the density: `[node][channel]`.
    nodes: Vec<f32>,
    /// Numbers of each node.
    width: usize,
    /// Integral of the density over each row, and the integral over y up to each row.
    rows: Vec<[f32; 2]>,
}

/// A direction towards the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct TableTowards {
    /// Unit vector in the frame of the surface.
    pub direction: Vec3,
    /// Density per solid angle with which [`ViewedTable::sample`] draws it.
    pub pdf: f32,
    nodes: [GridNode; 4],
}

impl ViewedTable {
    /// Interpolates the table for a viewer above the horizon.
    pub fn look(&mut self, table: &SampledTable<'_>, viewer: Vec3) {
        let layout = table.table.layout();
        let ([columns, rows], width) = (sides(&layout), table.table.channels() + 1);
        self.viewer = viewer;
        self.width = width;
        self.origin = layout.origin(viewer);
        let count = layout.node_count() * width;
        let incident = layout.incident_nodes(viewer);
        let [a, b, c, d] = incident.map(|node| &table.nodes[node.index * count..][..count]);
        let [of_a, of_b, of_c, of_d] = incident.map(|node| node.weight);
        self.nodes.clear();
        let four = a.iter().zip(b).zip(c.iter().zip(d));
        self.nodes.extend(four.map(|((a, b), (c, d))| of_a * a + of_b * b + of_c * c + of_d * d));
        let over = 1.0 / viewer.z.max(ScatterLayout::THETA_MAX.cos() as f32);
        self.rows.clear();
        let mut total = 0.0;
        for row in self.nodes.chunks_mut(columns * width) {
            let (mut sum, last) = (0.0, columns - 1);
            for (column, node) in row.chunks_mut(width).enumerate() {
                sum += node[width - 1] * if column == 0 || column == last { 0.5 } else { 1.0 };
                node[..width - 1].iter_mut().for_each(|s| *s *= over);
            }
            self.rows.push([sum / last as f32, 0.0]);
        }
        // The last row lies beside the first.
        self.rows.push(self.rows[0]);
        for row in 0..rows {
            total += 0.5 * (self.rows[row][0] + self.rows[row + 1][0]) / rows as f32;
            self.rows[row + 1][1] = total;
        }
    }

    /// Fraction of the light that is reflected, without lobes, as the sampling densities have it.
    fn reflected(&self) -> f32 {
        self.rows.last().map_or(0.0, |row| row[1])
    }

    /// What is known of a direction towards the light, above the horizon.
    pub fn towards(&self, table: &SampledTable<'_>, direction: Vec3) -> TableTowards {
        let warped = table.table.warp().warped(self.viewer, direction, self.origin);
        let nodes = table.table.layout().square_nodes(warped.place[0], warped.place[1]);
        let pdf = self.density(nodes) / (self.reflected() * warped.solid_angle);
        TableTowards { direction, pdf: if pdf.is_finite() { pdf } else { 0.0 }, nodes }
    }

    /// Draws a direction towards the light by `u`, uniform in [0, 1)²; `None` for a draw below the horizon.
    pub fn sample(&self, table: &SampledTable<'_>, u: [f32; 2]) -> Option<TableTowards> {
        let layout = table.table.layout();
        let ([columns, rows], width) = (sides(&layout), self.width);
        let whole = self.reflected();
        let up_to = u[1] * whole;
        let row = self.rows.partition_point(|row| row[1] <= up_to).clamp(1, rows) - 1;
        let [from, to] = [row, row + 1].map(|row| self.rows[row][0]);
        let t = within((up_to - self.rows[row][1]) * rows as f32, from, to);
        // Along the line between two rows, the density is linear between columns.
        let [lower, upper] = [row, (row + 1) % rows].map(|row| &self.nodes[row * columns * width..][..columns * width]);
        let at = |column: usize| {
            let i = column * width + width - 1;
            lower[i] + t * (upper[i] - lower[i])
        };
        let mut left = u[0] * (from + t * (to - from)) * (columns - 1) as f32;
        let (mut column, mut ends) = (0, [at(0), at(1)]);
        loop {
            let inside = 0.5 * (ends[0] + ends[1]);
            if left <= inside || column + 2 >= columns {
                break;
            }
            left -= inside;
            column += 1;
            ends = [ends[1], at(column + 1)];
        }
        let x = (column as f32 + within(left, ends[0], ends[1])) / (columns - 1) as f32;
        let y = (row as f32 + t) / rows as f32;
        let (m, solid_angle) = table.table.warp().half_vector([x, y], self.origin);
        let cos = self.viewer.dot(m);
        let direction = 2.0 * cos * m - self.viewer;
        let nodes = layout.square_nodes(x, y);
        let pdf = self.density(nodes) / (whole * solid_angle * cos);
        let counts = cos > 0.0 && direction.z > 0.0 && pdf > 0.0 && pdf.is_finite();
        counts.then(|| TableTowards { direction: direction.normalize(), pdf, nodes })
    }

    /// Writes f cos θ of the light's direction to `out`, for each channel.
    pub fn reflect(&self, towards: &TableTowards, out: &mut [f32]) {
        out.fill(0.0);
        for GridNode { index, weight } in towards.nodes {
            let node = &self.nodes[index * (out.len() + 1)..][..out.len()];
            out.iter_mut().zip(node).for_each(|(out, s)| *out += weight * s);
        }
    }

    /// Density over the square, times what is reflected.
    fn density(&self, nodes: [GridNode; 4]) -> f32 {
        nodes.iter().map(|node| node.weight * self.nodes[(node.index + 1) * self.width - 1]).sum()
    }
}

/// Numbers of columns and rows of the square of half vectors.
fn sides(layout: &ScatterLayout) -> [usize; 2] {
    layout.square_sides().map(|side| side as usize)
}

/// One of the parts that cumulative sums add up.
fn difference(sums: &[f32], index: usize) -> f32 {
    sums[index] - index.checked_sub(1).map_or(0.0, |before| sums[before])
}

/// The place t in [0, 1] up to which a density that is linear between its ends has the integral `rest`: the root of
/// from t + ½ (to − from) t² = rest, without cancellation.
fn within(rest: f32, from: f32, to: f32) -> f32 {
    let root = (from * from + 2.0 * rest * (to - from)).max(0.0).sqrt();
    let t = 2.0 * rest / (from + root);
    if t.is_finite() { t.clamp(0.0, 1.0) } else { 0.5 }
}
