//! BRDF tables over borrowed memory: layout, checks, look-up, importance sampling.
//!
//! - [`MirrorTable`]: BRDF of a mirror-like surface, which reflects into one direction only: f(wi, wo) = ρ(θ) δ(wo −
//!   mirror(wi)) / cos θ. The table holds ρ(θ) for each channel. The paper calls it "2D", angle × wavelength (section
//!   3.1).
//! - [`ScatterTable`]: BRDF f(wi, wo) of a surface of tilted facets, which reflects into every direction, on a grid of
//!   directions ([`ScatterLayout`]). [`ScatterSampler`] draws wo.
//! - [`blob`]: both kinds as bytes, to load without copying.

mod error;
mod values;
mod layout;
mod mirror;
mod scatter;
mod sampler;
pub mod blob;

pub use error::{MAX_MAGNITUDE, TableError};
pub use layout::{GridNode, ScatterLayout};
pub use mirror::MirrorTable;
pub use sampler::ScatterSampler;
pub use scatter::ScatterTable;
