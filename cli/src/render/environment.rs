//! The light around a body: linear RGB radiance from every direction, and directions drawn by how bright they are.

use glam::DVec3;

use super::distribution::Distribution;
use super::latlong::{LatLong, direction, place};
use super::studio::Studio;
use crate::colour::LUMINANCE_F32;

/// Cells of the grid by which the studio is sampled: its edges are a few degrees wide.
const STUDIO_CELLS: [usize; 2] = [256, 128];

/// The light around a body, before it is turned.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentLight {
    /// Radiance 1 from everywhere.
    White,
    /// The built-in [`Studio`].
    Studio(Box<Studio>),
    /// A lat-long image.
    Image(LatLong),
}

/// Light around a body, turned about z, with a distribution by which directions are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    light: EnvironmentLight,
    /// Sine and cosine of the turn.
    turn: [f64; 2],
    distribution: Distribution,
}

impl Environment {
    /// The environment of a light, turned by an angle about z, counter-clockwise from above.
    #[must_use]
    pub fn new(light: EnvironmentLight, turn_deg: f64) -> Self {
        // Products in single precision, their sum in double.
        let luminance = |rgb: [f32; 3]| -> f64 { rgb.iter().zip(LUMINANCE_F32).map(|(c, w)| f64::from(c * w)).sum() };
        let distribution = match &light {
            EnvironmentLight::White => Distribution::new([1, 1], |_, _| 1.0),
            EnvironmentLight::Studio(studio) => {
                let [width, height] = STUDIO_CELLS.map(|n| n as f64);
                Distribution::new(STUDIO_CELLS, |x, y| {
                    studio.radiance(direction([(x as f64 + 0.5) / width, (y as f64 + 0.5) / height]))
                })
            }
            EnvironmentLight::Image(image) => {
                let (size, texels) = (image.size(), image.texels());
                Distribution::new(size, |x, y| luminance(texels[y * size[0] + x]))
            }
        };
        Self { light, turn: turn_deg.to_radians().sin_cos().into(), distribution }
    }

    /// The light before it was turned.
    #[must_use]
    pub fn light(&self) -> &EnvironmentLight {
        &self.light
    }

    /// Whether radiance is the same from everywhere.
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

    /// Draws a unit direction of the world in proportion to the light's luminance around it; returns it with its
    /// probability density per solid angle. `u` is uniform in [0, 1)².
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let drawn = direction(self.distribution.sample(u));
        (self.turned(drawn, 1.0), self.distribution.pdf(place(drawn)))
    }

    /// The probability density per solid angle with which [`Environment::sample`] draws a unit direction.
    #[must_use]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.distribution.pdf(place(self.turned(direction, -1.0)))
    }

    /// A direction turned about z with the light, or back with the sign −1.
    fn turned(&self, d: DVec3, sign: f64) -> DVec3 {
        let [sin, cos] = [sign * self.turn[0], self.turn[1]];
        DVec3::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y, d.z)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use goniochrome::trace::sobol::sobol;

    use super::super::distribution::tests::edges;
    use super::super::latlong::tests::sample as image;
    use super::*;

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
            let image = LatLong::new([16, 8], texels.clone()).unwrap();
            let environment = Environment::new(EnvironmentLight::Image(image), turn);
            let [rows, columns] = edges(&environment.distribution);
            for u1 in rows {
                for &u0 in &columns {
                    let (wi, pdf) = environment.sample([u0, u1]);
                    assert!(pdf > 0.0 && pdf.is_finite(), "{u0} {u1}: {pdf}");
                    assert!((pdf / environment.pdf(wi) - 1.0).abs() < 1e-6, "{u0} {u1}: {pdf}");
                }
            }
        }
    }

    #[test]
    fn darkness_is_drawn_from_everywhere() {
        let image = LatLong::new([4, 2], vec![[0.0; 3]; 8]).unwrap();
        let dark = Environment::new(EnvironmentLight::Image(image), 0.0);
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
}
