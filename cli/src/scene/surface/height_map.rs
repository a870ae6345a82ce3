//! Measured heights: the map of an atomic force microscope or of an interferometer.
//!
//! `file` is a PNG, OpenEXR, TIFF or NPY file of one channel; its top row has the largest y. Integers from 0 to the
//! largest of their type become 0 to `height_nm`. Floating-point numbers are heights in nanometres; with `height_nm`
//! they are scaled to that range. `[cell] period_nm` is the period of the surface, by `edges`: `"mirror"` reflects the
//! map in x and y, so the map spans half a period; with `"wrap"` the map spans the period and must join at its edges.
//! `level` (true; false with `"wrap"`) subtracts the least-squares plane. `grid` counts the squares of the mesh, at
//! most 512 a side and at most the pixels of a period; each vertex is the mean over its part of the period.

use super::builder::Builder;
use super::keys::{counts, positive};
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;
use crate::support::grey_map::{self, GreyMap};

/// Maximum number of squares along a side, and the number without `grid`.
const MAX_SQUARES: usize = 512;
const DEFAULT_SQUARES: usize = 128;

/// Maximum rms slope, as of sines: steeper maps have another unit than their period.
const MAX_RMS_SLOPE: f64 = 10.0;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "file", "height_nm", "edges", "level", "grid"])?;
    let file = table.require("file", "file = \"map.tiff\"")?;
    let height_nm = table.get("height_nm").map(|item| positive(&item)).transpose()?;
    let mirror = match table.get("edges") {
        None => true,
        Some(item) => match item.text()? {
            "mirror" => true,
            "wrap" => false,
            other => return Err(item.refuse(format_args!("{other:?} is unknown; write \"mirror\" or \"wrap\""))),
        },
    };
    let level = table.get("level").map(|item| item.flag()).transpose()?.unwrap_or(mirror);
    let map = grey_map::read(&(builder.find)(&file)?)?;
    let pixels = map.size.map(|n| if mirror { 2 * n } else { n });
    let grid = match table.get("grid") {
        None => pixels.map(|n| n.min(DEFAULT_SQUARES)),
        Some(_) => counts::<2>(table, "grid", MAX_SQUARES as u32)?.map(|n| n as usize),
    };
    if grid[0] > pixels[0] || grid[1] > pixels[1] {
        let [x, y] = pixels;
        return Err(table.refuse(format_args!("grid has more squares than a period has pixels, {x} × {y}; use fewer")));
    }
    if map.integer && height_nm.is_none() {
        return Err(table.refuse("the map holds integers; write height_nm, the height of the largest"));
    }
    let heights = heights(&map, height_nm, level);
    let nodes = resampled(&heights, map.size, mirror, grid);
    let [nx, ny] = grid;
    let step = [0, 1].map(|axis| builder.period_nm[axis] / grid[axis] as f64);
    let square: f64 = (0..nx * ny)
        .map(|k| {
            let (i, j) = (k % nx, k / nx);
            let along_x = (nodes[j * nx + (i + 1) % nx] - nodes[k]) / step[0];
            let along_y = (nodes[(j + 1) % ny * nx + i] - nodes[k]) / step[1];
            along_x * along_x + along_y * along_y
        })
        .sum();
    let slope = (square / (nx * ny) as f64).sqrt();
    if slope.is_nan() || slope > MAX_RMS_SLOPE {
        return Err(file.refuse(format_args!(
            "the rms slope is {slope:.3}; at most {MAX_RMS_SLOPE}; heights and period_nm are in nm"
        )));
    }
    let index = |u: f64, n: usize| ((u * n as f64).round() as usize).min(n - 1);
    builder.height_field(grid.map(|n| n as u32), 0, |u, v| nodes[index(v, ny) * nx + index(u, nx)]);
    Ok(())
}

/// Heights in nanometres, row by row from the bottom.
fn heights(map: &GreyMap, height_nm: Option<f64>, level: bool) -> Vec<f64> {
    let [width, height] = map.size;
    let values = || map.values.iter().map(|&x| f64::from(x));
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let (from, factor) = match height_nm {
        None => (0.0, 1.0),
        Some(height_nm) if map.integer => (0.0, height_nm),
        Some(height_nm) => (low, if high > low { height_nm / (high - low) } else { 0.0 }),
    };
    let rows = map.values.chunks_exact(width).rev().flatten();
    let mut heights: Vec<f64> = rows.map(|&x| (f64::from(x) - from) * factor).collect();
    if level {
        // On a full grid the plane's two slopes and its mean are independent.
        let place =
            |k: usize| [(k % width) as f64 - (width - 1) as f64 / 2.0, (k / width) as f64 - (height - 1) as f64 / 2.0];
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let slope = [0, 1].map(|axis| {
            let (zx, xx) = heights.iter().enumerate().fold((0.0, 0.0), |(zx, xx), (k, z)| {
                let x = place(k)[axis];
                (zx + x * (z - mean), xx + x * x)
            });
            if xx > 0.0 { zx / xx } else { 0.0 }
        });
        for (k, z) in heights.iter_mut().enumerate() {
            let [x, y] = place(k);
            *z -= mean + slope[0] * x + slope[1] * y;
        }
    }
    heights
}

/// Means of a periodic map over the boxes of a grid.
fn resampled(heights: &[f64], [width, height]: [usize; 2], mirror: bool, [nx, ny]: [usize; 2]) -> Vec<f64> {
    let columns = boxes(width, mirror, nx);
    let rows = boxes(height, mirror, ny);
    let narrow: Vec<f64> = heights
        .chunks_exact(width)
        .flat_map(|row| columns.iter().map(|parts| parts.iter().map(|&(at, part)| part * row[at]).sum::<f64>()))
        .collect();
    rows.iter()
        .flat_map(|parts| {
            (0..nx).map(|i| parts.iter().map(|&(at, part)| part * narrow[at * nx + i]).sum::<f64>()).collect::<Vec<_>>()
        })
        .collect()
}

/// Pixels under each of `count` equal boxes of a period, with their parts of the box.
fn boxes(pixels: usize, mirror: bool, count: usize) -> Vec<Vec<(usize, f64)>> {
    let period = if mirror { 2 * pixels } else { pixels };
    // In units of 1/count of a pixel all borders are integers.
    (0..count)
        .map(|k| {
            let (start, end) = (k * period, (k + 1) * period);
            (start / count..end.div_ceil(count))
                .map(|at| {
                    let overlap = end.min((at + 1) * count) - start.max(at * count);
                    let pixel = if at < pixels { at } else { period - 1 - at };
                    (pixel, overlap as f64 / period as f64)
                })
                .collect()
        })
        .collect()
}
