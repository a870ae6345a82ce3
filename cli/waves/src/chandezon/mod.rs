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
mod interface;
mod half_space;

use half_space::{HalfSpace, Side};
use interface::{Fields, Interface};
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
        let half_spaces = [Complex64::from(self.above), self.below];
        let half_space = |medium: usize, side| {
            let k_z = interface.k_x.iter().map(|&k_x| fields::vertical(half_spaces[medium], [k_x, ky])).collect();
            HalfSpace::new(interface, gamma2[medium], k_z, side)
        };
        let [above, below] = [half_space(0, Side::Above)?, half_space(1, Side::Below)?];

        let incident = fields::incident(self.above, q, vertical);
        let light = above.arriving(interface);
        // Yψ − q of the light: what the reflected field must add.
        let excess = product(above.outgoing.as_ref(), light.psi.as_ref()) - &light.q;

        // Unknowns: E_y, then H_y, on the interface. Continuity of H_u gives the first n equations, of E_u the others:
        //   γ² H_u = −k_y αH_y − εq(E_y)          γ² E_u = −k_y αE_y + q(H_y)
        let weight = [gamma2[1], gamma2[0]];
        let equations = Matrix::from_fn(2 * n, 2 * n, |row, column| {
            let [i, j] = [row % n, column % n];
            let [electric_row, electric_column] = [row < n, column < n];
            if electric_row == electric_column {
                let [a, b] = if electric_row { [0, 1].map(|k| weight[k] * epsilon[k]) } else { weight };
                a * above.outgoing[(i, j)] - b * below.outgoing[(i, j)]
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
        let transmitted = Matrix::from_fn(n, 4, |row, column| solution[(row + n * (column / 2), column % 2)]);
        let reflected = Matrix::from_fn(n, 4, |row, column| {
            let Tangential { electric, magnetic } = incident[column % 2];
            let amplitude = if column < 2 { electric[1] } else { magnetic[1] };
            transmitted[(row, column)] - amplitude * light.psi[(row, 0)]
        });
        let orders = |medium: usize, side: Side, half_space: &HalfSpace, psi: Matrix| {
            let q = product(half_space.outgoing.as_ref(), psi.as_ref());
            let amplitudes = half_space.amplitudes(interface, &Fields { psi, q });
            let of_order = |i: usize| {
                let q = [interface.k_x[i], ky];
                let k_z = side.sign() * fields::vertical(half_spaces[medium], q);
                let fields = [0, 1].map(|polarisation| {
                    let [electric, magnetic] = [0, 2].map(|field| amplitudes[(i, polarisation + field)]);
                    let [e_x, h_x] = [k_z * magnetic, -k_z * epsilon[medium] * electric];
                    let e_x = (e_x - q[0] * ky * electric) / gamma2[medium];
                    let h_x = (h_x - q[0] * ky * magnetic) / gamma2[medium];
                    Tangential { electric: [e_x, electric], magnetic: [h_x, magnetic] }
                });
                fields::order([i as i32 - self.max_order as i32, 0], half_spaces[medium], q, fields)
            };
            let orders: Vec<Order> = (0..n).map(of_order).collect();
            let finite = |order: &Order| order.jones.as_flattened().iter().all(|amplitude| amplitude.is_finite());
            if orders.iter().all(finite) { Ok(orders) } else { Err(WaveError::Singular) }
        };
        Ok(Response {
            incident_vertical: vertical,
            half_spaces,
            reflected: orders(0, Side::Above, &above, reflected)?,
            transmitted: orders(1, Side::Below, &below, transmitted)?,
        })
    }
}
