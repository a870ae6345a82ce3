//! The option `--body` of `render` and `view`.

use crate::commands::args::BodyArg;
use crate::support::error::{Error, Result};
use crate::table::Table;
use crate::table::metadata::MetadataKey;
use crate::table::mirror::MirrorTable;

/// Whether the surface of a table is shown as a sheet, through which light goes: as the option says, else where the
/// medium behind a film is the one in front of it.
///
/// # Errors
/// A sheet of what is none.
pub(super) fn is_sheet(body: Option<BodyArg>, table: &Table) -> Result<bool> {
    let through = matches!(table, Table::Mirror(MirrorTable { transmittance_s, .. }) if !transmittance_s.is_empty());
    let has_sheet = through && table.metadata().get(MetadataKey::Backing) == Some("ambient");
    match body {
        None => Ok(has_sheet),
        Some(BodyArg::Solid) => Ok(false),
        Some(BodyArg::Sheet) if has_sheet => Ok(true),
        Some(BodyArg::Sheet) => Err(Error::usage(format_args!(
            "--body sheet: the table of {} holds no light that goes on in the medium in front of the surface; a sheet is a film \
             with one clear medium on both sides",
            table.name()
        ))),
    }
}
