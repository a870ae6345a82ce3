//! Which triangle a ray meets first: a bounding volume hierarchy in memory that the caller owns.
//!
//! Built top down by binned surface area heuristic, a child for each lane to a node, so that one box test serves all.
//! Boxes are single precision, about the centre of the mesh, rounded outwards; rays and triangles are double precision. A ray that
//! meets an edge or a vertex of a closed mesh meets at least one of the triangles there.
//!
//! Sources: Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007); Woop, Benthin & Wald,
//! "Watertight ray/triangle intersection" (2013); Shewchuk, "Adaptive precision floating-point arithmetic" (1997).

mod build;
#[cfg(test)]
mod tests;

use crate::lanes::{F64, Lanes};
use glam::DVec3;

/// Children of a node: 8 with AVX-512, otherwise 4.
const WIDTH: usize = F64::WIDTH;
/// Triangles of a leaf at most.
const LEAF_TRIANGLES: usize = 4;
/// Children of an inner node at least: it holds more triangles than a leaf, and is split as far as it can be.
const LEAST_CHILDREN: usize = if LEAF_TRIANGLES + 1 < WIDTH { LEAF_TRIANGLES + 1 } else { WIDTH };
/// Levels of nodes at most, 48 binary ones; the builder halves by count where the heuristic would exceed it.
const MAX_DEPTH: usize = 48 / WIDTH.ilog2() as usize;
/// A node leaves WIDTH − 1 entries behind for each level, and the last leaves WIDTH.
const STACK: usize = (WIDTH - 1) * MAX_DEPTH + 1;
/// Coordinates beyond this are refused: boxes and their areas must stay finite.
const MAX_COORDINATE: f64 = (1u128 << 120) as f64;

// Halving by count gives each child a WIDTHth, rounded up, and places every mesh that 32-bit indices can name.
const _: () = assert!(WIDTH.is_power_of_two() && WIDTH >= 2);
const _: () = assert!((LEAF_TRIANGLES as u128) * (WIDTH as u128).pow(MAX_DEPTH as u32) > u32::MAX as u128);
const _: () = assert!(size_of::<Node>() == 32 * WIDTH);

/// Widening of the boxes in units of ‖origin − centre‖∞ + half the extent of the mesh.
///
/// In units of the roundoff ε/2 and that length, the roundings between a box test and a triangle test are: origin and
/// vertex made relative to the centre 2, the widening itself 1, the slab distance 3, vertex relative to the origin 1,
/// shear factor, product and difference 4; together 11, held by 16.
const BOX_SLACK: f64 = 8.0 * f64::EPSILON;

/// The half-line origin + t · direction between two parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where t = 0.
    pub origin: DVec3,
    /// Need not be of unit length; components may be 0, but not all.
    pub direction: DVec3,
    /// Smallest t of a hit.
    pub t_min: f64,
    /// Largest t of a hit; may be infinite.
    pub t_max: f64,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the triangle.
    pub triangle: u32,
    /// Parameter of the ray, in lengths of its direction.
    pub t: f64,
    /// direction · normal < 0, where the vertices run counter-clockwise about the normal.
    pub front: bool,
}

/// Boxes of the children, in single precision relative to the centre of the mesh.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// Of each axis, the lower and the upper bounds of the children.
    bounds: [[[f32; WIDTH]; 2]; 3],
    /// A node, or the first place in `order` if `count` is not 0.
    first: [u32; WIDTH],
    /// Triangles of a leaf; 0 for a node.
    count: [u32; WIDTH],
}

impl Node {
    /// A node without children: no ray enters an inverted box.
    pub const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3],
        first: [0; WIDTH],
        count: [0; WIDTH],
    };
}

impl Default for Node {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// Why a mesh was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BvhError {
    /// No triangles.
    Empty,
    /// A vertex with a coordinate that is NaN, infinite or beyond ±2¹²⁰.
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A triangle that names a vertex beyond the list.
    NoVertex {
        /// The triangle.
        triangle: usize,
    },
    /// More triangles than 32 bits count.
    TooMany,
    /// The memory is too small.
    Memory {
        /// Nodes needed: [`Bvh::required_nodes`].
        nodes: usize,
        /// Elements of `order` needed: one per triangle.
        order: usize,
    },
}

impl core::fmt::Display for BvhError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Empty => write!(f, "the mesh has no triangles"),
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} has a coordinate that is not finite or too large"),
            Self::NoVertex { triangle } => write!(f, "triangle {triangle} names a vertex that the mesh does not have"),
            Self::TooMany => write!(f, "the mesh has more triangles than 32 bits count"),
            Self::Memory { nodes, order } => {
                write!(f, "the hierarchy needs memory for {nodes} nodes and {order} elements of the order")
            }
        }
    }
}

impl core::error::Error for BvhError {}

/// A checked mesh with its hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a> {
    vertices: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    nodes: &'a [Node],
    order: &'a [u32],
    /// Middle of the mesh, to which the boxes refer.
    centre: DVec3,
    /// Half the largest extent of the mesh.
    radius: f64,
}

/// What waits on the stack: a child whose box the ray enters at `near`.
#[derive(Clone, Copy)]
struct Entry {
    near: f64,
    first: u32,
    count: u32,
}

impl<'a> Bvh<'a> {
    /// Nodes that suffice for any mesh of so many triangles.
    ///
    /// With I nodes of `LEAST_CHILDREN` or more there are (`LEAST_CHILDREN` − 1) I + 1 leaves or more, none empty.
    #[must_use]
    pub const fn required_nodes(triangle_count: usize) -> usize {
        let nodes = triangle_count.saturating_sub(1) / (LEAST_CHILDREN - 1);
        if nodes == 0 { 1 } else { nodes }
    }

    /// Checks the mesh and builds the hierarchy over it.
    ///
    /// `triangles` index `vertices`. `nodes` must have [`Bvh::required_nodes`] elements, `order` one per triangle; what
    /// they hold does not matter. Triangles of zero area are left out, and so never hit.
    ///
    /// # Errors
    /// [`BvhError`], with the first offending index or with the memory needed.
    pub fn build(
        vertices: &'a [DVec3],
        triangles: &'a [[u32; 3]],
        nodes: &'a mut [Node],
        order: &'a mut [u32],
    ) -> Result<Self, BvhError> {
        build::build(vertices, triangles, nodes, order)
    }

    /// The nearest hit with t in \[`t_min`, `t_max`\] among those that `accept` admits; of equally near ones, that of
    /// the lowest index.
    ///
    /// `accept` may be asked about any hit, in any order. A ray that is not finite (`t_max` apart) or has no direction
    /// hits nothing. The t of a hit lies between those of the triangle's vertices, to rounding, and is no better than that
    /// where the ray sees the triangle thinner than the rounding of its vertices.
    #[must_use]
    pub fn closest(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let [x, y, z] = ray.direction.abs().to_array();
        if !ray.origin.is_finite() || !ray.direction.is_finite() || ray.direction == DVec3::ZERO {
            None
        } else if z >= x && z >= y {
            self.traverse::<2>(ray, accept)
        } else if y >= x {
            self.traverse::<1>(ray, accept)
        } else {
            self.traverse::<0>(ray, accept)
        }
    }

    /// The vertices.
    #[must_use]
    pub fn vertices(&self) -> &'a [DVec3] {
        self.vertices
    }

    /// The triangles.
    #[must_use]
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// [`Bvh::closest`] for rays whose direction is longest along axis `KZ`.
    #[inline]
    fn traverse<const KZ: usize>(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let slabs = Slabs::new(ray, self.centre, self.radius);
        let shear = Shear::<KZ>::new(ray);
        let mut stack = [Entry { near: 0.0, first: 0, count: 0 }; STACK];
        let mut height = 1;
        let mut best = Hit { triangle: u32::MAX, t: ray.t_max, front: false };
        while height > 0 {
            height -= 1;
            let Some(&entry) = stack.get(height) else { break };
            if height > 0 && entry.near > best.t {
                continue;
            }
            if entry.count == 0 {
                let node = self.nodes.get(entry.first as usize).unwrap_or(&Node::EMPTY);
                slabs.push_children(node, best.t, &mut stack, &mut height);
                continue;
            }
            for &triangle in self.order.iter().skip(entry.first as usize).take(entry.count as usize) {
                let Some((t, front)) = self.intersect(&shear, triangle) else { continue };
                let hit = Hit { triangle, t, front };
                let nearer = t < best.t || (t == best.t && triangle < best.triangle);
                if nearer && t >= ray.t_min && accept(&hit) {
                    best = hit;
                }
            }
        }
        (best.triangle != u32::MAX).then_some(best)
    }

    #[inline]
    fn intersect<const KZ: usize>(&self, shear: &Shear<KZ>, triangle: u32) -> Option<(f64, bool)> {
        let [a, b, c] = corners(self.vertices, self.triangles, triangle);
        shear.intersect(a, b, c)
    }
}

/// The vertices of a triangle that is there, as `check` has seen to; of others a triangle without area.
#[inline]
fn corners(vertices: &[DVec3], triangles: &[[u32; 3]], triangle: u32) -> [DVec3; 3] {
    let triangle = triangles.get(triangle as usize).copied().unwrap_or_default();
    triangle.map(|vertex| vertices.get(vertex as usize).copied().unwrap_or_default())
}

/// A ray made ready for box tests.
struct Slabs {
    t_min: f64,
    /// 1/direction; infinite for components of 0.
    inverse: [f64; 3],
    /// The origin relative to the centre, moved forwards and backwards by the slack.
    origin_near: [f64; 3],
    origin_far: [f64; 3],
    /// Of each axis, which of the bounds the ray meets first: 1, the upper, if it runs downwards.
    near_side: [usize; 3],
}

impl Slabs {
    #[inline]
    fn new(ray: &Ray, centre: DVec3, radius: f64) -> Self {
        let origin = (ray.origin - centre).to_array();
        let direction = ray.direction.to_array();
        let slack = BOX_SLACK * (origin[0].abs().max(origin[1].abs()).max(origin[2].abs()) + radius);
        Self {
            t_min: ray.t_min,
            inverse: direction.map(|d| 1.0 / d),
            origin_near: core::array::from_fn(|axis| origin[axis] + slack.copysign(direction[axis])),
            origin_far: core::array::from_fn(|axis| origin[axis] - slack.copysign(direction[axis])),
            near_side: direction.map(|d| usize::from(d.is_sign_negative())),
        }
    }

    /// Pushes the children of `node` that the ray enters before `t_max`, the nearest last.
    #[inline]
    fn push_children(&self, node: &Node, t_max: f64, stack: &mut [Entry; STACK], height: &mut usize) {
        let mut near = F64::splat(self.t_min);
        let mut far = F64::splat(t_max);
        for axis in 0..3 {
            let side = self.near_side[axis] & 1;
            let plane = |side: usize| F64::new(node.bounds[axis][side].map(f64::from));
            let inverse = F64::splat(self.inverse[axis]);
            let enter = (plane(side) - F64::splat(self.origin_near[axis])) * inverse;
            let leave = (plane(1 - side) - F64::splat(self.origin_far[axis])) * inverse;
            // 0 · ∞, a ray within a face, is NaN: the comparisons are false and the axis does not count.
            near = near.select_lt(enter, enter, near);
            far = leave.select_lt(far, leave, far);
        }
        let mut entered = near.mask_le(far);
        let near = near.to_array();
        let base = *height;
        while entered != 0 {
            let i = entered.trailing_zeros() as usize % WIDTH;
            entered &= entered - 1;
            let entry = Entry { near: near[i], first: node.first[i], count: node.count[i] };
            // The stack holds the deepest tree, so there is room.
            let Some(pushed) = stack.get_mut(base..=*height) else { return };
            let place = pushed.iter().take(*height - base).position(|other| other.near < entry.near);
            let mut moving = entry;
            for slot in pushed.iter_mut().skip(place.unwrap_or(*height - base)) {
                core::mem::swap(slot, &mut moving);
            }
            *height += 1;
        }
    }
}

/// A ray made ready for triangle tests: the shear that turns it into the axis `KZ`.
struct Shear<const KZ: usize> {
    origin: DVec3,
    x: f64,
    y: f64,
    z: f64,
    /// The ray runs down the axis, which mirrors what it sees.
    mirrored: bool,
}

impl<const KZ: usize> Shear<KZ> {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let [x, y, z] = Self::cycle(ray.direction);
        Self { origin: ray.origin, x: x / z, y: y / z, z, mirrored: z < 0.0 }
    }

    /// The components with that of `KZ` last.
    #[inline]
    fn cycle(v: DVec3) -> [f64; 3] {
        match KZ {
            0 => [v.y, v.z, v.x],
            1 => [v.z, v.x, v.y],
            _ => [v.x, v.y, v.z],
        }
    }

    /// A vertex in the frame of the ray: the same for every triangle that has it.
    #[inline]
    fn project(&self, vertex: DVec3) -> [f64; 3] {
        let [x, y, z] = Self::cycle(vertex - self.origin);
        [x - self.x * z, y - self.y * z, z]
    }

    /// t and whether the front is hit. With the vertices projected, u = c × b, v = a × c, w = b × a must be of one
    /// sign, 0 included; t = (u a_z + v b_z + w c_z)/((u + v + w) d_z).
    #[inline]
    fn intersect(&self, a: DVec3, b: DVec3, c: DVec3) -> Option<(f64, bool)> {
        let (a, b, c) = (self.project(a), self.project(b), self.project(c));
        let (u, v, w) = (cross(c, b), cross(a, c), cross(b, a));
        // Signs are exact, so the sum vanishes only if the triangle is seen edge-on.
        let one_sign = (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
        let sum = u + v + w;
        if !one_sign || sum == 0.0 {
            return None;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) / sum / self.z;
        Some((t, (sum > 0.0) != self.mirrored))
    }
}

/// p_x q_y − p_y q_x with the exact sign, and exactly −cross(q, p).
///
/// Rounding is monotonic, so the rounded products order as the exact ones do unless they are equal; then the roundings
/// decide (Shewchuk's two-product), short of underflow.
#[inline]
fn cross(p: [f64; 3], q: [f64; 3]) -> f64 {
    let (left, right) = (p[0] * q[1], p[1] * q[0]);
    if left == right { tie(p, q, left) } else { left - right }
}

#[cold]
fn tie(p: [f64; 3], q: [f64; 3], product: f64) -> f64 {
    libm::fma(p[0], q[1], -product) - libm::fma(p[1], q[0], -product)
}
