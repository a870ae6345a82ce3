//! Arguments of `sampling`.

use std::path::PathBuf;

use clap::Args;
use goniochrome::colour::RgbSpace;

use crate::commands::args::shared::Computing;
use crate::commands::args::values::{IlluminantArg, SpaceArg};
use crate::solve::grid::Angles;

/// The largest number of wavelengths to try: one every 0.1 nm.
const MAX_SAMPLES: i64 = 4000;

/// Arguments of `sampling`.
#[derive(Debug, Args)]
pub struct SamplingArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Numbers of wavelengths to try; they lie at the midpoints of equal parts of 380 to 780 nm
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=MAX_SAMPLES))]
    #[arg(allow_hyphen_values = true, default_value = "4,5,6,8,10,12,16,20,24,28,32,36,40,48,56,64,80,100")]
    pub samples: Vec<u16>,
    /// Angles of incidence in degrees; the error is the largest over all of them
    #[arg(long, allow_hyphen_values = true, default_value = "0:85:5")]
    pub theta: Angles,
    /// The CSV file to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// Also draw the error curve (.png or .svg)
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The spectrum of the light; the paper's is E
    #[arg(long, value_enum, ignore_case = true, default_value_t = IlluminantArg::E)]
    pub illuminant: IlluminantArg,
    /// The colour space in which the error is measured
    #[arg(long, value_enum, default_value_t = SpaceArg(RgbSpace::Srgb))]
    pub space: SpaceArg,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}
