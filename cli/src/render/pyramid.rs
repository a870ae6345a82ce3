//! The light around a body at several sharpnesses, for previews.
//!
//! Filtered importance sampling (J. Křivánek, M. Colbert, "Real-time shading with filtered importance sampling", EGSR
//! 2008) looks up each sample of probability density p among N in the mean of the light over the solid angle 1/(N p),
//! for which the sample stands. Means over squares of sides 2^k texels are computed beforehand. The light is divided
//! by polar angle and azimuth, with the solid angle of each cell; rows near the poles, whose cells are narrow, are
//! averaged along the row until all cells are as wide as high. Even light stays exactly even.

use std::f64::consts::PI;

use glam::DVec3;

use super::environment::{Environment, EnvironmentLight};
use super::latlong::LatLong;
use super::spread::cells;
use crate::support::error::{Error, Result};

/// Rows of the sharpest level, 0.35° each, unless an image has its own. What is sharper is looked up in the light
/// itself.
const ROWS: usize = 512;
/// Rows of the sharpest level of an image of many texels.
const MAX_ROWS: usize = 2048;
/// Rows of the last level, 45° each.
const LAST_ROWS: usize = 4;

/// An environment with its blurred copies.
pub(super) struct Pyramid<'a> {
    environment: &'a Environment,
    /// From the sharpest, each half as high as the one before.
    levels: Vec<LatLong>,
}

impl<'a> Pyramid<'a> {
    /// Blurs an environment.
    ///
    /// # Errors
    /// Too little memory.
    pub fn new(environment: &'a Environment) -> Result<Self> {
        if environment.is_uniform() {
            return Ok(Self { environment, levels: Vec::new() });
        }
        let mut rows = match environment.light() {
            EnvironmentLight::Image(image) => image.size()[1].next_power_of_two().clamp(LAST_ROWS, MAX_ROWS),
            _ => ROWS,
        };
        let [red, green, blue] = cells(environment.light(), rows)?;
        let mut texels: Vec<[f32; 3]> =
            red.into_iter().zip(green).zip(blue).map(|((red, green), blue)| [red, green, blue]).collect();
        let mut levels = Vec::new();
        loop {
            let level = LatLong::new([2 * rows, rows], widened(&texels, rows));
            levels.push(level.ok_or_else(|| Error::failed("the environment is not finite"))?);
            if rows <= LAST_ROWS {
                return Ok(Self { environment, levels });
            }
            texels = halved(&texels, rows);
            rows /= 2;
        }
    }

    /// Mean linear RGB radiance over about a solid angle around a unit direction of the world.
    pub fn radiance(&self, direction: DVec3, solid_angle: f64) -> [f32; 3] {
        let Some(first) = self.levels.first() else { return self.environment.radiance(direction) };
        let texel = PI / first.size()[1] as f64;
        let level = (solid_angle.sqrt() / texel).log2().clamp(-1.0, (self.levels.len() - 1) as f64);
        let before_turn = self.environment.before_turn(direction);
        let at = |level: f64| match self.levels.get(level as usize) {
            Some(blurred) if level >= 0.0 => blurred.radiance(before_turn),
            _ => self.environment.light().radiance(before_turn),
        };
        let (sharper, share) = (level.floor(), (level - level.floor()) as f32);
        let sharp = at(sharper);
        if share == 0.0 {
            return sharp;
        }
        let blurred = at(sharper + 1.0);
        std::array::from_fn(|c| sharp[c] + share * (blurred[c] - sharp[c]))
    }
}

/// Solid angle of a cell in a row, but for a factor that all rows share.
fn area(row: usize, rows: usize) -> f32 {
    (PI * (row as f64 + 0.5) / rows as f64).sin() as f32
}

/// Means over squares of 2 × 2 cells, weighted by their solid angles.
fn halved(texels: &[[f32; 3]], rows: usize) -> Vec<[f32; 3]> {
    let columns = 2 * rows;
    let mut means = Vec::with_capacity(texels.len() / 4);
    for y in 0..rows / 2 {
        let [upper, lower] = [2 * y, 2 * y + 1].map(|row| area(row, rows));
        let scale = 0.5 / (upper + lower);
        for x in 0..rows {
            let at = 2 * y * columns + 2 * x;
            let [a, b, c, d] = [at, at + 1, at + columns, at + columns + 1].map(|i| texels[i]);
            means.push(std::array::from_fn(|i| scale * (upper * (a[i] + b[i]) + lower * (c[i] + d[i]))));
        }
    }
    means
}

/// Cells averaged along each row until they are as wide as high.
fn widened(texels: &[[f32; 3]], rows: usize) -> Vec<[f32; 3]> {
    let columns = 2 * rows;
    let mut means = Vec::with_capacity(texels.len());
    let mut sums = vec![[0.0f64; 3]; columns + 1];
    for (y, row) in texels.chunks(columns).enumerate() {
        for (x, texel) in row.iter().enumerate() {
            sums[x + 1] = std::array::from_fn(|c| sums[x][c] + f64::from(texel[c]));
        }
        // Half the width, to either side of the middle of a cell.
        let half = (0.5 / f64::from(area(y, rows))).min(rows as f64);
        let up_to = |place: f64, c: usize| {
            let turns = (place / columns as f64).floor();
            let within = place - turns * columns as f64;
            let cell = (within as usize).min(columns - 1);
            turns * sums[columns][c] + sums[cell][c] + (within - cell as f64) * f64::from(row[cell][c])
        };
        for x in 0..columns {
            let middle = x as f64 + 0.5;
            means.push(std::array::from_fn(|c| {
                ((up_to(middle + half, c) - up_to(middle - half, c)) / (2.0 * half)).max(0.0) as f32
            }));
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::super::lamp::{Lamp, SURROUNDINGS};
    use super::super::latlong::direction;
    use super::*;

    #[test]
    fn even_light_stays_even_at_every_sharpness() {
        let image = LatLong::new([8, 4], vec![[0.5, 1.0, 2.0]; 32]).unwrap();
        let environment = Environment::new(EnvironmentLight::Image(image), 20.0);
        let pyramid = Pyramid::new(&environment).unwrap();
        for solid_angle in [1e-9, 1e-3, 0.1, 100.0] {
            for z in [-1.0, 0.3, 1.0] {
                let found = pyramid.radiance(DVec3::new(f64::sqrt(1.0 - z * z), 0.0, z), solid_angle);
                // Rounding of a few operations in single precision.
                assert!((0..3).all(|c| (found[c] / [0.5, 1.0, 2.0][c] - 1.0).abs() < 1e-6), "{found:?}");
            }
        }
    }

    #[test]
    fn every_level_keeps_the_lights_power_wherever_it_stands() {
        // Rows of the last levels are so high that sines at their middles are off by (45°)²/24 = 2.6 %.
        const POWER: f64 = 0.03;
        for elevation in [0.0, 50.0, 89.0] {
            let lamp = Lamp::new(elevation, 30.0, 10.0).unwrap();
            let environment = Environment::new(EnvironmentLight::Lamp(lamp), 0.0);
            let pyramid = Pyramid::new(&environment).unwrap();
            let power = |level: &LatLong| {
                let [width, height] = level.size();
                let row = |y: usize| PI / height as f64 * f64::from(area(y, height)) * PI / height as f64;
                let texels = level.texels().iter().enumerate();
                texels.map(|(i, texel)| row(i / width) * (f64::from(texel[1]) - SURROUNDINGS)).sum::<f64>()
            };
            let sharpest = power(&pyramid.levels[0]);
            for level in &pyramid.levels {
                let found = power(level);
                println!("{elevation} {:?}: {:.4}", level.size(), found / sharpest);
                assert!((found / sharpest - 1.0).abs() < POWER, "{elevation} {:?}", level.size());
            }
        }
    }

    #[test]
    fn a_lamp_at_the_pole_is_blurred_to_a_round_spot() {
        // What is left of the octants' differences at a texel's scale.
        const ROUND: f32 = 0.02;
        let environment = Environment::new(EnvironmentLight::Lamp(Lamp::new(90.0, 0.0, 4.0).unwrap()), 0.0);
        let pyramid = Pyramid::new(&environment).unwrap();
        for polar in [0.5, 2.0, 5.0, 10.0] {
            let at = |turn: f64| pyramid.radiance(direction([turn, polar / 180.0]), 0.02)[1];
            let around: Vec<f32> = (0..32).map(|i| at(f64::from(i) / 32.0)).collect();
            let (least, most) = around.iter().fold((f32::INFINITY, 0.0f32), |(a, b), &x| (a.min(x), b.max(x)));
            assert!(most - least <= ROUND * most, "{polar}: {least} {most}");
        }
    }
}
