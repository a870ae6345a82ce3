//! Arguments of `merge`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Running;

/// Arguments of `merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The files of all parts, in any order
    #[arg(value_name = "PART", required = true)]
    pub parts: Vec<PathBuf>,
    /// The table to write (.exr): byte for byte that of one `estimate` without --part
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
