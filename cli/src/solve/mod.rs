//! From scenes to numbers: spectra of planes, scattering and diffraction of cells, and the tables made of them.

pub mod precision;
pub mod planar_scene;
pub mod mesh_scene;
pub mod groups;
pub mod spectra;
pub mod hits;
pub mod colours;
pub mod integral;
pub mod refine;
pub mod fidelity;
pub mod grid;
pub mod scatter;
pub mod diffraction;
pub mod coherent;
pub mod order_error;
pub mod cell_warnings;
pub mod checkpoint;
pub mod cell_table;
