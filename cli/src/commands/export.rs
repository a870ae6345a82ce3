//! `goniochrome export`.

use crate::args::export::{ExportArgs, ExportKind};
use crate::args::spelled;
use crate::blob;
use crate::error::{Error, Result};

pub fn run(args: &ExportArgs) -> Result<()> {
    match args.to {
        ExportKind::Lut | ExportKind::Merl | ExportKind::Bsdf | ExportKind::Gltf => {
            Err(Error::failed(format_args!("--to {}: not written yet", spelled(args.to))))
        }
        ExportKind::Blob => blob::run(args),
    }
}
