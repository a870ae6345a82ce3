//! The table of a scene, as `estimate` makes it.

mod made;
mod metadata;
mod shared;
mod planar;
mod cell;
mod waves;

use std::path::Path;

use crate::commands::args::{Bins, EstimateArgs};
use crate::scene::{Periods, Scene, Shape};
use crate::solve::grid::Wavelengths;
use crate::solve::scatter::Coherence;
use crate::support::error::Result;
use crate::table::Table;

pub(super) use made::Made;

/// Starting rays for a cell's table that is only drawn: the presets then take seconds.
const RAYS_IN_MEMORY: u32 = 512;

/// Step of the wavelengths of a table of waves that is only drawn.
const STEP_IN_MEMORY_NM: f64 = 20.0;
/// Error bar of the efficiencies of a table of waves that is only drawn.
const ERROR_IN_MEMORY: f64 = 5e-3;
/// Numbers of directions of the light, β × α, of a table of orders that is only drawn.
const NODES_IN_MEMORY: [u32; 2] = [5, 13];

/// Makes the table of a scene, or a share of it.
pub(super) fn make_table(args: &EstimateArgs, scene: &Scene, output: Option<&Path>) -> Result<Made> {
    match &scene.shape {
        Shape::Mesh(_) => match coherence(args, scene) {
            Coherence::Cell => waves::wave_table(args, scene, output),
            coherence => cell::scatter_table(args, scene, coherence, output),
        },
        Shape::Stack { .. } | Shape::Planes(_) => {
            planar::mirror_table(args, scene).map(|(table, summary)| Made::Table(Box::new(table), summary, None))
        }
    }
}

/// The coherence of a cell's light: as the options say, else `cell` for a scene that says how its periods differ.
fn coherence(args: &EstimateArgs, scene: &Scene) -> Coherence {
    let by_scene = if scene.periods.is_some() { Coherence::Cell } else { Coherence::default() };
    args.cell.coherence.unwrap_or(by_scene)
}

/// Makes the table of a scene by the defaults of `estimate`, for cells with fewer rays; also returns its summary.
/// Nothing is written.
pub(super) fn make_table_in_memory(scene: &Scene, quiet: bool) -> Result<(Table, String)> {
    let mut args = EstimateArgs::defaults();
    args.computing.running.quiet = quiet;
    if matches!(scene.shape, Shape::Mesh(_)) {
        match coherence(&args, scene) {
            Coherence::Cell => {
                args.wavelengths = Some(Wavelengths::every(STEP_IN_MEMORY_NM));
                args.cell.target_error = Some(ERROR_IN_MEMORY);
                if scene.periods != Some(Periods::Random) {
                    args.cell.incident = Some(Bins(NODES_IN_MEMORY));
                }
            }
            _ => args.cell.rays = Some(RAYS_IN_MEMORY),
        }
    }
    match make_table(&args, scene, None)? {
        Made::Table(table, summary, _) => Ok((*table, summary)),
        Made::Share(..) => unreachable!("no share is asked for"),
    }
}
