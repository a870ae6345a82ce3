//! Arguments of `lookup`.

use std::path::PathBuf;

use clap::Args;
use goniochrome::microfacet::Distribution;

use crate::commands::args::shared::Compensating;
use crate::commands::args::values::{DirectionArg, RoughnessArg, distribution, spread};

/// Arguments of `lookup`. Both directions point away from the surface; azimuths count from the tangent +x.
#[derive(Debug, Args)]
pub struct LookupArgs {
    /// A table made by `estimate`, or a scene file or preset, whose table is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// Direction towards the light in degrees
    #[arg(long, value_name = "THETA,PHI", required_unless_present = "pairs", allow_hyphen_values = true)]
    pub wi: Option<DirectionArg>,
    /// Direction towards the viewer in degrees; without it, light that leaves in exact directions is listed
    #[arg(long, value_name = "THETA,PHI", allow_hyphen_values = true)]
    pub wo: Option<DirectionArg>,
    /// Many pairs of directions, in place of --wi and --wo: a CSV file of theta_i,phi_i,theta_o,phi_o in degrees, one
    /// pair in each line, with or without a header
    #[arg(long, value_name = "FILE", conflicts_with_all = ["wi", "wo"])]
    pub pairs: Option<PathBuf>,
    /// Tables over the thickness of a layer, by `estimate --vary`: the thickness in nm
    #[arg(long, value_name = "NM")]
    pub thickness: Option<f64>,
    /// Mirror-like tables: f of facets of this roughness α in (0, 1], along x and y if there are two, as `export` takes
    /// it [default: the table's finish; without one the reflectance and the mirror direction are printed]
    #[arg(long, value_name = "ALPHA[,ALPHA]", allow_hyphen_values = true)]
    pub roughness: Option<RoughnessArg>,
    /// Mirror-like tables: the distribution of the facets' normals, ggx or beckmann [default: the table's, else ggx]
    #[arg(long, value_name = "ggx|beckmann", value_parser = distribution)]
    pub distribution: Option<Distribution>,
    /// Several bounces among facets
    #[command(flatten)]
    pub compensating: Compensating,
    /// Diffraction orders and flat facets: f with a Gaussian lobe of this standard deviation in degrees around each
    /// exact direction, as `export` takes it; without it they are listed
    #[arg(long, value_name = "DEGREES", value_parser = spread, allow_negative_numbers = true)]
    pub spread: Option<f64>,
    /// The CSV file to write instead of a text to read; - is standard output
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}
