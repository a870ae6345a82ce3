//! Waves in a homogeneous half-space beside an interface, and the map from a field on it to its normal derivative.
//!
//! With invariance along y, each component ψ ∈ {E_y, H_y} obeys (∂_x² + ∂_z² + γ²) ψ = 0 with γ² = ε − k_y². In the
//! coordinates x = X(u), z = Z(u) + v, with f = X′ and g = Z′, a mode ψ = φ(u) exp(iρv) and its χ = −i∂_xψ + iρψ
//! are continuous wherever f or g jumps, and obey the pencil
//!
//! ```text
//! ρ (G − iF) φ = αφ − Fχ          ρ (G + iF) χ = αχ − γ²Fφ
//! ```
//!
//! of the Toeplitz matrices F = ⟦f⟧ and G = ⟦g⟧ and α = −i∂_u. It is Chandezon's eigenproblem with Li's factorisation
//! at corners (Li & Chandezon 1996), written by ∂_x ± i∂_z: no inverse of f remains, so vertical walls, where f = 0, are
//! no exception. The tangential field of the other polarisation is q = −i (f ∂_z − g ∂_x) ψ = iαφ − (G + iF) χ.

use num_complex::Complex64;

use super::path::{Node, Path};
use crate::error::WaveError;
use crate::fields::{forward_root, off_anomaly};
use crate::linear::{Matrix, eigen, product, scale_columns, solve};

/// Largest decay, as Im k_z times the height of the interface, of orders that enter as plane waves. Their exact fields
/// replace those of modes. Plane waves of steeper decay would make the basis ill-conditioned.
const MAX_DECAY: f64 = 1.0;
/// Nodes of the quadratures for each order: six for each oscillation of the fastest harmonic.
const NODES_PER_ORDER: f64 = 6.0;

/// Direction in which waves leave a half-space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Above the interface, waves go up.
    Above,
    /// Below the interface, waves go down.
    Below,
}

impl Side {
    /// Sign of the vertical wavevector.
    pub fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }
}

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

/// Values of a plane wave and of its q at the nodes.
pub(super) struct PlaneWave {
    /// ψ at each node.
    pub field: Vec<Complex64>,
    /// q at each node.
    pub derivative: Vec<Complex64>,
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
        let toeplitz = |z_sign: f64| {
            Matrix::from_fn(n, n, |row, column| {
                let [f, g] = coefficients[row + n - 1 - column];
                if z_sign == 0.0 { f } else { g + Complex64::new(0.0, z_sign) * f }
            })
        };
        let step = std::f64::consts::TAU / path.period;
        let k_x: Vec<f64> = (0..n).map(|i| kx0 + (i as f64 - max_order as f64) * step).collect();
        let alpha = Matrix::from_fn(n, n, |row, column| {
            if row == column { Complex64::from(k_x[row] * path.period) } else { Complex64::ZERO }
        });
        let [difference, f, sum] = [-1.0, 0.0, 1.0].map(toeplitz);
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

    /// Length of the period in units of 1/k₀.
    pub fn period(&self) -> f64 {
        self.path.period
    }

    /// z at which the phases of a half-space's plane waves are 0: the top of the interface for those above, its bottom
    /// for those below.
    pub fn reference(&self, side: Side) -> f64 {
        self.path.heights[usize::from(side == Side::Above)]
    }

    /// −i∂_u of Fourier coefficients: the factor of one order.
    pub fn alpha(&self, order: usize) -> f64 {
        self.k_x[order] * self.path.period
    }

    /// Plane wave exp(i k_x x + i k_z (z − z₀)) with [`Self::reference`] z₀ at the nodes.
    pub fn plane_wave(&self, k_x: f64, k_z: Complex64, side: Side) -> PlaneWave {
        let origin = self.reference(side);
        let field: Vec<Complex64> = self
            .nodes
            .iter()
            .map(|node| (Complex64::I * (k_x * node.position[0] + k_z * (node.position[1] - origin))).exp())
            .collect();
        let derivative = self
            .nodes
            .iter()
            .zip(&field)
            .map(|(node, field)| field * (node.velocity[0] * k_z - node.velocity[1] * k_x))
            .collect();
        PlaneWave { field, derivative }
    }

    /// Fourier coefficients of functions that are given at the nodes, one function for each column.
    pub fn analyse(&self, columns: &[Vec<Complex64>]) -> Matrix {
        let values = Matrix::from_fn(self.nodes.len(), columns.len(), |row, column| columns[column][row]);
        product(self.analysis.as_ref(), values.as_ref())
    }

    /// Values at the nodes, times the weights of the quadrature, of functions that are given by Fourier coefficients, one
    /// for each column.
    pub fn weighted_values(&self, coefficients: &Matrix) -> Matrix {
        self.analysis.adjoint() * coefficients
    }

    /// Matrix Y with q = Yψ on the interface for waves that leave into a half-space, of squared wavevector `gamma2`
    /// across y.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if the eigenproblem does not converge or the modes are not independent.
    pub fn outgoing(&self, gamma2: Complex64, side: Side) -> Result<Matrix, WaveError> {
        let n = self.orders();
        let k_z: Vec<Complex64> =
            self.k_x.iter().map(|k_x| forward_root(off_anomaly(gamma2 - k_x * k_x, gamma2))).collect();
        let height = self.path.heights[1] - self.path.heights[0];
        let mut plane: Vec<usize> = (0..n).filter(|&i| k_z[i].im * height < MAX_DECAY).collect();
        plane.sort_by(|&a, &b| self.k_x[a].abs().total_cmp(&self.k_x[b].abs()));
        let (fields, derivatives) = plane
            .iter()
            .map(|&i| self.plane_wave(self.k_x[i], side.sign() * k_z[i], side))
            .map(|wave| (wave.field, wave.derivative))
            .unzip::<_, _, Vec<_>, Vec<_>>();
        let exact = [self.analyse(&fields), self.analyse(&derivatives)];
        let modes = if plane.len() < n {
            let taken: Vec<Complex64> = plane.iter().flat_map(|&i| [k_z[i], -k_z[i]]).collect();
            Some(self.modes(gamma2, side, &taken, n - plane.len())?)
        } else {
            None
        };
        let mut basis = [0, 1].map(|part| {
            Matrix::from_fn(n, n, |row, column| match (&modes, column.checked_sub(plane.len())) {
                (Some(modes), Some(mode)) => modes[part][(row, mode)],
                _ => exact[part][(row, column)],
            })
        });
        let scales: Vec<Complex64> = (0..n).map(|i| Complex64::from(basis[0].col(i).norm_l2().recip())).collect();
        for part in &mut basis {
            scale_columns(part, &scales);
        }
        let [fields, derivatives] = basis;
        Ok(solve(&fields.transpose().to_owned(), &derivatives.transpose().to_owned())?.transpose().to_owned())
    }

    /// The `count` modes of fastest decay away from the interface, as columns of ψ and of q. Eigenvalues nearest to those
    /// in `taken`, one for each, are left out.
    fn modes(
        &self,
        gamma2: Complex64,
        side: Side,
        taken: &[Complex64],
        count: usize,
    ) -> Result<[Matrix; 2], WaveError> {
        let n = self.orders();
        let [minus_alpha, minus_f, plus_alpha, plus_f] = &self.products;
        let found = eigen(&Matrix::from_fn(2 * n, 2 * n, |row, column| match (row < n, column < n) {
            (true, true) => minus_alpha[(row, column)],
            (true, false) => -minus_f[(row, column - n)],
            (false, true) => -gamma2 * plus_f[(row - n, column)],
            (false, false) => plus_alpha[(row - n, column - n)],
        }))?;
        let mut left: Vec<usize> = (0..2 * n).collect();
        for value in taken {
            let distance = |&i: &usize| (found.values[i] - value).norm();
            let nearest = (0..left.len()).min_by(|&a, &b| distance(&left[a]).total_cmp(&distance(&left[b])));
            nearest.map(|i| left.swap_remove(i));
        }
        let decay = |i: usize| side.sign() * found.values[i].im;
        // Equal decays keep the order of the decomposition.
        left.sort_unstable();
        left.sort_by(|&a, &b| decay(b).total_cmp(&decay(a)));
        let field = Matrix::from_fn(n, count, |row, column| found.vectors[(row, left[column])]);
        let chi = Matrix::from_fn(n, count, |row, column| found.vectors[(row + n, left[column])]);
        let product = product(self.sum.as_ref(), chi.as_ref());
        let derivative = Matrix::from_fn(n, count, |row, column| {
            Complex64::new(0.0, self.alpha(row)) * field[(row, column)] - product[(row, column)]
        });
        Ok([field, derivative])
    }
}
