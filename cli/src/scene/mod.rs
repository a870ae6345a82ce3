//! Scenes as plain data, read from scene files, OBJ meshes and refractive index files.

mod diagnostics;
mod toml_value;
mod yaml;
mod dispersion;
mod column;
mod medium;
mod refractive_index_info;
mod delimited;
mod parts;
mod builtin;
mod media;
mod mesh_frame;
mod mesh;
mod placement;
mod surface;
mod watertight;
mod planes;
mod finish;
mod model;
mod file;
pub mod vary;
pub mod presets;
mod load;

pub use builtin::{list as list_materials, names as material_names};
pub use dispersion::OwnedDispersion;
pub use finish::{DISTRIBUTIONS, FinishFacets, LEAST_ROUGHNESS, MASKINGS, OwnedFacets, OwnedFinish, named};
pub use load::{load, parse, parse_columns, parse_mesh, parse_nk, parse_without_finish};
pub use medium::OwnedMedium;
pub use mesh::{Mesh, Triangle};
pub use model::{Periods, Scene, Shape};
pub use parts::{Layer, NamedInterface, NamedMedium, ThicknessSpread};
pub use planes::{FlatCell, Plane};
pub use watertight::ClosedCell;
