//! Square pyramids, such as alkaline etching leaves on silicon.
//!
//! The period is divided into `count` = [nx, ny] squares (it must be in that ratio). Each holds one pyramid at a random
//! place. The side of its base is a random fraction of the square's side, between the two numbers of `fill`. The rest
//! is flat, at z = 0. `angle_deg` is the slope of the faces: 54.7356° between (111) and (100) in silicon. `inverted`
//! pyramids go down.

use glam::DVec3;

use super::builder::{Builder, bounded};
use super::keys::{counts, list, within};
use super::random::RandomSequence;
use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

/// Angle between the planes (111) and (100) of a cubic crystal, arctan √2.
const ETCHED_SILICON_DEG: f64 = 54.735_610_317_245_35;

/// Largest fill that leaves a rim: a narrower rim would be of slivers.
const FULL: f64 = 0.999;

pub(super) fn build(table: &TomlTable<'_>, builder: &mut Builder<'_>) -> Result<()> {
    table.allow(&["kind", "count", "angle_deg", "fill", "inverted", "seed"])?;
    let [nx, ny] = counts::<2>(table, "count", 1000)?;
    let angle = table.get("angle_deg").map_or(Ok(ETCHED_SILICON_DEG), |item| within(&item, [1.0, 80.0]))?;
    let fill = match table.get("fill") {
        None => [1.0, 1.0],
        Some(item) => {
            let [min, max] = list::<2>(&item)?;
            let min = within(&min, [0.05, 1.0])?;
            [min, within(&max, [min, 1.0])?]
        }
    };
    let inverted = table.get("inverted").map_or(Ok(false), |item| item.flag())?;
    let mut random = RandomSequence::read(table)?;
    bounded(table, 12 * u64::from(nx) * u64::from(ny))?;
    let [width, depth] = builder.period_nm;
    let (dx, dy) = (width / f64::from(nx), depth / f64::from(ny));
    if (dx / dy - 1.0).abs() > 1e-6 {
        return Err(table.refuse(format_args!("a square of {dx} by {dy} nm; make count and period_nm of one ratio")));
    }
    let steepness = angle.to_radians().tan() * if inverted { -1.0 } else { 1.0 };
    for j in 0..ny {
        for i in 0..nx {
            let part = random.between(fill[0], fill[1]);
            // Never at the edge of its square: the rim keeps an area on each side.
            let (shift_x, shift_y) = (random.between(0.1, 0.9), random.between(0.1, 0.9));
            let (left, front) = (f64::from(i) * dx, f64::from(j) * dy);
            let right = if i + 1 == nx { width } else { f64::from(i + 1) * dx };
            let back = if j + 1 == ny { depth } else { f64::from(j + 1) * dy };
            let mut square = |[left, right]: [f64; 2], [front, back]: [f64; 2]| {
                [(left, front), (right, front), (right, back), (left, back)]
                    .map(|(x, y)| builder.vertex(DVec3::new(x, y, 0.0)))
            };
            let outer = square([left, right], [front, back]);
            let mut base = ([left, right], [front, back]);
            let mut inner = outer;
            if part < FULL {
                let (x, y) = (left + shift_x * (1.0 - part) * dx, front + shift_y * (1.0 - part) * dy);
                base = ([x, x + part * dx], [y, y + part * dy]);
                inner = square(base.0, base.1);
            }
            let ([x0, x1], [y0, y1]) = base;
            let apex = DVec3::new(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.25 * (x1 - x0 + y1 - y0) * steepness);
            let apex = builder.vertex(apex);
            for side in 0..4 {
                let next = (side + 1) % 4;
                if part < FULL {
                    builder.quad([outer[side], outer[next], inner[next], inner[side]], 0);
                }
                builder.triangle([inner[side], inner[next], apex], 0);
            }
        }
    }
    Ok(())
}
