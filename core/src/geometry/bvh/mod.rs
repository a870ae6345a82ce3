//! Which triangle a ray meets first: a bounding volume hierarchy in memory that the caller owns.
//!
//! Built top down by binned surface area heuristic, eight children to a node, so that one box test serves all, and eight
//! triangles to a leaf at most, which lie side by side. Boxes are tested in single precision, widened by its rounding, in
//! units of the mesh about its middle; rays and triangles are double precision. A ray that meets an edge or a vertex of a
//! closed mesh meets at least one of the triangles there.
//!
//! Sources: Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007); Wald, Benthin & Boulos, "Getting
//! rid of packets" (2008), for wide nodes; Woop, Benthin & Wald, "Watertight ray/triangle intersection" (2013);
//! Shewchuk, "Adaptive precision floating-point arithmetic" (1997).

mod boxes;
mod build;
mod leaf;
#[cfg(test)]
mod tests;
mod batch;
mod traversal;

pub use boxes::Node;

use boxes::Slabs;
use glam::DVec3;
use leaf::{Leaf, Shear, TERMS, WINDOW};

/// Children of a node.
const WIDTH: usize = 8;
/// Triangles of a leaf at most.
const LEAF_TRIANGLES: usize = 8;
/// Children of an inner node at least, which holds more triangles than a leaf: where fewer are large enough to be nodes, small
/// ones are split too, since leaves of a few triangles are entered more seldom.
const MIN_CHILDREN: usize = 5;
/// Levels of nodes at most, 48 binary ones; the builder halves by count where the heuristic would exceed it.
const MAX_DEPTH: usize = 48 / WIDTH.ilog2() as usize;
/// A node leaves WIDTH − 1 entries behind for each level, and the last leaves WIDTH.
const STACK: usize = (WIDTH - 1) * MAX_DEPTH + 1;
/// Coordinates beyond this are refused: boxes and their areas must stay finite.
const MAX_COORDINATE: f64 = (1u128 << 120) as f64;

// Halving by count gives each child a WIDTHth, rounded up, and places every mesh that a child can name.
const _: () = assert!(WIDTH.is_power_of_two() && MIN_CHILDREN >= 2 && MIN_CHILDREN <= WIDTH);
const _: () = assert!(MIN_CHILDREN <= LEAF_TRIANGLES + 1);
const _: () = assert!((LEAF_TRIANGLES as u128) * (WIDTH as u128).pow(MAX_DEPTH as u32) > (u32::MAX / COUNTS) as u128);

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

impl Ray {
    /// Whether it can hit anything.
    #[inline]
    fn has_direction(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != DVec3::ZERO
    }
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

impl Hit {
    /// Nearer, or as near and of a lower index.
    #[inline]
    fn precedes(&self, other: &Self) -> bool {
        self.t < other.t || (self.t == other.t && self.triangle < other.triangle)
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
    /// 2²⁸ triangles or more.
    TooMany,
    /// The memory is too small.
    Memory {
        /// Nodes needed: [`Bvh::required_nodes`].
        nodes: usize,
        /// Elements of `order` needed: one per triangle.
        order: usize,
        /// Elements of `corners` needed: [`Bvh::required_corners`].
        corners: usize,
    },
}

impl core::fmt::Display for BvhError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Empty => write!(f, "the mesh has no triangles"),
            Self::NotFinite { vertex } => write!(f, "vertex {vertex} has a coordinate that is not finite or too large"),
            Self::NoVertex { triangle } => write!(f, "triangle {triangle} names a vertex that the mesh does not have"),
            Self::TooMany => write!(f, "the mesh has 268435456 triangles or more"),
            Self::Memory { nodes, order, corners } => {
                write!(
                    f,
                    "the hierarchy needs memory for {nodes} nodes, {order} triangles and {corners} numbers of theirs"
                )
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
    /// The corners of the triangles, leaf by leaf.
    corners: &'a [f64],
    frame: Frame,
}

/// Where the boxes are: they refer to the middle of the mesh, in units of half its largest extent.
#[derive(Clone, Copy, Debug)]
struct Frame {
    centre: DVec3,
    /// 2 over the largest extent of the mesh.
    scale: f64,
}

impl Frame {
    #[inline]
    fn place(&self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }
}

/// A node, or a leaf: where its triangles begin, leaf by leaf, and how many there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

/// Values of a count, 0 to [`LEAF_TRIANGLES`], rounded up to a power of 2.
const COUNTS: u32 = 16;
const _: () = assert!(LEAF_TRIANGLES < COUNTS as usize);

impl Child {
    const ROOT: Self = Self::node(0);

    const fn node(place: usize) -> Self {
        Self(place as u32 * COUNTS)
    }

    const fn leaf(first: usize, count: usize) -> Self {
        Self(first as u32 * COUNTS + count as u32)
    }

    const fn place(self) -> usize {
        (self.0 / COUNTS) as usize
    }

    /// Triangles of a leaf; 0 for a node.
    const fn count(self) -> usize {
        (self.0 % COUNTS) as usize
    }
}

/// A child whose box the ray enters at `near`.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    child: Child,
}

impl<'a> Bvh<'a> {
    /// Nodes that suffice for any mesh of so many triangles.
    ///
    /// With I nodes of `MIN_CHILDREN` or more there are (`MIN_CHILDREN` − 1) I + 1 leaves or more, none empty.
    #[must_use]
    pub const fn required_nodes(triangle_count: usize) -> usize {
        let nodes = triangle_count.saturating_sub(1) / (MIN_CHILDREN - 1);
        if nodes == 0 { 1 } else { nodes }
    }

    /// Numbers that suffice for the corners of so many triangles.
    ///
    /// Beyond those of the triangles, a test of the last leaf reads as many as a full one has.
    #[must_use]
    pub const fn required_corners(triangle_count: usize) -> usize {
        TERMS.saturating_mul(triangle_count).saturating_add(WINDOW)
    }

    /// Checks the mesh and builds the hierarchy over it.
    ///
    /// `triangles` index `vertices`. `nodes` must have [`Bvh::required_nodes`] elements, `order` one per triangle, `corners`
    /// [`Bvh::required_corners`]; what they hold does not matter, and `order` is free again afterwards. Triangles of zero area
    /// are left out, and so never hit.
    ///
    /// # Errors
    /// [`BvhError`], with the first offending index or with the memory needed.
    pub fn build(
        vertices: &'a [DVec3],
        triangles: &'a [[u32; 3]],
        nodes: &'a mut [Node],
        order: &mut [u32],
        corners: &'a mut [f64],
    ) -> Result<Self, BvhError> {
        build::build(vertices, triangles, nodes, order, corners)
    }

    /// The nearest hit with t in \[`t_min`, `t_max`\] among those that `accept` admits; of equally near ones, that of
    /// the lowest index.
    ///
    /// `accept` may be asked about any hit, in any order. A ray that is not finite (`t_max` apart) or has no direction
    /// hits nothing. The t of a hit lies between those of the triangle's vertices, to rounding, and is no better than that
    /// where the ray sees the triangle thinner than the rounding of its vertices.
    #[must_use]
    pub fn intersect_nearest(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        if ray.has_direction() { self.traverse(ray, accept) } else { None }
    }

    /// [`Bvh::intersect_nearest`] of each of many rays, the same hits. The rays take turns and so wait for memory together, which pays for
    /// incoherent rays, and most on meshes beyond the caches; for coherent rays one by one is faster. It takes some 20 KiB of
    /// stack.
    ///
    /// `accept` may be asked about any hit of the ray of an index, in any order. Rays beyond the end of `hits` are left out;
    /// hits beyond that of `rays` become `None`.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>], accept: impl FnMut(usize, &Hit) -> bool) {
        batch::intersect_batch(self, rays, hits, accept);
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

    /// A node that is there; of others one without children.
    #[inline]
    fn node(&self, place: usize) -> &'a Node {
        self.nodes.get(place).unwrap_or(&Node::EMPTY)
    }

    /// [`Bvh::intersect_nearest`] of a ray that has a direction.
    #[inline]
    fn traverse(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let slabs = Slabs::new(ray, &self.frame);
        let shear = Shear::new(ray);
        let mut entries = [Entry { near: 0.0, child: Child::ROOT }; STACK];
        let mut stack = Stack { entries: &mut entries, height: 0 };
        let mut best = Hit { triangle: u32::MAX, t: ray.t_max, front: false };
        let mut far = slabs.last(best.t);
        let mut child = Child::ROOT;
        loop {
            if child.count() == 0 {
                let node = self.node(child.place());
                if let Some(nearest) = slabs.enter(node, far, &mut stack) {
                    child = nearest;
                    continue;
                }
            } else {
                if let Some(leaf) = Leaf::new(self.corners, child) {
                    shear.intersect(leaf, |hit| {
                        if hit.precedes(&best) && hit.t >= ray.t_min && accept(&hit) {
                            best = hit;
                            far = slabs.last(hit.t);
                        }
                    });
                }
            }
            match stack.pop_before(far) {
                Some(waiting) => child = waiting,
                None => return (best.triangle != u32::MAX).then_some(best),
            }
        }
    }
}

/// Children that wait, the nearest of each node on top. It holds those of the deepest tree.
struct Stack<'e> {
    /// Apart, so that the height stays in a register.
    entries: &'e mut [Entry; STACK],
    height: usize,
}

impl Stack<'_> {
    #[inline]
    fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(self.height) {
            *slot = entry;
            self.height += 1;
        }
    }

    /// Sinks the uppermost entry below those above `base` that are nearer.
    #[inline]
    fn sink(&mut self, base: usize) {
        let mut place = self.height.saturating_sub(1);
        while place > base {
            let Some([below, above]) = self.entries.get_mut(place - 1..=place) else { return };
            if below.near >= above.near {
                return;
            }
            core::mem::swap(below, above);
            place -= 1;
        }
    }

    /// The uppermost that is entered before `far`.
    #[inline]
    fn pop_before(&mut self, far: f32) -> Option<Child> {
        loop {
            self.height = self.height.checked_sub(1)?;
            let entry = self.entries.get(self.height)?;
            if entry.near <= far {
                return Some(entry.child);
            }
        }
    }
}

/// The vertices of a triangle that is there, as `check` has seen to; of others a triangle without area.
#[inline]
fn vertices_of(vertices: &[DVec3], triangles: &[[u32; 3]], triangle: u32) -> [DVec3; 3] {
    let triangle = triangles.get(triangle as usize).copied().unwrap_or_default();
    triangle.map(|vertex| vertices.get(vertex as usize).copied().unwrap_or_default())
}
