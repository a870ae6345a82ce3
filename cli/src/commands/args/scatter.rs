//! Arguments of `scatter`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Running;
use crate::commands::args::values::{Bins, positive};
use crate::solve::grid::Wavelengths;
use crate::solve::precision::Precision;
use crate::solve::scatter::Coherence;

/// Arguments of `scatter`.
#[derive(Debug, Args)]
pub struct ScatterArgs {
    /// A scene file or preset with a cell of polygons
    pub scene: String,
    /// Angle of incidence in degrees, in [0, 90)
    #[arg(long, default_value_t = 0.0)]
    pub theta: f64,
    /// Azimuth of the direction towards the light in degrees, from the tangent +x
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Wavelengths in nm: a list 450,550 or a range 380:780:5 (start:end:step)
    #[arg(long, alias = "wavelength", allow_hyphen_values = true, default_value = "550")]
    pub wavelengths: Wavelengths,
    /// Number of starting rays, spread over the period
    #[arg(long, default_value_t = 65536, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: u32,
    /// Double the rays until every standard error is at most this
    #[arg(long, value_parser = positive)]
    pub target_error: Option<f64>,
    /// Number of bins of outgoing directions, cos θ × φ, uniform in both
    #[arg(long, default_value = "8x16")]
    pub bins: Bins,
    /// Which light interferes where it leaves
    #[arg(long, value_enum, default_value_t = Coherence::Ray)]
    pub coherence: Coherence,
    /// Single or double precision
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// Seed of the random sequence of starting rays
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// The JSON file to write: an object, or a list of objects for several wavelengths; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub json: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
