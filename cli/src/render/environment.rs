//! The light around a body: linear RGB radiance from every direction, and directions drawn by how bright they are.

use std::f64::consts::PI;

use glam::DVec3;

use super::distribution::Distribution;
use super::lamp::Lamp;
use super::latlong::{LatLong, direction, place};
use super::studio::{SOFT_BOXES, Studio};
use crate::colour::LUMINANCE_F32;

/// Cells of the grid by which the studio is sampled: its edges are a few degrees wide.
const STUDIO_CELLS: [usize; 2] = [256, 128];

/// Part of a texel, of the narrowest edge of a soft box and of a lamp's radius that [`Environment::detail`] resolves.
/// A sum of one-pixel lights in such steps is within 1 % of their integral, of lamps within 0.1 %.
const DETAIL_OF: [f64; 3] = [0.5, 0.25, 0.125];

/// The light around a body, before it is turned.
#[derive(Clone, Debug, PartialEq)]
pub enum EnvironmentLight {
    /// Radiance 1 from everywhere.
    White,
    /// The built-in [`Studio`].
    Studio(Box<Studio>),
    /// A small [`Lamp`].
    Lamp(Lamp),
    /// A lat-long image.
    Image(LatLong),
}

impl EnvironmentLight {
    /// Linear RGB radiance from a unit direction.
    pub(super) fn radiance(&self, direction: DVec3) -> [f32; 3] {
        match self {
            Self::White => [1.0; 3],
            Self::Studio(studio) => [studio.radiance(direction) as f32; 3],
            Self::Lamp(lamp) => [lamp.radiance(direction) as f32; 3],
            Self::Image(image) => image.radiance(direction),
        }
    }
}

/// Light around a body, turned about z, with a distribution by which directions are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    light: EnvironmentLight,
    /// Sine and cosine of the turn.
    turn: [f64; 2],
    distribution: Distribution,
    detail: f64,
}

impl Environment {
    /// The environment of a light, turned by an angle about z, counter-clockwise from above.
    #[must_use]
    pub fn new(light: EnvironmentLight, turn_deg: f64) -> Self {
        // Products in single precision, their sum in double.
        let luminance = |rgb: [f32; 3]| -> f64 { rgb.iter().zip(LUMINANCE_F32).map(|(c, w)| f64::from(c * w)).sum() };
        let distribution = match &light {
            // A lamp draws its own directions.
            EnvironmentLight::White | EnvironmentLight::Lamp(_) => Distribution::new([1, 1], |_, _| 1.0),
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
        let [texel, edge, radius] = DETAIL_OF;
        let detail = match &light {
            EnvironmentLight::White => f64::INFINITY,
            EnvironmentLight::Studio(_) => {
                2.0 * edge * SOFT_BOXES.iter().map(|lamp| lamp.softness).fold(f64::INFINITY, f64::min)
            }
            EnvironmentLight::Lamp(lamp) => radius * lamp.radius(),
            EnvironmentLight::Image(image) => texel * PI / image.size()[1] as f64,
        };
        Self { light, turn: turn_deg.to_radians().sin_cos().into(), distribution, detail }
    }

    /// The environment with the light of each direction replaced, whose features are no smaller than an angle.
    pub(super) fn replaced(&self, light: LatLong, feature: f64) -> Self {
        let replaced = Self::new(EnvironmentLight::Image(light), 0.0);
        Self { turn: self.turn, detail: replaced.detail.max(DETAIL_OF[0] * feature), ..replaced }
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

    /// Angle between directions, in radians, in whose steps a sum over a row of them is close to its integral.
    pub(super) fn detail(&self) -> f64 {
        self.detail
    }

    /// Whether radiance is known to be even up to an angle around a unit direction of the world.
    pub(super) fn is_even_around(&self, direction: DVec3, angle: f64) -> bool {
        match &self.light {
            EnvironmentLight::White => true,
            // A chord is no longer than its arc.
            EnvironmentLight::Lamp(lamp) => {
                self.turned(direction, -1.0).distance(lamp.towards()) > lamp.reach() + angle
            }
            EnvironmentLight::Studio(_) | EnvironmentLight::Image(_) => false,
        }
    }

    /// Linear RGB radiance from a unit direction of the world.
    #[must_use]
    pub fn radiance(&self, direction: DVec3) -> [f32; 3] {
        self.light.radiance(self.before_turn(direction))
    }

    /// The direction in which the light that comes from a direction of the world lay before it was turned.
    pub(super) fn before_turn(&self, direction: DVec3) -> DVec3 {
        self.turned(direction, -1.0)
    }

    /// Draws a unit direction of the world in proportion to the light's luminance around it; returns it with its
    /// probability density per solid angle. `u` is uniform in [0, 1)².
    #[must_use]
    pub fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let drawn = match &self.light {
            EnvironmentLight::Lamp(lamp) => lamp.sample(u),
            _ => direction(self.distribution.sample(u)),
        };
        (self.turned(drawn, 1.0), self.pdf_before_turn(drawn))
    }

    /// The probability density per solid angle with which [`Environment::sample`] draws a unit direction.
    #[must_use]
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.pdf_before_turn(self.turned(direction, -1.0))
    }

    fn pdf_before_turn(&self, direction: DVec3) -> f64 {
        match &self.light {
            EnvironmentLight::Lamp(lamp) => lamp.pdf(direction),
            _ => self.distribution.pdf(place(direction)),
        }
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
        let lamp = EnvironmentLight::Lamp(Lamp::new(40.0, 10.0, 20.0).unwrap());
        for light in
            [EnvironmentLight::White, EnvironmentLight::Studio(Box::default()), lamp, EnvironmentLight::Image(image())]
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
