//! Diffraction of plane waves by periodic surfaces, by rigorous methods.
//!
//! Conventions: time dependence exp(−iωt), index η = n + ik. The surface is periodic along x, or along x and y; z
//! points up, and light arrives from above. Lengths are in nanometres, wavevectors in units of k₀ = 2π/λ. The wave that
//! arrives has the tangential wavevector (k_x, k_y) = −n (wi_x, wi_y) for light from the unit vector `wi`; order (m, n)
//! has the tangential wavevector (k_x + mλ/Λ_x, k_y + nλ/Λ_y).
//!
//! Each module uses only those declared above it.

pub mod error;
pub(crate) mod linear;
pub(crate) mod fourier;
pub mod light;
pub mod response;
pub(crate) mod fields;
pub mod profile;
pub mod convergence;
pub mod lamellar;
pub mod crossed;
pub mod chandezon;

pub use error::WaveError;
pub use num_complex::Complex64;
