//! Arguments of `view`.

use std::path::PathBuf;

use clap::Args;

/// Arguments of `view`.
#[derive(Debug, Args)]
pub struct PageArgs {
    /// A table made by `estimate`
    pub table: PathBuf,
    /// The page (.html): one file that needs no network
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
}
