//! SIMD lanes that hold one number per wavelength, and the complex numbers, vectors and phase factors made of them.
//!
//! All of the crate's numerics that run at several wavelengths at once are generic over [`lanes::Lanes`].

pub mod lanes;
pub mod common;
pub mod registers;
pub mod ray_lanes;
pub mod double_double;
pub mod complex;
pub mod vector;
pub mod phase;
