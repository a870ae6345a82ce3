//! Sum of periodic sines: a smooth bumpy sheet.
//!
//! z = Σ a sin(2π(m x/Λx + n y/Λy) + φ), with `waves` different random pairs of integers 0 < m² + n² ≤ `highest`² and
//! random phases. Each wave has an equal part of the mean square slope ⟨|∇z|²⟩ = `rms_slope`². `grid` counts the
//! squares of the mesh along x and y: at least four to a period of the shortest wave. With `offset_nm` a second sheet
//! `lower` follows the first that far below: a film whose thickness across a facet is offset_nm times the cosine of its
//! slope.

use std::f64::consts::TAU;

use super::builder::{Builder, bounded};
use super::keys::{count, counts, positive, within};
use super::random::RandomSequence;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

pub(super) fn interfaces(table: &TomlTable<'_>) -> &'static [&'static str] {
    if table.get("offset_nm").is_some() { &["upper", "lower"] } else { &["upper"] }
}

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "waves", "highest", "rms_slope", "grid", "seed", "offset_nm"])?;
    let waves_item = table.require("waves", "waves = 12")?;
    let waves = count(&waves_item, [1, 1000])?;
    let highest = count(&table.require("highest", "highest = 4")?, [1, 100])?;
    let rms_slope = within(&table.require("rms_slope", "rms_slope = 0.35")?, [0.0, 10.0])?;
    let grid = counts::<2>(table, "grid", 10_000)?;
    let offset_nm = table.get("offset_nm").map(|item| positive(&item)).transpose()?;
    let mut random = RandomSequence::read(table)?;
    if grid.iter().any(|&n| n < 4 * highest) {
        return Err(table.refuse(format_args!("grid must be at least 4 times highest, {} squares", 4 * highest)));
    }
    let sheets = 1 + u64::from(offset_nm.is_some());
    bounded(table, 2 * sheets * u64::from(grid[0]) * u64::from(grid[1]))?;

    // One of each pair (m, n), (−m, −n): they are the same wave.
    let reach = f64::from(highest);
    let max = highest as i32; // at most 100
    let mut pairs: Vec<[f64; 2]> = (0..=max)
        .flat_map(|m| (-max..=max).map(move |n| (m, n)))
        .filter(|&(m, n)| m > 0 || n > 0)
        .map(|(m, n)| [f64::from(m), f64::from(n)])
        .filter(|[m, n]| m * m + n * n <= reach * reach)
        .collect();
    if pairs.len() < waves as usize {
        return Err(waves_item.refuse(format_args!(
            "there are only {} waves with highest = {highest}; use fewer or a larger highest",
            pairs.len()
        )));
    }
    let [width, depth] = builder.period_nm;
    let amplitude_over_length = rms_slope * (2.0 / f64::from(waves)).sqrt();
    let waves: Vec<[f64; 4]> = (0..waves)
        .map(|_| {
            let pick = (random.unit() * pairs.len() as f64) as usize;
            let [m, n] = pairs.swap_remove(pick.min(pairs.len() - 1));
            let wavenumber = TAU * (m / width).hypot(n / depth);
            [m, n, random.unit(), amplitude_over_length / wavenumber]
        })
        .collect();
    let height = |u: f64, v: f64| -> f64 {
        waves.iter().map(|[m, n, phase, amplitude]| amplitude * (TAU * (m * u + n * v + phase)).sin()).sum()
    };
    builder.height_field(grid, 0, height);
    if let Some(offset_nm) = offset_nm {
        builder.height_field(grid, 1, |u, v| height(u, v) - offset_nm);
    }
    Ok(())
}
