//! A small round lamp in dim, even surroundings: the light by which the colours of a disc are known.
//!
//! At the angle γ from its centre the lamp's radiance is that of its middle times 1 − s((γ/r − 1 + [`EDGE`])/2
//! [`EDGE`]), where r is its angular radius and s the smoothstep. It is as bright as [`RADIANCE_BY_DEGREES`] over its
//! diameter in degrees: the lamp's image in a grating is as wide in wavelengths as the lamp in angle, so that a disc's
//! colours are as bright under any of these lamps.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::studio::smoothstep;
use crate::support::error::{Error, Result};

/// Radiance from everywhere but the lamp.
pub const SURROUNDINGS: f64 = 0.1;
/// Radiance in the middle of the lamp, times its diameter in degrees.
pub const RADIANCE_BY_DEGREES: f64 = 60.0;
/// Half the width of the edge, in radii of the lamp.
pub const EDGE: f64 = 0.25;

/// Smallest and largest diameter in degrees: a fifth of the sun's, and a soft box at arm's length.
const DIAMETERS_DEG: [f64; 2] = [0.1, 60.0];

/// A round lamp with a soft edge, far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    towards: DVec3,
    radius: f64,
    radiance: f64,
}

impl Default for Lamp {
    /// A lamp of 5°, behind the body as the camera's first view has it: on a compact disc, rainbows fan out in front of
    /// the hole and behind it.
    fn default() -> Self {
        Self::at(55.0, 112.0, 5.0)
    }
}

impl Lamp {
    /// A lamp whose centre stands at an elevation above the horizon and an azimuth from +x, with a diameter, all in
    /// degrees.
    ///
    /// # Errors
    /// An elevation beyond ±90°, an azimuth that is not finite, or a diameter that is not from 0.1 to 60.
    pub fn new(elevation_deg: f64, azimuth_deg: f64, diameter_deg: f64) -> Result<Self> {
        let [min, max] = DIAMETERS_DEG;
        if !(-90.0..=90.0).contains(&elevation_deg) || !azimuth_deg.is_finite() {
            return Err(Error::usage(format_args!(
                "--env lamp:{elevation_deg},{azimuth_deg},{diameter_deg}: an elevation lies from -90 to 90 degrees, an \
                 azimuth is finite"
            )));
        }
        if !(min..=max).contains(&diameter_deg) {
            return Err(Error::usage(format_args!(
                "--env lamp:{elevation_deg},{azimuth_deg},{diameter_deg}: a lamp's diameter is from {min} to {max} degrees"
            )));
        }
        Ok(Self::at(elevation_deg, azimuth_deg, diameter_deg))
    }

    fn at(elevation_deg: f64, azimuth_deg: f64, diameter_deg: f64) -> Self {
        let (sin, cos) = elevation_deg.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        Self {
            towards: DVec3::new(cos * cos_azimuth, cos * sin_azimuth, sin),
            radius: 0.5 * diameter_deg.to_radians(),
            radiance: RADIANCE_BY_DEGREES / diameter_deg,
        }
    }

    /// Unit vector towards the lamp's centre.
    #[must_use]
    pub fn towards(&self) -> DVec3 {
        self.towards
    }

    /// Angular radius in radians, to the middle of the edge.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Radiance in the lamp's middle, above that of the surroundings.
    #[must_use]
    pub fn middle(&self) -> f64 {
        self.radiance
    }

    /// Angle from the centre beyond which no light of the lamp comes.
    pub(super) fn reach(&self) -> f64 {
        self.radius * (1.0 + EDGE)
    }

    /// Angle between a unit direction and the lamp's centre.
    pub(super) fn angle(&self, direction: DVec3) -> f64 {
        2.0 * (0.5 * direction.distance(self.towards)).min(1.0).asin()
    }

    /// Radiance from a unit direction; it is the same in red, green and blue.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> f64 {
        // A chord is no longer than its arc.
        if direction.distance_squared(self.towards) > self.reach().powi(2) {
            return SURROUNDINGS;
        }
        let beyond = self.angle(direction) / self.radius - (1.0 - EDGE);
        SURROUNDINGS + self.radiance * (1.0 - smoothstep(beyond / (2.0 * EDGE)))
    }

    /// Share of the directions of [`Lamp::sample`] that are drawn from the lamp: its share of all light.
    fn share(&self) -> f64 {
        let lamp = self.radiance * PI * self.radius * self.radius;
        lamp / (lamp + 4.0 * PI * SURROUNDINGS)
    }

    /// Draws a unit direction: uniform over the lamp, or over the sphere.
    pub(super) fn sample(&self, [choice, turn]: [f64; 2]) -> DVec3 {
        let share = self.share();
        let (height, axis) = if choice < share {
            (choice / share * (1.0 - self.reach().cos()), self.towards)
        } else {
            (2.0 * (choice - share) / (1.0 - share), DVec3::Z)
        };
        let (sin, cos) = (TAU * turn).sin_cos();
        let (right, up) = axis.any_orthonormal_pair();
        let across = (height * (2.0 - height)).max(0.0).sqrt();
        ((1.0 - height) * axis + across * (cos * right + sin * up)).normalize()
    }

    /// Probability density per solid angle with which [`Lamp::sample`] draws a unit direction.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let share = self.share();
        let lamp = if self.angle(direction) < self.reach() { share / (TAU * (1.0 - self.reach().cos())) } else { 0.0 };
        lamp + (1.0 - share) / (4.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lamp_is_round_and_ends_at_its_edge() {
        let lamp = Lamp::new(30.0, 90.0, 2.0).unwrap();
        let degree = 1f64.to_radians();
        assert!((lamp.radius() - degree).abs() < 1e-12 && (lamp.middle() - 30.0).abs() < 1e-12);
        let (right, up) = lamp.towards().any_orthonormal_pair();
        let at = |turn: f64, angle: f64| {
            lamp.radiance(angle.cos() * lamp.towards() + angle.sin() * (turn.cos() * right + turn.sin() * up))
        };
        for turn in [0.0, 1.0, 4.0] {
            assert!((at(turn, 0.7 * degree) - SURROUNDINGS - 30.0).abs() < 1e-9);
            assert!((at(turn, degree) - SURROUNDINGS - 15.0).abs() < 1e-6);
            assert!((at(turn, 1.26 * degree) - SURROUNDINGS).abs() < 1e-9);
        }
    }

    #[test]
    fn places_and_diameters_out_of_range_are_refused() {
        for [elevation, azimuth, diameter] in
            [[91.0, 0.0, 1.0], [0.0, f64::NAN, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 61.0]]
        {
            let error = Lamp::new(elevation, azimuth, diameter).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().starts_with("--env lamp:"), "{error}");
        }
    }
}
