//! Arguments of `view`.

use std::path::PathBuf;

use clap::Args;
use goniochrome::microfacet::Distribution;

use crate::commands::args::shared::Compensating;
use crate::commands::args::values::{BodyArg, RoughnessArg, distribution, roughness_or_mirror};

/// Arguments of `view`.
#[derive(Debug, Args)]
pub struct PageArgs {
    /// A table made by `estimate`, or a scene file or preset, whose table is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// The page (.html): one file that needs no network
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Mirror-like tables: whether light goes through [default: sheet for films in one clear medium]
    #[arg(long, value_enum)]
    pub body: Option<BodyArg>,
    /// Tables over the thickness of a layer, by `estimate --vary`: where the film is how thick, as in `render`
    /// [default: one thickness, by a slider]
    #[arg(long, value_name = "NM|drain|noise|FILE")]
    pub thickness: Option<String>,
    /// Diffraction orders: the standard deviation of their width, in degrees; 0 is sharp
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub spread: f64,
    /// Mirror-like tables: the roughness α with which the page opens, in (0, 1], or two numbers along the tangent and
    /// the binormal; 0 is a mirror [default: the table's finish]
    #[arg(long, value_name = "ALPHA[,ALPHA]", value_parser = roughness_or_mirror, allow_hyphen_values = true)]
    pub roughness: Option<RoughnessArg>,
    /// Mirror-like tables: the distribution of the facets' normals, ggx or beckmann [default: the table's, else ggx]
    #[arg(long, value_name = "ggx|beckmann", value_parser = distribution)]
    pub distribution: Option<Distribution>,
    /// Several bounces among facets
    #[command(flatten)]
    pub compensating: Compensating,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}
