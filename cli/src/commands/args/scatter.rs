//! Arguments of `scatter`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::{Diffracting, Running};
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
    /// Number of starting rays, spread over the period [default: 65536]
    #[arg(long, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: Option<u32>,
    /// Coherence cell: waves or rays
    #[command(flatten)]
    pub diffracting: Diffracting,
    /// Double the rays until every standard error is at most this; waves: take more orders along until the error bar of
    /// every efficiency is at most this
    #[arg(long, value_parser = positive)]
    pub target_error: Option<f64>,
    /// Number of bins of outgoing directions, cos θ × φ, uniform in both
    #[arg(long, default_value = "8x16")]
    pub bins: Bins,
    /// Which light interferes where it leaves
    #[arg(long, value_enum, default_value_t = Coherence::Ray)]
    pub coherence: Coherence,
    /// Rays: single or double precision [default: f32]
    #[arg(long, value_enum)]
    pub precision: Option<Precision>,
    /// Rays: seed of the random sequence of starting rays [default: 0]
    #[arg(long)]
    pub seed: Option<u32>,
    /// The JSON file to write: an object, or a list of objects for several wavelengths; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub json: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
