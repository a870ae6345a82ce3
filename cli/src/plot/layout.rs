//! One picture made of several.

use super::picture::Picture;
use super::svg::{Anchor, Canvas, Style};

/// A picture of several in rows under one title; each row is centred.
#[must_use]
pub fn rows(title: &str, rows: &[Vec<Picture>]) -> Picture {
    const GAP: f64 = 8.0;
    let row_width = |row: &Vec<Picture>| row.iter().map(|p| p.size().0 + GAP).sum::<f64>() - GAP;
    let width = rows.iter().map(row_width).fold(0.0, f64::max);
    let mut canvas = Canvas::default();
    let mut y = 0.0;
    if !title.is_empty() {
        let style = Style { size: 18.0, ..Style::title() }.fitted(title, width - 24.0);
        canvas.text(0.5 * width, 34.0, Anchor::Middle, style, title);
        y = 48.0;
    }
    for row in rows {
        let mut x = 0.5 * (width - row_width(row));
        for picture in row {
            canvas.moved(x, y, |canvas| canvas.append(picture.body(), picture.shapes()));
            x += picture.size().0 + GAP;
        }
        y += row.iter().map(|p| p.size().1).fold(0.0, f64::max) + GAP;
    }
    Picture::new(width.max(1.0).ceil(), y.max(1.0).ceil(), canvas)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::picture::tests::pixels;
    use crate::plot::swatches;

    #[test]
    fn pictures_stand_side_by_side_and_below() {
        let one = |rgb| swatches("", &[("".into(), rgb)]);
        let all = rows("Both", &[vec![one([1.0, 0.0, 0.0]), one([0.0, 1.0, 0.0])], vec![one([0.0, 0.0, 1.0])]]);
        let (width, height) = one([0.0; 3]).size();
        assert_eq!(all.size(), (2.0 * width + 8.0, 48.0 + 2.0 * (height + 8.0)));
        let pixels = pixels(&all, 1.0);
        let at = |x: f64, y: f64| pixels.pixel(x as u32, y as u32).map(|p| [p.red(), p.green(), p.blue()]).unwrap();
        assert_eq!(at(50.0, 148.0), [255, 0, 0]);
        assert_eq!(at(50.0 + width + 8.0, 148.0), [0, 255, 0]);
        assert_eq!(at(width + 4.0, 148.0 + height + 8.0), [0, 0, 255]);
        assert!(all.svg().contains(">Both<"));
        assert_eq!(all.svg().matches("<svg ").count(), 1);
    }
}
