//! Directions drawn in proportion to the luminance of a lat-long grid.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// A piecewise constant distribution over the cells of a lat-long grid.
///
/// The weight of a cell is its solid angle times the mean over it of the bilinear interpolation between cells
/// ([1 6 1]/8 along each axis), so that no direction from which any light comes is left out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Distribution {
    size: [usize; 2],
    /// Cumulative probabilities of the rows.
    rows: Vec<f64>,
    /// Cumulative probabilities of the cells in each row, row by row.
    columns: Vec<f64>,
}

impl Distribution {
    /// The distribution over a grid of width and height, in proportion to the luminance `of(x, y)` of its cells.
    /// Uniform over the sphere if all of them are 0.
    pub fn new([width, height]: [usize; 2], of: impl Fn(usize, usize) -> f64) -> Self {
        let along_row = |y: usize| -> Vec<f64> {
            let row: Vec<f64> = (0..width).map(|x| of(x, y)).collect();
            (0..width).map(|x| 0.125 * (row[(x + width - 1) % width] + 6.0 * row[x] + row[(x + 1) % width])).collect()
        };
        let (mut rows, mut columns) = (Vec::with_capacity(height), Vec::with_capacity(width * height));
        let mut above = along_row(0);
        let mut here = above.clone();
        let mut total = 0.0;
        for y in 0..height {
            let below = along_row((y + 1).min(height - 1));
            let mut sum = 0.0;
            let from = columns.len();
            for x in 0..width {
                sum += 0.125 * (above[x] + 6.0 * here[x] + below[x]);
                columns.push(sum);
            }
            // A row without light is never drawn.
            columns[from..].iter_mut().for_each(|c| *c /= if sum > 0.0 { sum } else { 1.0 });
            total += sum * solid_angle(y, height);
            rows.push(total);
            (above, here) = (here, below);
        }
        if total <= 0.0 {
            // Darkness is the same everywhere: one cell.
            return Self { size: [1, 1], rows: vec![1.0], columns: vec![1.0] };
        }
        rows.iter_mut().for_each(|row| *row /= total);
        Self { size: [width, height], rows, columns }
    }

    /// A place u, v in the image, drawn by two numbers uniform in [0, 1).
    pub fn sample(&self, [u0, u1]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size;
        let (y, within_row) = invert_cdf(&self.rows, u1);
        let (x, within) = invert_cdf(&self.columns[y * width..][..width], u0);
        // Uniform over the cell's solid angle: uniform in cos θ.
        let (top, bottom) = ((PI * y as f64 / height as f64).cos(), (PI * (y + 1) as f64 / height as f64).cos());
        let v = (top + within_row * (bottom - top)).clamp(-1.0, 1.0).acos() * FRAC_1_PI;
        [(x as f64 + within) / width as f64, v]
    }

    /// Probability density per solid angle at a place u, v in the image.
    pub fn pdf(&self, [u, v]: [f64; 2]) -> f64 {
        let [width, height] = self.size;
        let cell = |place: f64, count: usize| ((place * count as f64) as usize).min(count - 1);
        let (x, y) = (cell(u, width), cell(v, height));
        let probability = probability(&self.rows, y) * probability(&self.columns[y * width..][..width], x);
        probability * width as f64 / (TAU * solid_angle(y, height))
    }
}

/// Solid angle of a row of cells, in units of 2π.
fn solid_angle(y: usize, height: usize) -> f64 {
    // cos a − cos b without cancellation.
    let half = 0.5 * PI / height as f64;
    2.0 * ((2 * y + 1) as f64 * half).sin() * half.sin()
}

/// The probability of one cell among cumulative ones.
fn probability(cumulative: &[f64], place: usize) -> f64 {
    cumulative[place] - if place == 0 { 0.0 } else { cumulative[place - 1] }
}

/// How far from the edges of its cell a direction is drawn, as a fraction of the cell. On an edge, rounding would give
/// it to the next cell, which may be dark. Rounding is largest within a cell by a pole, in a row's arc cosine: 2⁻⁵³
/// over the square of its polar angle, 10⁻⁸ of a row among 32768.
const EDGE: f64 = 1e-6;

/// The cell that `u` falls into, the first whose cumulative probability is larger, and how far into it.
fn invert_cdf(cumulative: &[f64], u: f64) -> (usize, f64) {
    let place = cumulative.partition_point(|&sum| sum <= u).min(cumulative.len() - 1);
    let (width, from) = (probability(cumulative, place), if place == 0 { 0.0 } else { cumulative[place - 1] });
    (place, if width > 0.0 { ((u - from) / width).clamp(EDGE, 1.0 - EDGE) } else { 0.5 })
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Numbers at and beside the edges of all rows, and of all columns.
    pub(in super::super) fn edges(distribution: &Distribution) -> [Vec<f64>; 2] {
        [&distribution.rows, &distribution.columns].map(|sums| {
            let around = sums.iter().flat_map(|sum| [sum.next_down(), *sum, sum.next_up()]);
            around.chain([0.0, 1.0 - f64::EPSILON / 2.0]).filter(|u| (0.0..1.0).contains(u)).collect()
        })
    }
}
