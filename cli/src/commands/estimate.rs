//! The command `goniochrome estimate`.

use std::path::Path;

use crate::commands::args::EstimateArgs;
use crate::commands::make_table::{Made, make_table};
use crate::commands::pictures::save_picture;
use crate::plot::{PictureFormat, tables};
use crate::scene::load;
use crate::solve::checkpoint::{Checkpoint, Identity};
use crate::solve::sealed_part::Seal;
use crate::solve::share::Share;
use crate::support::error::{Error, Result};
use crate::support::output;
use crate::support::progress::note;
use crate::table::file;

pub fn run(args: &EstimateArgs) -> Result<()> {
    let share = args.farm.share()?;
    if share.is_none() && args.output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("exr")) {
        return Err(Error::usage(format_args!("{}: a table is written as .exr; name it so", args.output.display())));
    }
    if share.is_some() && args.plot.is_some() {
        return Err(Error::usage("--plot: a part is no table yet; draw the table that merge makes"));
    }
    let scene = load(&args.scene)?;
    for path in [Some(&args.output), args.plot.as_ref()].into_iter().flatten() {
        output::check_destination(path, &scene.files)?;
    }
    if let Some(plot) = &args.plot {
        PictureFormat::of(plot)?;
        output::refuse_same_output(&args.output, plot)?;
    }
    match (make_table(args, &scene, Some(&args.output))?, share) {
        (Made::Table(table, summary, checkpoint), _) => {
            file::write(&args.output, &table, args.computing.request().threads)?;
            if let Some(path) = &args.plot {
                save_picture(&tables::disc(&table, None, 0.0)?, path, args.computing.running.quiet)?;
            }
            // Only after all is written: if writing fails, on a full disk for example, the work is kept.
            checkpoint.map_or(Ok(()), Checkpoint::remove)?;
            note(args.computing.running.quiet, format_args!("{}: {summary}", args.output.display()));
        }
        (Made::Share(checkpoint, identity), Some(share)) => {
            let records = close(checkpoint, &identity, args, share)?;
            let output = args.output.display();
            note(
                args.computing.running.quiet,
                format_args!("{output}: part {share}, {records} directions; merge joins it"),
            );
        }
        (Made::Share(..), None) => unreachable!("no share is asked for"),
    }
    Ok(())
}

/// Makes the output of the checkpoint of a finished share; returns its number of records.
fn close(checkpoint: Checkpoint, identity: &Identity, args: &EstimateArgs, share: Share) -> Result<u64> {
    let path = Path::new(&args.scene);
    // The parts may be joined in another folder.
    let scene = if path.is_file() { std::path::absolute(path).ok() } else { None };
    let scene = scene.map_or_else(|| args.scene.clone(), |path| path.to_string_lossy().into_owned());
    let arguments = std::env::args().skip(1).collect();
    let (head, mut count) = (identity.head(), 0);
    checkpoint.close(&args.output, head, |records, record_bytes| {
        count = records;
        let head_bytes = head.len() as u64;
        Seal { arguments, scene, share: [share.number, share.of], head_bytes, record_bytes, records }.bytes(head)
    })?;
    Ok(count)
}
