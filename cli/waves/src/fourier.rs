//! Fourier coefficients of functions that are piecewise constant.

use std::f64::consts::TAU;

use num_complex::Complex64;

use crate::linear::Matrix;

/// Coefficient of exp(2πi h x/Λ) of a function with period Λ = `period` that is `values[i]` from `edges[i]` to the next
/// edge, the last over the period's end. With no edge it is `values[0]` everywhere.
pub(crate) fn coefficient(period: f64, edges: &[f64], values: &[Complex64], h: i32) -> Complex64 {
    let Some((first, last)) = edges.first().zip(edges.last()) else {
        return if h == 0 { values[0] } else { Complex64::ZERO };
    };
    let n = edges.len();
    if h == 0 {
        let end = |i: usize| if i + 1 < n { edges[i + 1] } else { first + period };
        debug_assert!(last - first <= period, "edges span more than a period");
        return (0..n).map(|i| values[i] * ((end(i) - edges[i]) / period)).sum();
    }
    let turns = TAU * f64::from(h);
    let jumps: Complex64 =
        (0..n).map(|i| (values[i] - values[(i + n - 1) % n]) * Complex64::cis(-turns * edges[i] / period)).sum();
    jumps / Complex64::new(0.0, turns)
}

/// Toeplitz matrix ⟦f⟧ of a piecewise constant function for orders −M…M: element (m, n) is the coefficient m − n. Its
/// product with the coefficients of a second function gives those of the product (Laurent's rule).
pub(crate) fn toeplitz(period: f64, edges: &[f64], values: &[Complex64], max_order: usize) -> Matrix {
    let n = 2 * max_order + 1;
    let limit = i32::try_from(2 * max_order).unwrap_or(i32::MAX);
    let all: Vec<Complex64> = (-limit..=limit).map(|h| coefficient(period, edges, values, h)).collect();
    Matrix::from_fn(n, n, |row, column| all[row + n - 1 - column])
}
