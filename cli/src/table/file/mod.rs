//! Tables as spectral OpenEXR images (Fichet, Pacanowski and Wilkie, JCGT 2021).
//!
//! All channels are 32-bit floats, ZIP-compressed. String attributes hold the axes at full precision
//! (`goniochrome.wavelength_nm`, …), the kind of table (`goniochrome.kind`: `mirror`, see [`mirror`], `scatter`, see
//! [`scatter`], or `orders`, see [`orders`]) and every entry of the metadata, with the prefix `goniochrome.`. Equal
//! tables give equal bytes.

mod lazy_channel;
mod container;
pub mod mirror;
pub mod scatter;
pub mod orders;

use std::path::Path;

use crate::support::error::{Error, Result};
use crate::table::Table;
use container::{KIND, Opened};
pub(crate) use container::{PREFIX, sort_attributes};

/// Writes the table to `path`, whole or not at all.
///
/// # Errors
/// A table that [`Table::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too close for
/// names of channels, a file that cannot be written.
pub fn write(path: &Path, table: &Table, threads: usize) -> Result<()> {
    crate::support::output::write_file(path, &encode(table, threads)?)
}

/// Reads a table that [`write()`] wrote.
///
/// # Errors
/// A file that cannot be read, or in which [`decode`] finds no table; the message names the file.
pub fn read(path: &Path) -> Result<Table> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| {
        Error::failed(format_args!("cannot read {name}: {error}; `goniochrome estimate` writes a table"))
    })?;
    decode(&bytes).map_err(|error| Error::failed(format_args!("{name}: {error}")))
}

/// Encodes a table as an EXR file. The bytes do not depend on the number of threads.
///
/// # Errors
/// A table that [`Table::check`] refuses, metadata whose keys are reserved or not printable, wavelengths too close for
/// names of channels.
pub fn encode(table: &Table, threads: usize) -> Result<Vec<u8>> {
    match table {
        Table::Mirror(table) => mirror::encode(table),
        Table::Scatter(table) => scatter::encode(table, threads),
        Table::Orders(table) => orders::encode(table, threads),
    }
}

/// Decodes the table in the bytes of an EXR file.
///
/// # Errors
/// Bytes that are not an EXR file, a missing attribute or channel, sizes that contradict one another, a table that
/// [`Table::check`] refuses.
pub fn decode(bytes: &[u8]) -> Result<Table> {
    let mut file = Opened::new(bytes)?;
    let kind = file.take(KIND)?;
    match kind.as_str() {
        mirror::MIRROR => mirror::decode(file).map(Table::Mirror),
        scatter::SCATTER => scatter::decode(file).map(Table::Scatter),
        orders::ORDERS => orders::decode(file).map(Table::Orders),
        _ => Err(Error::failed(format_args!(
            "{PREFIX}{KIND} is \"{kind}\"; this version reads \"mirror\", \"scatter\" and \"orders\""
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cuts a file short at every length and flips bits of every byte: errors are one line, and tables are checked.
    pub(super) fn damage(good: &[u8]) {
        for length in 0..good.len() {
            let error = decode(&good[..length]).unwrap_err();
            assert!(!error.to_string().contains('\n'));
        }
        for at in 0..good.len() {
            for flip in [0x01, 0x80, 0xff] {
                let mut bytes = good.to_vec();
                bytes[at] ^= flip;
                // Some flips only change a value; what matters is that the result is checked.
                if let Ok(table) = decode(&bytes) {
                    table.check().unwrap();
                }
            }
        }
    }
}
