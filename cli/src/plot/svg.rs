//! A few SVG elements, each beside the shape that is painted for it, and the type sizes and greys that all pictures
//! share.

use std::fmt::Write;

use tiny_skia::{LineCap, LineJoin, Path, Stroke, StrokeDash, Transform};

use super::paint::{Shape, circle, colour, polyline, rectangle};
use super::raster::Raster;
use super::{Picture, font};
use crate::support::text::is_active;

pub(super) const INK: &str = "#1b1b1f";
pub(super) const SOFT_INK: &str = "#55555d";
pub(super) const GRID: &str = "#e7e7ea";
pub(super) const AXIS: &str = "#8a8a92";

/// How much wider than regular the bundled semi-bold is.
const BOLD_WIDTH: f64 = 1.06;

/// Which point of the text stands at the given place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

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

    /// The same style, smaller if the text would be wider than `width`.
    pub(super) fn fitted(self, text: &str, width: f64) -> Self {
        let natural = text_width(text, self.size) * if self.bold { BOLD_WIDTH } else { 1.0 };
        Self { size: self.size * (width / natural).clamp(0.5, 1.0), ..self }
    }
}

/// What is drawn so far, twice: as SVG elements, and as the shapes of a PNG.
#[derive(Debug, Default)]
pub(super) struct Canvas {
    body: String,
    shapes: Vec<Shape>,
}

impl Canvas {
    /// The SVG elements and the shapes.
    pub(super) fn finish(self) -> (String, Vec<Shape>) {
        (self.body, self.shapes)
    }

    /// Adds all of a picture.
    pub(super) fn picture(&mut self, picture: &Picture) {
        self.body.push_str(picture.body());
        self.shapes.extend_from_slice(&picture.shapes);
    }

    fn element(&mut self, element: std::fmt::Arguments) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }

    fn fill(&mut self, path: Option<Path>, fill: &str) {
        self.shapes.extend(path.zip(colour(fill)).map(|(path, colour)| Shape::Fill { path, colour }));
    }

    fn stroke(&mut self, path: Option<Path>, code: &str, stroke: Stroke) {
        let shape = |(path, colour)| Shape::Stroke { path, colour, stroke };
        self.shapes.extend(path.zip(colour(code)).map(shape));
    }

    /// The shapes that `draw` adds.
    fn shapes_of(&mut self, draw: impl FnOnce(&mut Self)) -> Vec<Shape> {
        let before = std::mem::take(&mut self.shapes);
        draw(self);
        std::mem::replace(&mut self.shapes, before)
    }

    pub(super) fn text(&mut self, x: f64, y: f64, anchor: Anchor, style: Style, text: &str) {
        self.turned_text(x, y, 0.0, anchor, style, text);
    }

    /// Text turned clockwise about its anchor.
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

    /// An open curve through the points.
    pub(super) fn curve(&mut self, points: &[(f64, f64)], stroke: &str, width: f64, dashed: bool) {
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
        let dash =
            if dashed { " stroke-dasharray=\"6 5\" stroke-linecap=\"butt\"" } else { " stroke-linecap=\"round\"" };
        self.element(format_args!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"{dash}/>",
            escape(stroke)
        ));
        let round = Stroke { line_join: LineJoin::Round, ..of_width(width) };
        let drawn = if dashed {
            Stroke { dash: StrokeDash::new(vec![6.0, 5.0], 0.0), ..round }
        } else {
            Stroke { line_cap: LineCap::Round, ..round }
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
            self.shapes.push(Shape::Stroke { path, colour, stroke: of_width(width) });
        }
    }

    /// A filled circle.
    pub(super) fn dot(&mut self, centre: (f64, f64), radius: f64, fill: &str) {
        let [x, y, radius] = [centre.0, centre.1, radius].map(number);
        self.element(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", escape(fill)));
        self.fill(circle((x, y), radius), fill);
    }

    /// A filled box with square corners.
    pub(super) fn block(&mut self, place: Place, fill: &str) {
        self.element(format_args!("<rect {place} fill=\"{}\"/>", escape(fill)));
        self.fill(rectangle(place.rounded()), fill);
    }

    /// The outline of a box.
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
        self.shapes.push(Shape::Image { place: place.rounded(), pixels: raster.pixels().clone() });
    }

    /// Draws within `place` alone; coordinates stay those of the canvas. Needs no id, so pictures can be nested freely.
    pub(super) fn clipped(&mut self, place: Place, draw: impl FnOnce(&mut Self)) {
        let [x, y, width, height] = [place.x, place.y, place.width, place.height].map(number);
        self.element(format_args!("<svg {place} viewBox=\"{x} {y} {width} {height}\" overflow=\"hidden\">"));
        let shapes = self.shapes_of(draw);
        self.element(format_args!("</svg>"));
        self.shapes.push(Shape::Clipped { place: place.rounded(), shapes });
    }

    /// Draws with the origin moved to `(x, y)`.
    pub(super) fn moved(&mut self, x: f64, y: f64, draw: impl FnOnce(&mut Self)) {
        let (x, y) = (number(x), number(y));
        self.element(format_args!("<g transform=\"translate({x} {y})\">"));
        let shapes = self.shapes_of(draw);
        self.element(format_args!("</g>"));
        self.shapes.push(Shape::Moved { x, y, shapes });
    }
}

/// A box on the canvas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Place {
    pub(super) fn right(&self) -> f64 {
        self.x + self.width
    }

    pub(super) fn bottom(&self) -> f64 {
        self.y + self.height
    }

    pub(super) fn grown(&self, by: f64) -> Self {
        Self { x: self.x - by, y: self.y - by, width: self.width + 2.0 * by, height: self.height + 2.0 * by }
    }

    /// The box as it is written.
    fn rounded(&self) -> Self {
        let [x, y, width, height] = [self.x, self.y, self.width, self.height].map(number);
        Self { x, y, width, height }
    }
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { x, y, width, height } = self.rounded();
        write!(f, "x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"")
    }
}

/// A line of this width with SVG's joins and ends.
fn of_width(width: f64) -> Stroke {
    Stroke { width: width as f32, ..Stroke::default() }
}

/// Hundredths of a pixel are enough, and keep files small.
fn number(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// Text that is safe between tags and in quotes.
pub(crate) fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            // XML 1.0 cannot hold control characters, not even escaped, and what turns writing would turn the page's
            // own.
            c if is_active(c) || matches!(c, '\u{fffe}' | '\u{ffff}') => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}

/// Width of a text in Inter, good to a few per cent: enough to place what stands beside it.
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
            let drawn = super::super::tests::pixels(&Picture::new(300.0, 50.0, canvas), 1.0);
            let ink = |x: &u32| (0..50).any(|y| drawn.pixel(*x, y).unwrap().red() < 160);
            let width = f64::from((0..300).filter(ink).max().unwrap() + 1);
            let estimate = text_width(text, 12.5);
            assert!((0.97..1.2).contains(&(estimate / width)), "{text}: {estimate} for {width}");
        }
    }
}
