//! Materials of glTF 2.0: single films as `KHR_materials_iridescence`.

pub mod iridescence;
