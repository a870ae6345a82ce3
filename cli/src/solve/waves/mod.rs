//! Rigorous diffraction of periodic cells: from a scene to the solvers of `goniochrome-waves`, and to orders, tables of
//! orders and scattering of cells whose periods differ at random.

mod sections;
mod powers;
mod cell;
mod front;
mod solvers;
pub mod one_direction;
pub mod table;
pub mod random_periods;

pub use cell::{Accuracy, WaveCell};

/// How diffraction orders are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderMethod {
    /// Maxwell's equations.
    Waves,
    /// Rays that interfere: physical optics.
    Rays,
}
