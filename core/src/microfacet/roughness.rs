//! The roughness of a finish, and how facets of one stretched distribution are those of another.

use super::limits::MIN_ROUGHNESS;
use core::f32::consts::PI;
use glam::Vec3;

/// Roughness α along x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Roughness {
    alpha: [f32; 2],
    /// 1/α along x and y.
    inverse: [f32; 2],
    /// 1/(π α_x α_y), the density of normals along z.
    peak: f32,
}

impl Roughness {
    /// Roughness α along x and y, each from [`MIN_ROUGHNESS`] to 1; `None` beyond.
    pub fn new(alpha: [f32; 2]) -> Option<Self> {
        let [x, y] = alpha;
        alpha.iter().all(|alpha| (MIN_ROUGHNESS..=1.0).contains(alpha)).then(|| Self {
            alpha,
            inverse: [1.0 / x, 1.0 / y],
            peak: 1.0 / (PI * x * y),
        })
    }

    /// α along x and y.
    pub fn alpha(self) -> [f32; 2] {
        self.alpha
    }

    /// Slopes of a facet in units of the roughness, squared and added, times cos²θ_m.
    #[inline]
    pub fn stretched_slope(self, m: Vec3) -> f32 {
        let [x, y] = [m.x * self.inverse[0], m.y * self.inverse[1]];
        x * x + y * y
    }

    /// Density of normals along z, 1/(π α_x α_y).
    #[inline]
    pub fn peak(self) -> f32 {
        self.peak
    }

    /// Square of sin θ α(φ), the roughness in the plane of a direction.
    #[inline]
    pub fn projected_square(self, w: Vec3) -> f32 {
        let [x, y] = [w.x * self.alpha[0], w.y * self.alpha[1]];
        x * x + y * y
    }

    /// Direction as the surface of roughness 1 sees it, not of unit length.
    #[inline]
    pub fn squeezed(self, w: Vec3) -> Vec3 {
        Vec3::new(w.x * self.alpha[0], w.y * self.alpha[1], w.z)
    }
}
