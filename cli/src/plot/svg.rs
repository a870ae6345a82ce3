//! The canvas of a picture: SVG elements, each with the shape that is painted for it in PNG, and the type sizes and
//! greys that all pictures share.

use std::fmt::Write;

use tiny_skia::{LineCap, LineJoin, Path, Stroke, StrokeDash, Transform};

use super::font;
use super::paint::{PaintShape, circle, colour, polyline, rectangle};
use super::place::{Place, number};
use super::raster::Raster;
use crate::support::text::is_active;

pub(super) const INK: &str = "#1b1b1f";
pub(super) const SOFT_INK: &str = "#55555d";
pub(super) const GRID: &str = "#e7e7ea";
pub(super) const AXIS: &str = "#8a8a92";

/// Width of the bundled semi-bold font over that of the regular one.
const BOLD_WIDTH: f64 = 1.06;

/// The point of a text that stands at the given place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Dashes of a line.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Dash {
    /// A full line.
    #[default]
    None,
    /// Long dashes.
    Long,
    /// Short dashes.
    Short,
}

impl Dash {
    /// Lengths of a dash and of the gap after it.
    fn lengths(self) -> Option<[f32; 2]> {
        match self {
            Self::None => None,
            Self::Long => Some([6.0, 5.0]),
            Self::Short => Some([2.0, 3.0]),
        }
    }
}

/// Size, colour and weight of a text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Style {
    pub size: f64,
    pub colour: &'static str,
    pub bold: bool,
}

impl Style {
    pub(super) fn title() -> Self {
        Self { size: 15.0, colour: INK, bold: true }
    }

    pub(super) fn label() -> Self {
        Self { size: 12.5, colour: INK, bold: false }
    }

    pub(super) fn tick() -> Self {
        Self { size: 11.5, colour: SOFT_INK, bold: false }
    }

    /// The style with letters so much smaller that the text is no wider than `width`, but at least half as large.
    pub(super) fn fitted(self, text: &str, width: f64) -> Self {
        let natural = text_width(text, self.size) * if self.bold { BOLD_WIDTH } else { 1.0 };
        Self { size: self.size * (width / natural).clamp(0.5, 1.0), ..self }
    }
}

/// A drawing in two forms: SVG elements, and the shapes that a PNG is painted from.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    body: String,
    shapes: Vec<PaintShape>,
}

impl Canvas {
    /// The SVG elements and the shapes.
    pub(super) fn finish(self) -> (String, Vec<PaintShape>) {
        (self.body, self.shapes)
    }

    /// Adds the elements and the shapes of another drawing.
    pub(super) fn append(&mut self, elements: &str, shapes: &[PaintShape]) {
        self.body.push_str(elements);
        self.shapes.extend_from_slice(shapes);
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }

    fn fill(&mut self, path: Option<Path>, fill: &str) {
        self.shapes.extend(path.zip(colour(fill)).map(|(path, colour)| PaintShape::Fill { path, colour }));
    }

    fn stroke(&mut self, path: Option<Path>, code: &str, stroke: Stroke) {
        let shape = |(path, colour)| PaintShape::Stroke { path, colour, stroke };
        self.shapes.extend(path.zip(colour(code)).map(shape));
    }

    /// Runs `draw` and takes out the shapes that it adds.
    fn shapes_of(&mut self, draw: impl FnOnce(&mut Self)) -> Vec<PaintShape> {
        let before = std::mem::take(&mut self.shapes);
        draw(self);
        std::mem::replace(&mut self.shapes, before)
    }

    pub(super) fn text(&mut self, x: f64, y: f64, anchor: Anchor, style: Style, text: &str) {
        self.turned_text(x, y, 0.0, anchor, style, text);
    }

    /// Adds a text turned clockwise about its anchor.
    pub(super) fn turned_text(&mut self, x: f64, y: f64, degrees: f64, anchor: Anchor, style: Style, text: &str) {
        let (anchor, share_before) = match anchor {
            Anchor::Start => ("start", 0.0),
            Anchor::Middle => ("middle", 0.5),
            Anchor::End => ("end", 1.0),
        };
        let weight = if style.bold { " font-weight=\"600\"" } else { "" };
        let (x, y) = (number(x), number(y));
        let turn = if degrees == 0.0 { String::new() } else { format!(" transform=\"rotate({degrees} {x} {y})\"") };
        self.element(format_args!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\" fill=\"{}\" text-anchor=\"{anchor}\"{weight}{turn}>{}</text>",
            number(style.size),
            style.colour,
            escape(text)
        ));
        let (letters, width) = font::outline(text, number(style.size), style.bold);
        let placed = Transform::from_translate((x - share_before * width) as f32, y as f32);
        let turned = placed.post_concat(Transform::from_rotate_at(degrees as f32, x as f32, y as f32));
        self.fill(letters.and_then(|letters| letters.transform(turned)), style.colour);
    }

    pub(super) fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: &str, width: f64) {
        let [x1, y1, x2, y2] = [from.0, from.1, to.0, to.1].map(number);
        self.element(format_args!(
            "<path d=\"M{x1} {y1}L{x2} {y2}\" stroke=\"{}\" stroke-width=\"{width}\"/>",
            escape(stroke)
        ));
        self.stroke(polyline(&[(x1, y1), (x2, y2)]), stroke, of_width(width));
    }

    /// Adds an open curve through the points.
    pub(super) fn curve(&mut self, points: &[(f64, f64)], stroke: &str, width: f64, dash: Dash) {
        if points.is_empty() {
            return;
        }
        // A curve of one point is a dot.
        let again = if let [only] = points { Some(only) } else { None };
        let points: Vec<_> = points.iter().chain(again).map(|(x, y)| (number(*x), number(*y))).collect();
        let mut path = String::new();
        for (i, (x, y)) in points.iter().enumerate() {
            let _ = write!(path, "{}{x} {y}", if i == 0 { 'M' } else { 'L' });
        }
        let lengths = dash.lengths();
        let dashes = lengths.map_or_else(
            || " stroke-linecap=\"round\"".to_owned(),
            |[on, off]| format!(" stroke-dasharray=\"{on} {off}\" stroke-linecap=\"butt\""),
        );
        self.element(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dashes}/>",
            escape(stroke)
        ));
        let round = Stroke { line_join: LineJoin::Round, ..of_width(width) };
        let drawn = match lengths {
            Some(lengths) => Stroke { dash: StrokeDash::new(lengths.to_vec(), 0.0), ..round },
            None => Stroke { line_cap: LineCap::Round, ..round },
        };
        self.stroke(polyline(&points), stroke, drawn);
    }

    pub(super) fn ring(&mut self, centre: (f64, f64), radius: f64, stroke: &str, width: f64, opacity: f64) {
        let [x, y, radius] = [centre.0, centre.1, radius].map(number);
        self.element(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\" \
             stroke-opacity=\"{opacity}\"/>"
        ));
        if let Some((path, mut colour)) = circle((x, y), radius).zip(colour(stroke)) {
            colour.apply_opacity(opacity as f32);
            self.shapes.push(PaintShape::Stroke { path, colour, stroke: of_width(width) });
        }
    }

    /// Adds a filled circle.
    pub(super) fn dot(&mut self, centre: (f64, f64), radius: f64, fill: &str) {
        let [x, y, radius] = [centre.0, centre.1, radius].map(number);
        self.element(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", escape(fill)));
        self.fill(circle((x, y), radius), fill);
    }

    /// Adds a filled box with square corners.
    pub(super) fn block(&mut self, place: Place, fill: &str) {
        self.element(format_args!("<rect {place} fill=\"{}\"/>", escape(fill)));
        self.fill(rectangle(place.rounded()), fill);
    }

    /// Adds the outline of a box.
    pub(super) fn frame(&mut self, place: Place, stroke: &str, width: f64) {
        self.element(format_args!("<rect {place} fill=\"none\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>"));
        self.stroke(rectangle(place.rounded()), stroke, of_width(width));
    }

    pub(super) fn image(&mut self, place: Place, raster: &Raster) {
        // Old viewers know only xlink:href, new ones both.
        self.element(format_args!(
            "<image {place} preserveAspectRatio=\"none\" xlink:href=\"{}\"/>",
            raster.data_uri()
        ));
        self.shapes.push(PaintShape::Image { place: place.rounded(), pixels: raster.pixels().clone() });
    }

    /// Draws clipped to `place`; coordinates stay those of the canvas. The clip needs no id, so pictures can be nested
    /// freely.
    pub(super) fn clipped(&mut self, place: Place, draw: impl FnOnce(&mut Self)) {
        let [x, y, width, height] = [place.x, place.y, place.width, place.height].map(number);
        self.element(format_args!("<svg {place} viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"));
        let shapes = self.shapes_of(draw);
        self.element(format_args!("</svg>"));
        self.shapes.push(PaintShape::Clipped { place: place.rounded(), shapes });
    }

    /// Draws with the origin moved to `(x, y)`.
    pub(super) fn moved(&mut self, x: f64, y: f64, draw: impl FnOnce(&mut Self)) {
        let (x, y) = (number(x), number(y));
        self.element(format_args!("<g transform=\"translate({x} {y})\">"));
        let shapes = self.shapes_of(draw);
        self.element(format_args!("</g>"));
        self.shapes.push(PaintShape::Moved { x, y, shapes });
    }
}

/// A stroke of a width, with SVG's default joins and ends.
fn of_width(width: f64) -> Stroke {
    Stroke { width: width as f32, ..Stroke::default() }
}

/// Escapes text for use between tags and in quotes.
pub(crate) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // XML 1.0 cannot hold control characters, not even escaped; characters that turn the direction of writing
            // would turn the document's own text.
            c if is_active(c) || matches!(c, '\u{fffe}' | '\u{ffff}') => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

/// Estimated width of a text in Inter, accurate to a few per cent: enough to place what stands beside it.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' => 0.28,
        'f' | 'r' | 't' | '(' | ')' | '-' | '°' | '/' => 0.38,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.9,
        c if c.is_uppercase() || c.is_ascii_digit() || "=+−×→".contains(c) => 0.67,
        c if c.is_ascii() || c.is_alphabetic() => 0.59,
        _ => 0.6,
    };
    size * text.chars().map(em).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::picture::{Picture, tests::pixels};

    #[test]
    fn text_from_users_cannot_break_the_document() {
        assert_eq!(escape("a<b> & \"c\"\u{0}\n\u{9b}\u{202e}"), "a&lt;b&gt; &amp; &quot;c&quot;    ");
        let mut canvas = Canvas::default();
        canvas.text(0.0, 0.0, Anchor::Start, Style::label(), "</text>&\u{1}");
        canvas.line((0.0, 0.0), (1.0, 1.0), "\"/>", 1.0);
        let picture = Picture::new(10.0, 10.0, canvas);
        picture.png(1.0).unwrap();
    }

    #[test]
    fn estimated_widths_bracket_the_drawn_ones() {
        for text in ["wavelength λ / nm", "closed form, s", "0.001", "unpolarised mean 45°", "MgF2 100 nm"] {
            let mut canvas = Canvas::default();
            canvas.text(0.0, 30.0, Anchor::Start, Style::label(), text);
            let drawn = pixels(&Picture::new(300.0, 50.0, canvas), 1.0);
            let ink = |x: &u32| (0..50).any(|y| drawn.pixel(*x, y).unwrap().red() < 160);
            let width = f64::from((0..300).filter(ink).max().unwrap() + 1);
            let estimate = text_width(text, 12.5);
            assert!((0.97..1.2).contains(&(estimate / width)), "{text}: {estimate} for {width}");
        }
    }
}
