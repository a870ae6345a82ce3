//! The figures of Shimada & Kawaguchi's paper "BRDF Estimation System for Structural Colors", and the studies behind
//! them.

pub mod html;
pub mod comparison;
pub mod wavelength_count;
pub mod teapots;
pub mod figures;
