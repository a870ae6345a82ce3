//! Arguments of `figures`.

use std::path::PathBuf;

use clap::Args;

use crate::commands::args::shared::Running;

/// Arguments of `figures`.
#[derive(Debug, Args)]
pub struct FiguresArgs {
    /// The folder to write into; made if it is missing
    #[arg(long, short, value_name = "DIR")]
    pub output: PathBuf,
    /// Threads and messages
    #[command(flatten)]
    pub running: Running,
}
