//! Waves within one medium or pattern of media that does not change with height.
//!
//! Four rows of numbers, continuous where layers meet, describe the fields of a pattern at one height:
//!
//! ```text
//! E_x = φ e₁        E_y = −k_y G e₁ − ψ e₂        H_x = ψ h₁        H_y = D h₂ − k_y L h₁
//! ```
//!
//! None of φ, ψ, D, G and L contains k_y. In a uniform medium φ, ψ and D are the unit matrix, and G and L are 0.

use std::f64::consts::TAU;

use faer::reborrow::ReborrowMut;
use faer::{Accum, MatMut, MatRef};
use num_complex::Complex64;

use crate::error::WaveError;
use crate::fields::{admittance, forward_root, off_anomaly, vertical};
use crate::fourier::toeplitz;
use crate::linear::{
    Eigen, Matrix, eigen, hermitian_eigen, inverse, multiply_into, product, scale_columns, scale_rows, solve,
};

/// Pattern of media along x that does not change with height, at one k_x0.
#[derive(Debug)]
pub(super) enum Pattern {
    /// One medium, by its index.
    Uniform(Complex64),
    /// Several media, by the modes of the fields in them.
    Modal(Box<Modal>),
}

/// What k_z of a pattern depends on, beside k_y.
#[derive(Debug)]
pub(super) enum Spectrum {
    /// Index of one medium.
    Uniform(Complex64),
    /// [`Modal::kappa_squared`].
    Modal([Vec<Complex64>; 2]),
}

impl From<&Pattern> for Spectrum {
    fn from(pattern: &Pattern) -> Self {
        match pattern {
            Pattern::Uniform(eta) => Self::Uniform(*eta),
            Pattern::Modal(modal) => Self::Modal(modal.kappa_squared.clone()),
        }
    }
}

/// Modes of a pattern of several media: fields that keep their form from one height to another.
///
/// Modes of the first kind have E_x = φ and H_x = 0, those of the second H_x = ψ and E_x = 0 (Li 1993, "A modal
/// analysis of lamellar diffraction gratings in conical mountings").
#[derive(Debug)]
pub(super) struct Modal {
    /// Squared wavevectors κ² = k_y² + k_z² of the modes of the first kind, then of the second.
    pub kappa_squared: [Vec<Complex64>; 2],
    pub phi: Matrix,
    pub phi_inverse: Matrix,
    pub psi: Matrix,
    pub psi_inverse: Matrix,
    /// D = ⟦1/ε⟧⁻¹ φ.
    pub d: Matrix,
    pub d_inverse: Matrix,
    /// ψ⁻¹ K φ. With κ² of the second kind, G = ⟦ε⟧⁻¹ K D / κ² of the first kind is ψ (1/κ²) ψ⁻¹ K φ, by the equations
    /// of both kinds.
    pub phi_in_psi: Matrix,
    /// D⁻¹ K ψ, so that L = K ψ / κ² is D (D⁻¹ K ψ) / κ².
    pub psi_in_d: Matrix,
}

impl Modal {
    /// Decomposes a pattern of several media from the edges `edges`, in shares of the period; the tangential
    /// wavevectors of the orders along x are `kx`. Follows Li (1996), "Use of Fourier series in the analysis of
    /// discontinuous periodic structures": E_x jumps at the edges, D_x does not.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if a decomposition or an inverse is not finite.
    pub fn new(edges: &[f64], eta: &[Complex64], kx: &[f64]) -> Result<Self, WaveError> {
        let max_order = kx.len() / 2;
        let epsilon: Vec<Complex64> = eta.iter().map(|eta| eta * eta).collect();
        let reciprocal: Vec<Complex64> = epsilon.iter().map(|epsilon| epsilon.inv()).collect();
        let k: Vec<Complex64> = kx.iter().map(|&k| Complex64::from(k)).collect();
        let largest = epsilon.iter().fold(Complex64::ZERO, |most, &e| if e.norm() > most.norm() { e } else { most });
        // Positive real ε makes both problems Hermitian: faster, and κ² is exactly real.
        let lossless = epsilon.iter().all(|epsilon| epsilon.im == 0.0 && epsilon.re > 0.0);

        let e = toeplitz(1.0, edges, &epsilon, max_order);
        // I − K E⁻¹ K.
        let mut curl = -inverse(&e)?;
        scale_columns(&mut curl, &k);
        scale_rows(&mut curl, &k);
        for i in 0..k.len() {
            curl[(i, i)] += 1.0;
        }
        let mut helmholtz = e;
        for (i, k) in k.iter().enumerate() {
            helmholtz[(i, i)] -= k * k;
        }
        let b = toeplitz(1.0, edges, &reciprocal, max_order);

        let (second, psi_inverse);
        let (first, phi_inverse, d, d_inverse);
        if lossless {
            second = hermitian_eigen(&helmholtz)?;
            psi_inverse = second.vectors.adjoint().to_owned();
            // With ⟦1/ε⟧ = C C†, C⁻¹ (I − K E⁻¹ K) C⁻†: Hermitian, with vectors y = C† D, so φ = C y.
            let c = b.llt(faer::Side::Lower).map_err(|_| WaveError::Singular)?.L().to_owned();
            let half = solve(&c, &curl)?;
            let whole = solve(&c, &half.adjoint().to_owned())?;
            let Eigen { values, vectors } = hermitian_eigen(&whole)?;
            d = solve(&c.adjoint().to_owned(), &vectors)?;
            let phi = product(c.as_ref(), vectors.as_ref());
            d_inverse = phi.adjoint().to_owned();
            phi_inverse = d.adjoint().to_owned();
            first = Eigen { values, vectors: phi };
        } else {
            second = eigen(&helmholtz)?;
            psi_inverse = inverse(&second.vectors)?;
            // Eigenvectors D of A (I − K E⁻¹ K) with A = ⟦1/ε⟧⁻¹, φ = A⁻¹ D, φ⁻¹ = D⁻¹ A.
            let a = inverse(&b)?;
            let found = eigen(&product(a.as_ref(), curl.as_ref()))?;
            d = found.vectors;
            d_inverse = inverse(&d)?;
            let phi = product(b.as_ref(), d.as_ref());
            phi_inverse = product(d_inverse.as_ref(), a.as_ref());
            first = Eigen { values: found.values, vectors: phi };
        }
        let off = |values: &[Complex64]| values.iter().map(|&value| off_anomaly(value, largest)).collect::<Vec<_>>();
        let kappa_squared = [off(&first.values), off(&second.values)];
        let (phi, psi) = (first.vectors, second.vectors);
        let between = |left: &Matrix, right: &Matrix| product(left.as_ref(), rows(right, &k).as_ref());
        let phi_in_psi = between(&psi_inverse, &phi);
        let psi_in_d = between(&d_inverse, &psi);
        Ok(Self { kappa_squared, phi, phi_inverse, psi, psi_inverse, d, d_inverse, phi_in_psi, psi_in_d })
    }

    /// Modes of the pattern moved along x by `shift` periods: each order of each mode gets a phase.
    pub fn shifted(&self, shift: f64) -> Self {
        let n = self.phi.nrows();
        let phase = |i: usize| Complex64::cis(-TAU * shift * (i as f64 - (n / 2) as f64));
        let phases: Vec<Complex64> = (0..n).map(phase).collect();
        let conjugates: Vec<Complex64> = phases.iter().map(Complex64::conj).collect();
        let rows = |matrix: &Matrix| rows(matrix, &phases);
        let columns = |matrix: &Matrix| columns(matrix, &conjugates);
        Self {
            kappa_squared: self.kappa_squared.clone(),
            phi: rows(&self.phi),
            phi_inverse: columns(&self.phi_inverse),
            psi: rows(&self.psi),
            psi_inverse: columns(&self.psi_inverse),
            d: rows(&self.d),
            d_inverse: columns(&self.d_inverse),
            phi_in_psi: self.phi_in_psi.clone(),
            psi_in_d: self.psi_in_d.clone(),
        }
    }

    /// 1/κ² of the second kind.
    fn reciprocals(&self) -> Vec<Complex64> {
        self.kappa_squared[1].iter().map(|kappa| kappa.inv()).collect()
    }
}

/// Copy of `matrix` with each row multiplied by its factor.
fn rows(matrix: &Matrix, factors: &[Complex64]) -> Matrix {
    let mut of = matrix.clone();
    scale_rows(&mut of, factors);
    of
}

/// Copy of `matrix` with each column multiplied by its factor.
fn columns(matrix: &Matrix, factors: &[Complex64]) -> Matrix {
    let mut of = matrix.clone();
    scale_columns(&mut of, factors);
    of
}

/// Waves of a pattern at one k_y. The first N are the modes of the first kind, or E_x of uniform media; the others the
/// modes of the second kind, or E_y. Waves u go up, d down; s = u + d and δ = u − d.
#[derive(Debug)]
pub(super) struct Waves {
    /// Vertical wavevectors, 2N.
    pub vertical: Vec<Complex64>,
    /// e₂ per s of the second half; e₁ = s of the first.
    pub electric: Vec<Complex64>,
    /// Inverse of `electric`.
    pub from_electric: Vec<Complex64>,
    pub magnetic: Magnetic,
}

/// (h₁, h₂) of each row from δ of both halves.
#[derive(Debug)]
pub(super) enum Magnetic {
    /// Any matrices, and their inverses: uniform media.
    Full(Vec<[[[Complex64; 2]; 2]; 2]>),
    /// h₁ = δ₂ and h₂ = the factor times δ₁, with the inverses of the factors: modes.
    Crossed(Vec<[Complex64; 2]>),
}

impl Waves {
    pub fn new(spectrum: &Spectrum, kx: &[f64], ky: f64) -> Self {
        let n = kx.len();
        let (vertical, electric, magnetic) = match spectrum {
            Spectrum::Uniform(eta) => {
                let half: Vec<Complex64> = kx.iter().map(|&kx| vertical(*eta, [kx, ky])).collect();
                let both = |(&kx, &kz): (&f64, &Complex64)| {
                    let forward @ [[a, b], [c, d]] = admittance([kx, ky], kz);
                    let factor = (a * d - b * c).inv();
                    [forward, [[d * factor, -b * factor], [-c * factor, a * factor]]]
                };
                let magnetic = Magnetic::Full(kx.iter().zip(&half).map(both).collect());
                (half.repeat(2), vec![-Complex64::ONE; n], magnetic)
            }
            Spectrum::Modal(kappa_squared) => {
                let root = |&kappa: &Complex64| forward_root(off_anomaly(kappa - ky * ky, kappa));
                let [first, second] = kappa_squared.each_ref().map(|kappa| kappa.iter().map(root).collect::<Vec<_>>());
                let both = |(kz, kappa): (&Complex64, &Complex64)| [kz / kappa, kappa / kz];
                let magnetic = Magnetic::Crossed(first.iter().zip(&kappa_squared[0]).map(both).collect());
                let electric = second.iter().zip(&kappa_squared[1]).map(|(kz, kappa)| kz / kappa).collect();
                ([first, second].concat(), electric, magnetic)
            }
        };
        let from_electric = electric.iter().map(|factor| factor.inv()).collect();
        Self { vertical, electric, from_electric, magnetic }
    }
}

/// Matrices that take (e₁, e₂, h₁, h₂) from the pattern below to that above, without k_y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Interface<'a> {
    /// e₁ above = `e1` e₁ below.
    pub e1: MatRef<'a, Complex64>,
    /// e₂ above = `second` e₂ + k_y `e_cross` e₁ below, and h₁ above = `second` h₁ below.
    pub second: MatRef<'a, Complex64>,
    pub e_cross: MatRef<'a, Complex64>,
    /// h₂ above = `h2` h₂ + k_y `h_cross` h₁ below.
    pub h2: MatRef<'a, Complex64>,
    pub h_cross: MatRef<'a, Complex64>,
}

impl<'a> Interface<'a> {
    /// Number of the matrices, which lie side by side in memory.
    pub const MATRICES: usize = 5;

    /// Interface whose matrices are `all`.
    pub fn of(all: MatRef<'a, Complex64>) -> Self {
        let n = all.nrows();
        let [e1, second, e_cross, h2, h_cross] = std::array::from_fn(|i| all.subcols(i * n, n));
        Self { e1, second, e_cross, h2, h_cross }
    }

    /// Writes the matrices of the interface of two patterns to `all`, unless both are uniform: there nothing changes.
    /// `kx` are the tangential wavevectors of the orders along x.
    pub fn write(above: &Pattern, below: &Pattern, kx: &[f64], all: MatMut<'_, Complex64>) {
        let n = kx.len();
        let (e1, rest) = all.split_at_col_mut(n);
        let (mut second, rest) = rest.split_at_col_mut(n);
        let (mut e_cross, rest) = rest.split_at_col_mut(n);
        let (h2, mut h_cross) = rest.split_at_col_mut(n);
        let write = |mut to: MatMut<'_, Complex64>, from: &Matrix| to.copy_from(from);
        let multiply = |to: MatMut<'_, Complex64>, left: &Matrix, right: &Matrix, sign: f64| {
            multiply_into(to, Accum::Replace, left.as_ref(), right.as_ref(), Complex64::from(sign));
        };
        let k = || kx.iter().map(|&k| Complex64::from(k)).collect::<Vec<_>>();
        // `second` times 1/κ² of the modes below less 1/κ² of those above, which is 0 in uniform media, gives both
        // cross terms: ψ⁻¹ of the pattern above times the difference of G, and D⁻¹ times that of L.
        match (above, below) {
            (Pattern::Uniform(_), Pattern::Uniform(_)) => (),
            (Pattern::Uniform(_), Pattern::Modal(below)) => {
                let change = columns(&below.psi, &below.reciprocals());
                write(e1, &below.phi);
                write(second, &below.psi);
                multiply(e_cross, &change, &below.phi_in_psi, 1.0);
                write(h2, &below.d);
                h_cross.copy_from(-rows(&change, &k()));
            }
            (Pattern::Modal(above), Pattern::Uniform(_)) => {
                let change = rows(&above.psi_inverse, &above.reciprocals());
                write(e1, &above.phi_inverse);
                write(second, &above.psi_inverse);
                e_cross.copy_from(-columns(&change, &k()));
                write(h2, &above.d_inverse);
                multiply(h_cross, &above.psi_in_d, &change, 1.0);
            }
            (Pattern::Modal(above), Pattern::Modal(below)) => {
                multiply(e1, &above.phi_inverse, &below.phi, 1.0);
                multiply(second.rb_mut(), &above.psi_inverse, &below.psi, 1.0);
                let mut change = second.to_owned();
                let from = above.reciprocals();
                for (column, to) in below.reciprocals().iter().enumerate() {
                    for (element, from) in change.col_as_slice_mut(column).iter_mut().zip(&from) {
                        *element *= to - from;
                    }
                }
                multiply(e_cross, &change, &below.phi_in_psi, 1.0);
                multiply(h2, &above.d_inverse, &below.d, 1.0);
                multiply(h_cross, &above.psi_in_d, &change, -1.0);
            }
        }
    }
}
