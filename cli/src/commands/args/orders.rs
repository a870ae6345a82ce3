//! Arguments of `orders`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::{Diffracting, Running};
use crate::commands::args::values::positive;
use crate::solve::grid::Wavelengths;
use crate::solve::precision::Precision;

/// Arguments of `orders`.
#[derive(Debug, Args)]
pub struct OrdersArgs {
    /// A scene file or preset with a cell of polygons
    pub scene: String,
    /// Angle of incidence in degrees, in [0, 90)
    #[arg(long, default_value_t = 0.0)]
    pub theta: f64,
    /// Azimuth of the direction towards the light in degrees, from the tangent +x; 180 for a wave that travels towards
    /// +x
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Wavelengths in nm: a list 450,550 or a range 380:780:5 (start:end:step)
    #[arg(long, allow_hyphen_values = true, default_value = "550")]
    pub wavelengths: Wavelengths,
    /// Waves or rays
    #[command(flatten)]
    pub diffracting: Diffracting,
    /// Waves: take more orders along until the error bar of every efficiency is at most this [default: 0.001]
    #[arg(long, value_name = "ERROR", value_parser = positive)]
    pub target_error: Option<f64>,
    /// Rays: number of starting rays, spread over the period [default: 65536]
    #[arg(long, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: Option<u32>,
    /// Largest |m| and |n| of the orders [default: all orders that propagate]
    #[arg(long, alias = "most-order", value_parser = clap::value_parser!(i32).range(0..))]
    pub max_order: Option<i32>,
    /// Rays: hits after which a ray is dropped [default: 1 for one surface, which is single scattering; 64 for several
    /// interfaces]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub hits: Option<u32>,
    /// Rays: single or double precision [default: f32]
    #[arg(long, value_enum)]
    pub precision: Option<Precision>,
    /// Rays: seed of the random sequence of starting rays [default: 0]
    #[arg(long)]
    pub seed: Option<u32>,
    /// The CSV file to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
