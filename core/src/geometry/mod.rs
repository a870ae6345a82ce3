//! The micro-surface: facets, cells that are made of them, and the search for the facet that a ray hits first.
//!
//! [`bvh`] finds the nearest triangle on a ray. [`planar_cell`] checks a cell of horizontal planes, [`mesh_cell`] one
//! of any facets.

pub mod side;
pub mod bvh;
pub mod facet;
pub mod planar_cell;
pub mod mesh_cell;
