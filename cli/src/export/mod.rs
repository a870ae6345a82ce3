//! Tables in the formats of engines and renderers, one file per format.

mod gaussian;
mod order_lobes;
mod reflection;
mod deltas;
mod texture;
mod shader;
pub mod lut;
pub mod order_lut;
pub mod png;
pub mod blob;
pub mod merl;
pub mod bsdf;
pub mod gltf;

pub use deltas::{Delta, Deltas, RGB};
pub use order_lobes::{LobesAt, OrderLobes};
pub use reflection::{Evaluator, LobeWidth, Reflection, ReflectionKind};
pub use shader::ShaderLanguage;
