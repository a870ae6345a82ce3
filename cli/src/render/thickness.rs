//! Where on a body a film is how thick.

use std::sync::Arc;

use fastnoise_lite::{DomainWarpType, FastNoiseLite, FractalType, NoiseType};
use glam::DVec3;

use super::body::Body;
use crate::support::grey_map::GreyMap;

/// Thickness over a body, as a share of the way from the first thickness of a table to the last.
#[derive(Clone, Debug)]
pub enum ThicknessMap {
    /// One share everywhere.
    Even(f64),
    /// A picture over the texture coordinates, 0 for the first thickness and 1 for the last; repeated beyond it.
    Picture(GreyMap),
    /// A film that drains: √d, where d is the depth below the body's top over its height. A film between rigid
    /// surfaces thins so (Jeffreys, "The draining of a vertical plate", 1930).
    Drain,
    /// Swirls: fractal noise in space, in parts of the body's radius.
    Noise(Swirls),
}

/// Noise that is warped by noise.
#[derive(Clone)]
pub struct Swirls {
    noise: Arc<FastNoiseLite>,
    warp: Arc<FastNoiseLite>,
}

impl std::fmt::Debug for Swirls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Swirls")
    }
}

impl Default for Swirls {
    fn default() -> Self {
        let mut noise = FastNoiseLite::with_seed(1);
        noise.set_noise_type(Some(NoiseType::OpenSimplex2S));
        noise.set_fractal_type(Some(FractalType::FBm));
        noise.set_fractal_octaves(Some(4));
        noise.set_frequency(Some(0.8));
        let mut warp = FastNoiseLite::with_seed(2);
        warp.set_domain_warp_type(Some(DomainWarpType::OpenSimplex2));
        warp.set_domain_warp_amp(Some(0.7));
        warp.set_frequency(Some(0.9));
        Self { noise: Arc::new(noise), warp: Arc::new(warp) }
    }
}

impl ThicknessMap {
    /// The share at a point of a triangle of a body, in [0, 1]; bodies that are no mesh have no triangles.
    #[must_use]
    pub fn at(&self, body: &Body<'_>, triangle: u32, point: DVec3) -> f64 {
        match self {
            Self::Even(share) => *share,
            Self::Picture(map) => f64::from(texel(map, body.texture_place(triangle, point))).clamp(0.0, 1.0),
            Self::Drain => {
                let [bottom, top] = body.heights();
                if top > bottom { ((top - point.z) / (top - bottom)).clamp(0.0, 1.0).sqrt() } else { 0.5 }
            }
            Self::Noise(swirls) => {
                let (centre, radius) = body.bounds();
                swirls.at((point - centre) / radius)
            }
        }
    }
}

impl Swirls {
    /// Noise at a place, in [0, 1]; thin and thick places are seldom.
    fn at(&self, place: DVec3) -> f64 {
        let (x, y, z) = self.warp.domain_warp_3d(place.x, place.y, place.z);
        // The sum of octaves seldom leaves ±0.5.
        (0.5 + 0.9 * f64::from(self.noise.get_noise_3d(x, y, z))).clamp(0.0, 1.0)
    }
}

/// The value of a picture at texture coordinates u, to the right, and v, upwards: linear between the middles of
/// pixels, repeated to the sides; in height pixels beyond the picture count only where v does.
fn texel(map: &GreyMap, [u, v]: [f64; 2]) -> f32 {
    let [width, height] = map.size;
    let v = if (0.0..=1.0).contains(&v) { v } else { v.rem_euclid(1.0) };
    let across = u.rem_euclid(1.0) * width as f64 - 0.5;
    let down = ((1.0 - v) * height as f64 - 0.5).clamp(0.0, (height - 1) as f64);
    let (left, above) = (across.floor(), down.floor());
    let [x0, x1] = [left, left + 1.0].map(|x| x.rem_euclid(width as f64) as usize % width);
    let [y0, y1] = [above as usize, (above as usize + 1).min(height - 1)];
    let row = |y: usize| mix(map.values[y * width + x0], map.values[y * width + x1], across - left);
    mix(row(y0), row(y1), down - above)
}

fn mix(a: f32, b: f32, weight: f64) -> f32 {
    a + weight as f32 * (b - a)
}

#[cfg(test)]
mod tests {
    use super::super::body::{BodyShape, BvhMemory};
    use super::*;

    /// Share at the point of the unit sphere that is seen from `eye`.
    fn at(map: &ThicknessMap, eye: [f64; 3]) -> f64 {
        let mut memory = BvhMemory::default();
        let body = Body::new(&BodyShape::Sphere, &mut memory).unwrap();
        let eye = 3.0 * DVec3::from(eye).normalize();
        map.at(&body, 0, body.intersect(eye, -eye.normalize()).unwrap().point)
    }

    #[test]
    fn a_bubble_is_thin_at_its_top() {
        let depth = |z: f64| at(&ThicknessMap::Drain, [(1.0 - z * z).sqrt(), 0.0, z]);
        for (z, expected) in [(1.0, 0.0), (0.5, 0.5), (-1.0, 1.0)] {
            assert!((depth(z) - expected).abs() < 1e-7, "{z}");
        }
    }

    #[test]
    fn a_picture_lies_on_the_sphere_like_a_map_of_the_earth() {
        // Two columns, west and east of the meridian through −x; three rows from the north.
        let values = vec![0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
        let map = ThicknessMap::Picture(GreyMap { size: [2, 3], values, integer: false });
        for (eye, expected) in [([0.0, 1.0, 0.0], 0.3), ([0.0, -1.0, 0.0], 0.2), ([1.0, 0.0, 0.0], 0.25)] {
            assert!((at(&map, eye) - expected).abs() < 1e-6, "{eye:?}: {}", at(&map, eye));
        }
        assert!((at(&map, [0.001, 1.0, 1e4]) - 0.1).abs() < 1e-3);
    }

    #[test]
    fn swirls_fill_the_range() {
        let map = ThicknessMap::Noise(Swirls::default());
        let mut shares: Vec<f64> = (0..1000)
            .map(|i| {
                let (z, turn) = (-0.999 + 0.001_998 * f64::from(i), 2.4 * f64::from(i));
                let across = (1.0 - z * z).sqrt();
                at(&map, [across * turn.cos(), across * turn.sin(), z])
            })
            .collect();
        shares.sort_by(f64::total_cmp);
        // The middle half spans a good part of the range, and both ends are reached seldom.
        assert!(
            shares[750] - shares[250] > 0.2 && shares[20] > 0.0 && shares[980] < 1.0,
            "{:?}",
            [shares[250], shares[750]]
        );
    }
}
