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
use crate::table::mirror::MirrorTable;
use crate::table::scatter::ScatterTable;
use container::{KIND, Opened};
pub(crate) use container::{PREFIX, sort_attributes};

/// A table of either kind.
#[derive(Debug, Clone, PartialEq)]
pub enum Table {
    /// Of a mirror-like surface.
    Mirror(MirrorTable),
    /// Of a cell of tilted facets.
    Scatter(ScatterTable),
}

impl From<MirrorTable> for Table {
    fn from(table: MirrorTable) -> Self {
        Self::Mirror(table)
    }
}

impl From<ScatterTable> for Table {
    fn from(table: ScatterTable) -> Self {
        Self::Scatter(table)
    }
}

impl Table {
    /// Refuses sizes that do not fit together and numbers that cannot be.
    pub fn check(&self) -> Result<()> {
        match self {
            Self::Mirror(table) => table.check(),
            Self::Scatter(table) => table.check(),
        }
    }

    /// The scene that the table was made from.
    #[must_use]
    pub fn name(&self) -> &str {
        let metadata = match self {
            Self::Mirror(table) => &table.metadata,
            Self::Scatter(table) => &table.metadata,
        };
        metadata.get("scene").map_or("table", String::as_str)
    }
}

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
