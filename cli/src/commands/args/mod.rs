//! The command line: commands and their arguments.

mod values;
mod shared;
mod spectrum;
mod colour;
mod estimate;
mod merge;
mod scatter;
mod orders;
mod compare;
mod sampling;
mod lookup;
mod plot;
mod render;
mod view;
mod figures;
mod export;

use std::sync::OnceLock;

use clap::{Parser, Subcommand};
use goniochrome::simd::lanes::simd_level;

pub use colour::ColourArgs;
pub use compare::CompareArgs;
pub use estimate::{CellSampling, EstimateArgs};
pub use export::{ExportArgs, ExportKind, Origin};
pub use figures::FiguresArgs;
pub use lookup::LookupArgs;
pub use merge::MergeArgs;
pub use orders::OrdersArgs;
pub use plot::{OrderArg, PlotArgs, PlotKind};
pub use render::{BackgroundArg, RenderArgs, SizeArg, ViewArgs};
pub use sampling::SamplingArgs;
pub use scatter::ScatterArgs;
pub use shared::{Colouring, Compensating, Computing, Diffracting, Running};
pub use spectrum::SpectrumArgs;
pub use values::{
    Bins, BodyArg, DirectionArg, IlluminantArg, ModelArg, RoughnessArg, SpaceArg, finish_choice, spelled,
};
pub use view::PageArgs;

/// Compute how layered and micro-structured surfaces reflect light: spectra, colours, BRDF tables, pictures.
#[derive(Debug, Parser)]
#[command(name = "goniochrome", version = version(), max_term_width = 100, after_help = PAPER)]
pub struct CommandLine {
    /// The command to run.
    #[command(subcommand)]
    pub command: Command,
}

/// The paper that help texts refer to.
const PAPER: &str = "The paper: Shimada & Kawaguchi, \"BRDF Estimation System for Structural Colors\".";

/// The version, and the instruction set that was compiled in.
fn version() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| format!("{} ({})", env!("CARGO_PKG_VERSION"), simd_level()))
}

/// The commands. SCENE is a scene file or the name of a preset.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the built-in scenes, or print one as TOML
    Presets {
        /// The scene to print
        name: Option<String>,
        /// List the built-in materials instead, with the wavelengths for which they have data and their sources
        #[arg(long, conflicts_with = "name")]
        materials: bool,
    },
    /// Compute reflectance and transmittance at angles and wavelengths, as CSV
    Spectrum(SpectrumArgs),
    /// Compute the colour at angles of incidence
    #[command(visible_alias = "color")]
    Colour(ColourArgs),
    /// Compute the BRDF table of a scene, spectral and RGB, as multi-channel EXR
    Estimate(EstimateArgs),
    /// Join the parts of a table that `estimate --part` wrote
    Merge(MergeArgs),
    /// Compute where a cell of polygons scatters light from one direction, as JSON
    Scatter(ScatterArgs),
    /// Compute diffraction orders of a cell of polygons, by waves or by rays, as CSV
    Orders(OrdersArgs),
    /// Compare ray tracing with the closed form (the paper's figure 7)
    Compare(CompareArgs),
    /// Compute the colour error against the number of wavelengths (the paper's figure 6)
    Sampling(SamplingArgs),
    /// Look up what a table says of one pair of directions: f in 1/sr, or light in exact directions
    Lookup(LookupArgs),
    /// Draw a table: BRDF disc, lobes, spectra, map, path of the colour
    Plot(PlotArgs),
    /// Render a lit body with a table as its surface: teapot, sphere, plane or any OBJ
    Render(Box<RenderArgs>),
    /// Write a web page that shows a lit body to turn by hand, with spectra under the pointer
    View(PageArgs),
    /// Draw every figure of the paper, with a page that explains them
    Figures(FiguresArgs),
    /// Write a table or scene in the format of an engine or a renderer
    Export(ExportArgs),
}

impl Command {
    /// Whether the command has the option `--wavelengths`, with which the user can avoid those without data.
    #[must_use]
    pub fn asks_wavelengths(&self) -> bool {
        match self {
            Self::Spectrum(_)
            | Self::Colour(_)
            | Self::Estimate(_)
            | Self::Scatter(_)
            | Self::Orders(_)
            | Self::Compare(_) => true,
            Self::Presets { .. }
            | Self::Sampling(_)
            | Self::Merge(_)
            | Self::Lookup(_)
            | Self::Plot(_)
            | Self::Render(_)
            | Self::View(_)
            | Self::Figures(_)
            | Self::Export(_) => false,
        }
    }
}

#[cfg(test)]
mod tests;
