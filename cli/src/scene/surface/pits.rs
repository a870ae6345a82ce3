//! Concave spherical caps on a hexagonal lattice, each filling its hexagonal cell.
//!
//! The period is √3 to 1 and holds two pits, one around its corners and one around its centre; neighbours are Λy
//! apart. `depth_nm` is the height of a cell's corners, at 0, over the bottom of its pit; at most their distance Λy/√3.
//! `rings` (40) is the number of triangles from the middle of a pit to its corner. Scattered light shows facets of few
//! rings as such: in 16 × 32 bins 8 rings are 28 % off 16, and 40 are 3 % off 80.

use glam::DVec3;

use super::builder::{Builder, bounded};
use super::keys::{count, length};
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

/// Fraction by which the period may differ from √3 to 1: numbers rounded to whole nanometres.
const RATIO: f64 = 1e-3;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "depth_nm", "rings"])?;
    let depth_nm = length(table, "depth_nm")?;
    let rings = table.get("rings").map_or(Ok(40), |item| count(&item, [1, 200]))?;
    let [width, pitch] = builder.period_nm;
    let wanted = 3f64.sqrt() * pitch;
    if (width / wanted - 1.0).abs() > RATIO {
        return Err(table.refuse(format_args!("pits need a period_nm of √3 to 1: [{wanted:.1}, {pitch}]")));
    }
    let corner_nm = pitch / 3f64.sqrt();
    if depth_nm > corner_nm {
        return Err(table.refuse(format_args!(
            "depth_nm = {depth_nm} is more than the distance from the middle of a pit to its corner, {corner_nm:.1} nm"
        )));
    }
    bounded(table, 12 * u64::from(rings) * (3 * u64::from(rings) + 1))?;

    let radius = (corner_nm * corner_nm + depth_nm * depth_nm) / (2.0 * depth_nm);
    let centres = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.5)];
    let height = |x: f64, y: f64| {
        let squared = |(u, v): (f64, f64)| (x - u * width).powi(2) + (y - v * pitch).powi(2);
        let nearest = centres.into_iter().map(squared).fold(f64::INFINITY, f64::min);
        radius - (radius * radius - nearest).max(0.0).sqrt() - depth_nm
    };
    // Rows of equilateral triangles; ridges run along them. Odd rows are shifted by half a step, with an extra point on
    // either border.
    let steps = 3 * rings;
    let rows: Vec<Vec<u32>> = (0..=2 * rings)
        .map(|j| {
            let y = pitch * f64::from(j) / f64::from(2 * rings);
            let shift = if j % 2 == 0 { 0.0 } else { 0.5 };
            let inner = (0..steps).map(|i| (f64::from(i) + shift) / f64::from(steps));
            let border = (j % 2 == 1).then_some(0.0);
            let fractions: Vec<f64> = border.into_iter().chain(inner).chain([1.0]).collect();
            let symmetric = y.min(pitch - y); // the first and last row, and the two borders, agree to the last digit
            fractions
                .into_iter()
                .map(|u| {
                    let x = width * u;
                    builder.vertex(DVec3::new(x, y, height(x.min(width - x), symmetric)))
                })
                .collect()
        })
        .collect();
    for (j, pair) in rows.windows(2).enumerate() {
        let (even, odd, odd_on_top) = if j % 2 == 0 { (&pair[0], &pair[1], true) } else { (&pair[1], &pair[0], false) };
        let mut add = |[a, b, c]: [u32; 3]| builder.triangle(if odd_on_top { [a, b, c] } else { [a, c, b] }, 0);
        for i in 0..steps as usize {
            add([even[i], odd[i + 1], odd[i]]);
            add([even[i], even[i + 1], odd[i + 1]]);
        }
        add([even[steps as usize], odd[steps as usize + 1], odd[steps as usize]]);
    }
    Ok(())
}
