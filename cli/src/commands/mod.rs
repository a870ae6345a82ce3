//! The commands: arguments in, files out, one file each. They share the files above `presets`.

pub mod args;
mod csv_file;
mod pictures;
mod cell_options;
mod notes;
mod wave_choice;
mod planar_spectra;
mod make_table;
mod table_source;
mod presets;
mod spectrum;
mod colour;
mod estimate;
mod merge;
mod scatter;
mod orders;
mod compare;
mod sampling;
mod thickness_option;
mod lookup;
mod plot;
mod spread_option;
mod body_option;
mod finish_option;
mod render;
mod view;
mod figures;
mod export;

use crate::commands::args::Command;
use crate::support::error::Result;

/// Runs a command.
///
/// # Errors
/// Wrong usage, input that cannot be read or computed, output that cannot be written: one line for the user.
pub fn run(command: &Command) -> Result<()> {
    let result = match command {
        Command::Presets { materials: true, .. } => presets::materials(),
        Command::Presets { name, .. } => presets::run(name.as_deref()),
        Command::Spectrum(args) => spectrum::run(args),
        Command::Colour(args) => colour::run(args),
        Command::Estimate(args) => estimate::run(args),
        Command::Merge(args) => merge::run(args),
        Command::Scatter(args) => scatter::run(args),
        Command::Orders(args) => orders::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Sampling(args) => sampling::run(args),
        Command::Lookup(args) => lookup::run(args),
        Command::Plot(args) => plot::run(args),
        Command::Render(args) => render::run(args),
        Command::View(args) => view::run(args),
        Command::Figures(args) => figures::run(args),
        Command::Export(args) => export::run(args),
    };
    result.map_err(|error| error.with_remedy(command.asks_wavelengths()))
}
