//! One number per wavelength: lanes of floating point and what is built of them.
//!
//! Everything in the crate that is followed at several wavelengths at once is generic over [`lanes::Lanes`].

pub mod lanes;
pub mod double_double;
pub mod complex;
pub mod vector;
pub mod phase;
