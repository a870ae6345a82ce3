//! Dense complex linear algebra, by faer on one thread.

use faer::Mat;
use faer::linalg::solvers::Solve;
use num_complex::Complex64;

use crate::error::WaveError;

/// Dense matrix of complex numbers.
pub(crate) type Matrix = Mat<Complex64>;

/// Eigenvalues and eigenvectors of a matrix.
pub(crate) struct Eigen {
    /// Eigenvalues, one for each column of `vectors`.
    pub values: Vec<Complex64>,
    /// Eigenvectors as columns.
    pub vectors: Matrix,
}

/// Decomposes a square matrix.
///
/// # Errors
/// [`WaveError::Singular`] if the iteration does not converge or a number is not finite.
pub(crate) fn eigen(matrix: &Matrix) -> Result<Eigen, WaveError> {
    let found = matrix.eigen().map_err(|_| WaveError::Singular)?;
    let values: Vec<Complex64> = found.S().column_vector().iter().copied().collect();
    let vectors = found.U().to_owned();
    if values.iter().all(|value| value.is_finite()) { Ok(Eigen { values, vectors }) } else { Err(WaveError::Singular) }
}

/// Solves `matrix · x = right` for x.
///
/// # Errors
/// [`WaveError::Singular`] if x is not finite.
pub(crate) fn solve(matrix: &Matrix, right: &Matrix) -> Result<Matrix, WaveError> {
    let found = matrix.partial_piv_lu().solve(right);
    if found.is_all_finite() { Ok(found) } else { Err(WaveError::Singular) }
}
