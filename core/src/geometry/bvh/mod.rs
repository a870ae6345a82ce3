//! A bounding volume hierarchy that finds the nearest triangle on a ray, in memory that the caller owns.
//!
//! The hierarchy is built top down by the binned surface area heuristic. A node has up to eight children, whose boxes
//! are tested together. A leaf has up to eight triangles, stored side by side. Boxes are in single precision, widened
//! by its rounding, in units of the mesh about its middle; rays and triangles are in double precision. The triangle
//! test is watertight: a ray that meets an edge or a vertex of a closed mesh hits at least one of the triangles there.
//!
//! Sources: Wald, "On fast construction of SAH-based bounding volume hierarchies" (2007); Wald, Benthin & Boulos,
//! "Getting rid of packets" (2008), for wide nodes; Woop, Benthin & Wald, "Watertight ray/triangle intersection"
//! (2013); Shewchuk, "Adaptive precision floating-point arithmetic" (1997).

mod ray;
mod node;
mod keys;
mod stack;
mod boxes;
mod leaf;
mod tree;
mod build;
mod traverse;
mod beam;
mod batch;
#[cfg(test)]
mod tests;

pub use node::Node;
pub use ray::{Hit, Ray};
pub use tree::{Bvh, BvhError};
