//! Sampled colours as pixels, for PNG files alone or embedded in SVG.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tiny_skia::{ColorU8, Pixmap};

use super::encode::srgb8;

/// A picture of 8-bit sRGB pixels with coverage.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    pixels: Pixmap,
}

impl Raster {
    /// Opaque pixels from linear RGB at each `(column, row)`, row 0 on top, under the gamut policy of pictures.
    ///
    /// # Panics
    /// If a side is 0 or the picture exceeds the address space.
    #[must_use]
    pub fn from_linear(width: u32, height: u32, mut rgb: impl FnMut(u32, u32) -> [f32; 3]) -> Self {
        Self::new(width, height, |x, y| {
            let [r, g, b] = srgb8(rgb(x, y));
            [r, g, b, 255]
        })
    }

    /// Pixels from linear RGB and coverage in [0, 1] at each `(column, row)`, row 0 on top, under the gamut policy of
    /// pictures.
    ///
    /// # Panics
    /// If a side is 0 or the picture exceeds the address space.
    #[must_use]
    pub fn from_linear_with_coverage(width: u32, height: u32, mut at: impl FnMut(u32, u32) -> ([f32; 3], f32)) -> Self {
        Self::new(width, height, |x, y| {
            let (rgb, coverage) = at(x, y);
            let [r, g, b] = srgb8(rgb);
            [r, g, b, (255.0 * coverage.clamp(0.0, 1.0)).round() as u8]
        })
    }

    /// Pixels from 8-bit sRGB and coverage at each `(column, row)`.
    pub(super) fn new(width: u32, height: u32, mut rgba: impl FnMut(u32, u32) -> [u8; 4]) -> Self {
        let mut pixels = Pixmap::new(width, height).expect("the sides of a raster are positive and small");
        for (i, pixel) in pixels.pixels_mut().iter_mut().enumerate() {
            let i = i as u32;
            let [r, g, b, a] = rgba(i % width, i / width);
            *pixel = ColorU8::from_rgba(r, g, b, a).premultiply();
        }
        Self { pixels }
    }

    /// The bytes of a PNG file.
    ///
    /// # Panics
    /// Never: encoding into memory does not fail.
    #[must_use]
    pub fn png(&self) -> Vec<u8> {
        self.pixels.encode_png().expect("encoding into memory does not fail")
    }

    pub(super) fn pixels(&self) -> &Pixmap {
        &self.pixels
    }

    pub(super) fn data_uri(&self) -> String {
        format!("data:image/png;base64,{}", STANDARD.encode(self.png()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_back_in_their_places() {
        let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3], [0.0; 3], [0.5; 3]];
        let raster = Raster::from_linear(3, 2, |x, y| colours[(x + 3 * y) as usize]);
        let back = Pixmap::decode_png(&raster.png()).unwrap();
        for (pixel, colour) in back.pixels().iter().zip(colours) {
            assert_eq!([pixel.red(), pixel.green(), pixel.blue()], srgb8(colour));
        }
        assert!(raster.data_uri().starts_with("data:image/png;base64,iVBORw0KGgo"));
    }
}
