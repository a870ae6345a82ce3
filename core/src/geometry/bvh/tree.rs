//! The hierarchy over a checked mesh, the memory that it needs, and the errors of its construction.

use super::leaf::{TERMS, WINDOW};
use super::node::{Frame, MIN_CHILDREN, Node};
use glam::DVec3;

/// An error in a mesh, for which it is refused, or too little memory for its hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BvhError {
    /// The mesh has no triangles.
    Empty,
    /// A vertex has a coordinate that is NaN, infinite or beyond ±2¹²⁰.
    NotFinite {
        /// Index of the vertex.
        vertex: usize,
    },
    /// A triangle names a vertex beyond the list.
    NoVertex {
        /// Index of the triangle.
        triangle: usize,
    },
    /// The mesh has 2²⁸ triangles or more.
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
                    "the hierarchy needs memory for {nodes} nodes, {order} triangles and {corners} numbers of corners"
                )
            }
        }
    }
}

impl core::error::Error for BvhError {}

/// A checked mesh with its hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct Bvh<'a> {
    pub(super) vertices: &'a [DVec3],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) nodes: &'a [Node],
    /// The corners of the triangles, leaf by leaf.
    pub(super) corners: &'a [f64],
    pub(super) frame: Frame,
}

impl<'a> Bvh<'a> {
    /// Number of nodes that suffice for any mesh of `triangle_count` triangles.
    ///
    /// A tree of I nodes, each with `MIN_CHILDREN` or more children, has (`MIN_CHILDREN` − 1) I + 1 leaves or more,
    /// none of them empty.
    #[must_use]
    pub const fn required_nodes(triangle_count: usize) -> usize {
        let nodes = triangle_count.saturating_sub(1) / (MIN_CHILDREN - 1);
        if nodes == 0 { 1 } else { nodes }
    }

    /// Number of elements that suffice for the corners of `triangle_count` triangles.
    ///
    /// It exceeds what the triangles take, since a test of the last leaf reads as much as a full leaf holds.
    #[must_use]
    pub const fn required_corners(triangle_count: usize) -> usize {
        TERMS.saturating_mul(triangle_count).saturating_add(WINDOW)
    }

    /// The vertices of the mesh.
    #[must_use]
    pub fn vertices(&self) -> &'a [DVec3] {
        self.vertices
    }

    /// The triangles of the mesh: three indices of vertices each.
    #[must_use]
    pub fn triangles(&self) -> &'a [[u32; 3]] {
        self.triangles
    }

    /// The node of an index; one without children beyond the last.
    #[inline]
    pub(super) fn node(&self, index: usize) -> &'a Node {
        self.nodes.get(index).unwrap_or(&Node::EMPTY)
    }
}
