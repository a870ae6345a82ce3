//! Input files of limited length.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::support::error::{Error, Result};

/// Reads a file of at most `limit` bytes. `kind` names it in the message about its length, and `failed` makes the
/// error where it cannot be read.
///
/// # Errors
/// A folder, a file that cannot be read, a file that is too long.
pub fn read_bytes(path: &Path, limit: u64, kind: &str, failed: impl Fn(io::Error) -> Error) -> Result<Vec<u8>> {
    let label = path.display();
    if path.is_dir() {
        return Err(Error::failed(format_args!("{label}: is a folder, expected a file")));
    }
    let mut bytes = Vec::new();
    File::open(path).map_err(&failed)?.take(limit + 1).read_to_end(&mut bytes).map_err(&failed)?;
    if bytes.len() as u64 > limit {
        return Err(Error::failed(format_args!("{label}: longer than {} MiB, the limit for {kind}", limit >> 20)));
    }
    Ok(bytes)
}
