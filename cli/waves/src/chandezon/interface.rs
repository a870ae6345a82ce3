//! Interface between two media in Fourier space, and the modes of a homogeneous medium in its coordinates.
//!
//! With invariance along y, each component ψ ∈ {E_y, H_y} obeys (∂_x² + ∂_z² + γ²) ψ = 0 with γ² = ε − k_y². In the
//! coordinates x = X(u), z = Z(u) + v, with f = X′ and g = Z′, a mode ψ = φ(u) exp(iρv) and its χ = −i∂_xψ + iρψ are
//! continuous wherever f or g jumps, and obey the pencil
//!
//! ```text
//! ρ (G − iF) φ = αφ − Fχ          ρ (G + iF) χ = αχ − γ²Fφ
//! ```
//!
//! of the Toeplitz matrices F = ⟦f⟧ and G = ⟦g⟧ and α = −i∂_u. It is Chandezon's eigenproblem with the factorisation of
//! Li & Chandezon (1996) at corners, written by ∂_x ± i∂_z: no inverse of f remains, so vertical walls, where f = 0,
//! are no exception. Eliminating χ gives a quadratic pencil in ρ of Hermitian matrices where γ² is real, so that the
//! flux Re φ†q of the truncated modes, with q = −i (f∂_z − g∂_x) ψ = iαφ − (G + iF) χ, is conserved exactly.

use num_complex::Complex64;

use super::path::{Node, Path};
use crate::error::WaveError;
use crate::linear::{Matrix, eigen, product, solve};

/// Nodes of the quadratures for each order. Products of a field and a plane wave make up to one oscillation for each
/// order, and Gauss-Legendre quadratures converge from π nodes for each.
const NODES_PER_ORDER: f64 = 4.0;

/// Interface in Fourier space, for one k_x.
#[derive(Clone, Debug)]
pub(super) struct Interface {
    path: Path,
    /// Nodes of quadratures over u.
    pub nodes: Vec<Node>,
    /// Tangential wavevector k_x of each order, in units of k₀.
    pub k_x: Vec<f64>,
    /// Products (G − iF)⁻¹α, (G − iF)⁻¹F, (G + iF)⁻¹α and (G + iF)⁻¹F.
    products: [Matrix; 4],
    /// G + iF.
    sum: Matrix,
    /// From values at the nodes to Fourier coefficients.
    analysis: Matrix,
}

/// Scalar fields on the interface, one for each column: ψ, and q, which is continuous with it.
#[derive(Clone, Debug)]
pub(super) struct Fields {
    /// ψ.
    pub psi: Matrix,
    /// q = −i (f∂_z − g∂_x) ψ.
    pub q: Matrix,
}

impl Fields {
    /// Flux products Σ (ψ₁* q₂ + q₁* ψ₂)/2 of the columns of `self` with those of `other`. For plane waves of real k_z
    /// it is the product of amplitudes, times k_z and the period.
    pub fn flux(&self, other: &Self) -> Matrix {
        let half = faer::Scale(Complex64::from(0.5));
        (product(self.psi.adjoint().to_owned().as_ref(), other.q.as_ref())
            + product(self.q.adjoint().to_owned().as_ref(), other.psi.as_ref()))
            * half
    }

    /// Linear combinations of the columns, by the columns of `factors`.
    pub fn combine(&self, factors: &Matrix) -> Self {
        Self { psi: product(self.psi.as_ref(), factors.as_ref()), q: product(self.q.as_ref(), factors.as_ref()) }
    }
}

/// Modes of a medium on the interface.
pub(super) struct Modes {
    /// Wavevectors ρ along z.
    pub rho: Vec<Complex64>,
    /// Fields, in Fourier coefficients.
    pub fields: Fields,
}

impl Interface {
    /// Interface for the orders −M…M around `kx0`, with M = `max_order`.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if a number is not finite.
    pub fn new(path: Path, kx0: f64, max_order: usize) -> Result<Self, WaveError> {
        let n = 2 * max_order + 1;
        let limit = i32::try_from(2 * max_order).unwrap_or(i32::MAX);
        let coefficients: Vec<[Complex64; 2]> = (-limit..=limit).map(|h| path.coefficients(h)).collect();
        let toeplitz = |of: fn([Complex64; 2]) -> Complex64| {
            Matrix::from_fn(n, n, |row, column| of(coefficients[row + n - 1 - column]))
        };
        let step = std::f64::consts::TAU / path.period;
        let k_x: Vec<f64> = (0..n).map(|i| kx0 + (i as f64 - max_order as f64) * step).collect();
        let alpha = Matrix::from_fn(n, n, |row, column| {
            if row == column { Complex64::from(k_x[row] * path.period) } else { Complex64::ZERO }
        });
        let f = toeplitz(|[f, _]| f);
        let difference = toeplitz(|[f, g]| g - Complex64::I * f);
        let sum = toeplitz(|[f, g]| g + Complex64::I * f);
        let products = [solve(&difference, &alpha)?, solve(&difference, &f)?, solve(&sum, &alpha)?, solve(&sum, &f)?];
        let nodes = path.nodes(NODES_PER_ORDER * n as f64);
        let analysis = Matrix::from_fn(n, nodes.len(), |order, i| {
            nodes[i].weight * Complex64::cis(-k_x[order] * path.period * nodes[i].u)
        });
        Ok(Self { path, nodes, k_x, products, sum, analysis })
    }

    /// Number of orders.
    pub fn orders(&self) -> usize {
        self.k_x.len()
    }

    /// Period in units of 1/k₀.
    pub fn period(&self) -> f64 {
        self.path.period
    }

    /// Lowest and highest z.
    pub fn heights(&self) -> [f64; 2] {
        self.path.heights
    }

    /// −i∂_u of Fourier coefficients: the factor of one order.
    pub fn alpha(&self, order: usize) -> f64 {
        self.k_x[order] * self.path.period
    }

    /// Values at the nodes of a plane wave exp(i k_x x + i k_z (z − `origin`)), one for each (k_x, k_z).
    pub fn plane_waves(&self, waves: &[(f64, Complex64)], origin: f64) -> Fields {
        let psi = Matrix::from_fn(self.nodes.len(), waves.len(), |row, column| {
            let ((k_x, k_z), [x, z]) = (waves[column], self.nodes[row].position);
            (Complex64::I * (k_x * x + k_z * (z - origin))).exp()
        });
        let q = Matrix::from_fn(self.nodes.len(), waves.len(), |row, column| {
            let ((k_x, k_z), [f, g]) = (waves[column], self.nodes[row].velocity);
            psi[(row, column)] * (f * k_z - g * k_x)
        });
        Fields { psi, q }
    }

    /// Fourier coefficients from values at the nodes.
    pub fn analyse(&self, values: &Fields) -> Fields {
        let [psi, q] = [&values.psi, &values.q].map(|part| product(self.analysis.as_ref(), part.as_ref()));
        Fields { psi, q }
    }

    /// Values at the nodes from Fourier coefficients, times the weights of the quadrature.
    pub fn weighted_values(&self, coefficients: &Fields) -> Fields {
        let synthesis = self.analysis.adjoint().to_owned();
        let [psi, q] = [&coefficients.psi, &coefficients.q].map(|part| product(synthesis.as_ref(), part.as_ref()));
        Fields { psi, q }
    }

    /// All modes of a medium of squared wavevector `gamma2` across y: two for each order.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if the iteration does not converge.
    pub fn modes(&self, gamma2: Complex64) -> Result<Modes, WaveError> {
        let n = self.orders();
        let [minus_alpha, minus_f, plus_alpha, plus_f] = &self.products;
        let found = eigen(&Matrix::from_fn(2 * n, 2 * n, |row, column| match (row < n, column < n) {
            (true, true) => minus_alpha[(row, column)],
            (true, false) => -minus_f[(row, column - n)],
            (false, true) => -gamma2 * plus_f[(row - n, column)],
            (false, false) => plus_alpha[(row - n, column - n)],
        }))?;
        let (psi, chi) = found.vectors.split_at_row(n);
        let product = product(self.sum.as_ref(), chi);
        let q = Matrix::from_fn(n, 2 * n, |row, column| {
            Complex64::new(0.0, self.alpha(row)) * psi[(row, column)] - product[(row, column)]
        });
        Ok(Modes { rho: found.values, fields: Fields { psi: psi.to_owned(), q } })
    }
}
