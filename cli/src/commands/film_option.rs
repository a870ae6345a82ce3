//! The options `--thickness` and `--body` of `render` and `view`: how a film lies on a body.

use std::path::{Path, PathBuf};

use crate::commands::args::BodyArg;
use crate::render::thickness::{Swirls, ThicknessMap};
use crate::support::error::{Error, Result};
use crate::support::grey_map;
use crate::table::Table;
use crate::table::metadata::MetadataKey;
use crate::table::mirror::{MirrorTable, ThicknessAxis};

/// The file that `--thickness` names, if it names one.
pub(super) fn map_file(word: Option<&str>) -> Option<PathBuf> {
    word.filter(|word| !["drain", "noise"].contains(word) && word.parse::<f64>().is_err()).map(PathBuf::from)
}

/// Where the film of a table is how thick.
///
/// # Errors
/// A table over a thickness without the option, one of a single surface with it, a thickness out of range, or a map
/// that cannot be read.
pub(super) fn thickness(word: Option<&str>, table: &Table) -> Result<Option<ThicknessMap>> {
    let axis = if let Table::Mirror(mirror) = table { mirror.thickness.as_ref() } else { None };
    let (axis, word) = match (axis, word) {
        (None, None) => return Ok(None),
        (None, Some(_)) => {
            return Err(Error::usage(format_args!(
                "--thickness: the table of {} has one surface; leave it out, or make a table over a thickness by \
                 `estimate --vary`",
                table.name()
            )));
        }
        (Some(axis), None) => {
            let ThicknessAxis { layer, .. } = axis;
            let [first, last] = axis.range_nm();
            return Err(Error::usage(format_args!(
                "--thickness is missing: the table of {} is over {first} to {last} nm of layer {layer}; name one in nm, drain, \
                 noise or a greyscale picture",
                table.name()
            )));
        }
        (Some(axis), Some(word)) => (axis, word),
    };
    let [first, last] = axis.range_nm();
    match (word, word.parse::<f64>()) {
        ("drain", _) => Ok(Some(ThicknessMap::Drain)),
        ("noise", _) => Ok(Some(ThicknessMap::Noise(Swirls::default()))),
        (_, Ok(nm)) if (first..=last).contains(&nm) => Ok(Some(ThicknessMap::Even((nm - first) / (last - first)))),
        (_, Ok(nm)) => Err(Error::usage(format_args!(
            "--thickness {nm}: the table of {} has {first} to {last} nm of layer {}",
            table.name(),
            axis.layer
        ))),
        (file, Err(_)) => {
            grey_map::read(Path::new(file)).map(|map| Some(ThicknessMap::Picture(map))).map_err(|error| {
                Error::failed(format_args!(
                    "{error}; a thickness is a number in nm, drain, noise or a greyscale picture"
                ))
            })
        }
    }
}

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
