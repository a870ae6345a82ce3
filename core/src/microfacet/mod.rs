//! Finishes: mirror-like surfaces that are rough at a scale far above the wavelength, as microfacets.
//!
//! A finished surface consists of facets, each of which reflects ρ(θ_d) as the plane surface does, with θ_d the angle
//! between the light and the facet's normal m, the half vector:
//!
//! f(wi, wo) = ρ(θ_d) D(m) G₂(wi, wo)/(4 cos θ_i cos θ_o)
//!
//! (Cook & Torrance 1982; Ashikhmin, Premoze & Shirley 2000). D is the density of normals, ∫ D cos θ_m dω_m = 1, and G₂
//! the part of them that both directions see, by Smith's model (Heitz, "Understanding the masking-shadowing function in
//! microfacet-based BRDFs", JCGT 2014). Light that meets a second facet is left out, or returned by a [`Compensation`].
//!
//! Directions are unit vectors in the surface's frame. All functions are in single precision; the caller owns no
//! memory.

mod exponential;
mod limits;
mod error;
mod roughness;
mod beckmann;
mod facet_layout;
mod visible;
mod table;
mod compensation;
mod finish;
mod losses;

pub use compensation::{Compensation, mean_reflectance};
pub use error::FinishError;
pub use finish::{Distribution, Finish, Lobe, Masking};
pub use limits::{MAX_RINGS, MAX_SECTORS, MIN_ROUGHNESS};
pub use table::FacetTable;
