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
//!   one formula ([`optics::interface`]); powers do not depend on that choice.
//!
//! # Where to find what
//!
//! Each module uses only those above it.
//!
//! | module | what | equation |
//! |---|---|---|
//! | [`simd::lanes`], [`simd::double_double`], [`simd::complex`], [`simd::vector`] | one number per wavelength of a group | |
//! | [`simd::phase`] | phase factors of long paths | exp(2πi q·L/λ), path reduced to ±½ in double precision |
//! | [`optics::medium`] | n + ik of a wavelength | dispersion formulas 1 to 9, tables |
//! | [`optics::incidence`] | the angle of the light, to all its digits | q_n² = η² − q_t² |
//! | [`optics::interface`] | one plane | r = (κ₁ − κ₂)/(κ₁ + κ₂), κ_s = q_n, κ_p = q_n/η²; models |
//! | [`optics::coating`] | films on a facet, by the same recursion | |
//! | [`optics::stack`] | planar multilayer in closed form | ρ_j = (r_j + ρ_{j+1}e²)/(1 + r_jρ_{j+1}e²) |
//! | [`optics::rounding`] | how far rounding may have moved R and T | δρ₀ = Σ (wave that meets plane j)² δρ_j |
//! | [`geometry::planar_cell`], [`geometry::mesh_cell`] | the facets of a micro-surface | |
//! | [`geometry::bvh`] | the triangle that a ray meets first | u, v, w of one sign |
//! | [`trace::waves`] | ray splitting, merging of equal states | a(state) = Σ a(rays in that state) |
//! | [`trace::paths`] | rays that do not interfere, followed one by one | a branch is drawn in proportion to its power |
//! | [`trace::ledger`] | how exits add; the power ledger | R + T + absorbed + imbalance = 1 |
//! | [`trace::planar`] | the tracer's planar cells, loops closed exactly | 1 + g + g² + … = 1/(1 − g) |
//! | [`trace::coherent_mesh`] | waves in polygon cells: fields along ŝ and p̂ of each facet | J_t = J_i cos θ_t/cos θ_i |
//! | [`trace::incoherent_mesh`] | paths in polygon cells: the coherency matrix of their light | ⟨E_s E_p*⟩ |
//! | [`measure::orders`] | diffraction by a periodic cell | F_m = ⟨w J E(x) exp(−i k_m·x)⟩ |
//! | [`measure::bins`], [`trace::sobol`] | where rays leave, where they start | |
//! | [`table`] | BRDF tables, and their form in bytes ([`table::blob`]) | f = ρ(θ) δ(wo − mirror(wi))/cos θ |
//! | [`colour`] | observer, illuminant, RGB | XYZ = Σ wᵢρ(λᵢ) |
//!
//! # Requirements
//!
//! Rust 1.89. There are no features: the crate is `no_std` always. SIMD instructions are those that the compiler is told it may
//! use, with `-C target-cpu`; [`simd::lanes::simd_level`] names them. Where there are none, as on a Cortex-M, lanes are loops.
//! Constructors check what they are given; what they return is infallible where rays are followed and tables looked up.
//!
//! # Example: the spectrum of a soap film
//!
//! ```
//! use goniochrome::simd::complex::ComplexLanes;
//! use goniochrome::optics::interface::{Below, Model};
//! use goniochrome::simd::lanes::{F32, Lanes};
//! use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
//! use goniochrome::optics::medium::{MediaLanes, Medium};
//! use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
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
//! let mut memory = PreparedStackArrays::<F32, 2>::new();
//! let optics = PreparedStack::new(stack, &media, 0.5, Model::Physical, memory.memory());
//!
//! // In closed form, and by tracing rays: the same.
//! let closed = optics.reflectance(optics.reflection());
//! let mut workspace = Workspace::<F32, 2>::new();
//! let traced = trace_planar(&optics, Summation::ClosedLoops, workspace.memory())?;
//! for lane in 0..F32::WIDTH {
//!     assert!((closed.s.lane(lane) - traced.ledger.reflected.s.lane(lane)).abs() < 1e-6);
//! }
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Example: the BRDF of a cell
//!
//! ```
//! use goniochrome::measure::bins::{DirectionBins, ExitRecord, ExitBuffer, Histogram};
//! use goniochrome::geometry::bvh::{Bvh, Node};
//! use goniochrome::geometry::facet::Facet;
//! use goniochrome::geometry::side::Side;
//! use goniochrome::simd::complex::ComplexLanes;
//! use goniochrome::optics::interface::{Below, Interface};
//! use goniochrome::simd::lanes::{F32, Lanes};
//! use goniochrome::optics::medium::{MediaLanes, Medium};
//! use goniochrome::geometry::mesh_cell::MeshCell;
//! use goniochrome::trace::coherent_mesh::{IncidentWave, CoherentMesh, free_slot};
//! use goniochrome::trace::sobol::sobol;
//! use goniochrome::trace::waves::{Limits, trace};
//! use glam::DVec3;
//!
//! // A ridge of glass along y, two slopes to a period of 1000 nm.
//! let vertices = [[0, 0, 0], [500, 0, 300], [1000, 0, 0], [0, 800, 0], [500, 800, 300], [1000, 800, 0]]
//!     .map(|v| DVec3::from_array(v.map(f64::from)));
//! let triangles = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
//! let mut nodes = [Node::EMPTY; Bvh::required_nodes(4)];
//! let (mut order, mut corners) = ([0; 4], [0.0; Bvh::required_corners(4)]);
//! let bvh = Bvh::build(&vertices, &triangles, &mut nodes, &mut order, &mut corners)?;
//! let up = DVec3::new(-0.6, 0.0, 1.0).normalize();
//! let facets = [(up, 0), (DVec3::new(-up.x, 0.0, up.z), 2)]
//!     .map(|(normal, anchor)| Facet { normal, anchor_nm: vertices[anchor], interface: 0 });
//! let interfaces = [Interface { above: 0, below: Below::Medium(1) }];
//! let cell = MeshCell::new(bvh, &[0, 0, 1, 1], &facets, &interfaces, [1000.0, 800.0], 0)?;
//!
//! let media = [Medium::VACUUM, Medium::constant(1.5.into())?];
//! let mut eta = [ComplexLanes::zero(); 2];
//! let media = MediaLanes::<F32>::evaluate(&media, &[550.0], &mut eta).map_err(|(_, error)| error)?;
//!
//! // Power of the first lane in each of 4 × 8 bins.
//! struct Power([f64; 32]);
//! impl Histogram for Power {
//!     fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
//!         if lane == 0 && side == Side::Above {
//!             self.0[bin] += power;
//!         }
//!     }
//! }
//!
//! const RAYS: u32 = 256;
//! let grid = DirectionBins { cos: 4, phi: 8 };
//! let wi = DVec3::new(0.6, 0.0, 0.8);
//! let mut polygons = CoherentMesh::new(cell, media, IncidentWave::new(wi, media.eta()[0]));
//! let (mut slots, mut memory) = ([free_slot::<F32>(); 16], [ExitRecord::<F32>::none(); 32]);
//! let mut exits = ExitBuffer::new(&mut memory, grid, &media);
//! let mut power = Power([0.0; 32]);
//! let limits = Limits { in_flight: 1e-13, generations: 10_000 };
//! for ray in 0..RAYS {
//!     let [u, v] = sobol(ray, 0);
//!     let (state, field) = polygons.start(u, v).expect("the ridge has no holes");
//!     exits.begin(state.point_nm());
//!     trace(&mut polygons, state, field, &mut slots, limits, &mut exits);
//!     exits.flush(&mut power);
//! }
//! let brdf: [f64; 32] =
//!     core::array::from_fn(|bin| power.0[bin] / f64::from(RAYS) / grid.projected_solid_angle(bin));
//! // Glass reflects a few percent, away from the slopes.
//! let reflected: f64 = power.0.iter().sum::<f64>() / f64::from(RAYS);
//! assert!((0.03..0.1).contains(&reflected) && brdf.iter().all(|f| *f >= 0.0));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Example: a table in a shader's loop
//!
//! `examples/material_system.rs` shows the same behind an engine's material trait.
//!
//! ```
//! use goniochrome::measure::bins::DirectionBins;
//! use goniochrome::colour::RgbSpace;
//! use goniochrome::table::blob::{Blob, Contents, Precision};
//! use goniochrome::table::{ScatterLayout, ScatterSampler, ScatterTable};
//! use glam::Vec3;
//!
//! // Elsewhere, once: `goniochrome estimate`, then `goniochrome export --to blob`. Here, a grey Lambert surface.
//! let layout = ScatterLayout::new(4, 1, DirectionBins { cos: 4, phi: 4 })?;
//! let values = [0.5 / core::f32::consts::PI; 4 * 16 * 3];
//! let table = ScatterTable::new(&values, layout, 3)?;
//! let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
//! let sampler = ScatterSampler::new(&table, &mut memory)?;
//! let blob = Blob { space: Some(RgbSpace::Srgb), contents: Contents::Scatter(table, sampler) };
//! let mut bytes = vec![0; blob.required_len(Precision::Half).unwrap()];
//! blob.write(Precision::Half, &mut bytes)?;
//!
//! // At run time: checked once, looked up where it lies.
//! let Contents::Scatter(table, sampler) = Blob::read(&bytes)?.contents else { panic!("a table of directions") };
//! let wi = Vec3::new(0.6, 0.0, 0.8);
//! let mut light = Vec3::ZERO;
//! let samples = 64;
//! for i in 0..samples {
//!     let u = [(i as f32 + 0.5) / samples as f32, (i as f32 * 0.618).fract()];
//!     let (wo, pdf) = sampler.sample(wi, u).expect("wi is above the surface");
//!     let sky = Vec3::ONE; // the radiance from wo
//!     light += Vec3::from(table.rgb(wi, wo)) * sky * (wo.z / pdf);
//! }
//! assert!((light / samples as f32 - Vec3::splat(0.5)).abs().max_element() < 0.01);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]

// Their types are in the interface.
pub use {glam, num_complex};

pub mod simd;
pub mod optics;
pub mod geometry;
pub mod trace;
pub mod measure;
pub mod colour;
pub mod table;
