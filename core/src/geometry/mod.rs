//! The facets of a micro-surface, and the first one that a ray hits.

pub mod side;
pub mod bvh;
pub mod facet;
pub mod planar_cell;
pub mod mesh_cell;
