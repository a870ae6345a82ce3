//! Random heights along x, extruded along y: brushed metal.
//!
//! `segments` facets of equal width have normally distributed random slopes. Their root mean square is exactly
//! `rms_slope`, and their sum is 0, so that both ends of the period are level.

use super::builder::{Builder, bounded};
use super::keys::{count, within};
use super::random::RandomSequence;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "segments", "rms_slope", "seed"])?;
    let segments = count(&table.require("segments", "segments = 200")?, [2, 100_000])?;
    let rms_slope = within(&table.require("rms_slope", "rms_slope = 0.1")?, [0.0, 10.0])?;
    bounded(table, 2 * u64::from(segments))?;
    let mut random = RandomSequence::read(table)?;
    let mut slopes: Vec<f64> = (0..segments).map(|_| random.normal()).collect();
    let mean = slopes.iter().sum::<f64>() / f64::from(segments);
    slopes.iter_mut().for_each(|slope| *slope -= mean);
    let rms = (slopes.iter().map(|slope| slope * slope).sum::<f64>() / f64::from(segments)).sqrt();
    let width = builder.period_nm[0];
    let step = width / f64::from(segments);
    let mut z = 0.0;
    let mut profile = vec![[0.0, 0.0]];
    for (i, slope) in (1..segments).zip(&slopes) {
        z += slope / rms * rms_slope * step;
        profile.push([f64::from(i) * step, z]);
    }
    profile.push([width, 0.0]);
    builder.extrude(&profile, 0);
    Ok(())
}
