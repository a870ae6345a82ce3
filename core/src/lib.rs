//! Spectral reflection of layered and micro-structured surfaces: ray splitting, interference, and BRDF tables.
//!
//! The method is that of Shimada & Kawaguchi, "BRDF Estimation System for Structural Colors". Rays split at every
//! interface by Fresnel's formulas, carry a phase for each wavelength, and interfere where they leave in one direction.
//! This crate is the part that computes: no `std`, no allocation, no `unsafe`; the caller owns all memory.
//!
//! # Conventions
//!
//! - Fields vary as exp(−iωt). A medium has the complex index η = n + ik; k ≥ 0 absorbs, k < 0 (gain) is refused.
//! - Lengths and vacuum wavelengths are in nanometres, angles in radians.
//! - The surface frame has z along the macroscopic normal (the paper's **n**), x along the tangent **t**, and y along
//!   the binormal **b**. `wi` points towards the light, `wo` towards the viewer; both leave the surface.
//! - k₀ = 2π/λ. A plane wave has the wavevector q in units of k₀, q·q = η², and the phase factor exp(i k₀ q·x). q may
//!   be complex, in absorbing media and beyond total reflection.
//! - s light has its electric field perpendicular to the plane of incidence. p light is followed by its magnetic field,
//!   so that both obey one formula ([`optics::interface`]); powers do not depend on that choice.
//!
//! # Where to find what
//!
//! Modules are listed in the order of use: each uses only those above it.
//!
//! | module | submodule | content | equation |
//! |---|---|---|---|
//! | [`simd`] | [`lanes`](simd::lanes) | one number per wavelength of a group | |
//! | | [`double_double`](simd::double_double) | lanes of twice the digits of double precision | a + b = s + e, exactly |
//! | | [`complex`](simd::complex), [`vector`](simd::vector) | complex numbers and vectors of lanes | |
//! | | [`phase`](simd::phase) | phase factors of long paths | exp(2πi q·L/λ), path reduced to ±½ in double precision |
//! | [`optics`] | [`medium`](optics::medium) | n + ik at a wavelength | dispersion formulas 1 to 9, tables |
//! | | [`incidence`](optics::incidence) | the angle of incidence, to all its digits | q_n² = η² − q_t² |
//! | | [`interface`](optics::interface) | reflection by one plane | r = (κ₁ − κ₂)/(κ₁ + κ₂), κ_s = q_n, κ_p = q_n/η² |
//! | | [`stack`](optics::stack) | planar multilayer in closed form | ρ_j = (r_j + ρ_{j+1}e²)/(1 + r_jρ_{j+1}e²) |
//! | | [`rounding`](optics::rounding) | rounding error of R and T | δρ₀ = Σ (wave that meets plane j)² δρ_j |
//! | | [`coating`](optics::coating) | films on a facet | the recursion of `stack` |
//! | [`geometry`] | [`side`](geometry::side) | the two sides of the surface | |
//! | | [`bvh`](geometry::bvh) | nearest triangle on a ray | u, v, w of one sign |
//! | | [`facet`](geometry::facet) | plane pieces of a micro-surface | |
//! | | [`planar_cell`](geometry::planar_cell), [`mesh_cell`](geometry::mesh_cell) | checked cells of facets | |
//! | [`trace`] | [`sobol`](trace::sobol), [`random`](trace::random) | where rays start, and random choices | |
//! | | [`waves`](trace::waves) | ray splitting, merging of equal states | a(state) = Σ a(rays in that state) |
//! | | [`paths`](trace::paths) | rays without interference | a branch is drawn in proportion to its power |
//! | | [`ledger`](trace::ledger) | how exits add; the power ledger | R + T + absorbed + imbalance = 1 |
//! | | [`planar`](trace::planar) | tracing of planar cells, loops summed exactly | 1 + g + g² + … = 1/(1 − g) |
//! | | [`coherent_mesh`](trace::coherent_mesh) | waves in mesh cells: fields along ŝ and p̂ | J_t = J_i cos θ_t/cos θ_i |
//! | | [`incoherent_mesh`](trace::incoherent_mesh) | paths in mesh cells: the coherency matrix | ⟨E_s E_p*⟩ |
//! | [`measure`] | [`bins`](measure::bins) | directions in which rays leave | |
//! | | [`orders`](measure::orders) | diffraction by a periodic cell, by rays | F_m = ⟨w J E(x) exp(−i k_m·x)⟩ |
//! | [`colour`] | | observer, illuminant, RGB | XYZ = Σ wᵢρ(λᵢ) |
//! | [`microfacet`] | | finishes: rough mirror-like surfaces, energy compensation | f = ρ(θ_d) D G₂/(4 cos θ_i cos θ_o) |
//! | [`table`] | | BRDF tables, tables of diffraction orders | f = ρ(θ) δ(wo − mirror(wi))/cos θ, L = Σ e L(wi) |
//! | | [`blob`](table::blob) | tables in bytes | |
//!
//! # Requirements
//!
//! Rust 1.89. There are no features: the crate is always `no_std`. The compiler uses the SIMD instructions that
//! `-C target-cpu` allows; [`simd::lanes::simd_level`] names them. Where there are none, as on a Cortex-M, lanes are
//! loops. Constructors check what they are given; what they return needs no further checks while rays are traced and
//! tables looked up.
//!
//! # Example: the spectrum of a soap film
//!
//! ```
//! use goniochrome::optics::interface::{Below, Model};
//! use goniochrome::optics::medium::{MediaLanes, Medium};
//! use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
//! use goniochrome::simd::complex::ComplexLanes;
//! use goniochrome::simd::lanes::{F32, Lanes};
//! use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
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
//! let prepared = PreparedStack::new(stack, &media, 0.5, Model::Physical, memory.memory());
//!
//! // The closed form and the traced rays agree.
//! let closed = prepared.reflectance(prepared.reflection());
//! let mut workspace = Workspace::<F32, 2>::new();
//! let traced = trace_planar(&prepared, Summation::ClosedLoops, workspace.memory())?;
//! for lane in 0..F32::WIDTH {
//!     assert!((closed.s.lane(lane) - traced.ledger.reflected.s.lane(lane)).abs() < 1e-6);
//! }
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Example: the BRDF of a cell
//!
//! ```
//! use glam::DVec3;
//! use goniochrome::geometry::bvh::{Bvh, Node};
//! use goniochrome::geometry::facet::Facet;
//! use goniochrome::geometry::mesh_cell::MeshCell;
//! use goniochrome::geometry::side::Side;
//! use goniochrome::measure::bins::{DirectionBins, ExitBuffer, ExitRecord, Histogram};
//! use goniochrome::optics::interface::{Below, Interface};
//! use goniochrome::optics::medium::{MediaLanes, Medium};
//! use goniochrome::simd::complex::ComplexLanes;
//! use goniochrome::simd::lanes::{F32, Lanes};
//! use goniochrome::trace::coherent_mesh::{CoherentMesh, IncidentWave, free_slot};
//! use goniochrome::trace::sobol::sobol;
//! use goniochrome::trace::waves::{Limits, trace};
//!
//! // A ridge of glass along y, with two slopes in a period of 1000 nm.
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
//! // The power of the first lane in each of 4 × 8 bins.
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
//! let mut mesh = CoherentMesh::new(cell, media, IncidentWave::new(wi, media.eta()[0]));
//! let (mut slots, mut memory) = ([free_slot::<F32>(); 16], [ExitRecord::<F32>::none(); 32]);
//! let mut exits = ExitBuffer::new(&mut memory, grid, &media);
//! let mut power = Power([0.0; 32]);
//! let limits = Limits { in_flight: 1e-13, generations: 10_000 };
//! for ray in 0..RAYS {
//!     let [u, v] = sobol(ray, 0);
//!     let (state, field) = mesh.start(u, v).expect("the ridge has no holes");
//!     exits.begin();
//!     trace(&mut mesh, state, field, &mut slots, limits, &mut exits);
//!     exits.flush(&mut power);
//! }
//! let brdf: [f64; 32] =
//!     core::array::from_fn(|bin| power.0[bin] / f64::from(RAYS) / grid.projected_solid_angle(bin));
//! // Glass reflects a few percent of the light.
//! let reflected: f64 = power.0.iter().sum::<f64>() / f64::from(RAYS);
//! assert!((0.03..0.1).contains(&reflected) && brdf.iter().all(|f| *f >= 0.0));
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
//!
//! # Example: a table in a shader's loop
//!
//! `examples/material_system.rs` shows such a table behind the material trait of an engine.
//!
//! ```
//! use glam::Vec3;
//! use goniochrome::colour::RgbSpace;
//! use goniochrome::table::blob::{Blob, Contents, Precision};
//! use goniochrome::table::{HalfVectorWarp, ScatterLayout, ScatterSampler, ScatterTable};
//!
//! // A blob is usually made once, by `goniochrome estimate` and `goniochrome export --to blob`. This one is grey, of
//! // facets whose normals lie around the surface's: s = f cos θ_i cos θ_o depends on the half vector alone.
//! let layout = ScatterLayout::new([4, 1], [8, 8], 0)?;
//! let mut memory = [0.0; HalfVectorWarp::required_len([2, 2])];
//! let warp = HalfVectorWarp::new([&[1.0; 2], &[1.0; 2]], &mut memory)?;
//! let s = |node: usize| 0.2 * warp.half_vector(layout.node(node).map(|x| x as f32), 0.0).0.z.powi(8);
//! let values: Vec<f32> =
//!     (0..layout.count()).flat_map(|value| [s(value % layout.node_count()); 3]).collect();
//! let table = ScatterTable::new(&values, layout, warp, &[], 3)?;
//! let mut memory = vec![0.0; ScatterSampler::required_len(&layout)];
//! let sampler = ScatterSampler::new(&table, &mut memory)?;
//! let blob = Blob { space: Some(RgbSpace::Srgb), contents: Contents::Scatter(table, sampler) };
//! let mut bytes = vec![0; blob.required_len(Precision::Half).unwrap()];
//! blob.write(Precision::Half, &mut bytes)?;
//!
//! // At run time the bytes are checked once, and looked up in place.
//! let Contents::Scatter(table, sampler) = Blob::read(&bytes)?.contents else { panic!("a table of directions") };
//! let wi = Vec3::new(0.6, 0.0, 0.8);
//! let mut light = Vec3::ZERO;
//! let samples = 64;
//! for i in 0..samples {
//!     let u = [(i as f32 + 0.5) / samples as f32, (i as f32 * 0.618).fract()];
//!     // Half vectors that reflect below the surface are samples without light.
//!     let Some((wo, pdf)) = sampler.sample(wi, u) else { continue };
//!     let sky = Vec3::ONE; // the radiance from wo
//!     light += Vec3::from(table.rgb(wi, wo)) * sky * (wo.z / pdf);
//! }
//! let mut albedo = [0.0; 3];
//! table.albedo(wi, &mut albedo);
//! assert!((light / samples as f32 - Vec3::from(albedo)).abs().max_element() < 0.05 * albedo[0]);
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```
#![no_std]

// Crates whose types are part of the interface.
pub use {glam, num_complex};

pub mod simd;
pub mod optics;
pub mod geometry;
pub mod trace;
pub mod measure;
pub mod colour;
mod values;
pub mod microfacet;
pub mod table;

/// The examples of README.md, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
