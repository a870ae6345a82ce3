//! A rendered picture, and its OpenEXR and PNG files.

use std::io::Cursor;

use exr::prelude::{Encoding, Image, Layer, LayerAttributes, SpecificChannels, Text, WritableImage};

use super::noise::NoiseReached;
use super::tone::{ToneMap, exposure};
use crate::plot::{OutOfGamut, Raster};
use crate::support::error::{Error, Result};

/// A rendered picture: linear RGB multiplied by coverage, and coverage, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Framebuffer {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// R, G, B and A, the coverage, of each pixel.
    pub pixels: Vec<[f32; 4]>,
    /// Whether some ray hit the body.
    pub shows_body: bool,
    /// Noise that was reached, where it was measured.
    pub noise: Option<NoiseReached>,
}

impl Framebuffer {
    /// The bytes of an OpenEXR file: scene-linear R, G, B multiplied by A, 32-bit float. Equal pictures give equal
    /// bytes.
    ///
    /// # Errors
    /// What the OpenEXR encoder refuses.
    pub fn exr(&self, comment: &str) -> Result<Vec<u8>> {
        let [width, height] = self.size.map(|side| side as usize);
        let pixel = |at: exr::math::Vec2<usize>| {
            let [r, g, b, a] = self.pixels[at.1 * width + at.0];
            (r, g, b, a)
        };
        let attributes = LayerAttributes {
            software_name: Some(Text::from(concat!("goniochrome ", env!("CARGO_PKG_VERSION")))),
            // UTF-8, although the crate's own conversion knows Latin-1 alone.
            comments: Some(Text::from_slice_unchecked(comment.as_bytes())),
            ..LayerAttributes::default()
        };
        let layer = Layer::new((width, height), attributes, Encoding::SMALL_LOSSLESS, SpecificChannels::rgba(pixel));
        let mut bytes = Cursor::new(Vec::new());
        Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(&mut bytes)
            .map_err(|error| Error::failed(format_args!("cannot encode the picture as EXR: {error}")))?;
        Ok(bytes.into_inner())
    }

    /// The bytes of a PNG file: exposed by `stops`, tone-mapped, then 8-bit sRGB under the gamut policy of pictures.
    /// The second result counts how many of the pixels that are not wholly transparent this policy has changed.
    #[must_use]
    pub fn png(&self, stops: f64, tone: ToneMap) -> (Vec<u8>, OutOfGamut) {
        let [width, height] = self.size;
        let factor = exposure(stops);
        let mut out_of_gamut = OutOfGamut::default();
        let pixel = |x: u32, y: u32| {
            let [r, g, b, a] = self.pixels[y as usize * width as usize + x as usize];
            let scale = if a > 0.0 { factor / a } else { 0.0 };
            let shown = tone.apply([r, g, b].map(|c| c * scale));
            if a > 0.0 {
                out_of_gamut += OutOfGamut::of(shown);
            }
            (shown, a)
        };
        let png = Raster::from_linear_with_coverage(width, height, pixel).png();
        (png, out_of_gamut)
    }
}
