//! Profile extruded along y: gratings, tracks of optical discs, blazed and triangular grooves.
//!
//! Straight lines join `points_nm = [[x, z], …]` from x = 0 to x = Λx. They may be vertical or overhang. Where the last
//! height is not the first, a vertical wall stands on the border of the period.

use super::builder::{Builder, bounded};
use super::keys::list;
use crate::scene::parts::MAX_LENGTH_NM;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "points_nm"])?;
    let item = table.require("points_nm", "points_nm = [[0, 0], [500, 100], [1000, 0]]")?;
    let mut profile: Vec<[f64; 2]> = Vec::new();
    let width = builder.period_nm[0];
    for point in item.array()? {
        let [x, z] = list::<2>(&point)?;
        let (x_nm, z_nm) = (x.number()?, z.number()?);
        if !(0.0..=width).contains(&x_nm) {
            return Err(x.refuse(format_args!("x = {x_nm} is outside the period, 0 to {width} nm")));
        }
        if z_nm.abs() > MAX_LENGTH_NM {
            return Err(z.refuse(format_args!("z = {z_nm} is more than {MAX_LENGTH_NM} nm, a metre")));
        }
        if profile.last() == Some(&[x_nm, z_nm]) {
            return Err(point.refuse("the point stands twice; remove one"));
        }
        profile.push([x_nm, z_nm]);
    }
    bounded(table, 2 * profile.len() as u64)?;
    match (profile.first(), profile.last()) {
        (Some(&[0.0, first]), Some(&[x, last])) if x == width => {
            if last != first {
                profile.push([width, first]);
            }
        }
        _ => return Err(item.refuse(format_args!("the profile must reach from x = 0 to x = {width} nm"))),
    }
    builder.extrude(&profile, 0);
    Ok(())
}
