//! The light around a body as a surface sees it that spreads each diffraction order, or facet lobe, over a width.
//!
//! The environment is convolved once, on the sphere, with K(γ) ∝ exp((cos γ − 1)/σ²) (von Mises and Fisher), which for
//! small σ is a Gaussian with the standard deviation σ along each of the two axes. White light stays exactly white.

use std::f64::consts::{PI, TAU};

use super::environment::{Environment, EnvironmentLight};
use super::lamp::Lamp;
use super::latlong::{LatLong, direction};
use crate::support::error::{Error, Result};
use crate::support::{memory, parallel};

/// Smallest and largest standard deviation in degrees: one that [`MAX_ROWS`] resolve, and one that leaves no colour.
const SPREADS_DEG: [f64; 2] = [0.25, 30.0];
/// Rows of the lat-long image for each standard deviation.
const ROWS_BY_SPREAD: f64 = 4.0;
const MAX_ROWS: usize = 2048;
/// The kernel ends where it has fallen to exp(−10), 4.5 standard deviations from its middle.
const LAST_EXPONENT: f64 = 10.0;

/// Standard deviation of the width of diffraction orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    degrees: f64,
}

impl Spread {
    /// A width with a standard deviation in degrees.
    ///
    /// # Errors
    /// A standard deviation that is not from 0.25 to 30.
    pub fn new(degrees: f64) -> Result<Self> {
        let [min, max] = SPREADS_DEG;
        if !(min..=max).contains(&degrees) {
            return Err(Error::usage(format_args!(
                "--spread {degrees}: 0 for sharp orders, or a standard deviation from {min} to {max} degrees"
            )));
        }
        Ok(Self { degrees })
    }

    /// Standard deviation in degrees.
    #[must_use]
    pub fn degrees(&self) -> f64 {
        self.degrees
    }

    /// Standard deviation in radians.
    #[must_use]
    pub fn radians(&self) -> f64 {
        self.degrees.to_radians()
    }

    /// Rows of the lat-long image that holds spread light.
    #[must_use]
    pub fn rows(&self) -> usize {
        (2 * (0.5 * ROWS_BY_SPREAD * PI / self.radians()).ceil() as usize).min(MAX_ROWS)
    }

    /// 1/σ² of the kernel. What averaging over cells and bilinear look-up blur beside it is taken off: variances of
    /// h²/12 and h²/6 for a texel of side h.
    #[must_use]
    pub fn concentration(&self) -> f64 {
        let texel = PI / self.rows() as f64;
        1.0 / (self.radians().powi(2) - 0.25 * texel * texel)
    }
}

/// The environment of a surface that spreads each diffraction order; white light is as it was.
///
/// # Errors
/// Too little memory.
pub fn spread_environment(environment: &Environment, width: Spread, threads: usize) -> Result<Environment> {
    if environment.is_uniform() {
        return Ok(environment.clone());
    }
    Ok(environment.replaced(spread(environment.light(), width, threads)?, width.radians()))
}

fn spread(light: &EnvironmentLight, width: Spread, threads: usize) -> Result<LatLong> {
    let height = width.rows();
    let cells = cells(light, height)?;
    let kernel = Kernel { concentration: width.concentration(), size: [2 * height, height] };
    let what = "the environment, spread";
    let mut texels = memory::filled([0.0f32; 3], 2 * height * height, what)?;
    parallel::for_each(
        threads,
        texels.chunks_mut(2 * height).enumerate(),
        || (vec![0.0; 2 * height], vec![0.0; 4 * height]),
        |(sum, padded), (y, row)| {
            for c in 0..3 {
                kernel.convolve(&cells[c], y, sum, padded);
                row.iter_mut().zip(&*sum).for_each(|(texel, sum)| texel[c] = *sum);
            }
        },
    );
    LatLong::new([2 * height, height], texels).ok_or_else(|| Error::failed("the environment is not finite"))
}

/// Mean radiance over each cell of a lat-long grid, for red, green and blue apart.
pub(super) fn cells(light: &EnvironmentLight, height: usize) -> Result<[Vec<f32>; 3]> {
    let width = 2 * height;
    let texel = PI / height as f64;
    let plane = || memory::filled(0.0f32, width * height, "the environment before it is spread");
    let mut cells = [plane()?, plane()?, plane()?];
    let finest = match light {
        EnvironmentLight::White => texel,
        EnvironmentLight::Studio(_) => 0.01,
        EnvironmentLight::Lamp(lamp) => 0.2 * lamp.radius(),
        EnvironmentLight::Image(image) => 0.5 * PI / image.size()[1] as f64,
    };
    let fine = ((texel / finest).ceil() as usize).max(1);
    for y in 0..height {
        for x in 0..width {
            let places = |count: usize| {
                let within = move |i: usize| (i as f64 + 0.5) / count as f64;
                let place = move |i: usize, j: usize| {
                    [(x as f64 + within(i)) / width as f64, (y as f64 + within(j)) / height as f64]
                };
                (0..count).flat_map(move |j| (0..count).map(move |i| direction(place(i, j))))
            };
            // Beside a lamp, which may be far smaller than a cell, the light is even.
            let even = |lamp: &Lamp| places(1).any(|middle| lamp.angle(middle) > lamp.reach() + texel);
            let count = if matches!(light, EnvironmentLight::Lamp(lamp) if even(lamp)) { 1 } else { fine };
            let (mut sum, mut area) = ([0.0f32; 3], 0.0);
            for direction in places(count) {
                let (rgb, part) = (light.radiance(direction), (1.0 - direction.z * direction.z).sqrt() as f32);
                (0..3).for_each(|c| sum[c] += part * rgb[c]);
                area += part;
            }
            (0..3).for_each(|c| cells[c][y * width + x] = sum[c] / area);
        }
    }
    Ok(cells)
}

/// The kernel on a lat-long grid.
struct Kernel {
    concentration: f64,
    size: [usize; 2],
}

impl Kernel {
    /// Sets `sum` to row `y` of the convolution of `cells`; `padded` is twice as long.
    ///
    /// Between rows at θ and θ', cos γ − 1 = cos(θ − θ') − 1 + sin θ sin θ' (cos Δφ − 1): a factor for the two rows,
    /// times a kernel along the row.
    fn convolve(&self, cells: &[f32], y: usize, sum: &mut [f32], padded: &mut [f32]) {
        let [width, height] = self.size;
        let theta = |y: usize| PI * (y as f64 + 0.5) / height as f64;
        sum.fill(0.0);
        let mut whole = 0.0;
        for (from, cells) in cells.chunks(width).enumerate() {
            let across = self.concentration * (1.0 - (theta(y) - theta(from)).cos());
            if across > LAST_EXPONENT {
                continue;
            }
            let area = theta(from).sin();
            let along = self.concentration * theta(y).sin() * area;
            for (i, padded) in padded.chunks_mut(width / 2).enumerate() {
                padded.copy_from_slice(&cells[(i + 1) % 2 * width / 2..][..width / 2]);
            }
            for step in 0..=width / 2 {
                let exponent = across + along * (1.0 - (TAU * step as f64 / width as f64).cos());
                if exponent > LAST_EXPONENT {
                    break;
                }
                // Opposite the middle, the steps to either side meet.
                let once = step == 0 || step == width / 2;
                let weight = area * (-exponent).exp() * if once { 0.5 } else { 1.0 };
                whole += 2.0 * weight;
                let weight = weight as f32;
                let (left, right) = (&padded[width / 2 - step..], &padded[width / 2 + step..]);
                for ((sum, left), right) in sum.iter_mut().zip(left).zip(right) {
                    *sum += weight * (left + right);
                }
            }
        }
        let scale = (1.0 / whole) as f32;
        sum.iter_mut().for_each(|x| *x *= scale);
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::lamp::SURROUNDINGS;
    use super::*;

    /// Integral over the sphere of what the lamp adds, times a function.
    fn integral(image: &LatLong, of: impl Fn(DVec3) -> f64) -> f64 {
        let [width, height] = image.size();
        let place = |i: usize| [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
        let texels = image.texels().iter().enumerate().map(|(i, texel)| {
            let [x, y] = place(i);
            let d = direction([x / width as f64, y / height as f64]);
            (PI * y / height as f64).sin() * (f64::from(texel[1]) - SURROUNDINGS) * of(d)
        });
        texels.sum::<f64>() * PI / height as f64 * TAU / width as f64
    }

    #[test]
    fn spread_light_keeps_its_power_and_has_the_width_that_was_asked_for() {
        // Quadrature of the lamp over cells.
        const POWER: f64 = 1e-3;
        // By a pole texels are narrow and blur less than the kernel leaves out: texel²/4 of 2 σ². Its end costs 0.1 %.
        const VARIANCE: f64 = 0.25 / (2.0 * ROWS_BY_SPREAD * ROWS_BY_SPREAD) + 1e-3;
        for (elevation, degrees) in [(20.0, 1.0), (88.0, 2.0), (-50.0, 6.0)] {
            let lamp = Lamp::new(elevation, 30.0, 1.0).unwrap();
            let width = Spread::new(degrees).unwrap();
            let image = spread(&EnvironmentLight::Lamp(lamp), width, 2).unwrap();
            let far = lamp.reach() + 6.0 * width.radians();
            let near = |d: DVec3| if lamp.angle(d) < far { 1.0 } else { 0.0 };
            let power = integral(&image, near);
            let variance = integral(&image, |d| 2.0 * (1.0 - d.dot(lamp.towards())) * near(d));
            // A soft disc of radius r: moments of 1 − s over the circle.
            let moment = |power: i32| {
                let steps = 1000;
                let angle = |i: usize| lamp.reach() * (i as f64 + 0.5) / steps as f64;
                let right = lamp.towards().any_orthonormal_vector();
                let at = |angle: f64| lamp.radiance(angle.cos() * lamp.towards() + angle.sin() * right) - SURROUNDINGS;
                let sum: f64 = (0..steps).map(|i| angle(i).powi(power) * at(angle(i))).sum();
                TAU * sum * lamp.reach() / f64::from(steps as u32)
            };
            // The kernel leaves out what bilinear look-up will blur.
            let texel = PI / width.rows() as f64;
            let kernel = 2.0 * (width.radians().powi(2) - texel * texel / 6.0);
            let expected = [moment(1), moment(3) / moment(1) + kernel];
            println!("{degrees}°: power {}, variance {}", power / expected[0], variance / power / expected[1]);
            assert!((power / expected[0] - 1.0).abs() < POWER, "{degrees}: {power} {expected:?}");
            assert!((variance / power / expected[1] - 1.0).abs() < VARIANCE, "{degrees}: {variance} {expected:?}");
        }
    }

    #[test]
    fn even_light_stays_even() {
        let image = LatLong::new([8, 4], vec![[0.5, 1.0, 2.0]; 32]).unwrap();
        let spread = spread(&EnvironmentLight::Image(image), Spread::new(5.0).unwrap(), 1).unwrap();
        for texel in spread.texels() {
            // Sums of some hundred numbers in single precision.
            assert!((0..3).all(|c| (texel[c] / [0.5, 1.0, 2.0][c] - 1.0).abs() < 1e-5), "{texel:?}");
        }
    }
}
