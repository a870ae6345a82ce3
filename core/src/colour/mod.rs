//! Spectral reflectance to colour: CIE 1931 2° observer, illuminants E and D65, RGB spaces.
//!
//! XYZ = ∫ ρ x̄ȳz̄ S dλ / ∫ ȳ S dλ = Σ w_i ρ(λ_i). The weights w contain the observer, the illuminant S and the grid of
//! wavelengths, and are scaled so that ρ = 1 has Y = 1. A 3×3 matrix turns XYZ into linear RGB, whose components may be
//! negative: tables keep such values, only pictures clip them.

mod observer;
mod illuminant;
mod space;
mod cubic;
mod weights;

pub use cubic::SpectrumCubic;
pub use illuminant::Illuminant;
pub use space::RgbSpace;
pub use weights::{ColourError, Quadrature, VISIBLE_NM, xyz, xyz_weights};
