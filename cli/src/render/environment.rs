//! The light around a mesh: linear RGB radiance from every direction.
//!
//! A lat-long image covers the sphere with its first row around +z and its last around −z. Its middle column is +x, and
//! azimuth grows to the left, as it does for somebody inside with z up: for a unit direction (x, y, z)
//!
//! ```text
//! u = ½ − atan2(y, x)/2π,   v = acos(z)/π,
//! ```
//!
//! with texel i of n centred at (i + ½)/n. Radiance is bilinear between centres, u wraps around, v is held at the poles.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

pub use super::latlong::{ImageRepairs, decode};
use super::studio::Studio;
use crate::colour::LUMINANCE_F32;

/// Cells of the grid by which the studio is sampled: its edges are a few degrees wide.
const STUDIO_CELLS: [usize; 2] = [256, 128];

/// A lat-long image.
#[derive(Clone, Debug, PartialEq)]
pub struct LatLong {
    size: [usize; 2],
    texels: Vec<[f32; 3]>,
}

impl LatLong {
    /// `texels` row by row from the top; finite and not negative. `None` if they are not `width` × `height`, or none.
    #[must_use]
    pub fn new(size: [usize; 2], texels: Vec<[f32; 3]>) -> Option<Self> {
        let fits = !texels.is_empty() && size[0].checked_mul(size[1]) == Some(texels.len());
        let sound = || texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0);
        (fits && sound()).then_some(Self { size, texels })
    }

    /// Width and height.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Row by row from the top.
    #[must_use]
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    fn radiance(&self, direction: DVec3) -> [f32; 3] {
        let [width, height] = self.size;
        let [u, v] = place(direction);
        let (x, y) = (u * width as f64 - 0.5, (v * height as f64 - 0.5).clamp(0.0, (height - 1) as f64));
        let (left, top) = (x.floor(), y.floor());
        let (wx, wy) = ((x - left) as f32, (y - top) as f32);
        let left = (left as isize).rem_euclid(width as isize) as usize;
        let top = top as usize;
        let (right, below) = ((left + 1) % width, (top + 1).min(height - 1));
        let texel = |x: usize, y: usize| self.texels[y * width + x];
        let [a, b, c, d] = [texel(left, top), texel(right, top), texel(left, below), texel(right, below)];
        std::array::from_fn(|i| {
            let (upper, lower) = (a[i] + wx * (b[i] - a[i]), c[i] + wx * (d[i] - c[i]));
            upper + wy * (lower - upper)
        })
    }
}

/// Where a unit direction lies in a lat-long image: u and v in [0, 1].
#[must_use]
pub fn place(direction: DVec3) -> [f64; 2] {
    let polar = direction.x.hypot(direction.y).atan2(direction.z);
    [0.5 - direction.y.atan2(direction.x) / TAU, polar * FRAC_1_PI]
}

/// The unit direction of a place in a lat-long image.
#[must_use]
pub fn direction([u, v]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = ((PI * v).sin_cos(), (TAU * (0.5 - u)).sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Where light comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentLight {
    /// Radiance 1 from everywhere.
    White,
    /// [`Studio`].
    Studio(Box<Studio>),
    /// An image.
    Image(LatLong),
}

/// EnvironmentLight around a mesh, turned about z, and a way to draw directions by how bright they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    light: EnvironmentLight,
    /// Sine and cosine of the turn.
    turn: [f64; 2],
    cells: Cells,
}

impl Environment {
    /// `light`, turned by an angle about z, counter-clockwise from above.
    #[must_use]
    pub fn new(light: EnvironmentLight, turn_deg: f64) -> Self {
        let luminance = |rgb: [f32; 3]| -> f64 { rgb.iter().zip(LUMINANCE_F32).map(|(c, w)| f64::from(c * w)).sum() };
        let cells = match &light {
            EnvironmentLight::White => Cells::new([1, 1], |_, _| 1.0),
            EnvironmentLight::Studio(studio) => {
                let [width, height] = STUDIO_CELLS.map(|n| n as f64);
                Cells::new(STUDIO_CELLS, |x, y| {
                    studio.radiance(direction([(x as f64 + 0.5) / width, (y as f64 + 0.5) / height]))
                })
            }
            EnvironmentLight::Image(image) => {
                Cells::new(image.size, |x, y| luminance(image.texels[y * image.size[0] + x]))
            }
        };
        Self { light, turn: turn_deg.to_radians().sin_cos().into(), cells }
    }

    /// What the light is.
    #[must_use]
    pub fn light(&self) -> &EnvironmentLight {
        &self.light
    }

    /// The same radiance from everywhere.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        matches!(self.light, EnvironmentLight::White)
    }

    /// Linear RGB radiance from a unit direction of the world.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        match &self.light {
            EnvironmentLight::White => [1.0; 3],
            EnvironmentLight::Studio(studio) => [studio.radiance(self.turned(direction, -1.0)) as f32; 3],
            EnvironmentLight::Image(image) => image.radiance(self.turned(direction, -1.0)),
        }
    }

    /// A unit direction of the world and its density per solid angle, in proportion to the light's luminance around it; `u`
    /// uniform in [0, 1)².
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let drawn = direction(self.cells.sample(u));
        (self.turned(drawn, 1.0), self.cells.density(place(drawn)))
    }

    /// The density of [`Environment::sample`].
    #[must_use]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.cells.density(place(self.turned(direction, -1.0)))
    }

    fn turned(&self, d: DVec3, sign: f64) -> DVec3 {
        let [sin, cos] = [sign * self.turn[0], self.turn[1]];
        DVec3::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y, d.z)
    }
}

/// Cells of a lat-long grid with the probability of each.
///
/// A cell's weight is its solid angle times the mean of the bilinear interpolation over it, ([1 6 1]/8 along each axis), so no
/// direction that any light comes from is left out.
#[derive(Clone, Debug, PartialEq)]
struct Cells {
    size: [usize; 2],
    /// Cumulative probabilities of the rows.
    rows: Vec<f64>,
    /// Of the cells in each row.
    columns: Vec<f64>,
}

impl Cells {
    fn new([width, height]: [usize; 2], of: impl Fn(usize, usize) -> f64) -> Self {
        let along_row = |y: usize| -> Vec<f64> {
            let row: Vec<f64> = (0..width).map(|x| of(x, y)).collect();
            (0..width).map(|x| 0.125 * (row[(x + width - 1) % width] + 6.0 * row[x] + row[(x + 1) % width])).collect()
        };
        let (mut rows, mut columns) = (Vec::with_capacity(height), Vec::with_capacity(width * height));
        let mut above = along_row(0);
        let mut here = above.clone();
        let mut total = 0.0;
        for y in 0..height {
            let below = along_row((y + 1).min(height - 1));
            let mut sum = 0.0;
            let from = columns.len();
            for x in 0..width {
                sum += 0.125 * (above[x] + 6.0 * here[x] + below[x]);
                columns.push(sum);
            }
            // A row without light is never drawn.
            columns[from..].iter_mut().for_each(|c| *c /= if sum > 0.0 { sum } else { 1.0 });
            total += sum * solid_angle(y, height);
            rows.push(total);
            (above, here) = (here, below);
        }
        if total <= 0.0 {
            // Darkness is the same everywhere: one cell.
            return Self { size: [1, 1], rows: vec![1.0], columns: vec![1.0] };
        }
        rows.iter_mut().for_each(|row| *row /= total);
        Self { size: [width, height], rows, columns }
    }

    /// A place in the image.
    fn sample(&self, [u0, u1]: [f64; 2]) -> [f64; 2] {
        let [width, height] = self.size;
        let (y, within_row) = take(&self.rows, u1);
        let (x, within) = take(&self.columns[y * width..][..width], u0);
        // Uniform over the cell's solid angle: uniform in cos θ.
        let (top, bottom) = ((PI * y as f64 / height as f64).cos(), (PI * (y + 1) as f64 / height as f64).cos());
        let v = (top + within_row * (bottom - top)).clamp(-1.0, 1.0).acos() * FRAC_1_PI;
        [(x as f64 + within) / width as f64, v]
    }

    /// Density per solid angle.
    fn density(&self, [u, v]: [f64; 2]) -> f64 {
        let [width, height] = self.size;
        let cell = |place: f64, count: usize| ((place * count as f64) as usize).min(count - 1);
        let (x, y) = (cell(u, width), cell(v, height));
        let probability = step(&self.rows, y) * step(&self.columns[y * width..][..width], x);
        probability * width as f64 / (TAU * solid_angle(y, height))
    }
}

/// Solid angle of a row of cells, in units of 2π.
fn solid_angle(y: usize, height: usize) -> f64 {
    // cos a − cos b without cancellation.
    let half = 0.5 * PI / height as f64;
    2.0 * ((2 * y + 1) as f64 * half).sin() * half.sin()
}

fn step(cumulative: &[f64], place: usize) -> f64 {
    cumulative[place] - if place == 0 { 0.0 } else { cumulative[place - 1] }
}

/// How far from the edges of its cell a direction is drawn, as a fraction of the cell: on an edge, rounding would give
/// it to the next cell, which may be dark. Within a cell by a pole, a row's arc cosine is rounded most: by 2⁻⁵³ over
/// the square of its polar angle, 10⁻⁸ of a row among 32768.
const EDGE: f64 = 1e-6;

/// Which place `u` falls on, the first whose sum is larger, and how far into it.
fn take(cumulative: &[f64], u: f64) -> (usize, f64) {
    let place = cumulative.partition_point(|&sum| sum <= u).min(cumulative.len() - 1);
    let (width, from) = (step(cumulative, place), if place == 0 { 0.0 } else { cumulative[place - 1] });
    (place, if width > 0.0 { ((u - from) / width).clamp(EDGE, 1.0 - EDGE) } else { 0.5 })
}

#[cfg(test)]
mod tests {
    use goniochrome::trace::sobol::sobol;

    use super::*;

    fn image() -> LatLong {
        let texel = |i: usize| [0.25 * (i % 5) as f32, (i % 3) as f32, if i == 9 { 40.0 } else { 0.0 }];
        LatLong::new([8, 4], (0..32).map(texel).collect()).unwrap()
    }

    #[test]
    fn places_and_directions_are_inverse_and_named_ones_are_where_the_words_say() {
        for (d, [u, v]) in [
            (DVec3::X, [0.5, 0.5]),
            (DVec3::Y, [0.25, 0.5]),
            (DVec3::NEG_Y, [0.75, 0.5]),
            (DVec3::Z, [0.5, 0.0]),
            (DVec3::NEG_Z, [0.5, 1.0]),
        ] {
            assert!(place(d).iter().zip([u, v]).all(|(a, b)| (a - b).abs() < 1e-12), "{d}");
            assert!(direction([u, v]).distance(d) < 1e-12);
        }
    }

    #[test]
    fn texels_come_back_at_their_centres_and_blend_across_the_seam() {
        let (image, [width, height]) = (image(), [8, 4]);
        for (i, texel) in image.texels().iter().enumerate() {
            let at = [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
            let found = image.radiance(direction([at[0] / width as f64, at[1] / height as f64]));
            assert!(found.iter().zip(texel).all(|(a, b)| (a - b).abs() < 1e-4), "{i}: {found:?} {texel:?}");
        }
        let seam = image.radiance(direction([0.0, 1.5 / 4.0]));
        let sides = [image.texels()[8], image.texels()[15]];
        assert!((0..3).all(|c| (seam[c] - 0.5 * (sides[0][c] + sides[1][c])).abs() < 1e-4), "{seam:?}");
    }

    #[test]
    fn samples_integrate_the_light_and_densities_integrate_to_one() {
        for light in
            [EnvironmentLight::White, EnvironmentLight::Studio(Box::default()), EnvironmentLight::Image(image())]
        {
            let environment = Environment::new(light, 33.0);
            let count = 1 << 16;
            let (mut by_light, mut by_sphere, mut density) = (0.0, 0.0, 0.0);
            for i in 0..count {
                let u = sobol(i, 7);
                let (wi, pdf) = environment.sample(u);
                assert!((pdf / environment.pdf(wi) - 1.0).abs() < 1e-6, "{pdf} {}", environment.pdf(wi));
                by_light += f64::from(environment.radiance(wi)[0]) / pdf;
                let cos = 1.0 - 2.0 * u[0];
                let (sin, phi) = ((1.0 - cos * cos).sqrt(), TAU * u[1]);
                let uniform = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                by_sphere += f64::from(environment.radiance(uniform)[0]);
                density += environment.pdf(uniform);
            }
            let sphere = 4.0 * PI / f64::from(count);
            let (by_light, by_sphere) = (by_light / f64::from(count), by_sphere * sphere);
            // Both estimates of 65536 well spread points.
            assert!((by_light / by_sphere - 1.0).abs() < 3e-3, "{by_light} {by_sphere}");
            assert!((density * sphere - 1.0).abs() < 3e-3);
        }
    }

    #[test]
    fn no_number_draws_a_direction_without_density() {
        let mut texels = vec![[0.0; 3]; 16 * 8];
        for lit in [3, 4, 9, 64, 70, 127] {
            texels[lit] = [1.0; 3];
        }
        for turn in [0.0, 33.0] {
            let environment =
                Environment::new(EnvironmentLight::Image(LatLong::new([16, 8], texels.clone()).unwrap()), turn);
            let edges = |sums: &[f64]| {
                let around = sums.iter().flat_map(|sum| [sum.next_down(), *sum, sum.next_up()]);
                around.chain([0.0, 1.0 - f64::EPSILON / 2.0]).filter(|u| (0.0..1.0).contains(u)).collect::<Vec<f64>>()
            };
            for u1 in edges(&environment.cells.rows) {
                for u0 in edges(&environment.cells.columns) {
                    let (wi, pdf) = environment.sample([u0, u1]);
                    assert!(pdf > 0.0 && pdf.is_finite(), "{u0} {u1}: {pdf}");
                    assert!((pdf / environment.pdf(wi) - 1.0).abs() < 1e-6, "{u0} {u1}: {pdf}");
                }
            }
        }
    }

    #[test]
    fn darkness_is_drawn_from_everywhere() {
        let dark = Environment::new(EnvironmentLight::Image(LatLong::new([4, 2], vec![[0.0; 3]; 8]).unwrap()), 0.0);
        for u in [[0.0, 0.0], [0.3, 0.8]] {
            let (wi, pdf) = dark.sample(u);
            assert!((pdf * 4.0 * PI - 1.0).abs() < 1e-9 && dark.radiance(wi) == [0.0; 3], "{pdf}");
        }
    }

    #[test]
    fn a_turn_moves_the_light_counter_clockwise() {
        let straight = Environment::new(EnvironmentLight::Image(image()), 0.0);
        let turned = Environment::new(EnvironmentLight::Image(image()), 90.0);
        let (a, b) = (straight.radiance(DVec3::X), turned.radiance(DVec3::Y));
        assert!((0..3).all(|c| (a[c] - b[c]).abs() < 1e-5));
    }

    #[test]
    fn what_is_no_image_is_refused() {
        assert!(LatLong::new([0, 0], vec![]).is_none());
        assert!(LatLong::new([2, 1], vec![[0.0; 3]]).is_none());
        assert!(LatLong::new([1, 1], vec![[f32::NAN, 0.0, 0.0]]).is_none());
    }
}
