//! Text as outlines of the two bundled fonts, the same on every machine.
//!
//! Glyphs are placed by their advances and the fonts' kerning. Latin, Greek and signs, which the fonts hold, need no
//! more shaping; a character that they lack is drawn as their box for missing glyphs.

use std::sync::OnceLock;

use tiny_skia::{Path, PathBuilder};
use ttf_parser::gpos::{PairAdjustment, PositioningSubtable};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

use crate::support::text::is_active;

/// The outlines of a text and its width, for a font size in SVG units.
///
/// The baseline starts at the origin, and y points downwards. `None` stands for the outlines of blank text. White space
/// is treated as in SVG: a run counts as one space, and none stands at the ends.
pub(super) fn outline(text: &str, size: f64, bold: bool) -> (Option<Path>, f64) {
    let face = face(bold);
    let shown: String = text.chars().map(|c| if is_active(c) { ' ' } else { c }).collect();
    let words: Vec<&str> = shown.split(' ').filter(|word| !word.is_empty()).collect();
    let scale = size as f32 / f32::from(face.units_per_em());
    let mut pen = Pen { path: PathBuilder::new(), scale, x: 0.0 };
    let mut last = None;
    for c in words.join(" ").chars() {
        let glyph = match face.glyph_index(c) {
            Some(glyph) => glyph,
            None if is_invisible(c) => continue,
            None => GlyphId(0),
        };
        pen.x += last.map_or(0.0, |last| f32::from(kerning(face, last, glyph)));
        face.outline_glyph(glyph, &mut pen);
        pen.x += f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
        last = Some(glyph);
    }
    (pen.path.finish(), f64::from(pen.x * scale))
}

/// Whether a character that the fonts lack is left out instead of drawn as a box: combining marks, joiners, variation
/// selectors and soft hyphens.
fn is_invisible(c: char) -> bool {
    matches!(c, '\u{300}'..='\u{36f}' | '\u{200b}'..='\u{200d}' | '\u{fe00}'..='\u{fe0f}')
        || matches!(c, '\u{ad}' | '\u{2060}' | '\u{feff}')
}

/// The font Inter, regular or semi-bold.
fn face(bold: bool) -> &'static Face<'static> {
    static FACES: OnceLock<[Face; 2]> = OnceLock::new();
    let faces = || {
        let files: [&[u8]; 2] =
            [include_bytes!("../../fonts/Inter-Regular.ttf"), include_bytes!("../../fonts/Inter-SemiBold.ttf")];
        files.map(|file| Face::parse(file, 0).expect("the bundled fonts are sound"))
    };
    &FACES.get_or_init(faces)[usize::from(bold)]
}

/// The kerning of two neighbours, in the font's units. All lookups of the bundled fonts are kerning.
fn kerning(face: &Face, left: GlyphId, right: GlyphId) -> i16 {
    let Some(table) = face.tables().gpos else { return 0 };
    let by_lookup = |lookup: ttf_parser::opentype_layout::Lookup| {
        lookup.subtables.into_iter::<PositioningSubtable>().find_map(|subtable| pair(&subtable, left, right))
    };
    (0..table.lookups.len()).filter_map(|i| table.lookups.get(i)).filter_map(by_lookup).sum()
}

/// The kerning of a pair by one subtable; `None` if the subtable does not hold the pair.
fn pair(subtable: &PositioningSubtable, left: GlyphId, right: GlyphId) -> Option<i16> {
    let PositioningSubtable::Pair(pairs) = subtable else { return None };
    let covered = pairs.coverage().get(left)?;
    let (value, _) = match pairs {
        PairAdjustment::Format1 { sets, .. } => sets.get(covered)?.get(right)?,
        PairAdjustment::Format2 { classes, matrix, .. } => matrix.get((classes.0.get(left), classes.1.get(right)))?,
    };
    Some(value.x_advance)
}

/// Builder of a path from glyphs, which are given in the font's units with y upwards and start at `x`.
struct Pen {
    path: PathBuilder,
    scale: f32,
    x: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        ((self.x + x) * self.scale, -y * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.path.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn width(text: &str) -> f64 {
        // Of a size of 2048, the font's units per em.
        outline(text, 2048.0, false).1
    }

    #[test]
    fn pairs_are_kerned() {
        assert_eq!(face(false).units_per_em(), 2048);
        for (pair, closer) in [("AV", true), ("To", true), ("HH", false), ("nn", false)] {
            let apart: f64 = pair.chars().map(|c| width(&c.to_string())).sum();
            assert_eq!(width(pair) < apart, closer, "{pair}: {} of {apart}", width(pair));
        }
    }

    #[test]
    fn white_space_is_as_in_svg() {
        let one = outline("a b", 12.0, false);
        for text in ["  a b ", "a \t b", "a\nb", "a\u{202e} b"] {
            assert_eq!(outline(text, 12.0, false), one, "{text:?}");
        }
        assert_eq!(outline(" \n", 12.0, false), (None, 0.0));
        assert_ne!(outline("a\u{a0}\u{a0}b", 12.0, false), one);
    }

    #[test]
    fn marks_without_a_glyph_leave_their_letters() {
        assert_eq!(outline("e\u{301}x\u{fe0f}", 12.0, true), outline("ex", 12.0, true));
        assert_eq!(width("\u{4e2d}"), width("\u{5d0}"));
        assert!(width("\u{4e2d}") > 0.0);
    }
}
