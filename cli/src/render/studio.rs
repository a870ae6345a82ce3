//! The built-in environment: a grey room with soft boxes, given by formulas so that other programs can draw the same.
//!
//! - The room is a mixture of [`HORIZON`] and [`CEILING`] by s(z) above the horizon, and of [`HORIZON`] and [`FLOOR`]
//!   by s(−z) below, where s(x) = 3x² − 2x³ for x clamped to [0, 1].
//! - Each soft box adds `radiance` · e(x/depth) · e(y/depth). Here `depth` is the component of the direction along
//!   `towards`, and x and y are those along `right` and `up`; e falls from 1 to 0 by s while |x/depth| goes from half
//!   extent − softness to half extent + softness. Directions of depth ≤ 0 do not see the box.
//!
//! All of it is neutral: every colour in a picture is the surface's own.

use glam::DVec3;

/// Radiance of the room straight up.
pub const CEILING: f64 = 0.14;
/// Radiance of the room at the horizon.
pub const HORIZON: f64 = 0.42;
/// Radiance of the room straight down.
pub const FLOOR: f64 = 0.05;

/// A soft box: a rectangular lamp behind cloth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftBox {
    /// Azimuth from +x and elevation of the box's centre, in degrees.
    pub towards_deg: [f64; 2],
    /// Tangents of half the width and height, seen from the body.
    pub half_extent: [f64; 2],
    /// Tangent over which the edges fade, to either side.
    pub softness: f64,
    /// Radiance in the middle.
    pub radiance: f64,
}

/// The soft boxes, as a camera at an azimuth of −60° sees them: a large one above, a key light at the left, a strip at
/// the right, and a low one behind the viewer.
pub const SOFT_BOXES: [SoftBox; 4] = [
    SoftBox { towards_deg: [-60.0, 80.0], half_extent: [1.1, 0.62], softness: 0.1, radiance: 1.15 },
    SoftBox { towards_deg: [-128.0, 34.0], half_extent: [0.36, 0.62], softness: 0.06, radiance: 1.45 },
    SoftBox { towards_deg: [12.0, 22.0], half_extent: [0.16, 0.78], softness: 0.05, radiance: 1.2 },
    SoftBox { towards_deg: [140.0, 18.0], half_extent: [0.55, 0.3], softness: 0.1, radiance: 0.8 },
];

impl SoftBox {
    /// Unit vectors towards the box's centre, to the right and upwards, seen from the body.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 3] {
        let [azimuth, elevation] = self.towards_deg.map(f64::to_radians);
        let (sin, cos) = azimuth.sin_cos();
        let towards = DVec3::new(cos * elevation.cos(), sin * elevation.cos(), elevation.sin());
        let right = DVec3::new(sin, -cos, 0.0);
        [towards, right, right.cross(towards)]
    }

    fn radiance(&self, [towards, right, up]: &[DVec3; 3], direction: DVec3) -> f64 {
        let depth = direction.dot(*towards);
        if depth <= 0.0 {
            return 0.0;
        }
        let edge = |along: &DVec3, half: f64| {
            let beyond = (direction.dot(*along) / depth).abs() - (half - self.softness);
            1.0 - smoothstep(beyond / (2.0 * self.softness))
        };
        self.radiance * edge(right, self.half_extent[0]) * edge(up, self.half_extent[1])
    }
}

/// The studio with the axes of its lamps computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Studio {
    axes: [[DVec3; 3]; SOFT_BOXES.len()],
}

impl Default for Studio {
    fn default() -> Self {
        Self { axes: SOFT_BOXES.map(|lamp| lamp.axes()) }
    }
}

impl Studio {
    /// Radiance from a unit direction; it is the same in red, green and blue.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> f64 {
        let end = if direction.z < 0.0 { FLOOR } else { CEILING };
        let room = HORIZON + (end - HORIZON) * smoothstep(direction.z.abs());
        let lamps = SOFT_BOXES.iter().zip(&self.axes).map(|(lamp, axes)| lamp.radiance(axes, direction));
        room + lamps.sum::<f64>()
    }
}

/// The smoothstep of x clamped to [0, 1].
pub(super) fn smoothstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_are_where_they_stand_and_end_at_their_edges() {
        let studio = Studio::default();
        for lamp in SOFT_BOXES {
            let [towards, right, up] = lamp.axes();
            assert!(right.cross(towards).distance(up) < 1e-12 && up.z >= 0.0 && (right.length() - 1.0).abs() < 1e-12);
            assert!(studio.radiance(towards) >= lamp.radiance);
            let edge = |tangent: f64| lamp.radiance(&lamp.axes(), (towards + tangent * right).normalize());
            let half = lamp.half_extent[0];
            assert!((edge(half) - 0.5 * lamp.radiance).abs() < 1e-12);
            assert!(edge(half + lamp.softness + 1e-9) == 0.0 && edge(half - lamp.softness) > lamp.radiance - 1e-9);
        }
        assert!((studio.radiance(DVec3::NEG_Z) - FLOOR).abs() < 1e-12);
    }
}
