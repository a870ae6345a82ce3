//! Arguments of `export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// A table made by `estimate` (.exr); for lut and gltf also a scene file or the name of a preset
    pub source: String,
    /// The format
    #[arg(long, value_enum)]
    pub to: ExportKind,
    /// The file to write
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Blob: values in half precision
    #[arg(long)]
    pub half: bool,
    /// No remarks on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

/// What `export` writes.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum ExportKind {
    /// RGB reflectance over cos θ for shaders (.exr or .png)
    Lut,
    /// The format of the MERL BRDF database (.binary)
    Merl,
    /// The RGL tensor file of Mitsuba's `measured` (.bsdf)
    Bsdf,
    /// A material with `KHR_materials_iridescence`, fitted (.gltf)
    Gltf,
    /// The bytes that the library and its C interface load at run time (.gonio)
    Blob,
}
