//! The bodies of the fuzz targets: checks that must hold for any input. The normal tests run them on every seed.
#![allow(dead_code, reason = "each fuzz target uses one")]

pub mod environment;
pub mod exr_table;
pub mod grey_map;
#[path = "../../tests/cells/height_field.rs"]
mod height_field;
pub mod nk_yaml;
pub mod obj;
#[path = "../../tests/scalar.rs"]
mod scalar;
pub mod scene_file;
pub mod table_blob;
pub mod trace_cell;
pub mod trace_stack;
