//! Arguments of `orders`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Running;
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
    /// Number of starting rays, spread over the period
    #[arg(long, default_value_t = 65536, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: u32,
    /// Largest |m| and |n| of the orders [default: all orders that propagate]
    #[arg(long, alias = "most-order", value_parser = clap::value_parser!(i32).range(0..))]
    pub max_order: Option<i32>,
    /// Hits after which a ray is dropped [default: 1 for one surface, which is single scattering; 64 for several
    /// interfaces]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub hits: Option<u32>,
    /// Single or double precision
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// Seed of the random sequence of starting rays
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// The CSV file to write; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
