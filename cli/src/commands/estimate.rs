//! The command `goniochrome estimate`.

use crate::commands::args::EstimateArgs;
use crate::commands::make_table::make_table;
use crate::commands::pictures::save_picture;
use crate::plot::{PictureFormat, tables};
use crate::scene::load;
use crate::solve::checkpoint::Checkpoint;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::note;
use crate::table::file;

pub fn run(args: &EstimateArgs) -> Result<()> {
    if args.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("exr")) {
        return Err(Error::usage(format_args!("{}: a table is written as .exr; name it so", args.output.display())));
    }
    let scene = load(&args.scene)?;
    for path in [Some(&args.output), args.plot.as_ref()].into_iter().flatten() {
        output::check_destination(path, &scene.files)?;
    }
    if let Some(plot) = &args.plot {
        PictureFormat::of(plot)?;
        output::refuse_same_output(&args.output, plot)?;
    }
    let (table, summary, checkpoint) = make_table(args, &scene, Some(&args.output))?;
    file::write(&args.output, &table, args.computing.request().threads)?;
    if let Some(path) = &args.plot {
        save_picture(&tables::disc(&table, None, 0.0)?, path, args.computing.running.quiet)?;
    }
    // Only after all is written: if writing fails, on a full disk for example, the work is kept.
    checkpoint.map_or(Ok(()), Checkpoint::remove)?;
    note(args.computing.running.quiet, format_args!("{}: {summary}", args.output.display()));
    Ok(())
}
