//! Arguments of `spectrum`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Computing;
use crate::solve::grid::{Angles, Wavelengths};

/// Arguments of `spectrum`.
#[derive(Debug, Args)]
pub struct SpectrumArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: a list 0,30,60 or a range 0:85:5 (start:end:step)
    #[arg(long, allow_hyphen_values = true, default_value = "0")]
    pub theta: Angles,
    /// Wavelengths in nm: a list 450,550, a range 380:780:5 (start:end:step), or auto: as many as the colours need
    #[arg(long, allow_hyphen_values = true, default_value = "380:780:5")]
    pub wavelengths: Wavelengths,
    /// The CSV file to write; - is standard output. Its last column, truncated, bounds the error of the other four
    /// against sums with closed loops; it is 0 except with --method hits
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}
