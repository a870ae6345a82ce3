//! Rectangular lines of one medium along y, standing on a flat substrate of another.
//!
//! The line is `width_nm` wide and `height_nm` high, in the middle of the period; its foot stands on the substrate at
//! z = 0. The interface `line` is the line's top and sides, its normals outwards; `foot` is where it stands, from the
//! line above to the substrate below; `base` is the substrate beside it.

use super::builder::Builder;
use super::keys::length;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

/// Number of the interface of the line's top and sides.
const LINE: usize = 0;
/// Number of the interface of its foot.
const FOOT: usize = 1;
/// Number of the interface of the substrate beside it.
const BASE: usize = 2;

pub(super) const INTERFACES: &[&str] = &["line", "foot", "base"];

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "width_nm", "height_nm"])?;
    let [width, height] = [length(table, "width_nm")?, length(table, "height_nm")?];
    let period = builder.period_nm[0];
    if width >= period {
        return Err(table.refuse(format_args!("width_nm = {width} must be less than the period, {period} nm")));
    }
    let (left, right) = (0.5 * (period - width), 0.5 * (period + width));
    builder.extrude(&[[0.0, 0.0], [left, 0.0]], BASE);
    builder.extrude(&[[left, 0.0], [left, height], [right, height], [right, 0.0]], LINE);
    builder.extrude(&[[left, 0.0], [right, 0.0]], FOOT);
    builder.extrude(&[[right, 0.0], [period, 0.0]], BASE);
    Ok(())
}
