//! Unit vectors from spherical angles.

use glam::DVec3;

/// The unit vector at polar angle `theta` from +z and azimuth `phi` from +x, in radians.
#[must_use]
pub fn direction(theta: f64, phi: f64) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn theta_is_measured_from_z_and_phi_from_x_towards_y() {
        for (theta, phi, want) in [
            (0.0, 1.0, DVec3::Z),
            (FRAC_PI_2, 0.0, DVec3::X),
            (FRAC_PI_2, FRAC_PI_2, DVec3::Y),
            (2.0 * FRAC_PI_2, 0.3, DVec3::NEG_Z),
        ] {
            assert!(direction(theta, phi).distance(want) < 1e-15, "{theta} {phi}");
        }
    }
}
