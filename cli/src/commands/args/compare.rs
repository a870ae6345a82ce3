//! Arguments of `compare`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Computing;
use crate::solve::grid::{Angles, Wavelengths};

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: a list 0,30,60 or a range 0:85:5 (start:end:step)
    #[arg(long, allow_hyphen_values = true, default_value = "0:89:1")]
    pub theta: Angles,
    /// Wavelengths in nm: a list 450,550, a range 380:780:5 (start:end:step), or auto: as many as the colours need
    #[arg(long, allow_hyphen_values = true, default_value = "436,546,700")]
    pub wavelengths: Wavelengths,
    /// The CSV file to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// Also draw both and their difference (.png or .svg)
    #[arg(long, short, visible_alias = "plot", value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// How to compute; the method is that of the ray tracer
    #[command(flatten)]
    pub computing: Computing,
}
