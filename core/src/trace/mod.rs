//! Ray tracing with and without interference.
//!
//! [`waves`] traces waves, which merge where they coincide; [`paths`] traces paths one by one, which add as powers.
//! [`planar`], [`coherent_mesh`] and [`incoherent_mesh`] implement these algorithms' traits for planar cells and for
//! polygon meshes: they define state, field and split.

pub mod sobol;
pub mod random;
pub mod waves;
pub mod paths;
pub mod ledger;
pub mod planar;
mod plane_of_incidence;
mod field_axes;
pub mod coherent_mesh;
pub mod incoherent_mesh;
