//! Rows of labelled colour swatches.

use super::encode::hex;
use super::place::Place;
use super::svg::{Anchor, Canvas, Style};
use super::{Picture, svg};

/// A picture of squares of linear RGB, each with its label above and its sRGB code below.
#[must_use]
pub fn swatches(title: &str, colours: &[(String, [f32; 3])]) -> Picture {
    const SIDE: f64 = 72.0;
    const MARGIN: f64 = 20.0;
    let mut canvas = Canvas::default();
    canvas.text(MARGIN, 28.0, Anchor::Start, Style::title(), title);
    for (i, (label, rgb)) in colours.iter().enumerate() {
        let place = Place { x: MARGIN + i as f64 * (SIDE + 8.0), y: 66.0, width: SIDE, height: SIDE };
        let centre = place.x + 0.5 * SIDE;
        canvas.text(centre, 56.0, Anchor::Middle, Style::label(), label);
        canvas.block(place, &hex(*rgb));
        canvas.frame(place.grown(-0.25), svg::GRID, 0.5);
        canvas.text(centre, place.bottom() + 17.0, Anchor::Middle, Style::tick(), &hex(*rgb));
    }
    let row = colours.len() as f64 * (SIDE + 8.0) - 8.0;
    let width = row.max(svg::text_width(title, Style::title().size)) + 2.0 * MARGIN;
    Picture::new(width.ceil(), 172.0, canvas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_stand_in_order_under_their_labels() {
        let picture = swatches("n", &[("0°".into(), [1.0, 0.0, 0.0]), ("60°".into(), [0.0, 0.5, 0.0])]);
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        let at = |x, y| pixels.pixel(x, y).map(|p| [p.red(), p.green(), p.blue()]).unwrap();
        assert_eq!((at(50, 100), at(130, 100)), ([255, 0, 0], [0, 188, 0]));
        for text in [">0°<", ">60°<", ">#ff0000<", ">#00bc00<"] {
            assert!(picture.svg().contains(text), "{text}");
        }
    }
}
