//! The option `--spread` of `render` and `view`.

use crate::render::spread::Spread;
use crate::support::error::{Error, Result};
use crate::table::Table;

/// The width of a table's diffraction orders; `None` for sharp ones.
///
/// # Errors
/// A width out of range, or one of a table without orders.
pub(super) fn spread(degrees: f64, table: &Table) -> Result<Option<Spread>> {
    if degrees == 0.0 {
        return Ok(None);
    }
    let width = Spread::new(degrees)?;
    if matches!(table, Table::Orders(_)) {
        Ok(Some(width))
    } else {
        Err(Error::usage(format_args!("--spread: the table of {} has no diffraction orders to spread", table.name())))
    }
}
