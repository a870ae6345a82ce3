//! Nodes of the hierarchy: the boxes of up to eight children, in a frame of the mesh.

use glam::DVec3;

/// Number of children of a node.
pub(super) const WIDTH: usize = 8;
/// Maximum number of triangles of a leaf.
pub(super) const MAX_LEAF_TRIANGLES: usize = 8;
/// Minimum number of children of a node that holds more triangles than a leaf can. Where fewer children are large
/// enough to be nodes, small ones are split too: rays enter leaves of a few triangles less often.
pub(super) const MIN_CHILDREN: usize = 5;
/// Maximum number of levels of nodes, equal to 48 binary levels. The builder halves by count where the heuristic would
/// exceed it.
pub(super) const MAX_DEPTH: usize = 48 / WIDTH.ilog2() as usize;
/// Maximum number of nodes and leaves that wait in a depth-first traversal: a node leaves `WIDTH` − 1 on each level,
/// and the last node leaves `WIDTH`.
pub(super) const MAX_WAITING: usize = (WIDTH - 1) * MAX_DEPTH + 1;
/// Number of values of a leaf's triangle count, 0 to [`MAX_LEAF_TRIANGLES`], rounded up to a power of 2.
pub(super) const COUNTS: u32 = 16;

// Halving by count gives each child a WIDTHth, rounded up; so the levels hold every mesh that a child can address.
const _: () = assert!(WIDTH.is_power_of_two() && MIN_CHILDREN >= 2 && MIN_CHILDREN <= WIDTH);
const _: () = assert!(MIN_CHILDREN <= MAX_LEAF_TRIANGLES + 1);
const _: () =
    assert!((MAX_LEAF_TRIANGLES as u128) * (WIDTH as u128).pow(MAX_DEPTH as u32) > (u32::MAX / COUNTS) as u128);
const _: () = assert!(MAX_LEAF_TRIANGLES < COUNTS as usize);

/// The frame of the boxes: its origin is the middle of the mesh, its unit half the largest extent of the mesh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) centre: DVec3,
    /// 2 over the largest extent of the mesh.
    pub(super) scale: f64,
}

impl Frame {
    #[inline]
    pub(super) fn to_local(self, point: DVec3) -> DVec3 {
        (point - self.centre) * self.scale
    }
}

/// A reference to a child: the index of a node, or the first triangle of a leaf, counted leaf by leaf, and the leaf's
/// number of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Child(u32);

impl Child {
    pub(super) const ROOT: Self = Self::node(0);

    pub(super) const fn node(index: usize) -> Self {
        Self(index as u32 * COUNTS)
    }

    pub(super) const fn leaf(first: usize, count: usize) -> Self {
        Self(first as u32 * COUNTS + count as u32)
    }

    /// Index of the node, or of the leaf's first triangle.
    pub(super) const fn index(self) -> usize {
        (self.0 / COUNTS) as usize
    }

    /// Number of triangles of a leaf; 0 for a node.
    pub(super) const fn count(self) -> usize {
        (self.0 % COUNTS) as usize
    }
}

/// A node: the boxes of its children, in single precision and in the hierarchy's frame.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// The lower and the upper bounds of the children along each axis.
    pub(super) bounds: [[[f32; WIDTH]; 2]; 3],
    pub(super) children: [Child; WIDTH],
}

impl Node {
    /// A node without children: no ray enters an inverted box.
    pub const EMPTY: Self =
        Self { bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [Child::ROOT; WIDTH] };

    /// Stores the box of child `i`, rounded to single precision and moved one step outwards: at least half a step more
    /// than the rounding. A bound that would be subnormal moves on to a normal number, since arithmetic with subnormal
    /// numbers takes some 150 cycles on Intel's processors, and a symmetric mesh has many bounds at 0.
    pub(super) fn store(&mut self, i: usize, low: DVec3, high: DVec3, frame: &Frame) {
        let (low, high) = (frame.to_local(low).to_array(), frame.to_local(high).to_array());
        for (axis, [lower, upper]) in self.bounds.iter_mut().enumerate() {
            if let (Some(lower), Some(upper)) = (lower.get_mut(i), upper.get_mut(i)) {
                *lower = -outwards(-low[axis] as f32);
                *upper = outwards(high[axis] as f32);
            }
        }
    }

    /// Copies child `from` of a node to child `to` of this one.
    #[inline]
    pub(super) fn copy_child(&mut self, to: usize, node: &Self, from: usize) {
        let (to, from) = (to % WIDTH, from % WIDTH);
        for (copies, bounds) in self.bounds.iter_mut().flatten().zip(node.bounds.iter().flatten()) {
            copies[to] = bounds[from];
        }
        self.children[to] = node.children[from];
    }
}

/// The next larger number that is not subnormal.
fn outwards(bound: f32) -> f32 {
    let next = bound.next_up();
    if next.is_subnormal() { f32::MIN_POSITIVE } else { next }
}

impl Default for Node {
    fn default() -> Self {
        Self::EMPTY
    }
}
