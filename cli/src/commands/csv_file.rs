//! CSV files.

use std::path::Path;

use crate::solve::precision::Precision;
use crate::support::error::{Error, Result};
use crate::support::output;

/// Writes rows of text as CSV.
pub(super) fn write_csv(path: &Path, header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Result<()> {
    let failed = |error| Error::failed(format_args!("{}: {error}", path.display()));
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(header).map_err(failed)?;
    for row in rows {
        writer.write_record(&row).map_err(failed)?;
    }
    let bytes = writer.into_inner().map_err(|error| Error::failed(error.error()))?;
    output::write_text(path, &String::from_utf8_lossy(&bytes))
}

/// The shortest text that gives the number back at its precision.
pub(super) fn number(x: f64, precision: Precision) -> String {
    match precision {
        Precision::F32 => (x as f32).to_string(),
        Precision::F64 => x.to_string(),
    }
}
