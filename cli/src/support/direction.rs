//! Unit vectors from spherical angles.

use glam::DVec3;

/// The unit vector at polar angle `theta` from +z and azimuth `phi` from +x, in radians.
#[must_use]
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}
