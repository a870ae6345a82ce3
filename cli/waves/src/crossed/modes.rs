//! Waves that travel up and down through one layer unchanged, by their fields along the layer.
//!
//! Fields of an order are taken along its tangential wavevector q (part p) and along s = ẑ × q/|q|: vectors of 2N
//! numbers have N parts p, then N parts s. The electric field is E; the magnetic field is ẑ × H, which makes the power
//! of a wave that goes down positive. Waves that go up have the electric field of those that go down and minus their
//! magnetic field.

use num_complex::Complex64;

use crate::crossed::permittivity::Permittivity;
use crate::error::WaveError;
use crate::fields::{forward_root, off_anomaly, s_direction, vertical};
use crate::linear::{Eigen, Matrix, eigen, solve};

/// Tangential wavevector of an order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wavevector {
    /// Components along x and y.
    pub q: [f64; 2],
    /// Its length.
    pub length: f64,
    /// Unit vector along it; +x if it is 0.
    pub direction: [f64; 2],
}

impl Wavevector {
    /// Wavevector by its components.
    pub(super) fn new(q: [f64; 2]) -> Self {
        let [s_x, s_y] = s_direction(q);
        Self { q, length: q[0].hypot(q[1]), direction: [s_y, -s_x] }
    }
}

/// Plane waves of a uniform medium, for each part of each order.
#[derive(Debug)]
pub(super) struct PlaneWaves {
    /// Vertical wavevector.
    pub vertical: Vec<Complex64>,
    /// Electric field: k_z/ε in p, 1 in s.
    pub electric: Vec<Complex64>,
    /// Magnetic field: 1 in p, k_z in s.
    pub magnetic: Vec<Complex64>,
}

impl PlaneWaves {
    /// Waves in a medium of permittivity `epsilon`.
    pub(super) fn new(epsilon: Complex64, orders: &[Wavevector]) -> Self {
        let root = forward_root(epsilon);
        let k_z: Vec<Complex64> = orders.iter().map(|order| vertical(root, order.q)).collect();
        let ones = || std::iter::repeat_n(Complex64::ONE, k_z.len());
        Self {
            electric: k_z.iter().map(|k_z| k_z / epsilon).chain(ones()).collect(),
            magnetic: ones().chain(k_z.iter().copied()).collect(),
            vertical: k_z.iter().chain(&k_z).copied().collect(),
        }
    }

    /// Electric and magnetic fields of waves of amplitude 1 that go down with their reflections.
    pub(super) fn fields(&self, reflection: &[Complex64]) -> [Vec<Complex64>; 2] {
        let electric = self.electric.iter().zip(reflection).map(|(e, r)| e * (1.0 + r));
        let magnetic = self.magnetic.iter().zip(reflection).map(|(h, r)| h * (1.0 - r));
        [electric.collect(), magnetic.collect()]
    }
}

/// Modes of a layer with a pattern.
#[derive(Debug)]
pub(super) struct Modes {
    /// Vertical wavevector of each mode.
    pub vertical: Vec<Complex64>,
    /// Electric field of each mode as a column.
    pub electric: Matrix,
    /// Magnetic field of each mode as a column.
    pub magnetic: Matrix,
}

impl Modes {
    /// Modes of a layer.
    ///
    /// With the parts p and s of the fields, Maxwell's equations (Li 1997) read dE/dz' = iFH, dH/dz' = iGE, z' = −z,
    /// with F = diag(1 − q ε_z⁻¹ q, 1) and G = ε_t − diag(0, q²), where ε_t is ε_x and ε_y turned into the parts p and
    /// s. Eigenvalues of FG are k_z².
    ///
    /// # Errors
    /// [`WaveError::Singular`] if the eigenproblem has no finite solution.
    pub(super) fn new(permittivity: &Permittivity, orders: &[Wavevector]) -> Result<Self, WaveError> {
        let n = orders.len();
        // G, until FG replaces it.
        let mut g = Matrix::zeros(2 * n, 2 * n);
        for (j, to) in orders.iter().enumerate() {
            let [d_x, d_y] = to.direction;
            for (i, from) in orders.iter().enumerate() {
                let [c_x, c_y] = from.direction;
                let (e_x, e_y) = (permittivity.x[(i, j)], permittivity.y[(i, j)]);
                g[(i, j)] = e_x * (c_x * d_x) + e_y * (c_y * d_y);
                g[(i, n + j)] = e_y * (c_y * d_x) - e_x * (c_x * d_y);
                g[(n + i, j)] = e_y * (c_x * d_y) - e_x * (c_y * d_x);
                g[(n + i, n + j)] = e_x * (c_y * d_y) + e_y * (c_x * d_x);
            }
            g[(n + j, n + j)] -= to.length * to.length;
        }

        // FG differs from G in the upper half alone.
        let lengths = Matrix::from_fn(n, n, |i, j| if i == j { orders[i].length.into() } else { Complex64::ZERO });
        let mut f = solve(&permittivity.z, &lengths)?;
        for (j, column) in f.col_iter_mut().enumerate() {
            for (i, element) in column.iter_mut().enumerate() {
                *element = f64::from(u8::from(i == j)) - orders[i].length * *element;
            }
        }
        let upper = g.subrows(0, n).to_owned();
        g.subrows_mut(0, n).copy_from(&f * &upper);

        let scale = g.norm_max();
        let Eigen { values, vectors: electric } = eigen(&g)?;
        let vertical: Vec<Complex64> = values.iter().map(|&value| root(value, scale)).collect();

        // H = GE/k_z. The lower half of G is that of FG, so that the lower half of GE is k_z²E.
        let upper = &upper * &electric;
        let mut magnetic = Matrix::zeros(2 * n, 2 * n);
        for (j, &k_z) in vertical.iter().enumerate() {
            for i in 0..n {
                magnetic[(i, j)] = upper[(i, j)] / k_z;
                magnetic[(n + i, j)] = electric[(n + i, j)] * (values[j] / k_z);
            }
        }
        Ok(Self { vertical, electric, magnetic })
    }
}

/// Imaginary part of k_z², as a share of the largest element of FG, that is taken for rounding where k_z travels.
const MAX_ROUNDING: f64 = 1e-10;

/// Vertical wavevector of a mode that goes down, from k_z² and the largest element of FG.
///
/// A mode of a lossless layer that travels has a small imaginary part by rounding, of either sign. It must not decide
/// which way the mode goes: reflections of modes taken the wrong way are not bounded.
fn root(squared: Complex64, scale: f64) -> Complex64 {
    let squared = off_anomaly(squared, scale.into());
    let travels = squared.re > 0.0 && squared.im.abs() <= MAX_ROUNDING * scale;
    if travels { squared.sqrt() } else { forward_root(squared) }
}
