//! Waves in the half-spaces beside an interface.

use num_complex::Complex64;

use super::interface::{Fields, Interface, Modes};
use crate::error::WaveError;
use crate::linear::{Matrix, nearest_isometry, product, scale_columns, scale_rows, solve};

/// Largest |Im ρ|, relative to |γ|, at which the flux of a mode tells its direction and not its decay. Eigenvalues of
/// travelling modes have rounding errors of up to some 1e-9 for deep interfaces. Near a Rayleigh anomaly ρ² is off by
/// rounding, and ρ by its root, 1e-8.
const MAX_TRAVELLING_DECAY: f64 = 1e-7;
/// Least flux of a travelling mode, relative to |ψ| |q|. Below it rounding errors outweigh the flux.
const MIN_FLUX: f64 = 1e-9;

/// Side of the interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// Above the interface, where waves leave upwards.
    Above,
    /// Below the interface, where waves leave downwards.
    Below,
}

impl Side {
    /// Sign of k_z of waves that leave.
    pub fn sign(self) -> f64 {
        match self {
            Self::Above => 1.0,
            Self::Below => -1.0,
        }
    }

    /// z at which the phases of plane waves are 0: the top of the interface for those above, its bottom for those
    /// below.
    pub fn origin(self, interface: &Interface) -> f64 {
        interface.heights()[usize::from(self == Self::Above)]
    }
}

/// Half-space beside an interface, by its truncated modes.
#[derive(Debug)]
pub(super) struct HalfSpace {
    pub side: Side,
    /// Vertical wavevector of each order.
    pub k_z: Vec<Complex64>,
    /// Matrix Y with q = Yψ for fields that leave.
    pub outgoing: Matrix,
    /// Travelling orders that leave.
    leaving: PlaneWaves,
    /// Travelling modes that arrive.
    arriving: Fields,
}

/// Plane waves of amplitude 1 within the truncation: the flux-orthogonal combinations of travelling modes that are
/// nearest to the exact plane waves. They carry the flux of these exactly, so that lossless surfaces keep all power at
/// any truncation.
#[derive(Debug)]
struct PlaneWaves {
    /// Orders of the columns, by their row; those that travel in a lossless medium.
    orders: Vec<usize>,
    fields: Fields,
}

impl HalfSpace {
    /// Half-space of squared wavevector `gamma2` across y, in which the orders have the vertical wavevectors `k_z`.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if the eigenproblem does not converge or its vectors are not independent.
    pub fn new(interface: &Interface, gamma2: Complex64, k_z: Vec<Complex64>, side: Side) -> Result<Self, WaveError> {
        let n = interface.orders();
        let modes = interface.modes(gamma2)?;
        let mut ranked: Vec<(f64, usize)> =
            (0..2 * n).map(|i| (side.sign() * upwardness(&modes, i, gamma2.norm().sqrt()), i)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let leaving = select(&modes.fields, &ranked[..n].iter().map(|&(_, i)| i).collect::<Vec<_>>());
        let [psi, q] = [&leaving.psi, &leaving.q].map(|part| part.transpose().to_owned());
        let outgoing = solve(&psi, &q)?.transpose().to_owned();
        let travelling = |direction: f64| {
            // A flux of 1 may be rounded up; decays begin at 2.
            let rank = MIN_FLUX..1.5;
            let of = ranked.iter().filter(|(value, _)| rank.contains(&(direction * value)));
            select(&modes.fields, &of.map(|&(_, i)| i).collect::<Vec<_>>())
        };
        let orders = (0..n).filter(|&i| k_z[i].im == 0.0).map(|i| (i, k_z[i].re)).collect();
        let leaving = PlaneWaves::new(interface, &travelling(1.0), orders, side.origin(interface), side.sign())?;
        let arriving = travelling(-1.0);
        Ok(Self { side, k_z, outgoing, leaving, arriving })
    }

    /// Plane wave of one order that arrives with amplitude 1, in Fourier coefficients.
    ///
    /// # Errors
    /// [`WaveError::Singular`] if a number is not finite.
    pub fn arriving(&self, interface: &Interface, order: usize) -> Result<Fields, WaveError> {
        let (origin, sign) = (self.side.origin(interface), -self.side.sign());
        let waves = PlaneWaves::new(interface, &self.arriving, vec![(order, self.k_z[order].re)], origin, sign)?;
        if !waves.orders.is_empty() {
            return Ok(waves.fields);
        }
        let wave = (interface.k_x[order], sign * self.k_z[order]);
        Ok(interface.analyse(&interface.plane_waves(&[wave], origin)))
    }

    /// Amplitudes of the orders, as rows, of fields that leave, given in Fourier coefficients as columns.
    ///
    /// Travelling orders are the products of flux with [`PlaneWaves`]. Others follow from Green's second identity with
    /// the plane wave of opposite wavevector, which does not grow between the interface and the plane where phases are
    /// 0.
    pub fn amplitudes(&self, interface: &Interface, fields: &Fields) -> Matrix {
        let (n, sign) = (interface.orders(), self.side.sign());
        let travelling = self.leaving.fields.flux(fields);
        let test: Vec<(f64, Complex64)> = (0..n).map(|i| (-interface.k_x[i], -sign * self.k_z[i])).collect();
        let test = interface.plane_waves(&test, self.side.origin(interface));
        let values = interface.weighted_values(fields);
        let green = product(test.psi.transpose().to_owned().as_ref(), values.q.as_ref())
            - product(test.q.transpose().to_owned().as_ref(), values.psi.as_ref());
        Matrix::from_fn(n, fields.psi.ncols(), |order, column| {
            let scale = sign * self.k_z[order] * interface.period();
            match self.leaving.orders.iter().position(|&other| other == order) {
                Some(row) => travelling[(row, column)] / scale,
                None => green[(order, column)] / (2.0 * scale),
            }
        })
    }
}

impl PlaneWaves {
    /// Plane waves of direction `sign` along z, given by their orders and |k_z|, from the travelling modes of that
    /// direction. None where there are no modes or they are not independent.
    fn new(
        interface: &Interface,
        modes: &Fields,
        waves: Vec<(usize, f64)>,
        origin: f64,
        sign: f64,
    ) -> Result<Self, WaveError> {
        let none = || Self { orders: Vec::new(), fields: select(modes, &[]) };
        if waves.is_empty() || modes.psi.ncols() == 0 {
            return Ok(none());
        }
        let Some(modes) = orthonormal(modes, sign)? else { return Ok(none()) };
        let exact: Vec<(f64, Complex64)> =
            waves.iter().map(|&(i, k_z)| (interface.k_x[i], Complex64::from(sign * k_z))).collect();
        let exact = interface.analyse(&interface.plane_waves(&exact, origin));
        // Amplitude 1 carries the flux k_z Λ.
        let roots: Vec<f64> = waves.iter().map(|(_, k_z)| (k_z * interface.period()).sqrt()).collect();
        let mut overlap = exact.flux(&modes);
        let factors: Vec<Complex64> = roots
            .iter()
            .enumerate()
            .map(|(row, root)| {
                // Orders that the truncation or a Rayleigh anomaly spoils do not outweigh the others.
                let length = overlap.row(row).norm_l2() / root;
                Complex64::from(sign / (root * length.max(1.0)))
            })
            .collect();
        scale_rows(&mut overlap, &factors);
        let mut combination = nearest_isometry(&overlap)?.adjoint().to_owned();
        scale_columns(&mut combination, &roots.iter().map(|&root| Complex64::from(root)).collect::<Vec<_>>());
        let orders = waves.into_iter().map(|(i, _)| i).collect();
        Ok(Self { orders, fields: modes.combine(&combination) })
    }
}

/// Some columns of fields.
fn select(fields: &Fields, columns: &[usize]) -> Fields {
    let [psi, q] = [&fields.psi, &fields.q]
        .map(|part| Matrix::from_fn(part.nrows(), columns.len(), |row, column| part[(row, columns[column])]));
    Fields { psi, q }
}

/// How far a mode goes up: its flux relative to |ψ| |q|, in [−1, 1], where it travels; otherwise its decay upwards
/// relative to `gamma`, beyond ±1.
fn upwardness(modes: &Modes, mode: usize, gamma: f64) -> f64 {
    let decay = modes.rho[mode].im / gamma;
    if decay.abs() > MAX_TRAVELLING_DECAY {
        return decay + 2.0_f64.copysign(decay);
    }
    let [psi, q] = [&modes.fields.psi, &modes.fields.q].map(|part| part.col_as_slice(mode));
    let flux: f64 = psi.iter().zip(q).map(|(psi, q)| (psi.conj() * q).re).sum();
    let square = |values: &[Complex64]| values.iter().map(Complex64::norm_sqr).sum::<f64>();
    flux / (square(psi) * square(q)).sqrt()
}

/// Combinations of travelling modes whose products of flux are ±1 with themselves, by the direction `sign`, and 0 with
/// others. `None` if the modes are not independent.
fn orthonormal(modes: &Fields, sign: f64) -> Result<Option<Fields>, WaveError> {
    let diagonal = modes.flux(modes);
    let scales: Vec<Complex64> =
        (0..diagonal.ncols()).map(|i| Complex64::from(diagonal[(i, i)].re.abs().sqrt().recip())).collect();
    let mut modes = modes.clone();
    scale_columns(&mut modes.psi, &scales);
    scale_columns(&mut modes.q, &scales);
    let Ok(root) = (modes.flux(&modes) * faer::Scale(Complex64::from(sign))).llt(faer::Side::Lower) else {
        return Ok(None);
    };
    // With fluxes C C†, the columns times C⁻† are orthonormal.
    let columns = scales.len();
    let unit = Matrix::from_fn(columns, columns, |i, j| Complex64::from(if i == j { 1.0 } else { 0.0 }));
    let inverse = solve(&root.L().adjoint().to_owned(), &unit)?;
    Ok(Some(modes.combine(&inverse)))
}
