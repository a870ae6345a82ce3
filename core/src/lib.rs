//! How layered and micro-structured surfaces reflect light of each wavelength.
//!
//! The method is that of Shimada & Kawaguchi, "BRDF Estimation System for Structural Colors": rays split at every
//! interface by Fresnel's formulas, carry a phase per wavelength, and interfere where they leave in one direction. This
//! crate is the part that computes: no `std`, no allocation, no `unsafe`; the caller owns all memory.
//!
//! # Conventions
//!
//! - Fields vary as exp(−iωt). A medium has the complex index η = n + ik; k ≥ 0 absorbs, k < 0 (gain) is refused.
//! - Lengths and vacuum wavelengths are in nanometres, angles in radians.
//! - Surface frame: z is the macroscopic normal (the paper's **n**), x the tangent **t**, y the binormal **b**. `wi` points
//!   towards the light, `wo` towards the viewer; both leave the surface.
//! - k₀ = 2π/λ. A plane wave has the wavevector q in units of k₀, q·q = η², and the phase factor exp(i k₀ q·x). q may be
//!   complex, in absorbing media and beyond total reflection.
//! - s is the electric field across the plane of incidence. p is followed by its magnetic field, which makes both obey
//!   one formula ([`interface`]); powers do not depend on that choice.
//!
//! # Where to find what
//!
//! Each module uses only those above it.
//!
//! | module | what | equation |
//! |---|---|---|
//! | [`lanes`], [`complex`], [`vector`] | one number per wavelength of a group | |
//! | [`turns`] | phase factors of long paths | exp(2πi q·L/λ), path reduced to ±½ in double precision |
//! | [`medium`] | n + ik of a wavelength | dispersion formulas 1 to 9, tables |
//! | [`interface`] | one plane | r = (κ₁ − κ₂)/(κ₁ + κ₂), κ_s = q_n, κ_p = q_n/η²; models |
//! | [`coating`] | films on a facet, by the same recursion | |
//! | [`stack`] | planar multilayer in closed form | ρ_j = (r_j + ρ_{j+1}e²)/(1 + r_jρ_{j+1}e²) |
//! | [`cell`], [`mesh`] | the facets of a micro-surface | |
//! | [`bvh`] | the triangle that a ray meets first | u, v, w of one sign |
//! | [`trace`] | ray splitting, merging of equal states | a(state) = Σ a(rays in that state) |
//! | [`coherence`] | how exits add; the power ledger | R + T + absorbed + truncated + imbalance = 1 |
//! | [`layers`] | the tracer's planar cells, loops closed exactly | 1 + g + g² + … = 1/(1 − g) |
//! | [`polygons`] | the tracer's polygon cells: fields along ŝ and p̂ of each facet | J_t = J_i cos θ_t/cos θ_i |
//! | [`orders`] | diffraction by a periodic cell | F_m = ⟨w J E(x) exp(−i k_m·x)⟩ |
//! | [`bins`], [`sampling`] | where rays leave, where they start | |
//! | [`table`] | BRDF tables | f = ρ(θ) δ(wo − mirror(wi))/cos θ |
//! | [`colour`] | observer, illuminant, RGB | XYZ = Σ wᵢρ(λᵢ) |
//!
//! # Example: the reflectance of a soap film
//!
//! ```
//! use goniochrome::complex::ComplexLanes;
//! use goniochrome::interface::{Below, Model};
//! use goniochrome::lanes::{F32, Lanes};
//! use goniochrome::layers::{Summation, Workspace, trace_layers};
//! use goniochrome::medium::{MediaLanes, Medium};
//! use goniochrome::stack::{Film, Optics, OpticsArrays, Stack, StackArrays};
//!
//! // Air and water, at as many wavelengths as there are lanes; here they start at 450 nm.
//! let media = [Medium::constant(1.0.into())?, Medium::constant(1.33.into())?];
//! let wavelengths_nm: [f64; F32::WIDTH] = core::array::from_fn(|i| 450.0 + 10.0 * i as f64);
//! let mut eta = [ComplexLanes::zero(); 2];
//! let media = MediaLanes::<F32>::evaluate(&media, &wavelengths_nm, &mut eta).map_err(|(_, error)| error)?;
//!
//! // 420 nm of water in air, seen at 30 degrees.
//! let mut arrays = StackArrays::<2>::new();
//! let film = Film { medium: 1, thickness_nm: 420.0 };
//! let stack = Stack::new(0, [film], Below::Medium(0), arrays.memory())?;
//! let mut memory = OpticsArrays::<F32, 2>::new();
//! let optics = Optics::new(stack, &media, 0.5, Model::Physical, memory.memory());
//!
//! // In closed form, and by tracing rays: the same.
//! let closed = optics.reflectance(optics.reflection());
//! let mut workspace = Workspace::<F32, 2>::new();
//! let traced = trace_layers(&optics, Summation::ClosedLoops, workspace.memory())?;
//! for lane in 0..F32::WIDTH {
//!     assert!((closed.s.lane(lane) - traced.ledger.reflected.s.lane(lane)).abs() < 1e-6);
//! }
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]

pub mod bins;
pub mod bvh;
pub mod cell;
pub mod coating;
pub mod coherence;
pub mod colour;
pub mod complex;
pub mod interface;
pub mod lanes;
pub mod layers;
pub mod medium;
pub mod mesh;
pub mod orders;
pub mod polygons;
pub mod sampling;
pub mod stack;
pub mod table;
pub mod trace;
pub mod turns;
pub mod vector;
