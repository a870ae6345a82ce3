//! Lat-long images: radiance from every direction on a rectangle.
//!
//! The image covers the sphere with its first row around +z and its last around −z. Its middle column is +x, and
//! azimuth grows to the left, as it does for somebody inside with z up: for a unit direction (x, y, z)
//!
//! ```text
//! u = ½ − atan2(y, x)/2π,   v = acos(z)/π,
//! ```
//!
//! with texel i of n centred at (i + ½)/n. Radiance is bilinear between centres, u wraps around, v is held at the
//! poles.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use glam::DVec3;

use crate::support::direction::direction as spherical;

/// A lat-long image in linear RGB.
#[derive(Clone, Debug, PartialEq)]
pub struct LatLong {
    size: [usize; 2],
    texels: Vec<[f32; 3]>,
}

impl LatLong {
    /// Makes an image of width and height `size` from texels row by row from the top. `None` if there are no texels,
    /// not `width` × `height` of them, or some component is negative or not finite.
    #[must_use]
    pub fn new(size: [usize; 2], texels: Vec<[f32; 3]>) -> Option<Self> {
        let fits = !texels.is_empty() && size[0].checked_mul(size[1]) == Some(texels.len());
        let sound = || texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0);
        (fits && sound()).then_some(Self { size, texels })
    }

    /// Width and height in texels.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Texels row by row from the top.
    #[must_use]
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.texels
    }

    /// Radiance from a unit direction.
    pub(super) fn radiance(&self, direction: DVec3) -> [f32; 3] {
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

/// The place u, v in [0, 1] of a unit direction in a lat-long image.
#[must_use]
pub fn place(direction: DVec3) -> [f64; 2] {
    let polar = (direction.x * direction.x + direction.y * direction.y).sqrt().atan2(direction.z);
    [0.5 - direction.y.atan2(direction.x) / TAU, polar * FRAC_1_PI]
}

/// The unit direction of a place u, v in a lat-long image: the inverse of [`place`].
#[must_use]
pub fn direction([u, v]: [f64; 2]) -> DVec3 {
    spherical(PI * v, TAU * (0.5 - u))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// An image of 8 × 4 texels, one of them with bright blue.
    pub(in super::super) fn sample() -> LatLong {
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
        let (image, [width, height]) = (sample(), [8, 4]);
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
    fn what_is_no_image_is_refused() {
        assert!(LatLong::new([0, 0], vec![]).is_none());
        assert!(LatLong::new([2, 1], vec![[0.0; 3]]).is_none());
        assert!(LatLong::new([1, 1], vec![[f32::NAN, 0.0, 0.0]]).is_none());
    }
}
