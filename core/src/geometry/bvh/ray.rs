//! A ray, and its intersection with a triangle.

use glam::DVec3;

/// A ray: the points origin + t · direction with t in \[`t_min`, `t_max`\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// The point at t = 0.
    pub origin: DVec3,
    /// The direction of the ray. It need not be of unit length; components may be 0, but not all.
    pub direction: DVec3,
    /// Smallest t of a hit.
    pub t_min: f64,
    /// Largest t of a hit; may be infinite.
    pub t_max: f64,
}

impl Ray {
    /// True if the ray can hit anything.
    #[inline]
    pub(super) fn has_direction(&self) -> bool {
        // 0 times a number that is not finite is NaN.
        (0.0 * self.origin + 0.0 * self.direction).element_sum() == 0.0 && self.direction != DVec3::ZERO
    }
}

/// The intersection of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the triangle.
    pub triangle: u32,
    /// Parameter of the ray, in lengths of its direction.
    pub t: f64,
    /// True if direction · normal < 0, where the vertices run counter-clockwise about the normal.
    pub front: bool,
}

impl Hit {
    /// True if this hit is nearer than `other`, or as near and of a lower index.
    #[inline]
    pub(super) fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
    }
}
