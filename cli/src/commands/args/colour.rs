//! Arguments of `colour`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::{Colouring, Computing};
use crate::solve::grid::{Angles, Wavelengths};

/// Arguments of `colour`.
#[derive(Debug, Args)]
pub struct ColourArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: a list 0,30,60 or a range 0:85:5 (start:end:step)
    #[arg(long, allow_hyphen_values = true, default_value = "0,15,30,45,60,75")]
    pub theta: Angles,
    /// Wavelengths in nm: a list 450,550, a range 380:780:5 (start:end:step), or auto: as many as the colours need
    #[arg(long, allow_hyphen_values = true, default_value = "auto")]
    pub wavelengths: Wavelengths,
    /// The CSV file to write; - is standard output [default: a table with swatches on the terminal]
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// From spectrum to colour
    #[command(flatten)]
    pub colouring: Colouring,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}
