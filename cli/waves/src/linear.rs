//! Dense complex linear algebra, by faer on one thread.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{
    solve_in_place, solve_in_place_scratch, solve_transpose_in_place, solve_transpose_in_place_scratch,
};
use faer::linalg::matmul::matmul;
use faer::perm::PermRef;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};
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
    // For real matrices with pairs of equal complex eigenvalues faer 0.24 finds wrong vectors: keep them complex, which
    // takes no longer.
    let found = matrix.eigen().map_err(|_| WaveError::Singular)?;
    let values: Vec<Complex64> = found.S().column_vector().iter().copied().collect();
    let vectors = found.U().to_owned();
    let finite = values.iter().all(|value| value.is_finite()) && vectors.is_all_finite();
    if finite { Ok(Eigen { values, vectors }) } else { Err(WaveError::Singular) }
}

/// Triangular factors of a square matrix, for several right sides.
#[derive(Clone, Debug)]
pub(crate) struct Factors {
    both: Matrix,
    rows: Rows,
}

/// Sequence of the rows of a matrix whose triangular factors were written over it. faer's own type copies each factor,
/// which takes as long as finding them where N is about 40.
#[derive(Clone, Debug)]
pub(crate) struct Rows([Vec<usize>; 2]);

impl Rows {
    /// Writes the factors of `matrix` over it.
    pub(crate) fn factor(matrix: MatMut<'_, Complex64>) -> Self {
        let n = matrix.nrows();
        let mut rows = [vec![0; n], vec![0; n]];
        let [forward, backward] = &mut rows;
        let scratch = lu_in_place_scratch::<usize, Complex64>(n, n, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        lu_in_place(matrix, forward, backward, Par::Seq, MemStack::new(&mut memory), Default::default());
        Self(rows)
    }

    fn permutation(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.0[0], &self.0[1], self.0[0].len())
    }

    /// Replaces b in `right` by the x of `matrix · x = b`, where `factors` were written over `matrix`.
    pub(crate) fn solve_in_place(&self, factors: MatRef<'_, Complex64>, right: MatMut<'_, Complex64>) {
        let scratch = solve_in_place_scratch::<usize, Complex64>(factors.nrows(), right.ncols(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        solve_in_place(factors, factors, self.permutation(), right, Par::Seq, stack);
    }

    /// Replaces b in `left` by the x of `x · matrix = b`, where `factors` were written over `matrix`.
    pub(crate) fn solve_left_in_place(&self, factors: MatRef<'_, Complex64>, left: MatMut<'_, Complex64>) {
        let scratch = solve_transpose_in_place_scratch::<usize, Complex64>(factors.nrows(), left.nrows(), Par::Seq);
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        solve_transpose_in_place(factors, factors, self.permutation(), left.transpose_mut(), Par::Seq, stack);
    }
}

impl Factors {
    /// Factors of `matrix`, written over it.
    pub(crate) fn new(mut matrix: Matrix) -> Self {
        let rows = Rows::factor(matrix.as_mut());
        Self { both: matrix, rows }
    }

    /// Solves `matrix · x = right` for x.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if x is not finite.
    pub(crate) fn solve(&self, right: &Matrix) -> Result<Matrix, WaveError> {
        let mut out = right.clone();
        self.rows.solve_in_place(self.both.as_ref(), out.as_mut());
        finite(out)
    }

    /// Solves `x · matrix = left` for x.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if x is not finite.
    pub(crate) fn solve_left(&self, left: &Matrix) -> Result<Matrix, WaveError> {
        let mut out = left.clone();
        self.rows.solve_left_in_place(self.both.as_ref(), out.as_mut());
        finite(out)
    }
}

fn finite(found: Matrix) -> Result<Matrix, WaveError> {
    if found.is_all_finite() { Ok(found) } else { Err(WaveError::Singular) }
}

/// Solves `matrix · x = right` for x.
///
/// # Errors
/// [`WaveError::Singular`] if x is not finite.
pub(crate) fn solve(matrix: &Matrix, right: &Matrix) -> Result<Matrix, WaveError> {
    Factors::new(matrix.clone()).solve(right)
}

/// Eigenvalues and eigenvectors of a Hermitian matrix, of which the lower half is read: the values are real, and the
/// vectors unitary.
///
/// # Errors
/// [`WaveError::Singular`] if the iteration does not converge or a number is not finite.
pub(crate) fn hermitian_eigen(matrix: &Matrix) -> Result<Eigen, WaveError> {
    let found = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| WaveError::Singular)?;
    let values: Vec<Complex64> = found.S().column_vector().iter().map(|value| Complex64::from(value.re)).collect();
    let vectors = found.U().to_owned();
    if values.iter().all(|value| value.is_finite()) { Ok(Eigen { values, vectors }) } else { Err(WaveError::Singular) }
}

/// Inverse of a square matrix.
///
/// # Errors
/// [`WaveError::Singular`] if it is not finite.
pub(crate) fn inverse(matrix: &Matrix) -> Result<Matrix, WaveError> {
    solve(matrix, &Matrix::identity(matrix.nrows(), matrix.ncols()))
}

/// Matrix with orthonormal rows or columns that is nearest to `matrix`: U V† of its singular value decomposition.
///
/// # Errors
/// [`WaveError::Singular`] if the iteration does not converge or a number is not finite.
pub(crate) fn nearest_isometry(matrix: &Matrix) -> Result<Matrix, WaveError> {
    let found = matrix.thin_svd().map_err(|_| WaveError::Singular)?;
    let nearest = product(found.U(), found.V().adjoint().to_owned().as_ref());
    if nearest.is_all_finite() { Ok(nearest) } else { Err(WaveError::Singular) }
}

/// Product of two matrices.
pub(crate) fn product(left: MatRef<'_, Complex64>, right: MatRef<'_, Complex64>) -> Matrix {
    let mut out = Matrix::zeros(left.nrows(), right.ncols());
    multiply_into(out.as_mut(), Accum::Replace, left, right, Complex64::ONE);
    out
}

/// Adds `factor · left · right` to `out`, or replaces `out` by it.
pub(crate) fn multiply_into(
    out: MatMut<'_, Complex64>,
    accumulate: Accum,
    left: MatRef<'_, Complex64>,
    right: MatRef<'_, Complex64>,
    factor: Complex64,
) {
    matmul(out, accumulate, left, right, factor, Par::Seq);
}

/// Multiplies each row by its factor.
pub(crate) fn scale_rows(matrix: &mut Matrix, factors: &[Complex64]) {
    for column in 0..matrix.ncols() {
        for (element, factor) in matrix.col_as_slice_mut(column).iter_mut().zip(factors) {
            *element *= factor;
        }
    }
}

/// Multiplies each column by its factor.
pub(crate) fn scale_columns(matrix: &mut Matrix, factors: &[Complex64]) {
    for (column, factor) in factors.iter().enumerate() {
        for element in matrix.col_as_slice_mut(column) {
            *element *= factor;
        }
    }
}
