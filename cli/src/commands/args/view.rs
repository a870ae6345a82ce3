//! Arguments of `view`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `view`.
#[derive(Debug, Args)]
pub struct PageArgs {
    /// A table made by `estimate`, or a scene file or preset, whose table is made in memory
    #[arg(value_name = "TABLE|SCENE")]
    pub table: PathBuf,
    /// The page (.html): one file that needs no network
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Tables over the thickness of a layer, by `estimate --vary`: the thickness in nm
    #[arg(long, value_name = "NM")]
    pub thickness: Option<f64>,
    /// Diffraction orders: the standard deviation of their width, in degrees; 0 is sharp
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0)]
    pub spread: f64,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}
