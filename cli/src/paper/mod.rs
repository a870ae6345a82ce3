//! The figures of Shimada & Kawaguchi's paper.

pub mod html;
pub mod comparison;
pub mod wavelength_count;
pub mod teapots;
pub mod figures;
