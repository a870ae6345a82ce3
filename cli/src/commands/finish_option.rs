//! The options `--roughness`, `--distribution` and `--energy-compensation` of `render` and `view`.

use goniochrome::microfacet::Distribution;

use crate::commands::args::{Compensating, RoughnessArg, finish_choice};
use crate::scene::OwnedFinish;
use crate::support::error::{Error, Result};
use crate::table::Table;

/// The finish of a table's surface: by the options, else the table's own; `None` for a mirror.
///
/// # Errors
/// Options for a table that is not mirror-like, a distribution without a roughness, or damaged metadata.
pub(super) fn finish(
    roughness: Option<RoughnessArg>,
    distribution: Option<Distribution>,
    compensating: Compensating,
    table: &Table,
) -> Result<Option<OwnedFinish>> {
    let choice = finish_choice(roughness, distribution, compensating.energy_compensation);
    match table {
        Table::Mirror(table) => choice.of(&table.metadata),
        _ if choice.is_given() => Err(Error::usage(
            "--roughness, --distribution, --energy-compensation: are for mirror-like tables, and this one has directions of \
             its own; leave them out",
        )),
        _ => Ok(None),
    }
}
