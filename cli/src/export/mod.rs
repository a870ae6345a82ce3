//! Tables in the formats of engines and renderers, one file per format.

pub mod ggx;
mod reflection;
pub mod lut;
pub mod png;
pub mod blob;
pub mod merl;
pub mod bsdf;
pub mod gltf;

pub use reflection::{Evaluator, Reflection, ReflectionKind};
