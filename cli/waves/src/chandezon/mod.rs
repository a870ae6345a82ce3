//! Coordinate-transformation method of Chandezon for one interface between two media, invariant along y.
//!
//! The interface itself is a coordinate line, so slanted and curved walls need no staircase. See [`GraphModes`].

use num_complex::Complex64;

use crate::error::WaveError;
use crate::fields::{self, Tangential};
use crate::linear::{Matrix, product, solve};
use crate::profile::Graph;
use crate::response::{Order, Response};

mod path;
mod half_space;

use half_space::{Interface, Side};
use path::Path;

/// Least |γ²| = |ε − k_y²| of a half-space, relative to |ε|. At γ² = 0 the components along y do not determine the
/// field. At this distance, ε is wrong by as much, and the other components lose half of the digits.
const MIN_GAMMA_SQUARED: f64 = 1e-8;

/// Interface prepared for one wavelength, one k_x and a number of orders.
///
/// The eigenproblem of each half-space depends on k_x and on k_y², so each [`Self::response`] solves two eigenproblems
/// of twice the number of orders.
#[derive(Clone, Debug)]
pub struct GraphModes {
    interface: Interface,
    above: f64,
    below: Complex64,
    max_order: usize,
}

impl GraphModes {
    /// Prepares the orders −M…M, with M = `max_order`, around the tangential wavevector `kx0` in units of k₀.
    ///
    /// # Errors
    /// [`WaveError::Profile`] or [`WaveError::Light`] if an argument is out of its domain, [`WaveError::Singular`] if the
    /// equations have no finite solution.
    pub fn new(graph: &Graph, wavelength_nm: f64, kx0: f64, max_order: usize) -> Result<Self, WaveError> {
        graph.check()?;
        if !(wavelength_nm > 0.0 && wavelength_nm.is_finite() && kx0.is_finite()) {
            return Err(WaveError::Light);
        }
        let path = Path::new(graph, std::f64::consts::TAU / wavelength_nm);
        let interface = Interface::new(path, kx0, max_order)?;
        Ok(Self { interface, above: graph.above, below: graph.below, max_order })
    }

    /// Orders for light of the tangential wavevector k_y in units of k₀.
    ///
    /// Phases are 0 at x = y = 0, at the top of the interface for the light that arrives and for reflected orders, and at
    /// its bottom for transmitted orders.
    ///
    /// # Errors
    /// [`WaveError::Light`] if the light does not travel in the half-space above, [`WaveError::Singular`] if the
    /// equations have no finite solution.
    pub fn response(&self, ky: f64) -> Result<Response, WaveError> {
        let interface = &self.interface;
        let n = interface.orders();
        let q = [interface.k_x[self.max_order], ky];
        let vertical = fields::vertical(self.above.into(), q).re;
        // Infinities and NaN fail too.
        if !(q[0].hypot(q[1]) < self.above && vertical > 0.0) {
            return Err(WaveError::Light);
        }
        let epsilon = [Complex64::from(self.above), self.below].map(|eta| eta * eta);
        let gamma2 = epsilon.map(|epsilon| {
            let gamma2 = epsilon - ky * ky;
            let least = MIN_GAMMA_SQUARED * epsilon.norm();
            if gamma2.norm() >= least { gamma2 } else { Complex64::from(least.copysign(gamma2.re)) }
        });
        let epsilon = gamma2.map(|gamma2| gamma2 + ky * ky);
        let above = interface.outgoing(gamma2[0], Side::Above)?;
        let below = interface.outgoing(gamma2[1], Side::Below)?;

        let incident = fields::incident(self.above, q, vertical);
        let wave = interface.plane_wave(q[0], Complex64::from(-vertical), Side::Above);
        let [wave_field, wave_derivative] = [wave.field, wave.derivative].map(|values| interface.analyse(&[values]));
        // Yψ − q of the incident field: what the reflected field must add.
        let excess = product(above.as_ref(), wave_field.as_ref()) - &wave_derivative;

        // Unknowns: E_y, then H_y, on the interface. Continuity of H_u gives the first n equations, of E_u the others:
        //   γ² H_u = −k_y αH_y − εq(E_y)          γ² E_u = −k_y αE_y + q(H_y)
        let weight = [gamma2[1], gamma2[0]];
        let equations = Matrix::from_fn(2 * n, 2 * n, |row, column| {
            let [i, j] = [row % n, column % n];
            let [electric_row, electric_column] = [row < n, column < n];
            if electric_row == electric_column {
                let [a, b] = if electric_row { [0, 1].map(|k| weight[k] * epsilon[k]) } else { weight };
                a * above[(i, j)] - b * below[(i, j)]
            } else if i == j {
                let coupling = (gamma2[1] - gamma2[0]) * ky * interface.alpha(i);
                if electric_row { coupling } else { -coupling }
            } else {
                Complex64::ZERO
            }
        });
        let right = Matrix::from_fn(2 * n, 2, |row, column| {
            let Tangential { electric, magnetic } = incident[column];
            if row < n {
                weight[0] * epsilon[0] * electric[1] * excess[(row, 0)]
            } else {
                weight[0] * magnetic[1] * excess[(row - n, 0)]
            }
        });
        let solution = solve(&equations, &right)?;
        // Columns: E_y for light in s, E_y in p, H_y in s, H_y in p.
        let field = Matrix::from_fn(n, 4, |row, column| solution[(row + n * (column / 2), column % 2)]);
        let reflected = product(above.as_ref(), field.as_ref());
        let reflected = Matrix::from_fn(n, 4, |row, column| {
            let Tangential { electric, magnetic } = incident[column % 2];
            let amplitude = if column < 2 { electric[1] } else { magnetic[1] };
            reflected[(row, column)] - amplitude * excess[(row, 0)]
        });
        let transmitted = product(below.as_ref(), field.as_ref());
        let order = |side, derivative: &Matrix, medium: usize| {
            self.orders(side, [&field, derivative], ky, gamma2[medium], epsilon[medium])
        };
        Ok(Response {
            incident_vertical: vertical,
            half_spaces: [Complex64::from(self.above), self.below],
            reflected: order(Side::Above, &reflected, 0)?,
            transmitted: order(Side::Below, &transmitted, 1)?,
        })
    }

    /// Plane waves that leave into a half-space, from ψ and q on the interface, columns as in [`Self::response`].
    ///
    /// Green's second identity with the plane wave of opposite wavevector, which does not grow between the interface and
    /// the plane of reference, gives each amplitude as an integral over the interface. It holds for the total field:
    /// light that arrives adds nothing.
    fn orders(
        &self,
        side: Side,
        [field, derivative]: [&Matrix; 2],
        ky: f64,
        gamma2: Complex64,
        epsilon: Complex64,
    ) -> Result<Vec<Order>, WaveError> {
        let interface = &self.interface;
        let [field, derivative] = [field, derivative].map(|part| interface.weighted_values(part));
        let eta = if side == Side::Above { Complex64::from(self.above) } else { self.below };
        let orders = (0..interface.orders()).map(|i| {
            let q = [interface.k_x[i], ky];
            let k_z = side.sign() * fields::vertical(eta, q);
            let test = interface.plane_wave(-q[0], -k_z, side);
            let amplitude = [0, 1, 2, 3].map(|column| {
                let sum: Complex64 = (0..interface.nodes.len())
                    .map(|j| test.field[j] * derivative[(j, column)] - test.derivative[j] * field[(j, column)])
                    .sum();
                sum / (2.0 * k_z * interface.period())
            });
            let fields = [0, 1].map(|polarisation| {
                let [electric, magnetic] = [amplitude[polarisation], amplitude[polarisation + 2]];
                Tangential {
                    electric: [(k_z * magnetic - q[0] * ky * electric) / gamma2, electric],
                    magnetic: [(-k_z * epsilon * electric - q[0] * ky * magnetic) / gamma2, magnetic],
                }
            });
            fields::order([i as i32 - self.max_order as i32, 0], eta, q, fields)
        });
        let orders: Vec<Order> = orders.collect();
        let finite = |order: &Order| order.jones.iter().flatten().all(|amplitude| amplitude.is_finite());
        if orders.iter().all(finite) { Ok(orders) } else { Err(WaveError::Singular) }
    }
}
