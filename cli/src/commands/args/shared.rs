//! Options that several commands share.

use clap::Args;
use goniochrome::colour::RgbSpace;

use crate::commands::args::values::{IlluminantArg, ModelArg, SpaceArg};
use crate::solve::precision::Precision;
use crate::solve::spectra::{Method, SpectraRequest};
use crate::solve::waves::{Accuracy, OrderMethod};
use crate::support::parallel;

/// Options of every command that computes: how it runs.
#[derive(Debug, Clone, Copy, Args)]
pub struct Running {
    /// Worker threads [default: as many as the machine has]; results do not depend on it
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print no progress and no notes on standard error
    #[arg(long, short)]
    pub quiet: bool,
}

impl Running {
    /// The number of threads to use.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.map_or_else(parallel::available, usize::from)
    }
}

/// Options of every command for planar scenes: how to compute.
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
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}

impl Computing {
    /// The request for spectra.
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

/// Options of commands that compute diffraction orders of one direction of the light.
#[derive(Debug, Clone, Copy, Args)]
pub struct Diffracting {
    /// How diffraction orders are computed [default: waves where the cell allows it]
    #[arg(long, value_enum)]
    pub method: Option<OrderMethod>,
    /// Waves: the largest number |m| of an order that is taken along before the error bar is accepted as it is
    /// [default: 120 for lines, 7 for cells with two periods]
    #[arg(long, value_name = "M", value_parser = clap::value_parser!(u16).range(1..=500))]
    pub max_harmonic: Option<u16>,
}

impl Diffracting {
    /// When waves are good enough.
    #[must_use]
    pub fn accuracy(&self, target_error: Option<f64>) -> Accuracy {
        Accuracy {
            target: target_error.unwrap_or(Accuracy::DEFAULT.target),
            max_order: self.max_harmonic.map(usize::from),
        }
    }
}

/// Options of commands that turn a spectrum into a colour.
#[derive(Debug, Clone, Copy, Args)]
pub struct Colouring {
    /// The spectrum of the light
    #[arg(long, value_enum, ignore_case = true, default_value_t = IlluminantArg::D65)]
    pub illuminant: IlluminantArg,
    /// The colour space of R, G, B; linear, unclipped
    #[arg(long, value_enum, default_value_t = SpaceArg(RgbSpace::Srgb))]
    pub space: SpaceArg,
}

/// The option of commands that show a finish: whether several bounces count.
#[derive(Debug, Clone, Copy, Args)]
pub struct Compensating {
    /// Mirror-like tables: whether light that meets several facets is returned [default: as the table's finish says]
    #[arg(
        long = "energy-compensation",
        value_name = "true|false",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "true"
    )]
    pub energy_compensation: Option<bool>,
}
