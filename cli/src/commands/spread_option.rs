//! The option `--spread` of `render` and `view`.

use crate::render::spread::Spread;
use crate::support::error::{Error, Result};
use crate::table::Table;

/// The width of a table's diffraction orders or facet lobes; `None` for sharp ones.
///
/// # Errors
/// A width out of range, or one of a table without either.
pub(super) fn spread(degrees: f64, table: &Table) -> Result<Option<Spread>> {
    if degrees == 0.0 {
        return Ok(None);
    }
    let width = Spread::new(degrees)?;
    let is_sharp = match table {
        Table::Orders(_) => true,
        Table::Scatter(scatter) => !scatter.lobes.is_empty(),
        Table::Mirror(_) => false,
    };
    if is_sharp {
        return Ok(Some(width));
    }
    Err(Error::usage(format_args!(
        "--spread: the table of {} has no diffraction orders or facet lobes to spread; leave it out",
        table.name()
    )))
}
