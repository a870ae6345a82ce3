//! Ray tracing with interference: waves that merge, paths that do not, and the cells in which they run.
//!
//! [`waves`] and [`paths`] hold the two algorithms. [`planar`], [`coherent_mesh`] and [`incoherent_mesh`] say what a
//! state, a field and a split are in each kind of cell.

pub mod sobol;
pub mod random;
pub mod waves;
pub mod paths;
pub mod ledger;
pub mod planar;
pub mod coherent_mesh;
pub mod incoherent_mesh;
