//! The command line.

pub mod export;
mod plot;
mod render;
mod values;
mod view;

use std::path::PathBuf;
use std::str::FromStr;
use std::sync::OnceLock;

use clap::{Args, FromArgMatches as _, Parser, Subcommand};
use goniochrome::colour::RgbSpace;
use goniochrome::simd::lanes::simd_level;

use crate::solve::grid::{Angles, Wavelengths};
use crate::solve::precision::Precision;
use crate::solve::scatter::Coherence;
use crate::solve::spectra::{Method, SpectraRequest};
use crate::support::parallel;

pub use plot::{PlotArgs, PlotKind};
pub use render::{BackgroundArg, RenderArgs, SizeArg, ViewArgs};
pub use values::{IlluminantArg, ModelArg, SpaceArg, spelled};
pub use view::PageArgs;

/// How layered and micro-structured surfaces reflect light: spectra, colours, BRDF tables, pictures.
#[derive(Debug, Parser)]
#[command(name = "goniochrome", version = version(), max_term_width = 100)]
pub struct CommandLine {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Version and the instruction set that was compiled in.
fn version() -> &'static str {
    static VERSION: OnceLock<String> = OnceLock::new();
    VERSION.get_or_init(|| format!("{} ({})", env!("CARGO_PKG_VERSION"), simd_level()))
}

/// The commands; SCENE is a scene file or the name of a preset.
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
    /// Reflectance and transmittance at angles and wavelengths
    Spectrum(SpectrumArgs),
    /// Colour at angles
    #[command(visible_alias = "color")]
    Colour(ColourArgs),
    /// The BRDF table: spectral and RGB, as multi-channel EXR
    Estimate(EstimateArgs),
    /// Where a polygon cell sends the light of one direction
    Scatter(ScatterArgs),
    /// Diffraction orders of a polygon cell by physical optics; says how far efficiencies may be off
    Orders(OrdersArgs),
    /// Ray tracing against the closed form (the paper's figure 7)
    Compare(CompareArgs),
    /// Colour error against the number of wavelengths (the paper's figure 6)
    Sampling(SamplingArgs),
    /// A picture of a table: BRDF disc, lobes, spectra, map, path of the colour
    Plot(PlotArgs),
    /// A lit body with the table as its surface: teapot, sphere, plane or any OBJ
    Render(Box<RenderArgs>),
    /// A page that turns a surface in light: teapot, sphere or plane, with spectra under the pointer
    View(PageArgs),
    /// Every figure of the paper, with a page that explains them
    Figures(FiguresArgs),
    /// A table or scene in the format of an engine or a renderer
    Export(export::ExportArgs),
}

impl Command {
    /// Whether the command has the option `--wavelengths`: then its user can keep to those for which media have data.
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
            | Self::Plot(_)
            | Self::Render(_)
            | Self::View(_)
            | Self::Figures(_)
            | Self::Export(_) => false,
        }
    }
}

/// How a command runs: shared by all that compute.
#[derive(Debug, Clone, Copy, Args)]
pub struct Running {
    /// Worker threads [default: as many as the machine has]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress and no remarks on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

impl Running {
    /// Threads to use.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.map_or_else(parallel::available, usize::from)
    }
}

/// How to compute: shared by all commands of planar scenes.
#[derive(Debug, Clone, Args)]
pub struct Computing {
    /// Exact physics, or the paper's words taken literally
    #[arg(long, value_enum, default_value_t = ModelArg::Physical)]
    pub model: ModelArg,
    /// Closed form, ray tracing with loops summed exactly, or ray tracing hit by hit
    #[arg(long, value_enum, default_value_t = Method::Trace)]
    pub method: Method,
    /// Single or double precision
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// How it runs
    #[command(flatten)]
    pub running: Running,
}

impl Computing {
    /// As the estimator wants it.
    #[must_use]
    pub fn request(&self) -> SpectraRequest {
        SpectraRequest {
            model: self.model.into(),
            method: self.method,
            precision: self.precision,
            threads: self.running.threads(),
        }
    }
}

/// How a spectrum becomes a colour.
#[derive(Debug, Clone, Copy, Args)]
pub struct Colouring {
    /// The light
    #[arg(long, value_enum, ignore_case = true, default_value_t = IlluminantArg::D65)]
    pub illuminant: IlluminantArg,
    /// The colour space of R, G, B; linear, unclipped
    #[arg(long, value_enum, default_value_t = SpaceArg(RgbSpace::Srgb))]
    pub space: SpaceArg,
}

/// Arguments of `spectrum`.
#[derive(Debug, Args)]
pub struct SpectrumArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: 0,30,60 or 0:85:5
    #[arg(long, allow_hyphen_values = true, default_value = "0")]
    pub theta: Angles,
    /// Wavelengths in nm: 450,550 or 380:780:5 or auto
    #[arg(long, allow_hyphen_values = true, default_value = "380:780:5")]
    pub wavelengths: Wavelengths,
    /// Where the CSV goes; - is standard output. Its last column, truncated, is how far the other four may be from
    /// their values with loops closed; 0 but for --method hits
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}

/// Arguments of `colour`.
#[derive(Debug, Args)]
pub struct ColourArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: 0,30,60 or 0:85:5
    #[arg(long, allow_hyphen_values = true, default_value = "0,15,30,45,60,75")]
    pub theta: Angles,
    /// Wavelengths in nm: 450,550 or 380:780:5 or auto
    #[arg(long, allow_hyphen_values = true, default_value = "auto")]
    pub wavelengths: Wavelengths,
    /// Where the CSV goes; - is standard output [default: a table with swatches on the terminal]
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// From spectrum to colour
    #[command(flatten)]
    pub colouring: Colouring,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}

/// Arguments of `estimate`.
#[derive(Debug, Args)]
pub struct EstimateArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// The table to write (.exr)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Also a picture of the table as a disc (.png or .svg)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Planar scenes: number of angles, evenly from 0 up to but not including 90 degrees [default: 90]
    #[arg(long, value_parser = clap::value_parser!(u16).range(2..=9000))]
    pub angles: Option<u16>,
    /// Wavelengths in nm: 450,550 or 380:780:5 or auto [default: auto, of cells 380:780:10]
    #[arg(long, allow_hyphen_values = true)]
    pub wavelengths: Option<Wavelengths>,
    /// How a cell of tilted facets is sampled
    #[command(flatten)]
    pub cell: CellSampling,
    /// From spectrum to colour
    #[command(flatten)]
    pub colouring: Colouring,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}

impl EstimateArgs {
    /// What holds where the user says nothing; the scene and the output are no files.
    #[must_use]
    pub fn defaults() -> Self {
        let command = Self::augment_args(clap::Command::new("estimate").no_binary_name(true));
        let matches = command.get_matches_from(["scene", "--output", "table.exr"]);
        Self::from_arg_matches(&matches).expect("the command line accepts its own defaults")
    }
}

/// How `estimate` samples a cell of tilted facets; planar scenes refuse these options.
#[derive(Debug, Clone, Args)]
pub struct CellSampling {
    /// Cells: incident directions, θ × φ; one φ makes an isotropic table, averaged around the normal [default: 8x16]
    #[arg(long, value_name = "THETAxPHI")]
    pub incident: Option<Bins>,
    /// Cells: bins of outgoing directions, cos θ × φ; φ a multiple of that of --incident [default: 16x32]
    #[arg(long, value_name = "COSxPHI")]
    pub bins: Option<Bins>,
    /// Cells: starting rays over the period for each incident direction [default: 4096]
    #[arg(long, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: Option<u32>,
    /// Cells: how exits add [default: ray]
    #[arg(long, value_enum)]
    pub coherence: Option<Coherence>,
    /// Cells: seed of the sampling sequence [default: 0]
    #[arg(long)]
    pub seed: Option<u32>,
    /// Cells: average f(wi, wo) and f(wo, wi)
    #[arg(long)]
    pub reciprocal: bool,
    /// Cells: double the rays of each incident direction until its albedo has this standard error, up to 4194304 rays
    #[arg(long, value_name = "ERROR")]
    pub target_error: Option<f64>,
    /// Cells: discard what an interrupted run has finished and begin anew; without it the same command resumes
    #[arg(long)]
    pub restart: bool,
}

/// Arguments of `scatter`.
#[derive(Debug, Args)]
pub struct ScatterArgs {
    /// A scene file with a cell of polygons, or the name of such a preset
    pub scene: String,
    /// Angle of incidence in degrees, in [0, 90)
    #[arg(long, default_value_t = 0.0)]
    pub theta: f64,
    /// Azimuth of the direction towards the light in degrees, from the tangent
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Wavelengths in nm: 450,550 or 380:780:5
    #[arg(long, alias = "wavelength", allow_hyphen_values = true, default_value = "550")]
    pub wavelengths: Wavelengths,
    /// Starting rays over the period
    #[arg(long, default_value_t = 65536, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: u32,
    /// Double the rays until every standard error is below this
    #[arg(long, value_parser = positive)]
    pub target_error: Option<f64>,
    /// Bins of outgoing directions: uniform in cos θ × uniform in φ
    #[arg(long, default_value = "8x16")]
    pub bins: Bins,
    /// How exits add
    #[arg(long, value_enum, default_value_t = Coherence::Ray)]
    pub coherence: Coherence,
    /// Single or double precision
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// Seed of the sampling sequence
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Where the JSON goes, an object, or a list of them for several wavelengths; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub json: PathBuf,
    /// How it runs
    #[command(flatten)]
    pub running: Running,
}

/// Arguments of `orders`.
#[derive(Debug, Args)]
pub struct OrdersArgs {
    /// A scene file with a cell of polygons, or the name of such a preset
    pub scene: String,
    /// Angle of incidence in degrees, in [0, 90)
    #[arg(long, default_value_t = 0.0)]
    pub theta: f64,
    /// Azimuth of the direction towards the light in degrees, from the tangent; 180 for a wave that travels towards +x
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    pub phi: f64,
    /// Wavelengths in nm: 450,550 or 380:780:5
    #[arg(long, allow_hyphen_values = true, default_value = "550")]
    pub wavelengths: Wavelengths,
    /// Starting rays over the period
    #[arg(long, default_value_t = 65536, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: u32,
    /// Largest |m| and |n| [default: all orders that travel]
    #[arg(long, alias = "most-order", value_parser = clap::value_parser!(i32).range(0..))]
    pub max_order: Option<i32>,
    /// Hits after which a ray is dropped [default: 1, single scattering, for one surface; 64 for several interfaces]
    #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
    pub hits: Option<u32>,
    /// Single or double precision
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// Seed of the sampling sequence
    #[arg(long, default_value_t = 0)]
    pub seed: u32,
    /// Where the CSV goes; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// How it runs
    #[command(flatten)]
    pub running: Running,
}

/// A number above 0.
fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|error| error.to_string())?;
    if number > 0.0 && number.is_finite() { Ok(number) } else { Err("must be positive".into()) }
}

/// `8x16`: bins in cos θ and in φ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bins(pub [u32; 2]);

impl FromStr for Bins {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let part = |text: &str| text.parse::<u32>().ok().filter(|n| (1..=1024).contains(n));
        match text.split_once('x').map(|(cos, phi)| (part(cos), part(phi))) {
            Some((Some(cos), Some(phi))) => Ok(Self([cos, phi])),
            _ => Err("expected two numbers such as 8x16, each from 1 to 1024".into()),
        }
    }
}

/// Arguments of `compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Angles of incidence in degrees: 0,30,60 or 0:85:5
    #[arg(long, allow_hyphen_values = true, default_value = "0:89:1")]
    pub theta: Angles,
    /// Wavelengths in nm: 450,550 or 380:780:5 or auto
    #[arg(long, allow_hyphen_values = true, default_value = "436,546,700")]
    pub wavelengths: Wavelengths,
    /// Where the CSV goes; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// A picture of both and their difference (.png or .svg)
    #[arg(long, short, visible_alias = "plot", value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// How to compute; the method is that of the ray tracer
    #[command(flatten)]
    pub computing: Computing,
}

/// A sample each 0.1 nm.
const MAX_SAMPLES: i64 = 4000;

/// Arguments of `sampling`.
#[derive(Debug, Args)]
pub struct SamplingArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// Numbers of midpoint samples from 380 to 780 nm
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=MAX_SAMPLES))]
    #[arg(allow_hyphen_values = true, default_value = "4,5,6,8,10,12,16,20,24,28,32,36,40,48,56,64,80,100")]
    pub samples: Vec<u16>,
    /// Angles of incidence over which the largest error is taken
    #[arg(long, allow_hyphen_values = true, default_value = "0:85:5")]
    pub theta: Angles,
    /// Where the CSV goes; - is standard output
    #[arg(long, value_name = "FILE", default_value = "-")]
    pub csv: PathBuf,
    /// A picture of the error curve (.png or .svg)
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// The light; the paper's is E
    #[arg(long, value_enum, ignore_case = true, default_value_t = IlluminantArg::E)]
    pub illuminant: IlluminantArg,
    /// The colour space of the error
    #[arg(long, value_enum, default_value_t = SpaceArg(RgbSpace::Srgb))]
    pub space: SpaceArg,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}

/// Arguments of `figures`.
#[derive(Debug, Args)]
pub struct FiguresArgs {
    /// The folder to write; made if it is missing
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// How it runs
    #[command(flatten)]
    pub running: Running,
}

#[cfg(test)]
mod tests;
