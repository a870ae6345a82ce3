//! Diffraction of plane waves by periodic surfaces, by rigorous methods.
//!
//! Conventions: time dependence exp(−iωt), index η = n + ik. The surface is periodic along x, or along x and y; z
//! points up, and light arrives from above. Lengths are in nanometres, wavevectors in units of k₀ = 2π/λ. The wave that
//! arrives has the tangential wavevector (k_x, k_y) = −n (wi_x, wi_y) for light from the unit vector `wi`; order (m, n)
//! has the tangential wavevector (k_x + mλ/Λ_x, k_y + nλ/Λ_y).
//!
//! [`lamellar`] solves layers invariant along y, [`chandezon`] one interface invariant along y with slanted or curved
//! walls, and [`crossed`] layers of rectangles. [`convergence`] chooses the number of orders, with an error bar.
//!
//! # Example
//!
//! Lines of glass on glass, 200 nm wide and high, every 600 nm, in light from 30° across the lines:
//!
//! ```
//! use goniochrome_waves::Complex64;
//! use goniochrome_waves::convergence::{Goal, converge};
//! use goniochrome_waves::lamellar::Modes;
//! use goniochrome_waves::profile::{Profile, Slice};
//!
//! let glass = Complex64::from(1.5);
//! let lines = Slice { thickness_nm: 200.0, edges_nm: vec![0.0, 200.0], eta: vec![glass, 1.0.into()] };
//! let profile = Profile { period_nm: 600.0, above: 1.0, below: glass, slices: vec![lines] };
//!
//! let (wavelength_nm, k_x, k_y) = (550.0, -0.5, 0.0);
//! let goal = Goal { target: 1e-3, first: 10, limit: 60 };
//! let found = converge(goal, |max_order| {
//!     Ok(vec![Modes::new(&profile, wavelength_nm, k_x, max_order)?.response(k_y)?])
//! })?;
//! assert!(found.met);
//!
//! let response = &found.responses[0];
//! for order in response.reflected.iter().filter(|order| order.vertical.re > 0.0) {
//!     let [s, p] = response.reflected_efficiency(order);
//!     println!("order {}: {s:.4} in s, {p:.4} in p, each within {:.4}", order.index[0], found.error_bar);
//! }
//! # Ok::<(), goniochrome_waves::WaveError>(())
//! ```
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
