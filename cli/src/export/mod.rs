//! Tables in the formats of engines and renderers, one file per format.

pub mod blob;
pub mod bsdf;
pub mod ggx;
pub mod gltf;
pub mod lut;
pub mod merl;
pub mod png;
mod reflection;

pub use reflection::Reflection;
