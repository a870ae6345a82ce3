//! Tables as spectral OpenEXR images (Fichet, Pacanowski and Wilkie, JCGT 2021).
//!
//! All channels are 32-bit floats, ZIP-compressed. String attributes hold the axes at full precision
//! (`goniochrome.wavelength_nm`, …), the kind of table (`goniochrome.kind`: `mirror`, see [`mirror`], or `scatter`, see
//! [`scatter`]) and every entry of the metadata with the prefix `goniochrome.`. Equal tables give equal bytes.

mod lazy_channel;
mod container;
pub mod mirror;
pub mod scatter;

use std::path::Path;

use crate::support::error::{Error, Result};
use crate::table::Table;
use container::{KIND, Opened};
pub(crate) use container::{PREFIX, sort_attributes};

/// Writes the table to `path`, whole or not at all.
pub fn write(path: &Path, table: &Table, threads: usize) -> Result<()> {
    crate::support::output::write_file(path, &encode(table, threads)?)
}

/// Reads a table that [`write()`] wrote.
pub fn read(path: &Path) -> Result<Table> {
    let name = path.display();
    let bytes = std::fs::read(path).map_err(|error| {
        Error::failed(format_args!("cannot read {name}: {error}; `goniochrome estimate` writes a table"))
    })?;
    decode(&bytes).map_err(|error| Error::failed(format_args!("{name}: {error}")))
}

/// The bytes of the EXR file, which any number of threads writes alike.
pub fn encode(table: &Table, threads: usize) -> Result<Vec<u8>> {
    match table {
        Table::Mirror(table) => mirror::encode(table),
        Table::Scatter(table) => scatter::encode(table, threads),
    }
}

/// The table in the bytes of an EXR file.
pub fn decode(bytes: &[u8]) -> Result<Table> {
    let mut file = Opened::new(bytes)?;
    let kind = file.take(KIND)?;
    match kind.as_str() {
        mirror::MIRROR => mirror::decode(file).map(Table::Mirror),
        scatter::SCATTER => scatter::decode(file).map(Table::Scatter),
        _ => Err(Error::failed(format_args!(
            "{PREFIX}{KIND} is \"{kind}\"; this version reads \"mirror\" and \"scatter\""
        ))),
    }
}
