//! BRDF tables over borrowed memory: layout, checks, look-up, importance sampling.
//!
//! - [`MirrorTable`]: BRDF of a mirror-like surface, which reflects into one direction only: f(wi, wo) = ρ(θ) δ(wo −
//!   mirror(wi)) / cos θ. The table holds ρ(θ) for each channel. The paper calls it "2D", angle × wavelength (section
//!   3.1).
//! - [`FilmTable`]: the same with what such a table may hold besides: transmittance, the thickness of a layer as a
//!   further axis, and a [`Finish`](crate::microfacet::Finish), by which it reflects into every direction.
//! - [`ScatterTable`]: BRDF f(wi, wo) of a surface of tilted facets, which reflects into every direction, on a grid of
//!   incident directions and half vectors ([`ScatterLayout`], [`HalfVectorWarp`]), with exact lobes of flat facets
//!   ([`FacetLobe`]). [`ScatterSampler`] draws wo.
//! - [`OrderTable`]: reflection of a periodic surface into diffraction orders, whose directions are exact, on a grid of
//!   directions of its own ([`OrderLayout`]).
//! - [`blob`]: all kinds as bytes, to load without copying.

mod error;
mod angles;
mod layout;
mod angle_axis;
mod mirror;
mod film;
mod warp;
mod lobe;
mod tents;
mod scatter;
mod half_vector_grid;
mod sampler;
mod order_layout;
mod orders;
mod blob_error;
mod blob_finish;
pub mod blob;

pub use angles::MIN_COS;
pub use error::{MAX_MAGNITUDE, TableError};
pub use film::{FilmArrays, FilmSample, FilmTable};
pub use half_vector_grid::{HalfVectorGrid, LobeDirection};
pub use layout::{GridNode, ScatterLayout};
pub use lobe::FacetLobe;
pub use mirror::MirrorTable;
pub use order_layout::{OrderLayout, Periodicity};
pub use orders::{DiffractedLight, OrderArrays, OrderSample, OrderTable, OrderView, match_factor};
pub use sampler::ScatterSampler;
pub use scatter::ScatterTable;
pub use tents::tent_solid_angles;
pub use warp::{HalfVectorWarp, Warped};
