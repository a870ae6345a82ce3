//! Tables in the formats of engines and renderers, one file per format.

pub mod bsdf;
pub mod ggx;
pub mod lut;
pub mod merl;
mod reflection;

pub use reflection::Reflection;
