//! Coordinate-transformation method of Chandezon for one interface between two media, invariant along y.
//!
//! The interface itself is a coordinate line, so that slanted and curved walls need no staircase. The coordinate along
//! it is its length, and slows down at corners, so that vertical walls and edges of metal converge too. Lossless
//! surfaces keep all power at any truncation that has the travelling orders; what a truncation leaves out shows as a
//! change from one truncation to another.
//!
//! Largest order M that every efficiency needs at 550 nm, k_x = 0.3, k_y = 0.25 (`tests/waves/chandezon.rs` checks
//! some):
//!
//! | interface | 1e-3 | 1e-4 |
//! |---|---|---|
//! | tracks of a compact disc, of a DVD, aluminium | 13, 11 | 17, 14 |
//! | sinusoid in aluminium, period 1000 nm, 100 nm high | 4 | 4 |
//! | sinusoid in silver, period 1000 nm, 250, 500, 1000 nm high | 4, 7, 15 | 5, 9, 22 |
//! | sawtooth in silver, 5°, period 6000 nm | 17 | 24 |
//! | rectangular grooves in silver, period 8000 nm, 150 nm deep | 34 | 42 |
//! | trapezoids of glass, period 800 nm, 220 nm high | 10 | 13 |
//! | rectangular ridges of glass, period 800 nm, 800 nm high | 17 | 22 |

use num_complex::Complex64;

use crate::error::WaveError;
use crate::fields::{self, Tangential};
use crate::linear::{Factors, Matrix, product};
use crate::profile::Graph;
use crate::response::{Order, Response};

mod path;
mod interface;
mod half_space;

use half_space::{HalfSpace, Side};
use interface::{Fields, Interface};
use path::Path;

/// Least |γ²| = |ε − k_y²| of a half-space, relative to |ε|. At γ² = 0 the components along y do not determine the
/// field. At this distance ε is wrong by as much, and the other components lose half of the digits.
const MIN_GAMMA_SQUARED: f64 = 1e-8;

/// Orders M for each oscillation of the fastest wave along the interface, and beyond these, of [`enough_orders`].
const ORDERS_PER_OSCILLATION: f64 = 1.3;
const MORE_ORDERS: f64 = 5.0;
/// Largest M for which [`suits`] takes the method: its eigenproblems have 242 rows.
const MAX_ORDER: usize = 60;
/// Largest height of an interface, in periods, for which [`suits`] takes the method.
const MAX_HEIGHT: f64 = 2.0;

/// Estimate of the largest order M that efficiencies need to be right to about 1e-3.
///
/// Measured on 299 random polygons of 2 to 7 corners, up to 8 wavelengths long and 1.5 periods high: from this M to 1.5
/// times as many orders, efficiencies changed by less than 1e-3 for 90 % of them, by 1e-5 in the median, and by up to
/// 0.05 for jagged metals with narrow grooves.
///
/// # Errors
/// [`WaveError::Profile`] or [`WaveError::Light`] if an argument is out of its domain.
pub fn enough_orders(graph: &Graph, wavelength_nm: f64) -> Result<usize, WaveError> {
    Ok(orders_for(graph, &path(graph, wavelength_nm)?))
}

/// Whether the method is trusted for an interface: it is at most two periods high, and [`enough_orders`] is at most 60.
/// Rounding errors grow with the height: 3e-9 at one period and 101 orders.
#[must_use]
pub fn suits(graph: &Graph, wavelength_nm: f64) -> bool {
    let Ok(path) = path(graph, wavelength_nm) else { return false };
    let [bottom, top] = path.heights;
    top - bottom <= MAX_HEIGHT * path.period && orders_for(graph, &path) <= MAX_ORDER
}

/// Path of an interface.
fn path(graph: &Graph, wavelength_nm: f64) -> Result<Path, WaveError> {
    graph.check()?;
    if !(wavelength_nm > 0.0 && wavelength_nm.is_finite()) {
        return Err(WaveError::Light);
    }
    Ok(Path::new(graph, std::f64::consts::TAU / wavelength_nm))
}

fn orders_for(graph: &Graph, path: &Path) -> usize {
    let oscillations = graph.above.max(graph.below.re) * path.stretched / std::f64::consts::TAU;
    (ORDERS_PER_OSCILLATION * oscillations + MORE_ORDERS).ceil() as usize
}

/// Interface prepared for one wavelength, one k_x and a number of orders.
#[derive(Clone, Debug)]
pub struct GraphModes {
    interface: Interface,
    half_spaces: [Complex64; 2],
    max_order: usize,
}

impl GraphModes {
    /// Prepares the orders −M…M, with M = `max_order`, around the tangential wavevector `kx0` in units of k₀.
    ///
    /// # Errors
    /// [`WaveError::Profile`] or [`WaveError::Light`] if an argument is out of its domain, [`WaveError::Singular`] if
    /// the equations have no finite solution.
    pub fn new(graph: &Graph, wavelength_nm: f64, kx0: f64, max_order: usize) -> Result<Self, WaveError> {
        if !kx0.is_finite() {
            return Err(WaveError::Light);
        }
        let interface = Interface::new(path(graph, wavelength_nm)?, kx0, max_order)?;
        Ok(Self { interface, half_spaces: [Complex64::from(graph.above), graph.below], max_order })
    }

    /// Orders for light of tangential wavevector (k_x0, `ky`), in s and in p.
    ///
    /// Phases are 0 at x = y = 0, at the top of the interface for the light that arrives and for reflected orders, and
    /// at its bottom for transmitted orders.
    ///
    /// # Errors
    /// [`WaveError::Light`] if the light does not travel in the half-space above, [`WaveError::Singular`] if the
    /// equations have no finite solution.
    pub fn response(&self, ky: f64) -> Result<Response, WaveError> {
        self.check(0, ky)?;
        self.waves(ky)?.response_at(0)
    }

    /// Waves of both half-spaces at one k_y: two eigenproblems of twice the number of orders. They serve light in any
    /// order of the truncation.
    ///
    /// # Errors
    /// [`WaveError::Light`] if `ky` is not finite, [`WaveError::Singular`] if the equations have no finite solution.
    pub fn waves(&self, ky: f64) -> Result<GraphWaves<'_>, WaveError> {
        if !ky.is_finite() {
            return Err(WaveError::Light);
        }
        let media = self.half_spaces.map(|eta| {
            let epsilon = eta * eta;
            let gamma2 = epsilon - ky * ky;
            let least = MIN_GAMMA_SQUARED * epsilon.norm();
            let gamma2 = if gamma2.norm() >= least { gamma2 } else { Complex64::from(least.copysign(gamma2.re)) };
            Medium { eta, epsilon: gamma2 + ky * ky, gamma2 }
        });
        let half_space = |side| {
            let Medium { eta, gamma2, .. } = media[usize::from(side == Side::Below)];
            let k_z = self.interface.k_x.iter().map(|&k_x| fields::vertical(eta, [k_x, ky])).collect();
            HalfSpace::new(&self.interface, gamma2, k_z, side)
        };
        let (above, below) = (half_space(Side::Above)?, half_space(Side::Below)?);
        let equations = Factors::new(equations(&self.interface, ky, media, [&above, &below]));
        Ok(GraphWaves { modes: self, ky, media, above, below, equations })
    }

    /// Tangential wavevector of an order, |`shift`| ≤ M, that travels in the half-space above, and its k_z there.
    fn check(&self, shift: i32, ky: f64) -> Result<(usize, [f64; 2], f64), WaveError> {
        let order = i64::from(shift) + self.max_order as i64;
        let order = usize::try_from(order).ok().filter(|&i| i < self.interface.orders()).ok_or(WaveError::Light)?;
        let q = [self.interface.k_x[order], ky];
        let vertical = fields::vertical(self.half_spaces[0], q).re;
        // Infinities and NaN fail too.
        let travels = q[0].hypot(q[1]) < self.half_spaces[0].re && vertical > 0.0;
        if travels { Ok((order, q, vertical)) } else { Err(WaveError::Light) }
    }
}

/// Medium of a half-space at one k_y, by its index, ε and γ² = ε − k_y².
#[derive(Clone, Copy, Debug, PartialEq)]
struct Medium {
    eta: Complex64,
    epsilon: Complex64,
    gamma2: Complex64,
}

/// Waves of both half-spaces of an interface at one k_x0 and one k_y, see [`GraphModes::waves`].
#[derive(Debug)]
pub struct GraphWaves<'a> {
    modes: &'a GraphModes,
    ky: f64,
    /// Above, and below.
    media: [Medium; 2],
    above: HalfSpace,
    below: HalfSpace,
    equations: Factors,
}

impl GraphWaves<'_> {
    /// Orders for light of tangential wavevector (k_x0 + `shift` λ/Λ, k_y), |`shift`| ≤ M. Orders are counted from that
    /// light: numbers −M − `shift`…M − `shift`.
    ///
    /// # Errors
    /// [`WaveError::Light`] if there is no such order or it does not travel in the half-space above,
    /// [`WaveError::Singular`] if the equations have no finite solution.
    pub fn response_at(&self, shift: i32) -> Result<Response, WaveError> {
        let interface = &self.modes.interface;
        let n = interface.orders();
        let (order, q, vertical) = self.modes.check(shift, self.ky)?;
        let incident = fields::incident(self.modes.half_spaces[0].re, q, vertical);
        let light = self.above.arriving(interface, order)?;
        // Yψ − q of the light: what the reflected field must add.
        let excess = product(self.above.outgoing.as_ref(), light.psi.as_ref()) - &light.q;

        let weight = self.media[1].gamma2;
        let right = Matrix::from_fn(2 * n, 2, |row, column| {
            let Tangential { electric, magnetic } = incident[column];
            let amplitude = if row < n { self.media[0].epsilon * electric[1] } else { magnetic[1] };
            weight * amplitude * excess[(row % n, 0)]
        });
        let solution = self.equations.solve(&right)?;
        // Columns: E_y for light in s, E_y in p, H_y in s, H_y in p.
        let transmitted = Matrix::from_fn(n, 4, |row, column| solution[(row + n * (column / 2), column % 2)]);
        let reflected = Matrix::from_fn(n, 4, |row, column| {
            let Tangential { electric, magnetic } = incident[column % 2];
            let amplitude = if column < 2 { electric[1] } else { magnetic[1] };
            transmitted[(row, column)] - amplitude * light.psi[(row, 0)]
        });
        Ok(Response {
            incident_vertical: vertical,
            half_spaces: self.modes.half_spaces,
            reflected: self.orders(&self.above, reflected, shift)?,
            transmitted: self.orders(&self.below, transmitted, shift)?,
        })
    }

    /// Orders of the fields that leave into a half-space, columns as in [`Self::response_at`].
    fn orders(&self, half_space: &HalfSpace, psi: Matrix, shift: i32) -> Result<Vec<Order>, WaveError> {
        let interface = &self.modes.interface;
        let Medium { eta, epsilon, gamma2 } = self.media[usize::from(half_space.side == Side::Below)];
        let q = product(half_space.outgoing.as_ref(), psi.as_ref());
        let amplitudes = half_space.amplitudes(interface, &Fields { psi, q });
        let last = i32::try_from(self.modes.max_order).unwrap_or(i32::MAX);
        let of_order = |(i, m): (usize, i32)| {
            let q = [interface.k_x[i], self.ky];
            let k_z = half_space.side.sign() * half_space.k_z[i];
            let fields = [0, 1].map(|polarisation| {
                let [electric, magnetic] = [0, 2].map(|field| amplitudes[(i, polarisation + field)]);
                let cross = q[0] * q[1];
                let e_x = (k_z * magnetic - cross * electric) / gamma2;
                let h_x = (-k_z * epsilon * electric - cross * magnetic) / gamma2;
                Tangential { electric: [e_x, electric], magnetic: [h_x, magnetic] }
            });
            fields::order([m - shift, 0], eta, q, fields)
        };
        let orders: Vec<Order> = (-last..=last).enumerate().map(of_order).collect();
        let finite = |order: &Order| order.jones.as_flattened().iter().all(|amplitude| amplitude.is_finite());
        if orders.iter().all(finite) { Ok(orders) } else { Err(WaveError::Singular) }
    }
}

/// Matrix of the unknowns E_y, then H_y, on the interface. Continuity of H_u gives the first n rows, of E_u the others,
/// both times the γ² of both media, of which `weight` holds that of the other medium:
///
/// ```text
/// γ² H_u = −k_y αH_y − εq(E_y)          γ² E_u = −k_y αE_y + q(H_y)
/// ```
fn equations(interface: &Interface, ky: f64, media: [Medium; 2], [above, below]: [&HalfSpace; 2]) -> Matrix {
    let weight = [media[1].gamma2, media[0].gamma2];
    let n = interface.orders();
    Matrix::from_fn(2 * n, 2 * n, |row, column| {
        let [i, j] = [row % n, column % n];
        if (row < n) == (column < n) {
            let factor = |k: usize| if row < n { weight[k] * media[k].epsilon } else { weight[k] };
            factor(0) * above.outgoing[(i, j)] - factor(1) * below.outgoing[(i, j)]
        } else if i == j {
            let coupling = (weight[0] - weight[1]) * ky * interface.alpha(i);
            if row < n { coupling } else { -coupling }
        } else {
            Complex64::ZERO
        }
    })
}
