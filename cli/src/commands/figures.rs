//! `goniochrome figures`: every figure of the paper by one command.

use crate::commands::args::FiguresArgs;
use crate::paper::figures;
use crate::support::error::Result;
use crate::support::progress::note;

pub fn run(args: &FiguresArgs) -> Result<()> {
    let index = figures::write(&args.output, args.running.threads(), args.running.quiet)?;
    note(args.running.quiet, format_args!("{}", index.display()));
    Ok(())
}
