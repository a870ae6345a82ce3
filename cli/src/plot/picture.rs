//! Finished pictures and their files.

use std::path::Path;

use tiny_skia::{Color, Pixmap, Transform};

use super::gamut::OutOfGamut;
use super::paint::{PaintShape, paint};
use super::svg::Canvas;
use crate::support::error::{Error, Result};

/// Pixels of a saved PNG per SVG unit: sharp in print and on dense screens.
pub const PNG_SCALE: f64 = 2.0;

/// Largest side of a PNG in pixels; 16384² of them already take a gigabyte.
const MAX_PNG_SIDE: f64 = 16_384.0;

/// A finished picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    svg: String,
    body: std::ops::Range<usize>,
    shapes: Vec<PaintShape>,
    width: f64,
    height: f64,
    out_of_gamut: OutOfGamut,
}

impl Picture {
    /// The picture of a canvas.
    pub(super) fn new(width: f64, height: f64, canvas: Canvas) -> Self {
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

    /// The picture with the count of its out-of-gamut colours.
    pub(super) fn showing(self, out_of_gamut: OutOfGamut) -> Self {
        Self { out_of_gamut, ..self }
    }

    /// Counts of the colours that show data, and of those that are out of gamut and were changed.
    #[must_use]
    pub fn out_of_gamut(&self) -> OutOfGamut {
        self.out_of_gamut
    }

    /// The SVG document.
    #[must_use]
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The shapes that its PNG is painted from.
    pub(super) fn shapes(&self) -> &[PaintShape] {
        &self.shapes
    }

    /// Width and height in SVG units, which are pixels at scale 1.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// The SVG elements inside the document, which another one can take in.
    pub(super) fn body(&self) -> &str {
        &self.svg[self.body.clone()]
    }

    /// The PNG file, at `scale` pixels per SVG unit. Its letters are the same on every machine.
    ///
    /// # Errors
    /// A side of less than 1 or more than 16384 pixels, or too little memory.
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
        paint(&self.shapes, Transform::from_scale(scale as f32, scale as f32), None, &mut pixels);
        pixels.encode_png().map_err(|error| Error::failed(format_args!("cannot encode the PNG: {error}")))
    }

    /// The bytes of a file at `path`: SVG or PNG by its extension.
    ///
    /// # Errors
    /// Another extension, as wrong usage; a PNG that is too large.
    pub fn encoded(&self, path: &Path) -> Result<Vec<u8>> {
        match PictureFormat::of(path)? {
            PictureFormat::Svg => Ok(self.svg.clone().into_bytes()),
            PictureFormat::Png => self.png(PNG_SCALE),
        }
    }

    /// Writes the file `path`, SVG or PNG by its extension.
    ///
    /// # Errors
    /// Another extension, as wrong usage; a PNG that is too large; a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<()> {
        crate::support::output::write_file(path, &self.encoded(path)?)
    }
}

/// The file format of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureFormat {
    /// Scalable lines and letters.
    Svg,
    /// Pixels.
    Png,
}

impl PictureFormat {
    /// The format that the extension of `path` names.
    ///
    /// # Errors
    /// Another extension, as wrong usage.
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
pub(super) mod tests {
    use super::*;
    use crate::plot::svg::{Anchor, Style};

    fn lettered(text: &str) -> Picture {
        let mut canvas = Canvas::default();
        canvas.text(10.0, 30.0, Anchor::Start, Style::title(), text);
        Picture::new(100.0, 50.0, canvas)
    }

    pub(in super::super) fn pixels(picture: &Picture, scale: f64) -> Pixmap {
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
