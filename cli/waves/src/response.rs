//! Orders into which a surface sends light.

use num_complex::Complex64;

/// Diffraction order of a surface, in the half-space that it leaves into.
///
/// Polarisation is relative to the plane of the order's own wavevector and the normal: with the tangential wavevector q
/// of length |q| > 0, the direction s is (−q_y, q_x)/|q|, and p has its magnetic field along s. At |q| = 0, s is +y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// Numbers (m, n) of the order along x and along y.
    pub index: [i32; 2],
    /// Vertical wavevector in units of k₀: real and positive where the order travels, of positive imaginary part where
    /// it is evanescent.
    pub vertical: Complex64,
    /// Jones matrix `[incident][outgoing]`, each s then p, for incident electric fields of amplitude 1. Outgoing s is
    /// the amplitude of the electric field along s; outgoing p is that of the magnetic field along s divided by the
    /// index of the half-space (η of vacuum impedance 1), which is the electric amplitude where the order travels.
    pub jones: [[Complex64; 2]; 2],
}

/// All orders of a truncation, for one plane wave.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Vertical wavevector of the light that arrives, in units of k₀; positive.
    pub incident_vertical: f64,
    /// Refractive indices of the half-spaces above and below.
    pub half_spaces: [Complex64; 2],
    /// Orders that go up, sorted by index, evanescent ones included.
    pub reflected: Vec<Order>,
    /// Orders that go down, likewise.
    pub transmitted: Vec<Order>,
}

impl Response {
    /// Efficiency of a reflected order for light in s and in p: its power through a plane parallel to the surface as a
    /// share of the power that arrives through it. 0 where the order is evanescent.
    #[must_use]
    pub fn reflected_efficiency(&self, order: &Order) -> [f64; 2] {
        self.efficiency(order, self.half_spaces[0])
    }

    /// Efficiency of a transmitted order for light in s and in p. In a half-space that absorbs it is the power at the
    /// top of the half-space.
    #[must_use]
    pub fn transmitted_efficiency(&self, order: &Order) -> [f64; 2] {
        self.efficiency(order, self.half_spaces[1])
    }

    fn efficiency(&self, order: &Order, eta: Complex64) -> [f64; 2] {
        // Power of s ∝ Re k_z |E_s|²; of p ∝ Re(k_z/η²) |H_s|², and |H_s|² = |η|² |p|².
        let s = order.vertical.re;
        let p = (order.vertical / (eta * eta)).re * eta.norm_sqr();
        order.jones.map(|[to_s, to_p]| (s * to_s.norm_sqr() + p * to_p.norm_sqr()) / self.incident_vertical)
    }
}
