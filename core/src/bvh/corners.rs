//! Triangles as leaves hold them, and rays made ready to be tested against them.

use super::Ray;
use crate::lanes::Four;
use glam::DVec3;

/// The corners of a triangle side by side, so that one instruction serves all three.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Corners {
    /// x, y and z of each corner; the last column is 0.
    coordinates: [[f64; 4]; 3],
    triangle: u32,
}

impl Corners {
    /// A triangle without area, which no ray meets.
    pub const EMPTY: Self = Self { coordinates: [[0.0; 4]; 3], triangle: 0 };

    pub(super) fn new([a, b, c]: [DVec3; 3], triangle: u32) -> Self {
        Self { coordinates: [[a.x, b.x, c.x, 0.0], [a.y, b.y, c.y, 0.0], [a.z, b.z, c.z, 0.0]], triangle }
    }

    /// Its index.
    #[inline]
    pub(super) fn triangle(&self) -> u32 {
        self.triangle
    }
}

impl Default for Corners {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// The lanes that hold corners.
const CORNERS: u32 = 0b111;

/// A ray made ready for triangle tests: the shear that turns it into the axis `KZ`.
pub(super) struct Shear<const KZ: usize> {
    origin: [Four; 3],
    x: Four,
    y: Four,
    z: f64,
    /// The ray runs down the axis, which mirrors what it sees.
    mirrored: bool,
}

impl<const KZ: usize> Shear<KZ> {
    /// The axes with `KZ` last.
    const AXES: [usize; 3] = [(KZ + 1) % 3, (KZ + 2) % 3, KZ % 3];

    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        let [x, y, z] = Self::AXES.map(|axis| ray.direction.to_array()[axis]);
        Self {
            origin: Self::AXES.map(|axis| Four::splat(ray.origin.to_array()[axis])),
            x: Four::splat(x / z),
            y: Four::splat(y / z),
            z,
            mirrored: z < 0.0,
        }
    }

    /// t and whether the front is hit. With the corners projected, u = c × b, v = a × c, w = b × a must be of one
    /// sign, 0 included; t = (u a_z + v b_z + w c_z)/((u + v + w) d_z).
    ///
    /// A corner is projected alike for every triangle that has it.
    #[inline]
    pub(super) fn intersect(&self, corners: &Corners) -> Option<(f64, bool)> {
        let relative = |i: usize| Four::new(corners.coordinates[Self::AXES[i]]) - self.origin[i];
        let z = relative(2);
        let (x, y) = (relative(0) - self.x * z, relative(1) - self.y * z);
        let areas = crosses(x, y);
        let (below, above) = (areas.simd_lt(Four::ZERO), areas.simd_gt(Four::ZERO));
        if below.to_bitmask() & CORNERS != 0 && above.to_bitmask() & CORNERS != 0 {
            return None;
        }
        let ([u, v, w, _], [a, b, c, _]) = (areas.to_array(), z.to_array());
        // Signs are exact, so the sum vanishes only if the triangle is seen edge-on.
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let t = (u * a + v * b + w * c) / sum / self.z;
        Some((t, (sum > 0.0) != self.mirrored))
    }
}

/// c × b, a × c and b × a, where p × q = p_x q_y − p_y q_x, with exact signs, and exactly −(q × p).
///
/// Rounding is monotonic, so the rounded products order as the exact ones do unless they are equal; then the roundings
/// decide (Shewchuk's two-product), short of underflow.
#[inline]
pub(super) fn crosses(x: Four, y: Four) -> Four {
    let cab = |of: Four| {
        let [a, b, c, none] = of.to_array();
        Four::new([c, a, b, none])
    };
    let bca = |of: Four| {
        let [a, b, c, none] = of.to_array();
        Four::new([b, c, a, none])
    };
    let (left, right) = (cab(x) * bca(y), cab(y) * bca(x));
    if left.simd_eq(right).to_bitmask() & CORNERS == 0 {
        left - right
    } else {
        Four::new(ties(x.to_array(), y.to_array(), left.to_array(), right.to_array()))
    }
}

#[cold]
fn ties(x: [f64; 4], y: [f64; 4], left: [f64; 4], right: [f64; 4]) -> [f64; 4] {
    const FIRST: [usize; 3] = [2, 0, 1];
    const SECOND: [usize; 3] = [1, 2, 0];
    let mut areas = [0.0; 4];
    for i in 0..3 {
        let (p, q) = (FIRST[i], SECOND[i]);
        areas[i] = if left[i] == right[i] {
            libm::fma(x[p], y[q], -left[i]) - libm::fma(y[p], x[q], -left[i])
        } else {
            left[i] - right[i]
        };
    }
    areas
}
