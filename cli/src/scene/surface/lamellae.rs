//! Ridge along y that carries shelves on both sides, like those on the scales of Morpho butterflies.
//!
//! A trunk `trunk_nm` wide stands in the middle of the period on a flat base at z = 0. It carries `shelves` shelves on
//! either side, `shelf_nm` thick and `gap_nm` apart; the lowest lies a gap above the base. Those on the right lie
//! `stagger_nm` higher, less than a gap. From tip to tip the lowest shelves measure `width_nm`, the highest
//! `top_width_nm`, the others between. The trunk ends half a gap above the highest shelf. Shelves and trunk are one
//! body of rectangles, without faces inside.

use super::builder::{Builder, bounded};
use super::keys::{count, length, positive, within};
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    let keys = ["kind", "shelves", "width_nm", "top_width_nm", "shelf_nm", "gap_nm", "trunk_nm", "stagger_nm"];
    table.allow(&keys)?;
    let shelves = count(&table.require("shelves", "shelves = 8")?, [1, 1000])?;
    let [width, shelf, gap, trunk] =
        [length(table, "width_nm")?, length(table, "shelf_nm")?, length(table, "gap_nm")?, length(table, "trunk_nm")?];
    let top_width = table.get("top_width_nm").map_or(Ok(width), |item| positive(&item))?;
    let stagger = table.get("stagger_nm").map_or(Ok(0.0), |item| within(&item, [0.0, gap]))?;
    let period = builder.period_nm[0];
    if !(trunk < width.min(top_width) && width.max(top_width) < period) {
        return Err(table.refuse(format_args!(
            "trunk_nm = {trunk} must be less than width_nm and top_width_nm, and these less than the period, {period} nm"
        )));
    }
    bounded(table, 16 * u64::from(shelves) + 16)?;
    let middle = 0.5 * period;
    let bottom = |i: u32, raised: f64| raised + gap + f64::from(i) * (shelf + gap);
    let tip = |i: u32| {
        let up = if shelves > 1 { f64::from(i) / f64::from(shelves - 1) } else { 0.0 };
        0.5 * (width + (top_width - width) * up)
    };
    let top = bottom(shelves - 1, stagger) + shelf + 0.5 * gap;
    // One side of the ridge, from the base to the top of the trunk; `side` is −1 on the left.
    let outline = |side: f64, raised: f64| {
        let mut points = vec![[middle + side * 0.5 * trunk, 0.0]];
        for i in 0..shelves {
            let (low, high) = (bottom(i, raised), bottom(i, raised) + shelf);
            let (inner, outer) = (middle + side * 0.5 * trunk, middle + side * tip(i));
            points.extend([[inner, low], [outer, low], [outer, high], [inner, high]]);
        }
        points.push([middle + side * 0.5 * trunk, top]);
        points
    };
    let mut profile = vec![[0.0, 0.0]];
    profile.extend(outline(-1.0, 0.0));
    profile.extend(outline(1.0, stagger).into_iter().rev());
    profile.push([period, 0.0]);
    builder.extrude(&profile, 0);
    Ok(())
}
