//! Arguments of `estimate`.

use std::path::PathBuf;
use std::str::FromStr;

use clap::builder::UnknownArgumentValueParser;
use clap::{Args, FromArgMatches as _};

use crate::commands::args::shared::{Colouring, Computing};
use crate::commands::args::values::{Bins, positive};
use crate::scene::vary::Vary;
use crate::solve::grid::Wavelengths;
use crate::solve::scatter::Coherence;
use crate::solve::share::Share;
use crate::support::error::Error;

/// Arguments of `estimate`.
#[derive(Debug, Args)]
pub struct EstimateArgs {
    /// A scene file or the name of a preset
    pub scene: String,
    /// The table to write (.exr)
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Also draw the table as a disc (.png or .svg)
    #[arg(long, value_name = "FILE")]
    pub plot: Option<PathBuf>,
    /// Planar scenes: number of angles of incidence, evenly spaced from 0 up to but not including 90° [default: 90]
    #[arg(long, value_parser = clap::value_parser!(u16).range(2..=9000))]
    pub angles: Option<u16>,
    /// Wavelengths in nm: a list 450,550, a range 380:780:5 (start:end:step), or auto: as many as the colours of a
    /// planar scene need [default: auto, for cells 380:780:10]
    #[arg(long, allow_hyphen_values = true)]
    pub wavelengths: Option<Wavelengths>,
    /// Planar scenes: a table over the thickness of a layer, counted from 1 at the top, in nm: LAYER=FROM:TO:STEPS such
    /// as 1=100:800:141
    #[arg(long, value_name = "LAYER=FROM:TO:STEPS")]
    pub vary: Option<Vary>,
    /// How a cell of tilted facets is sampled
    #[command(flatten)]
    pub cell: CellSampling,
    /// Shares of the work
    #[command(flatten)]
    pub farm: Farm,
    /// From spectrum to colour
    #[command(flatten)]
    pub colouring: Colouring,
    /// How to compute
    #[command(flatten)]
    pub computing: Computing,
}

impl EstimateArgs {
    /// The defaults of all options. The scene and the output are placeholders, not files.
    #[must_use]
    pub(crate) fn defaults() -> Self {
        let command = Self::augment_args(clap::Command::new("estimate").no_binary_name(true));
        let matches = command.get_matches_from(["scene", "--output", "table.exr"]);
        Self::from_arg_matches(&matches).expect("the command line accepts its own defaults")
    }
}

/// Options of `estimate` for work that is spread over machines.
#[derive(Debug, Clone, Args)]
pub struct Farm {
    /// Cells: compute part I of N, every Nth of the incident directions, and write it to the output; `merge` joins the
    /// parts. array: the part that SLURM_ARRAY_TASK_ID, _MIN and _COUNT name
    #[arg(long, value_name = "I/N|array")]
    pub part: Option<PartArg>,
}

/// The values of `--part`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartArg {
    /// One share of so many.
    Share(Share),
    /// The share that the environment of a task of an array names.
    Array,
}

impl FromStr for PartArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "array" { Ok(Self::Array) } else { text.parse().map(Self::Share) }
    }
}

impl Farm {
    /// The share to compute, if one is asked for.
    ///
    /// # Errors
    /// `array` without the variables of an array.
    pub fn share(&self) -> Result<Option<Share>, Error> {
        match self.part {
            None => Ok(None),
            Some(PartArg::Share(share)) => Ok(Some(share)),
            Some(PartArg::Array) => {
                let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u32>().ok());
                let [id, first, of] =
                    ["SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_COUNT"].map(number);
                let share = id.zip(first).zip(of).and_then(|((id, first), of)| {
                    format!("{}/{of}", id.checked_sub(first)?.checked_add(1)?).parse().ok()
                });
                share.map(Some).ok_or_else(|| {
                    Error::usage(
                        "--part array: SLURM_ARRAY_TASK_ID, SLURM_ARRAY_TASK_MIN and SLURM_ARRAY_TASK_COUNT do not name a part; \
                         submit an array such as --array=1-8, or name the part as I/N",
                    )
                })
            }
        }
    }
}

/// Options of `estimate` for sampling a cell of tilted facets; planar scenes refuse them.
#[derive(Debug, Clone, Args)]
pub struct CellSampling {
    /// Cells: number of incident directions, θ × φ; with one φ the table is isotropic, averaged around the normal
    /// [default: 15x20, for lines 28x20, for flat facets 22x24]. Diffraction orders: cone angles β × α, where sin α is
    /// the component along the period [default: 9x33, for cells with two periods 13x13]
    #[arg(long, value_name = "THETAxPHI")]
    pub incident: Option<Bins>,
    /// Cells: number of half vectors at which the table holds values, outwards from the normal × around it
    /// [default: 13x16, for lines 13x8, for flat facets 7x12, for isotropic tables 33x32]
    #[arg(long, value_name = "THETAxPHI")]
    pub half_vectors: Option<Bins>,
    /// What sized tables of versions before 0.2
    #[arg(long, hide = true, value_parser = UnknownArgumentValueParser::suggest_arg("--half-vectors"))]
    pub bins: Option<String>,
    /// Cells: number of starting rays for each incident direction, spread over the period [default: 4096; between
    /// interfaces 1024, unless wavelengths differ in phase alone]
    #[arg(long, value_parser = clap::value_parser!(u32).range(32..=1 << 28))]
    pub rays: Option<u32>,
    /// Cells: which light interferes where it leaves [default: cell for scenes that name their periods, else ray]
    #[arg(long, value_enum)]
    pub coherence: Option<Coherence>,
    /// Cells: seed of the random sequence of starting rays [default: 0]
    #[arg(long)]
    pub seed: Option<u32>,
    /// Cells: average f(wi, wo) and f(wo, wi): less noise, and a table that path tracers may use from either end
    #[arg(long)]
    pub reciprocal: bool,
    /// Cells: double the rays of each incident direction until the standard error of its albedo is at most this, up to
    /// 4194304 rays; coherence cell: take more orders along until the error bar of every efficiency is at most this
    /// [default: 0.002]
    #[arg(long, value_name = "ERROR", value_parser = positive)]
    pub target_error: Option<f64>,
    /// Coherence cell: the largest number |m| of an order that waves take along before their error bar is accepted as
    /// it is [default: 48 for lines, 4 for cells with two periods]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u16).range(1..=500))]
    pub max_harmonic: Option<u16>,
    /// Cells: start over and discard the finished part of an interrupted run; without this option the command resumes
    /// it
    #[arg(long)]
    pub restart: bool,
}
