//! The option `--thickness`: which thickness of a table over them, or where on a body the film has which.

use std::path::{Path, PathBuf};

use crate::render::thickness::{Swirls, ThicknessMap};
use crate::support::error::{Error, Result};
use crate::support::grey_map;
use crate::table::Table;
use crate::table::mirror::ThicknessAxis;

/// The table of one surface: the table itself, or that of one thickness of its layer.
///
/// # Errors
/// A table over a thickness without the option, one of a single surface with it, or a thickness out of range.
pub(super) fn one_surface(table: Table, thickness_nm: Option<f64>) -> Result<Table> {
    let nm = match (axis(&table, thickness_nm.is_some())?, thickness_nm) {
        (None, _) => return Ok(table),
        (Some(axis), None) => return Err(missing(axis, &table, "name one in nm")),
        (Some(axis), Some(nm)) => within(axis, &table, nm)?,
    };
    match table {
        Table::Mirror(mirror) => Ok(mirror.at_thickness(nm).into()),
        other => Ok(other),
    }
}

/// The file that `--thickness` names, if it names one.
pub(super) fn map_file(word: Option<&str>) -> Option<PathBuf> {
    word.filter(|word| !["drain", "noise"].contains(word) && word.parse::<f64>().is_err()).map(PathBuf::from)
}

/// Where the film of a table is how thick; `None` for a table of one surface.
///
/// # Errors
/// As of [`one_surface`], or a map that cannot be read.
pub(super) fn thickness(word: Option<&str>, table: &Table) -> Result<Option<ThicknessMap>> {
    let (axis, word) = match (axis(table, word.is_some())?, word) {
        (None, _) => return Ok(None),
        (Some(axis), None) => {
            return Err(missing(axis, table, "name one in nm, drain, noise or a greyscale picture"));
        }
        (Some(axis), Some(word)) => (axis, word),
    };
    let map = match (word, word.parse::<f64>()) {
        ("drain", _) => ThicknessMap::Drain,
        ("noise", _) => ThicknessMap::Noise(Swirls::default()),
        (_, Ok(nm)) => {
            let [first, last] = axis.range_nm();
            ThicknessMap::Even((within(axis, table, nm)? - first) / (last - first))
        }
        (file, Err(_)) => ThicknessMap::Picture(grey_map::read(Path::new(file)).map_err(|error| {
            Error::failed(format_args!("{error}; a thickness is a number in nm, drain, noise or a greyscale picture"))
        })?),
    };
    Ok(Some(map))
}

/// The thicknesses of a table, if it has several; refuses the option for others.
fn axis(table: &Table, given: bool) -> Result<Option<&ThicknessAxis>> {
    let axis = if let Table::Mirror(mirror) = table { mirror.thickness.as_ref() } else { None };
    if given && axis.is_none() {
        return Err(Error::usage(format_args!(
            "--thickness: the table of {} has one surface; leave it out, or make a table over a thickness by `estimate --vary`",
            table.name()
        )));
    }
    Ok(axis)
}

/// The error for a table over a thickness without the option.
fn missing(axis: &ThicknessAxis, table: &Table, remedy: &str) -> Error {
    let [first, last] = axis.range_nm();
    Error::usage(format_args!(
        "--thickness is missing: the table of {} is over {first} to {last} nm of layer {}; {remedy}",
        table.name(),
        axis.layer
    ))
}

/// Refuses a thickness that the table does not have.
fn within(axis: &ThicknessAxis, table: &Table, nm: f64) -> Result<f64> {
    let [first, last] = axis.range_nm();
    if (first..=last).contains(&nm) {
        return Ok(nm);
    }
    Err(Error::usage(format_args!(
        "--thickness {nm}: the table of {} has {first} to {last} nm of layer {}",
        table.name(),
        axis.layer
    )))
}
