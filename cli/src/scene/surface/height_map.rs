//! Measured heights: the map of an atomic force microscope or of an interferometer.
//!
//! `file` is a PNG, OpenEXR, TIFF or NPY file of one channel; its top row has the largest y. Integers from 0 to the
//! largest of their type become 0 to `height_nm`. Floating-point numbers are heights in nanometres; with `height_nm`
//! they are scaled to that range. `size_nm`, two lengths or the width of a map of square pixels, is what the map spans;
//! the period follows from it by `edges`, and `[cell] period_nm` may be left out:
//!
//! - `"mirror"` reflects the map in x and y: the period is twice the map.
//! - `"blend"` lays an eighth of the map at each left edge over that at the right edge, and at each bottom edge over
//!   that at the top: the period is seven eighths of the map. Heights count from their mean, and weights are sine and
//!   cosine of an angle that grows linearly. Their squares add up to 1, so margins of unrelated heights keep their
//!   variance, and of all such weights these add the least slope.
//! - `"wrap"` takes a map that joins already.
//!
//! `level` (true; false with `"wrap"`) subtracts the least-squares plane. `smooth_nm` is the standard deviation of a
//! Gaussian low pass. `grid` counts the squares of the mesh, at most 512 a side and at most the pixels of a period;
//! each vertex is the mean over its part of the period.

use std::f64::consts::FRAC_PI_2;

use super::builder::Builder;
use super::keys::{counts, list, positive};
use crate::scene::parts::MAX_LENGTH_NM;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;
use crate::support::grey_map::{self, GreyMap};

/// Maximum number of squares along a side, and the number without `grid`.
const MAX_SQUARES: usize = 512;
const DEFAULT_SQUARES: usize = 128;

/// Maximum rms slope, as of sines: steeper maps have another unit than their period.
const MAX_RMS_SLOPE: f64 = 10.0;

/// Part of a map that its opposite margins share.
const BLENDED: usize = 8;

/// Largest part of the period that `smooth_nm` may be: a Gaussian of it leaves 2 % of a wave of 7 to the period.
const MAX_SMOOTH: f64 = 1.0 / 16.0;
/// Standard deviations after which a Gaussian is cut off, with a weight of 1e-6 beyond.
const REACH: f64 = 5.0;

/// Largest relative difference of two periods that agree: that of numbers written with seven digits.
const AGREED: f64 = 1e-6;

/// How opposite edges of a map become one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Edges {
    Mirror,
    Blend,
    Wrap,
}

/// Pixels of a map along an axis, and of the period that is made of them.
#[derive(Clone, Copy, Debug)]
struct Axis {
    pixels: usize,
    period: usize,
}

impl Axis {
    fn new(pixels: usize, edges: Edges) -> Self {
        let period = match edges {
            Edges::Mirror => 2 * pixels,
            Edges::Blend => pixels - pixels / BLENDED,
            Edges::Wrap => pixels,
        };
        Self { pixels, period }
    }

    /// Pixels that both margins share.
    fn overlap(self) -> usize {
        self.pixels.saturating_sub(self.period)
    }
}

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "file", "height_nm", "size_nm", "edges", "level", "smooth_nm", "grid"])?;
    let file = table.require("file", "file = \"map.tiff\"")?;
    let height_nm = table.get("height_nm").map(|item| positive(&item)).transpose()?;
    let edges = match table.get("edges") {
        None => Edges::Mirror,
        Some(item) => match item.text()? {
            "mirror" => Edges::Mirror,
            "blend" => Edges::Blend,
            "wrap" => Edges::Wrap,
            other => {
                let known = "write \"mirror\", \"blend\" or \"wrap\"";
                return Err(item.refuse(format_args!("{other:?} is unknown; {known}")));
            }
        },
    };
    let level = table.get("level").map(|item| item.flag()).transpose()?.unwrap_or(edges != Edges::Wrap);
    let map = grey_map::read(&(builder.find)(&file)?)?;
    let axes = map.size.map(|pixels| Axis::new(pixels, edges));
    if edges == Edges::Blend && axes.iter().any(|axis| axis.overlap() == 0) {
        let [x, y] = map.size;
        return Err(table.refuse(format_args!("a map of {x} × {y} pixels has no margins to blend; at least {BLENDED}")));
    }
    builder.period_nm = period_nm(table, builder.period_nm, axes)?;
    let pixel_nm = [0, 1].map(|axis| builder.period_nm[axis] / axes[axis].period as f64);
    let grid = match table.get("grid") {
        None => axes.map(|axis| axis.period.min(DEFAULT_SQUARES)),
        Some(_) => counts::<2>(table, "grid", MAX_SQUARES as u32)?.map(|n| n as usize),
    };
    if grid[0] > axes[0].period || grid[1] > axes[1].period {
        let [x, y] = axes.map(|axis| axis.period);
        return Err(table.refuse(format_args!("grid has more squares than a period has pixels, {x} × {y}; use fewer")));
    }
    let smooth_nm = match table.get("smooth_nm") {
        None => 0.0,
        Some(item) => {
            let (smooth_nm, max) = (positive(&item)?, MAX_SMOOTH * builder.period_nm[0].min(builder.period_nm[1]));
            if smooth_nm > max {
                return Err(item.refuse(format_args!(
                    "{smooth_nm} nm is more than a sixteenth of the period, and would leave little; at most {max:.4}"
                )));
            }
            smooth_nm
        }
    };
    if map.integer && height_nm.is_none() {
        return Err(table.refuse("the map holds integers; write height_nm, the height of the largest"));
    }
    let mut heights = heights(&map, height_nm);
    let tilt = if level { levelled(&mut heights, map.size) } else { [0.0; 2] };
    let measured = rms(&heights);
    if edges == Edges::Blend {
        blend(&mut heights, axes);
    }
    let nodes = resampled(&heights, axes, grid, pixel_nm.map(|pixel| smooth_nm / pixel));
    let slope = rms_slope(&nodes, grid, builder.period_nm);
    if slope.is_nan() || slope > MAX_RMS_SLOPE {
        return Err(file.refuse(format_args!(
            "the rms slope is {slope:.3}; at most {MAX_RMS_SLOPE}; heights and lengths are in nm"
        )));
    }
    let [nx, ny] = grid;
    let index = |u: f64, n: usize| ((u * n as f64).round() as usize).min(n - 1);
    builder.height_field(grid.map(|n| n as u32), 0, |u, v| nodes[index(v, ny) * nx + index(u, nx)]);
    let tilt = (tilt[0] / pixel_nm[0]).hypot(tilt[1] / pixel_nm[1]).atan().to_degrees();
    let removed = if level { format!("a tilt of {tilt:.3}° is removed; ") } else { String::new() };
    builder.notes.push(format!(
        "{}: {removed}{nx} × {ny} squares have an rms height of {:.4} nm ({measured:.4} in the file) and an rms slope of \
         {slope:.4}",
        file.text()?,
        rms(&nodes)
    ));
    Ok(())
}

/// Period in x and y from `size_nm` and what the scene `given`s, zeros if nothing.
fn period_nm(table: &TomlTable<'_>, given: [f64; 2], axes: [Axis; 2]) -> Result<[f64; 2]> {
    let Some(item) = table.get("size_nm") else { return Ok(given) };
    let size = if item.is_number() {
        let width = positive(&item)?;
        [width, width * axes[1].pixels as f64 / axes[0].pixels as f64]
    } else {
        let [x, y] = list::<2>(&item)?;
        [positive(&x)?, positive(&y)?]
    };
    let period = [0, 1].map(|axis| size[axis] * axes[axis].period as f64 / axes[axis].pixels as f64);
    if period.iter().any(|period| *period > MAX_LENGTH_NM) {
        return Err(item.refuse("the period is more than a metre; lengths are in nm"));
    }
    let agree = (0..2).all(|axis| (given[axis] - period[axis]).abs() <= AGREED * period[axis]);
    if given != [0.0; 2] && !agree {
        let [x, y] = period;
        return Err(
            item.refuse(format_args!("gives a period of [{x}, {y}] nm; write that as period_nm, or leave it out"))
        );
    }
    Ok(period)
}

/// Heights in nanometres, row by row from the bottom.
fn heights(map: &GreyMap, height_nm: Option<f64>) -> Vec<f64> {
    let values = || map.values.iter().map(|&x| f64::from(x));
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let (from, factor) = match height_nm {
        None => (0.0, 1.0),
        Some(height_nm) if map.integer => (0.0, height_nm),
        Some(height_nm) => (low, if high > low { height_nm / (high - low) } else { 0.0 }),
    };
    let rows = map.values.chunks_exact(map.size[0]).rev().flatten();
    rows.map(|&x| (f64::from(x) - from) * factor).collect()
}

/// Subtracts the least-squares plane, and returns its slopes along x and y in nanometres a pixel.
fn levelled(heights: &mut [f64], [width, height]: [usize; 2]) -> [f64; 2] {
    // On a full grid the plane's two slopes and its mean are independent.
    let place =
        |k: usize| [(k % width) as f64 - (width - 1) as f64 / 2.0, (k / width) as f64 - (height - 1) as f64 / 2.0];
    let mean = mean(heights);
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
    slope
}

/// Replaces the pixels of the left and of the bottom margin by their sum with those of the opposite one. The period is
/// what the map then holds from its left and its bottom edge.
fn blend(heights: &mut [f64], axes: [Axis; 2]) {
    let [x, y] = axes;
    let mean = mean(heights);
    heights.iter_mut().for_each(|z| *z -= mean);
    let weights = |at: usize, overlap: usize| (FRAC_PI_2 * (at as f64 + 0.5) / overlap as f64).sin_cos();
    for row in heights.chunks_exact_mut(x.pixels) {
        for at in 0..x.overlap() {
            let (near, far) = weights(at, x.overlap());
            row[at] = near * row[at] + far * row[x.period + at];
        }
    }
    let (rows, opposite) = heights.split_at_mut(y.period * x.pixels);
    for (k, z) in opposite.iter().enumerate() {
        let (near, far) = weights(k / x.pixels, y.overlap());
        rows[k] = near * rows[k] + far * z;
    }
}

/// Means of a periodic map over the boxes of a grid, of heights smoothed by a Gaussian of this many pixels.
fn resampled(heights: &[f64], [x, y]: [Axis; 2], [nx, ny]: [usize; 2], sigma: [f64; 2]) -> Vec<f64> {
    let columns = weights(x, nx, sigma[0]);
    let rows = weights(y, ny, sigma[1]);
    let narrow: Vec<f64> = heights
        .chunks_exact(x.pixels)
        .flat_map(|row| columns.iter().map(|parts| parts.iter().map(|&(at, part)| part * row[at]).sum::<f64>()))
        .collect();
    rows.iter()
        .flat_map(|parts| {
            (0..nx).map(|i| parts.iter().map(|&(at, part)| part * narrow[at * nx + i]).sum::<f64>()).collect::<Vec<_>>()
        })
        .collect()
}

/// Pixels that count for each of `count` equal boxes of a period, with their weights, which add up to 1.
fn weights(Axis { pixels, period }: Axis, count: usize, sigma: f64) -> Vec<Vec<(usize, f64)>> {
    let reach = (REACH * sigma) as i64;
    let gauss = |offset: i64| if offset == 0 { 1.0 } else { (-0.5 * (offset as f64 / sigma).powi(2)).exp() };
    let kernel: Vec<(i64, f64)> = (-reach..=reach).map(|offset| (offset, gauss(offset))).collect();
    let whole = period as f64 * kernel.iter().map(|(_, weight)| weight).sum::<f64>();
    // In units of 1/count of a pixel all borders are integers.
    (0..count)
        .map(|k| {
            let (start, end) = (k * period, (k + 1) * period);
            let mut all = vec![0.0; pixels];
            for at in start / count..end.div_ceil(count) {
                let overlap = end.min((at + 1) * count) - start.max(at * count);
                for (offset, weight) in &kernel {
                    let at = (at as i64 + offset).rem_euclid(period as i64) as usize;
                    let pixel = if at < pixels { at } else { period - 1 - at };
                    all[pixel] += overlap as f64 * weight / whole;
                }
            }
            all.into_iter().enumerate().filter(|(_, weight)| *weight > 0.0).collect()
        })
        .collect()
}

fn mean(heights: &[f64]) -> f64 {
    heights.iter().sum::<f64>() / heights.len() as f64
}

/// Standard deviation of heights.
fn rms(heights: &[f64]) -> f64 {
    let mean = mean(heights);
    (heights.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / heights.len() as f64).sqrt()
}

/// Root of the mean square slope along the sides of the squares of a periodic mesh.
fn rms_slope(nodes: &[f64], [nx, ny]: [usize; 2], period_nm: [f64; 2]) -> f64 {
    let step = [period_nm[0] / nx as f64, period_nm[1] / ny as f64];
    let square: f64 = (0..nx * ny)
        .map(|k| {
            let (i, j) = (k % nx, k / nx);
            let along_x = (nodes[j * nx + (i + 1) % nx] - nodes[k]) / step[0];
            let along_y = (nodes[(j + 1) % ny * nx + i] - nodes[k]) / step[1];
            along_x * along_x + along_y * along_y
        })
        .sum();
    (square / (nx * ny) as f64).sqrt()
}
