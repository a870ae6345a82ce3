//! Arguments of `export`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use goniochrome::microfacet::Distribution;

use crate::commands::args::shared::Compensating;
use crate::commands::args::values::{RoughnessArg, distribution, roughness_or_mirror, spread};
use crate::export::bsdf::Gamut;
use crate::scene::vary::Vary;

/// Arguments of `export`.
#[derive(Debug, Args)]
pub struct ExportArgs {
    /// A table made by `estimate` (.exr); for lut and gltf also a scene file or the name of a preset
    pub source: String,
    /// The format to write
    #[arg(long, value_enum)]
    pub to: ExportKind,
    /// The file to write
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// blob: values in half precision
    #[arg(long)]
    pub half: bool,
    /// merl, bsdf and gltf of tables over the thickness of a layer, by `estimate --vary`: the thickness in nm
    #[arg(long, value_name = "NM")]
    pub thickness: Option<f64>,
    /// Mirror-like tables and scenes of planes: the roughness α of the facets, in (0, 1], along the tangent and the
    /// binormal; 0 is a mirror, which merl and bsdf cannot hold [default: that of the table's finish]
    #[arg(long, value_name = "ALPHA[,ALPHA]", allow_hyphen_values = true, value_parser = roughness_or_mirror)]
    pub roughness: Option<RoughnessArg>,
    /// Mirror-like tables: the distribution of the facets' normals, ggx or beckmann [default: the table's, else ggx]
    #[arg(long, value_name = "ggx|beckmann", value_parser = distribution)]
    pub distribution: Option<Distribution>,
    /// Several bounces among facets
    #[command(flatten)]
    pub compensating: Compensating,
    /// bsdf of diffraction orders, bsdf and merl of tables with exact lobes of flat facets: the width of each, the
    /// standard deviation of a Gaussian lobe in degrees
    #[arg(long, value_name = "DEGREES", value_parser = spread, allow_negative_numbers = true)]
    pub spread: Option<f64>,
    /// bsdf: the table's linear RGB instead of its spectra, for RGB variants of Mitsuba
    #[arg(long)]
    pub rgb: bool,
    /// bsdf with --rgb: what becomes of negative components, of colours out of gamut [default: clip]
    #[arg(long, value_enum)]
    pub gamut: Option<Gamut>,
    /// lut: texels over cos θ [default: 256]
    #[arg(long, value_parser = clap::value_parser!(u16).range(2..=4096))]
    pub width: Option<u16>,
    /// lut of a scene: vary the thickness of a layer in nm over y; 1=100:800:64 varies the top layer in 64 rows
    #[arg(long, value_name = "LAYER=FROM:TO:STEPS")]
    pub vary: Option<Vary>,
    /// lut with --vary: the side of the picture at which the range starts [default: top]
    #[arg(long, value_enum)]
    pub origin: Option<Origin>,
    /// order-lut: number of wavelengths, a multiple of 4 up to 64 [default: 16]
    #[arg(long, value_name = "N", value_parser = bands)]
    pub bands: Option<u16>,
    /// lut and order-lut: also write the shader function that samples it (.glsl, .hlsl or .wgsl)
    #[arg(long, value_name = "FILE")]
    pub shader: Option<PathBuf>,
    /// lut of a finish of tabulated facets: also write their texture, for the functions of --shader (.exr)
    #[arg(long, value_name = "FILE")]
    pub facets: Option<PathBuf>,
    /// lut of a finish with energy compensation: also write its texture, for the functions of --shader (.exr)
    #[arg(long, value_name = "FILE")]
    pub compensation: Option<PathBuf>,
    /// Print no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

/// The formats that `export` writes.
#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
pub enum ExportKind {
    /// RGB reflectance over cos θ for shaders (.exr, half floats, or .png, 16 bits)
    Lut,
    /// Strengths of diffraction orders for shaders, over the direction of the viewer (.exr, half floats)
    OrderLut,
    /// The format of the MERL BRDF database (.binary)
    Merl,
    /// The RGL tensor file of Mitsuba's `measured` (.bsdf)
    Bsdf,
    /// A glTF 2.0 material: the best fit of `KHR_materials_iridescence` to a single film, and how far off it is (.gltf)
    Gltf,
    /// The bytes that the library and its C interface load at run time (.gonio)
    Blob,
}

/// The side of a picture at which the rows of a varied thickness start.
#[derive(Debug, Clone, Copy, Default, ValueEnum, PartialEq, Eq)]
pub enum Origin {
    /// The first row of the file: for programs that upload rows in the file's order
    #[default]
    Top,
    /// The last row of the file: for programs in which v = 0 is the bottom of a picture, such as Blender and three.js
    Bottom,
}

/// Parses `--bands`.
fn bands(text: &str) -> Result<u16, String> {
    let count = text.parse::<u16>().map_err(|error| error.to_string())?;
    let good = (4..=64).contains(&count) && count.is_multiple_of(4);
    if good { Ok(count) } else { Err("must be a multiple of 4, from 4 to 64".into()) }
}
