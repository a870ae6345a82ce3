//! Options of commands that trace a cell: the direction and the wavelengths of the light.

use glam::DVec3;

use crate::scene::Scene;
use crate::solve::grid::Wavelengths;
use crate::support::direction::direction;
use crate::support::error::{Error, Result};

/// The unit vector towards the light, from `--theta` and `--phi` in degrees.
pub(super) fn light_direction(theta_deg: f64, phi_deg: f64) -> Result<DVec3> {
    if !((0.0..90.0).contains(&theta_deg) && phi_deg.is_finite()) {
        return Err(Error::usage(format_args!(
            "--theta {theta_deg} --phi {phi_deg}: theta must lie in [0, 90) degrees and phi be finite"
        )));
    }
    Ok(direction(theta_deg.to_radians(), phi_deg.to_radians()))
}

/// The listed wavelengths; refuses `auto`, which needs a planar scene.
pub(super) fn listed_wavelengths<'w>(wavelengths: &'w Wavelengths, scene: &Scene) -> Result<&'w [f64]> {
    match wavelengths {
        Wavelengths::List(list) => Ok(list),
        Wavelengths::Auto(_) => Err(Error::usage(format_args!(
            "--wavelengths auto: {} is traced, and has no one optical path; name the wavelengths, as 380:780:10",
            scene.name
        ))),
    }
}
