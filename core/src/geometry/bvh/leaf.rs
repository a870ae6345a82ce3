//! The triangle test: leaves store triangles side by side, and a ray is tested against one triangle per SIMD lane.

use super::node::{Child, MAX_LEAF_TRIANGLES};
use super::ray::{Hit, Ray};
use crate::simd::lanes::{F64, Lanes};
use glam::DVec3;

/// Numbers that a leaf stores for each triangle: x, y and z of its three corners, and its index.
pub(super) const TERMS: usize = 10;
/// Place of the triangle's index among its terms.
const INDEX: usize = TERMS - 1;
/// Numbers of a full leaf. A test of any leaf may read as many.
pub(super) const WINDOW: usize = TERMS * MAX_LEAF_TRIANGLES;
/// Number of triangles that are tested at once.
const TESTED: usize = F64::WIDTH;

const _: () = assert!(MAX_LEAF_TRIANGLES.is_multiple_of(TESTED));

/// The numbers that a leaf stores for a triangle. A leaf lies term by term, with as many of each as it has triangles.
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
    /// The leaf that `leaf` refers to; `None` beyond the end of `corners`.
    #[inline]
    pub(super) fn new(corners: &'a [f64], leaf: Child) -> Option<Self> {
        let window = corners.get(leaf.index() * TERMS..)?.first_chunk()?;
        Some(Self { window, count: leaf.count() })
    }

    /// The numbers from a place of the leaf on: a term of some triangles; lanes beyond the last triangle hold anything.
    #[inline]
    fn row(&self, place: usize) -> F64 {
        let place = place.min(WINDOW - TESTED);
        F64::new(core::array::from_fn(|i| self.window[place + i]))
    }

    /// The index of the leaf's triangle `i`.
    #[inline]
    pub(super) fn triangle(&self, i: usize) -> u32 {
        self.window.get(INDEX * self.count + i).map_or(u32::MAX, |index| *index as u32)
    }
}

/// A corner of each triangle, in coordinates along the ray.
#[derive(Clone, Copy)]
struct Sheared {
    x: F64,
    y: F64,
    z: F64,
}

/// A ray prepared for triangle tests: the shear that maps it onto the axis along which it is longest.
pub(super) struct Shear {
    /// The axes in cyclic order, with the one along which the ray is longest last.
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

    /// Calls `each` with every hit of the ray on a triangle of the leaf.
    ///
    /// With a, b, c the sheared corners, u = c × b, v = a × c and w = b × a must have one sign, 0 included; then
    /// t = (u a_z + v b_z + w c_z)/((u + v + w) d_z).
    #[inline]
    pub(super) fn intersect(&self, leaf: Leaf<'_>, mut each: impl FnMut(Hit)) {
        for first in (0..leaf.count).step_by(TESTED) {
            let (a, b, c) = (self.shear(leaf, 0, first), self.shear(leaf, 1, first), self.shear(leaf, 2, first));
            let valid = (1 << (leaf.count - first).min(TESTED)) - 1;
            let (u, v, w) = areas(a, b, c, valid);
            let (min, max) = (u.fast_min(v).fast_min(w), u.fast_max(v).fast_max(w));
            // One branch for all triangles: which of them are hit cannot be predicted.
            let mut hits = (min.simd_ge(F64::ZERO) | max.simd_le(F64::ZERO)).to_bitmask() & valid;
            if hits == 0 {
                continue;
            }
            // Signs are exact, so the sum vanishes only if the triangle is seen edge-on.
            let (sum, t) = ((u + v + w).to_array(), (u * a.z + v * b.z + w * c.z).to_array());
            while hits != 0 {
                let i = hits.trailing_zeros() as usize % TESTED;
                hits &= hits - 1;
                if sum[i] != 0.0 {
                    // A ray down the axis sees a mirror image.
                    let front = (sum[i] > 0.0) != (self.z < 0.0);
                    each(Hit { triangle: leaf.triangle(first + i), t: t[i] / sum[i] / self.z, front });
                }
            }
        }
    }

    /// The sheared corner of the triangles from `first` on. Triangles that share a vertex get equal coordinates for it.
    #[inline]
    fn shear(&self, leaf: Leaf<'_>, corner: usize, first: usize) -> Sheared {
        let corner = 3 * corner * leaf.count + first;
        let along = |i: usize| leaf.row(corner + self.axes[i] * leaf.count) - F64::splat(self.origin[i]);
        let (x, y, z) = (along(0), along(1), along(2));
        Sheared { x: x - F64::splat(self.x) * z, y: y - F64::splat(self.y) * z, z }
    }
}

/// c × b, a × c and b × a, where p × q = p_x q_y − p_y q_x. In the `valid` lanes signs are exact, and p × q is exactly
/// −(q × p).
///
/// Rounding is monotonic, so the rounded products order as the exact ones do unless they are equal; then the roundings
/// decide (Shewchuk's two-product), short of underflow.
#[inline]
fn areas(a: Sheared, b: Sheared, c: Sheared, valid: u32) -> (F64, F64, F64) {
    let products = |p: Sheared, q: Sheared| (p.x * q.y, p.y * q.x);
    let (u, v, w) = (products(c, b), products(a, c), products(b, a));
    let ties = u.0.simd_eq(u.1) | v.0.simd_eq(v.1) | w.0.simd_eq(w.1);
    if ties.to_bitmask() & valid == 0 {
        (u.0 - u.1, v.0 - v.1, w.0 - w.1)
    } else {
        let plane = |of: Sheared| [of.x.to_array(), of.y.to_array()];
        let [u, v, w] = exact_areas(plane(a), plane(b), plane(c)).map(F64::new);
        (u, v, w)
    }
}

#[cold]
fn exact_areas(a: [[f64; TESTED]; 2], b: [[f64; TESTED]; 2], c: [[f64; TESTED]; 2]) -> [[f64; TESTED]; 3] {
    let areas = |[px, py]: [[f64; TESTED]; 2], [qx, qy]: [[f64; TESTED]; 2]| {
        core::array::from_fn(|i| exact_cross([px[i], py[i]], [qx[i], qy[i]]))
    };
    [areas(c, b), areas(a, c), areas(b, a)]
}

/// p × q of one triangle, with exact sign.
pub(super) fn exact_cross([px, py]: [f64; 2], [qx, qy]: [f64; 2]) -> f64 {
    let (left, right) = (px * qy, py * qx);
    if left == right { libm::fma(px, qy, -left) - libm::fma(py, qx, -left) } else { left - right }
}
