//! The option `--thickness` of commands that take a table of one surface.

use crate::support::error::{Error, Result};
use crate::table::Table;

/// The table of one surface: the table itself, or that of one thickness of its layer.
///
/// # Errors
/// A table over a thickness without the option, one of a single surface with it, or a thickness out of range.
pub(super) fn one_surface(table: Table, thickness_nm: Option<f64>) -> Result<Table> {
    let axis = if let Table::Mirror(mirror) = &table { mirror.thickness.as_ref() } else { None };
    match (axis, thickness_nm) {
        (None, None) => Ok(table),
        (None, Some(_)) => Err(Error::usage(format_args!(
            "--thickness: the table of {} has one surface; leave it out, or make a table over a thickness by `estimate --vary`",
            table.name()
        ))),
        (Some(axis), given) => {
            let [first, last] = axis.range_nm();
            match (&table, given) {
                (Table::Mirror(mirror), Some(nm)) if (first..=last).contains(&nm) => Ok(mirror.at_thickness(nm).into()),
                (_, Some(nm)) => Err(Error::usage(format_args!(
                    "--thickness {nm}: the table of {} has {first} to {last} nm of layer {}",
                    table.name(),
                    axis.layer
                ))),
                (_, None) => Err(Error::usage(format_args!(
                    "--thickness is missing: the table of {} is over {first} to {last} nm of layer {}; name one in nm",
                    table.name(),
                    axis.layer
                ))),
            }
        }
    }
}
