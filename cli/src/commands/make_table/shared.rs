//! What tables of cells share, by rays or by waves: the grid of scattered light, and progress that tells of the
//! checkpoint.

use std::sync::Once;

use goniochrome::table::ScatterLayout;
use indicatif::ProgressBar;

use crate::commands::args::EstimateArgs;
use crate::commands::make_table::made::Made;
use crate::solve::cell_table::Sides;
use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::support::error::{Error, Result};
use crate::support::progress::note;

/// The grid of a table of scattered light, without lobes: as the options say, else these sides.
pub(super) fn scatter_layout(args: &EstimateArgs, defaults: Sides) -> Result<ScatterLayout> {
    let incident = args.cell.incident.map_or(defaults.incident, |sides| sides.0);
    let otherwise = if incident[1] == 1 { Sides::ISOTROPIC } else { defaults };
    let half_vectors = args.cell.half_vectors.map_or(otherwise.half_vectors, |sides| sides.0);
    let ([theta, phi], [u, v]) = (incident, half_vectors);
    ScatterLayout::new(incident, half_vectors, 0)
        .map_err(|error| Error::usage(format_args!("--incident {theta}x{phi} --half-vectors {u}x{v}: {error}")))
}

/// The sides of a grid, in words.
pub(super) fn sides(layout: &ScatterLayout) -> String {
    let ([theta, phi], [u, v]) = (layout.incident_sides(), layout.square_sides());
    let lobes = match layout.lobes() {
        0 => String::new(),
        1 => " and 1 exact lobe".to_owned(),
        lobes => format!(" and {lobes} exact lobes"),
    };
    format!("{theta} × {phi} incident directions × {u} × {v} half vectors{lobes}")
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

/// A finished share, which is kept in its checkpoint.
pub(super) fn made_share(checkpoint: Option<Checkpoint>, identity: Identity) -> Result<Made> {
    let refused = || Error::usage("--part: a part is a file, which no device or pipe holds; name one by --output");
    checkpoint.map(|checkpoint| Made::Share(checkpoint, identity)).ok_or_else(refused)
}
