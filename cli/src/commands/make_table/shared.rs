//! What tables of cells share, by rays or by waves: the grid of scattered light, and progress that tells of the
//! checkpoint.

use std::sync::Once;

use goniochrome::measure::bins::DirectionBins;
use goniochrome::table::ScatterLayout;
use indicatif::ProgressBar;

use crate::commands::args::EstimateArgs;
use crate::solve::checkpoint::Checkpoint;
use crate::support::error::{Error, Result};
use crate::support::progress::note;

/// The grid of a table of scattered light.
pub(super) fn scatter_layout(args: &EstimateArgs) -> Result<ScatterLayout> {
    let [theta, phi] = args.cell.incident.map_or([8, 16], |bins| bins.0);
    let [cos, around] = args.cell.bins.map_or([16, 32], |bins| bins.0);
    ScatterLayout::new(theta, phi, DirectionBins { cos, phi: around })
        .map_err(|error| Error::usage(format_args!("--incident {theta}x{phi} --bins {cos}x{around}: {error}")))
}

/// What is called after each finished part: it moves the progress bar. The first call tells of the checkpoint, since a
/// request that is refused has nothing to resume.
pub(super) fn ticking<'p>(
    progress: &'p ProgressBar,
    checkpoint: Option<&Checkpoint>,
    quiet: bool,
) -> impl Fn() + Sync + use<'p> {
    let (message, told) = (checkpoint.map(Checkpoint::says), Once::new());
    move || {
        told.call_once(|| message.iter().for_each(|message| progress.suspend(|| note(quiet, message))));
        progress.inc(1);
    }
}
