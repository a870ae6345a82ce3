//! Leaves: triangles side by side, and rays made ready to be tested against as many at once as there are lanes.

use super::{Child, Hit, LEAF_TRIANGLES, Ray};
use crate::simd::lanes::{F64, Lanes};
use glam::DVec3;

/// Numbers that a leaf holds of each triangle: x, y and z of its corners in turn, and its index.
pub(super) const TERMS: usize = 10;
/// The last of them.
const INDEX: usize = TERMS - 1;
/// Numbers of a full leaf, and those within reach of a test of any.
pub(super) const WINDOW: usize = TERMS * LEAF_TRIANGLES;
/// Triangles tested at once.
const WIDTH: usize = F64::WIDTH;

const _: () = assert!(LEAF_TRIANGLES.is_multiple_of(WIDTH));

/// What a leaf holds of a triangle; a leaf lies term by term, as many of each as there are triangles.
pub(super) fn terms([a, b, c]: [DVec3; 3], triangle: u32) -> [f64; TERMS] {
    [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, f64::from(triangle)]
}

/// A leaf, and what follows it in memory.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    window: &'a [f64; WINDOW],
    count: usize,
}

impl<'a> Leaf<'a> {
    /// A leaf that is there.
    #[inline]
    pub(super) fn new(corners: &'a [f64], leaf: Child) -> Option<Self> {
        let window = corners.get(leaf.place() * TERMS..)?.first_chunk()?;
        Some(Self { window, count: leaf.count() })
    }

    /// A term of the triangles from `first` on; lanes beyond the last hold anything.
    #[inline]
    fn row(&self, term: usize, first: usize) -> F64 {
        let row = self.window.get(term * self.count + first..).and_then(<[f64]>::first_chunk);
        row.map_or(F64::ZERO, |row| F64::new(*row))
    }

    /// The index of a triangle.
    #[inline]
    pub(super) fn triangle(&self, i: usize) -> u32 {
        self.window.get(INDEX * self.count + i).map_or(u32::MAX, |index| *index as u32)
    }
}

/// A corner of each triangle, seen along the ray.
#[derive(Clone, Copy)]
struct Seen {
    x: F64,
    y: F64,
    z: F64,
}

/// A ray made ready for triangle tests: the shear that turns it into the axis along which it is longest.
pub(super) struct Shear {
    /// That axis last.
    axes: [usize; 3],
    origin: [f64; 3],
    x: f64,
    y: f64,
    z: f64,
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
        Self { axes, origin: axes.map(|axis| ray.origin.to_array()[axis]), x: x / z, y: y / z, z }
    }

    /// Calls `each` with every place where the ray meets a triangle of a leaf.
    ///
    /// With the corners projected, u = c × b, v = a × c, w = b × a must be of one sign, 0 included; t = (u a_z + v b_z + w
    /// c_z)/((u + v + w) d_z).
    #[inline]
    pub(super) fn intersect(&self, leaf: Leaf<'_>, mut each: impl FnMut(Hit)) {
        for first in (0..leaf.count).step_by(WIDTH) {
            let (a, b, c) = (self.see(leaf, 0, first), self.see(leaf, 1, first), self.see(leaf, 2, first));
            let there = (1 << (leaf.count - first).min(WIDTH)) - 1;
            let (u, v, w) = areas(a, b, c, there);
            let (least, most) = (u.fast_min(v).fast_min(w), u.fast_max(v).fast_max(w));
            // Which are met cannot be foretold, so that one question is asked about all.
            let mut met = (least.simd_ge(F64::ZERO) | most.simd_le(F64::ZERO)).to_bitmask() & there;
            if met == 0 {
                continue;
            }
            // Signs are exact, so the sum vanishes only if the triangle is seen edge-on.
            let (sum, t) = ((u + v + w).to_array(), (u * a.z + v * b.z + w * c.z).to_array());
            while met != 0 {
                let i = met.trailing_zeros() as usize % WIDTH;
                met &= met - 1;
                if sum[i] != 0.0 {
                    // A ray down the axis sees a mirror image.
                    let front = (sum[i] > 0.0) != (self.z < 0.0);
                    each(Hit { triangle: leaf.triangle(first + i), t: t[i] / sum[i] / self.z, front });
                }
            }
        }
    }

    /// A corner of the triangles from `first` on. One corner is seen alike for every triangle that has it.
    #[inline]
    fn see(&self, leaf: Leaf<'_>, corner: usize, first: usize) -> Seen {
        let along = |i: usize| leaf.row(3 * corner + self.axes[i], first) - F64::splat(self.origin[i]);
        let (x, y, z) = (along(0), along(1), along(2));
        Seen { x: x - F64::splat(self.x) * z, y: y - F64::splat(self.y) * z, z }
    }
}

/// c × b, a × c and b × a, where p × q = p_x q_y − p_y q_x, with exact signs, and exactly −(q × p), in the lanes that are `there`.
///
/// Rounding is monotonic, so the rounded products order as the exact ones do unless they are equal; then the roundings
/// decide (Shewchuk's two-product), short of underflow.
#[inline]
fn areas(a: Seen, b: Seen, c: Seen, there: u32) -> (F64, F64, F64) {
    let products = |p: Seen, q: Seen| (p.x * q.y, p.y * q.x);
    let (u, v, w) = (products(c, b), products(a, c), products(b, a));
    let ties = u.0.simd_eq(u.1) | v.0.simd_eq(v.1) | w.0.simd_eq(w.1);
    if ties.to_bitmask() & there == 0 {
        (u.0 - u.1, v.0 - v.1, w.0 - w.1)
    } else {
        let plane = |of: Seen| [of.x.to_array(), of.y.to_array()];
        let [u, v, w] = exact_areas(plane(a), plane(b), plane(c)).map(F64::new);
        (u, v, w)
    }
}

#[cold]
fn exact_areas(a: [[f64; WIDTH]; 2], b: [[f64; WIDTH]; 2], c: [[f64; WIDTH]; 2]) -> [[f64; WIDTH]; 3] {
    let areas = |[px, py]: [[f64; WIDTH]; 2], [qx, qy]: [[f64; WIDTH]; 2]| {
        core::array::from_fn(|i| exact_cross([px[i], py[i]], [qx[i], qy[i]]))
    };
    [areas(c, b), areas(a, c), areas(b, a)]
}

/// p × q of one triangle.
pub(super) fn exact_cross([px, py]: [f64; 2], [qx, qy]: [f64; 2]) -> f64 {
    let (left, right) = (px * qy, py * qx);
    if left == right { libm::fma(px, qy, -left) - libm::fma(py, qx, -left) } else { left - right }
}
