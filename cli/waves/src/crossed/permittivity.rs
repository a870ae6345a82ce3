//! Fourier matrices of the permittivity of a layer, by the rules of Li (1997), "New formulation of the Fourier modal
//! method for crossed surface-relief gratings", J. Opt. Soc. Am. A 14, 2758.
//!
//! Orders (m, n) are numbered m-major: (m + M_x)(2M_y + 1) + n + M_y.

use num_complex::Complex64;

use crate::error::WaveError;
use crate::fourier::toeplitz;
use crate::linear::{Matrix, inverse};
use crate::profile::CrossedSlice;

/// Permittivity of a layer on a grid of rectangles, without lines at which nothing changes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Cells {
    /// Grid lines along x.
    x: Vec<f64>,
    /// Grid lines along y.
    y: Vec<f64>,
    /// Permittivity `rows[j][i]` from line i along x and line j along y to the next ones, the last over the period's
    /// end.
    rows: Vec<Vec<Complex64>>,
}

impl Cells {
    /// Grid of a layer.
    pub(super) fn new(slice: &CrossedSlice) -> Self {
        let mut x: Vec<f64> = slice.strips.iter().flat_map(|strip| strip.edges_nm.iter().copied()).collect();
        x.sort_by(f64::total_cmp);
        x.dedup();
        let starts = if x.is_empty() { &[0.0][..] } else { &x };
        let rows = slice.strips.iter().map(|strip| {
            let medium = |&start: &f64| match strip.edges_nm.partition_point(|&edge| edge <= start) {
                0 => strip.eta[strip.eta.len() - 1],
                after => strip.eta[after - 1],
            };
            starts.iter().map(|start| medium(start).powi(2)).collect()
        });
        let mut cells = Self { rows: rows.collect(), x, y: slice.strip_edges_nm.clone() };
        // Lines along y first, then, with the axes exchanged, those along x.
        cells.y = merge(&cells.y, &mut cells.rows);
        let mut columns = transposed(&cells.rows);
        cells.x = merge(&cells.x, &mut columns);
        cells.rows = transposed(&columns);
        cells
    }

    /// Permittivity of a layer that has one medium.
    pub(super) fn uniform(&self) -> Option<Complex64> {
        (self.x.is_empty() && self.y.is_empty()).then(|| self.rows[0][0])
    }
}

/// Removes equal neighbours among `rows`, the last and the first included, and returns the edges that are left.
fn merge(edges: &[f64], rows: &mut Vec<Vec<Complex64>>) -> Vec<f64> {
    if edges.is_empty() {
        return Vec::new();
    }
    let n = edges.len();
    let keep: Vec<usize> = (0..n).filter(|&i| rows[i] != rows[(i + n - 1) % n]).collect();
    if keep.is_empty() {
        rows.truncate(1);
    } else {
        *rows = keep.iter().map(|&i| rows[i].clone()).collect();
    }
    keep.iter().map(|&i| edges[i]).collect()
}

fn transposed(rows: &[Vec<Complex64>]) -> Vec<Vec<Complex64>> {
    (0..rows[0].len()).map(|i| rows.iter().map(|row| row[i]).collect()).collect()
}

/// Matrices that give D from E for the orders of a truncation.
pub(super) struct Permittivity {
    /// From E_x: the inverse rule along x, the direct rule along y.
    pub x: Matrix,
    /// From E_y: the direct rule along x, the inverse rule along y.
    pub y: Matrix,
    /// From E_z, which is continuous at each wall: the direct rule.
    pub z: Matrix,
}

impl Permittivity {
    /// Matrices for orders |m| ≤ `max_order[0]`, |n| ≤ `max_order[1]`.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if a matrix of the inverse rule has no inverse.
    pub(super) fn new(cells: &Cells, period: [f64; 2], max_order: [usize; 2]) -> Result<Self, WaveError> {
        let [n_x, n_y] = max_order.map(|order| 2 * order + 1);
        let along_x = Axis { period: period[0], edges: &cells.x, max_order: max_order[0] };
        let along_y = Axis { period: period[1], edges: &cells.y, max_order: max_order[1] };
        let zeros = || Matrix::zeros(n_x * n_y, n_x * n_y);
        let mut found = Self { x: zeros(), y: zeros(), z: zeros() };
        for (row, share) in along_y.distinct(&cells.rows) {
            add_product(&mut found.x, &along_x.inverse_rule(row)?, &share);
            add_product(&mut found.z, &along_x.direct_rule(row), &share);
        }
        for (column, share) in along_x.distinct(&transposed(&cells.rows)) {
            add_product(&mut found.y, &share, &along_y.inverse_rule(column)?);
        }
        Ok(found)
    }
}

/// Indices (m, n) of the orders.
pub(super) fn indices(max_order: [usize; 2]) -> impl Iterator<Item = [i32; 2]> {
    let [m_x, m_y] = max_order.map(|order| i32::try_from(order).unwrap_or(i32::MAX));
    (-m_x..=m_x).flat_map(move |m| (-m_y..=m_y).map(move |n| [m, n]))
}

/// Edges along one axis.
struct Axis<'a> {
    period: f64,
    edges: &'a [f64],
    max_order: usize,
}

impl Axis<'_> {
    fn direct_rule(&self, values: &[Complex64]) -> Matrix {
        toeplitz(self.period, self.edges, values, self.max_order)
    }

    /// ⟦1/ε⟧⁻¹, for a factor that jumps where ε does while their product does not (Li 1996).
    fn inverse_rule(&self, values: &[Complex64]) -> Result<Matrix, WaveError> {
        let inverses: Vec<Complex64> = values.iter().map(|value| value.inv()).collect();
        inverse(&self.direct_rule(&inverses))
    }

    /// Different lines across this axis, each with the Toeplitz matrix of the function that is 1 where it stands.
    fn distinct<'b>(&self, lines: &'b [Vec<Complex64>]) -> Vec<(&'b [Complex64], Matrix)> {
        let first = |line: &Vec<Complex64>| lines.iter().position(|other| other == line);
        let found = lines.iter().enumerate().filter(|(j, line)| first(line) == Some(*j));
        found
            .map(|(_, line)| {
                let shares = lines.iter().map(|other| Complex64::from(f64::from(u8::from(other == line))));
                (&line[..], self.direct_rule(&shares.collect::<Vec<_>>()))
            })
            .collect()
    }
}

/// Adds the Kronecker product a ⊗ b.
fn add_product(sum: &mut Matrix, a: &Matrix, b: &Matrix) {
    let n = b.nrows();
    for (k, column) in sum.col_iter_mut().enumerate() {
        let (a_column, b_column) = (a.col(k / n), b.col(k % n));
        for (l, element) in column.iter_mut().enumerate() {
            *element += a_column[l / n] * b_column[l % n];
        }
    }
}
