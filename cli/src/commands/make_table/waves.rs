//! The tables of a periodic cell by waves: diffraction orders, or scattered light where its periods differ at random.

use std::path::Path;

use goniochrome::colour::Quadrature;
use goniochrome::table::OrderLayout;

use crate::colour::visible_weights;
use crate::commands::args::{Bins, EstimateArgs, ModelArg};
use crate::commands::cell_options::listed_wavelengths;
use crate::commands::make_table::made::Made;
use crate::commands::make_table::metadata::wave_metadata;
use crate::commands::make_table::shared::{made_share, scatter_layout, sides, ticking};
use crate::commands::notes::note_on_scene;
use crate::scene::{Periods, Scene};
use crate::solve::cell_table::Sides;
use crate::solve::checkpoint::Checkpoint;
use crate::solve::grid::Wavelengths;
use crate::solve::spectra::Method;
use crate::solve::waves::random_periods::scattered;
use crate::solve::waves::table::{OrderTableRequest, WaveTable, steps, wave_table as solve};
use crate::solve::waves::{Accuracy, WaveCell};
use crate::support::error::{Error, Result};
use crate::support::progress::{bar, note};
use crate::table::Table;

/// Default numbers of directions of the light, β × α, for lines.
const NODES_LINES: [u32; 2] = [7, 25];
/// Default numbers of directions of the light, β × α, for cells with two periods.
const NODES_CROSSED: [u32; 2] = [7, 7];

/// Largest sum of efficiencies between directions of the grid without a warning: a difference that is hardly seen.
const MAX_ALBEDO: f64 = 1.02;

/// Computes the table of a periodic cell; also returns its summary, and its checkpoint if it has an output.
pub(super) fn wave_table(args: &EstimateArgs, scene: &Scene, output: Option<&Path>) -> Result<Made> {
    let periods = scene.periods.unwrap_or(Periods::Coherent);
    refuse_options(args, scene, periods)?;
    let quiet = args.computing.running.quiet;
    let wavelengths = args.wavelengths.as_ref().map_or_else(|| Wavelengths::every(10.0), Wavelengths::increasing);
    let wavelength_nm = listed_wavelengths(&wavelengths, scene)?;
    let cell = WaveCell::new(scene)?;
    let lines = cell.periodicity().has_lines();
    let default = if lines { Accuracy::TABLE } else { Accuracy::CROSSED_TABLE };
    let accuracy = Accuracy {
        target: args.cell.target_error.unwrap_or(default.target),
        max_order: args.cell.max_harmonic.map(usize::from).or(default.max_order),
    };
    cell.check_size(wavelength_nm, accuracy)?;
    let default = if lines { NODES_LINES } else { NODES_CROSSED };
    let [across, along] = match periods {
        Periods::Coherent => args.cell.incident.map_or(default, |Bins(nodes)| nodes),
        Periods::Random => default,
    };
    let layout =
        OrderLayout::new([along, across], cell.periodicity(), cell.period_nm().map(|nm| nm as f32)).map_err(|_| {
            Error::usage(format_args!("--incident {across}x{along}: orders need 2 to 1024 directions each way"))
        })?;
    let spread = match periods {
        Periods::Coherent => None,
        Periods::Random => {
            let illuminant = args.colouring.illuminant.into();
            Some((
                scatter_layout(args, Sides::LINES)?,
                visible_weights(wavelength_nm, illuminant, Quadrature::Interpolated)?,
            ))
        }
    };
    note_on_scene(scene, wavelength_nm, quiet);
    let share = args.farm.share()?;
    let request = OrderTableRequest { layout, accuracy, threads: args.computing.running.threads(), share };
    let checkpoint = match output {
        Some(output) => Checkpoint::open(output, &request.identity(scene, wavelength_nm), args.cell.restart)?,
        None => None,
    };
    let columns = steps(&layout, wavelength_nm.len());
    let columns = share.map_or(columns, |share| columns.div_ceil(share.of as usize));
    let progress = bar(&scene.name, columns, quiet);
    let finished = ticking(&progress, checkpoint.as_ref(), quiet);
    let WaveTable { mut table, met, decompositions, layers } =
        solve(&cell, wavelength_nm, &request, checkpoint.as_ref(), &finished)?;
    progress.finish_and_clear();
    if share.is_some() {
        return made_share(checkpoint, request.identity(scene, wavelength_nm));
    }
    let error = table.worst_error();
    let mut warnings = Vec::new();
    if !met {
        let target = accuracy.target;
        warnings.push(format!("the error bar of efficiencies is up to {error:.1e}, more than {target:.0e}"));
    }
    let albedo = table.worst_albedo()?;
    if albedo > MAX_ALBEDO {
        let remedy = match periods {
            Periods::Coherent => format!("; name more directions, as --incident {}x{}", 2 * across, 2 * along),
            // --incident names the directions of scattered light.
            Periods::Random => String::new(),
        };
        warnings.push(format!("between directions of the grid orders add up to {albedo:.2} of the light{remedy}"));
    }
    warnings.iter().for_each(|warning| note(quiet, format_args!("{}: {warning}", scene.name)));
    let metadata = wave_metadata(args, scene, periods, error, &warnings);
    let count = wavelength_nm.len();
    let (table, summary): (Table, String) = match spread {
        None => {
            table.metadata = metadata;
            let summary = format!(
                "{} diffraction orders × {along} × {across} directions × {count} wavelengths; error bar ≤ {error:.1e}; {decompositions} decompositions \
                 for {layers} passages of layers",
                table.orders.len()
            );
            (table.into(), summary)
        }
        Some((scatter_layout, weights)) => {
            let mut table = scattered(&table, scatter_layout, &weights, args.colouring.space.into())?;
            table.metadata = metadata;
            let summary = format!(
                "{} × {count} wavelengths, by waves; error bar of orders ≤ {error:.1e}; {decompositions} decompositions for \
                 {layers} passages of layers",
                sides(&scatter_layout)
            );
            (table.into(), summary)
        }
    };
    Ok(Made::Table(Box::new(table), summary, checkpoint))
}

/// Refuses options that waves do not have.
fn refuse_options(args: &EstimateArgs, scene: &Scene, periods: Periods) -> Result<()> {
    let cell = &args.cell;
    let unused = [
        ("--angles", args.angles.is_some(), "name its directions by --incident"),
        ("--vary", args.vary.is_some(), "it is for the layers of a [stack]"),
        ("--model", args.computing.model != ModelArg::Physical, "waves are exact physics alone"),
        ("--method", args.computing.method != Method::Trace, "coherence cell is computed by waves"),
        ("--rays", cell.rays.is_some(), "coherence cell is computed by waves, not by rays"),
        ("--seed", cell.seed.is_some(), "coherence cell is computed by waves, without chance"),
        ("--reciprocal", cell.reciprocal, "waves are reciprocal"),
        (
            "--half-vectors",
            cell.half_vectors.is_some() && periods == Periods::Coherent,
            "diffraction orders have exact directions",
        ),
    ];
    match unused.into_iter().find(|(_, given, _)| *given) {
        Some((option, _, why)) => Err(Error::usage(format_args!("{option}: {}: {why}; leave it out", scene.name))),
        None => Ok(()),
    }
}
