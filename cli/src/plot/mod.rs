//! Pictures: every chart is drawn once, as SVG and as the shapes of its PNG, whose letters are the bundled fonts'.

mod axis;
mod chromaticity;
mod compare;
mod disc;
mod encode;
mod font;
mod gamut;
mod heat_map;
mod layout;
mod line_chart;
mod paint;
mod raster;
mod svg;
mod swatch;
pub mod tables;

use std::path::Path;

use tiny_skia::{Color, Pixmap, Transform};

use crate::support::error::{Error, Result};
use paint::Shape;
use svg::Canvas;

pub use chromaticity::{ColourAt, chromaticity, xy};
pub use compare::{Profile, side_by_side};
pub use disc::{Disc, Mark, disc, disc_grid, marked_disc};
pub use encode::{grey, hex, in_gamut, srgb8, wavelength_colour};
pub use gamut::OutOfGamut;
pub use heat_map::{HeatAxis, heat_map};
pub use layout::rows;
pub use line_chart::{LineOptions, PALETTE, Series, line_chart};
pub use raster::Raster;
pub(crate) use svg::escape;
pub use swatch::swatches;

/// Pixels of a saved PNG per SVG unit: sharp in print and on dense screens.
pub const PNG_SCALE: f64 = 2.0;

/// Pixels of a PNG on its longer side; 16384² of them would already take a gigabyte.
const MAX_PNG_SIDE: f64 = 16_384.0;

/// A finished picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    svg: String,
    body: std::ops::Range<usize>,
    shapes: Vec<Shape>,
    width: f64,
    height: f64,
    out_of_gamut: OutOfGamut,
}

impl Picture {
    fn new(width: f64, height: f64, canvas: Canvas) -> Self {
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             font-family=\"Inter, 'Helvetica Neue', Arial, sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        let start = svg.len();
        let (elements, shapes) = canvas.finish();
        svg.push_str(&elements);
        let body = start..svg.len();
        svg.push_str("</svg>\n");
        Self { svg, body, shapes, width, height, out_of_gamut: OutOfGamut::default() }
    }

    /// The same picture, which shows such colours.
    fn showing(self, out_of_gamut: OutOfGamut) -> Self {
        Self { out_of_gamut, ..self }
    }

    /// How many of the pixels that show measured colours had to be changed.
    #[must_use]
    pub fn out_of_gamut(&self) -> OutOfGamut {
        self.out_of_gamut
    }

    /// The SVG document.
    #[must_use]
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// Width and height in SVG units, which are pixels at scale 1.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// The elements inside the document, for placing them in another one.
    fn body(&self) -> &str {
        &self.svg[self.body.clone()]
    }

    /// The same picture as PNG, `scale` pixels per SVG unit, with the same letters on every machine.
    pub fn png(&self, scale: f64) -> Result<Vec<u8>> {
        let (width, height) = ((self.width * scale).round(), (self.height * scale).round());
        if !(width >= 1.0 && height >= 1.0 && width.max(height) <= MAX_PNG_SIDE) {
            return Err(Error::failed(format_args!(
                "a PNG of {width} × {height} pixels is out of range; sides go from 1 to {MAX_PNG_SIDE}, SVG has no limit"
            )));
        }
        let mut pixels = Pixmap::new(width as u32, height as u32)
            .ok_or_else(|| Error::failed(format_args!("no memory for {width} × {height} pixels")))?;
        pixels.fill(Color::WHITE);
        paint::paint(&self.shapes, Transform::from_scale(scale as f32, scale as f32), None, &mut pixels);
        pixels.encode_png().map_err(|error| Error::failed(format_args!("cannot encode the PNG: {error}")))
    }

    /// The bytes of a file at `path`: SVG or PNG, as its extension says.
    pub fn encoded(&self, path: &Path) -> Result<Vec<u8>> {
        match Format::of(path)? {
            Format::Svg => Ok(self.svg.clone().into_bytes()),
            Format::Png => self.png(PNG_SCALE),
        }
    }

    /// Writes `path` as SVG or PNG, as its extension says.
    pub fn save(&self, path: &Path) -> Result<()> {
        crate::support::output::write_file(path, &self.encoded(path)?)
    }
}

/// How a picture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Lines and letters.
    Svg,
    /// Pixels.
    Png,
}

impl Format {
    /// What the extension of `path` says; any other than these is wrong usage.
    pub fn of(path: &Path) -> Result<Self> {
        match path.extension().unwrap_or_default().to_ascii_lowercase().to_str() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(Error::usage(format_args!(
                "{}: pictures are written as .png or .svg; choose one of these extensions",
                path.display()
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use svg::{Anchor, Style};

    fn lettered(text: &str) -> Picture {
        let mut canvas = Canvas::default();
        canvas.text(10.0, 30.0, Anchor::Start, Style::title(), text);
        Picture::new(100.0, 50.0, canvas)
    }

    pub(super) fn pixels(picture: &Picture, scale: f64) -> Pixmap {
        Pixmap::decode_png(&picture.png(scale).unwrap()).unwrap()
    }

    #[test]
    fn the_extension_chooses_the_format() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let picture = lettered("θ");
        picture.save(&at("a.svg")).unwrap();
        picture.save(&at("a.PNG")).unwrap();
        assert_eq!(std::fs::read_to_string(at("a.svg")).unwrap(), picture.svg());
        let png = Pixmap::decode_png(&std::fs::read(at("a.PNG")).unwrap()).unwrap();
        assert_eq!((png.width(), png.height()), (200, 100));
        for name in ["a.jpg", "png"] {
            let error = picture.save(&at(name)).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains(".png or .svg"), "{error}");
        }
    }

    #[test]
    fn letters_and_signs_are_drawn_with_the_bundled_font() {
        let ink = |text: &str| pixels(&lettered(text), 1.0).pixels().iter().filter(|p| p.red() < 128).count();
        assert_eq!(ink(""), 0);
        // A missing glyph would be drawn as the same box as any other missing glyph.
        let missing = pixels(&lettered("\u{4e2d}"), 1.0);
        for sign in ["θ", "λ", "φ", "°", "−", "⁻", "≤", "Δ", "₂"] {
            assert!(ink(sign) > 3, "{sign}");
            assert_ne!(pixels(&lettered(sign), 1.0).data(), missing.data(), "{sign}");
        }
    }

    #[test]
    fn titles_are_bold() {
        let label = |bold| {
            let mut canvas = Canvas::default();
            canvas.text(10.0, 30.0, Anchor::Start, Style { bold, ..Style::title() }, "nm");
            let picture = Picture::new(100.0, 50.0, canvas);
            pixels(&picture, 1.0).pixels().iter().map(|p| 255 - u32::from(p.red())).sum::<u32>()
        };
        assert!(label(true) * 10 > label(false) * 11, "{} against {}", label(true), label(false));
    }

    #[test]
    fn absurd_sizes_are_refused() {
        assert!(lettered("a").png(1e4).unwrap_err().to_string().contains("1000000 × 500000 pixels is out of range"));
        assert!(lettered("a").png(f64::NAN).is_err());
    }
}
