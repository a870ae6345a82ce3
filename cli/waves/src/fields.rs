//! Fields of plane waves in a half-space, by their components along the surface.
//!
//! Maxwell's equations with lengths in units of 1/k₀ and the magnetic field times the impedance of vacuum: H = k × E
//! and εE = −k × H. The frame is (x, y, z) with z up: the vertical component of k is positive for waves that go up.

use num_complex::Complex64;

use crate::response::Order;

/// Smallest |k_z²|, relative to |ε|, that the solvers use. At a Rayleigh anomaly k_z is 0 and the fields of an order
/// per unit of H have no limit. At this distance k_z/n is 1e-6, and so is at most the efficiency of an order that
/// should have none; divisions by k_z² keep four digits. Energy and reciprocity hold for any k_z.
const MIN_VERTICAL_SQUARED: f64 = 1e-12;

/// Components (x, y) of a field along the surface.
pub(crate) type Components = [Complex64; 2];

/// Electric and magnetic field of a wave along the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tangential {
    /// Electric field.
    pub electric: Components,
    /// Magnetic field times the impedance of vacuum.
    pub magnetic: Components,
}

/// Root of a squared wavevector whose wave does not grow: Im ≥ 0, and Re ≥ 0 where Im is 0.
pub(crate) fn forward_root(squared: Complex64) -> Complex64 {
    // The root of a negative real number with a negative zero as imaginary part would be on the other side.
    let root = squared.sqrt();
    if root.im < 0.0 || (root.im == 0.0 && root.re < 0.0) { -root } else { root }
}

/// k_z² kept off 0 by a share of |ε|, with the sign of its real part.
pub(crate) fn off_anomaly(squared: Complex64, epsilon: Complex64) -> Complex64 {
    let least = MIN_VERTICAL_SQUARED * epsilon.norm();
    if squared.norm() >= least { squared } else { Complex64::from(least.copysign(squared.re)) }
}

/// Vertical wavevector in a medium of index `eta` at the tangential wavevector `q`, by [`forward_root`], never 0.
pub(crate) fn vertical(eta: Complex64, q: [f64; 2]) -> Complex64 {
    let epsilon = eta * eta;
    forward_root(off_anomaly(epsilon - (q[0] * q[0] + q[1] * q[1]), epsilon))
}

/// Direction s of a tangential wavevector, as [`Order`] defines it.
pub(crate) fn s_direction([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    if length > 0.0 { [-y / length, x / length] } else { [0.0, 1.0] }
}

/// Fields of the light that arrives in s and in p with an electric amplitude of 1, in a medium of real index `above`,
/// at the tangential wavevector `q` and vertical wavevector `vertical` > 0 (taken downwards).
pub(crate) fn incident(above: f64, q: [f64; 2], vertical: f64) -> [Tangential; 2] {
    let [s_x, s_y] = s_direction(q);
    let along_s = |amplitude: f64| [s_x * amplitude, s_y * amplitude].map(Complex64::from);
    // Along the tangential wavevector, which is s turned by −90°.
    let along_q = |amplitude: f64| [s_y * amplitude, -s_x * amplitude].map(Complex64::from);
    [
        Tangential { electric: along_s(1.0), magnetic: along_q(vertical) },
        Tangential { electric: along_q(-vertical / above), magnetic: along_s(above) },
    ]
}

/// Magnetic from electric field along the surface, `[[xx, xy], [yx, yy]]`, of a wave that goes up; minus that for a
/// wave that goes down.
pub(crate) fn admittance(q: [f64; 2], vertical: Complex64) -> [Components; 2] {
    let cross = q[0] * q[1] / vertical;
    [[-cross, -(vertical + q[1] * q[1] / vertical)], [vertical + q[0] * q[0] / vertical, cross]]
}

/// Order of a half-space of index `eta`, from its fields along the surface for light in s and in p.
pub(crate) fn order(index: [i32; 2], eta: Complex64, q: [f64; 2], fields: [Tangential; 2]) -> Order {
    let [s_x, s_y] = s_direction(q);
    let jones = fields
        .map(|Tangential { electric: e, magnetic: h }| [e[0] * s_x + e[1] * s_y, (h[0] * s_x + h[1] * s_y) / eta]);
    Order { index, vertical: vertical(eta, q), jones }
}
