//! Triangles as leaves hold them, and rays made ready to be tested against them.

use super::{Hit, LEAF_TRIANGLES, Ray};
use crate::lanes::Four;
use glam::DVec3;

/// The corners of a triangle side by side, so that one instruction serves all three.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Corners {
    /// x, y and z of each corner; the last column holds the triangle's index and nothing.
    coordinates: [[f64; 4]; 3],
}

// A cache line and a half: memory is what large meshes wait for.
const _: () = assert!(size_of::<Corners>() == 96);

impl Corners {
    /// A triangle without area, which no ray meets.
    pub const EMPTY: Self = Self { coordinates: [[0.0; 4]; 3] };

    pub(super) fn new([a, b, c]: [DVec3; 3], triangle: u32) -> Self {
        let index = f64::from(triangle);
        Self { coordinates: [[a.x, b.x, c.x, index], [a.y, b.y, c.y, 0.0], [a.z, b.z, c.z, 0.0]] }
    }

    /// Its index.
    #[inline]
    pub(super) fn triangle(&self) -> u32 {
        self.coordinates[0][3] as u32
    }
}

impl Default for Corners {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// The lanes that hold corners.
const CORNERS: u32 = 0b111;

/// A ray made ready for triangle tests: the shear that turns it into the axis along which it is longest.
pub(super) struct Shear {
    /// That axis last.
    axes: [usize; 3],
    origin: [Four; 3],
    x: Four,
    y: Four,
    z: f64,
    /// The ray runs down the axis, which mirrors what it sees.
    mirrored: bool,
}

impl Shear {
    #[inline]
    pub(super) fn new(ray: &Ray) -> Self {
        let [x, y, z] = ray.direction.abs().to_array();
        let axes = if z >= x && z >= y {
            [0, 1, 2]
        } else if y >= x {
            [2, 0, 1]
        } else {
            [1, 2, 0]
        };
        let [x, y, z] = axes.map(|axis| ray.direction.to_array()[axis]);
        let origin = axes.map(|axis| Four::splat(ray.origin.to_array()[axis]));
        Self { axes, origin, x: Four::splat(x / z), y: Four::splat(y / z), z, mirrored: z < 0.0 }
    }

    /// Where the ray meets the triangles of a leaf.
    ///
    /// With the corners projected, u = c × b, v = a × c, w = b × a must be of one sign, 0 included; t = (u a_z + v b_z + w
    /// c_z)/((u + v + w) d_z).
    #[inline]
    pub(super) fn hits<'l>(&'l self, leaf: &'l [Corners]) -> impl Iterator<Item = Hit> + use<'l> {
        let mut met = self.met(leaf);
        core::iter::from_fn(move || {
            while met != 0 {
                let corners = leaf.get(met.trailing_zeros() as usize % LEAF_TRIANGLES)?;
                met &= met - 1;
                // Seen again, since few are met: to keep what all look like takes longer.
                let [x, y, z] = self.project(corners);
                let ([u, v, w, _], [a, b, c, _]) = (crosses(x, y).to_array(), z.to_array());
                // Signs are exact, so the sum vanishes only if the triangle is seen edge-on.
                let sum = u + v + w;
                if sum != 0.0 {
                    let t = (u * a + v * b + w * c) / sum / self.z;
                    return Some(Hit { triangle: corners.triangle(), t, front: (sum > 0.0) != self.mirrored });
                }
            }
            None
        })
    }

    /// Triangles whose areas are of one sign, 0 included: a bit each, without a branch, since which are met cannot be
    /// foretold.
    #[inline]
    fn met(&self, leaf: &[Corners]) -> u32 {
        let mut met = 0;
        for (i, corners) in leaf.iter().enumerate() {
            let [x, y, _] = self.project(corners);
            let areas = crosses(x, y);
            let below = areas.simd_lt(Four::ZERO).to_bitmask() & CORNERS;
            let above = areas.simd_gt(Four::ZERO).to_bitmask() & CORNERS;
            met |= u32::from(below == 0 || above == 0) << (i % LEAF_TRIANGLES);
        }
        met
    }

    /// The corners in the frame of the ray. One corner is projected alike for every triangle that has it.
    #[inline]
    fn project(&self, corners: &Corners) -> [Four; 3] {
        let along = |i: usize| Four::new(corners.coordinates.get(self.axes[i]).copied().unwrap_or_default());
        let [x, y, z] = [along(0) - self.origin[0], along(1) - self.origin[1], along(2) - self.origin[2]];
        [x - self.x * z, y - self.y * z, z]
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
