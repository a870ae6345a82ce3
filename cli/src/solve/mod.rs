//! From scenes to numbers: spectra of planar scenes, scattering and diffraction of cells, and the tables of both.

pub mod precision;
pub mod groups;
pub mod planar_scene;
pub mod backing;
pub mod mesh_scene;
pub mod spectra;
pub mod colours;
pub mod integral;
pub mod refine;
pub mod fidelity;
pub mod grid;
pub mod batches;
pub mod truncation;
mod wave_limits;
pub mod share;
pub mod checkpoint;
pub mod sealed_part;
pub mod diffraction;
pub mod scatter;
pub mod order_error;
pub mod cell_warnings;
pub mod cell_table;
pub mod waves;
