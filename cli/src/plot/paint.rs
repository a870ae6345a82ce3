//! Painting the shapes of a picture into pixels.

use tiny_skia::{
    Color, FillRule, FilterQuality, Mask, Paint, Path, PathBuilder, Pattern, Pixmap, Rect, SpreadMode, Stroke,
    Transform,
};

use super::place::Place;

/// A shape of a picture, in SVG units.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum PaintShape {
    /// A filled path.
    Fill { path: Path, colour: Color },
    /// A stroked path.
    Stroke { path: Path, colour: Color, stroke: Stroke },
    /// Pixels stretched over a box.
    Image { place: Place, pixels: Pixmap },
    /// Shapes clipped to a box.
    Clipped { place: Place, shapes: Vec<PaintShape> },
    /// Shapes moved by x and y.
    Moved { x: f64, y: f64, shapes: Vec<PaintShape> },
}

/// Paints shapes over each other, the last on top. `to_pixels` takes their coordinates to those of the pixels; nothing
/// is painted outside of `clip`.
pub(super) fn paint(shapes: &[PaintShape], to_pixels: Transform, clip: Option<&Mask>, pixels: &mut Pixmap) {
    let solid = |colour: &Color| {
        let mut paint = Paint::default();
        paint.set_color(*colour);
        paint
    };
    for shape in shapes {
        match shape {
            PaintShape::Fill { path, colour } => {
                pixels.fill_path(path, &solid(colour), FillRule::Winding, to_pixels, clip);
            }
            PaintShape::Stroke { path, colour, stroke } => {
                pixels.stroke_path(path, &solid(colour), stroke, to_pixels, clip);
            }
            PaintShape::Image { place, pixels: image } => {
                let (width, height) = (image.width() as f32, image.height() as f32);
                let Some(whole) = Rect::from_xywh(0.0, 0.0, width, height) else { continue };
                let [x, y, right, bottom] = [place.x, place.y, place.width, place.height].map(|v| v as f32);
                let stretched =
                    to_pixels.pre_concat(Transform::from_row(right / width, 0.0, 0.0, bottom / height, x, y));
                let unchanged = Transform::identity();
                let shader = Pattern::new(image.as_ref(), SpreadMode::Pad, FilterQuality::Bicubic, 1.0, unchanged);
                pixels.fill_rect(whole, &Paint { shader, ..Paint::default() }, stretched, clip);
            }
            PaintShape::Clipped { place, shapes } => {
                let Some(path) = rectangle(*place) else { continue };
                let within = match clip {
                    Some(clip) => {
                        let mut both = clip.clone();
                        both.intersect_path(&path, FillRule::Winding, true, to_pixels);
                        Some(both)
                    }
                    None => Mask::new(pixels.width(), pixels.height()).map(|mut mask| {
                        mask.fill_path(&path, FillRule::Winding, true, to_pixels);
                        mask
                    }),
                };
                paint(shapes, to_pixels, within.as_ref(), pixels);
            }
            PaintShape::Moved { x, y, shapes } => {
                paint(shapes, to_pixels.pre_translate(*x as f32, *y as f32), clip, pixels);
            }
        }
    }
}

/// The path of straight lines from point to point; `None` if there are fewer than two points.
pub(super) fn polyline(points: &[(f64, f64)]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let (x, y) = (x as f32, y as f32);
        if i == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
    }
    path.finish()
}

/// The outline of a box; `None` if the box is empty.
pub(super) fn rectangle(place: Place) -> Option<Path> {
    let [x, y, width, height] = [place.x, place.y, place.width, place.height].map(|v| v as f32);
    Rect::from_xywh(x, y, width, height).map(PathBuilder::from_rect)
}

/// The path of a circle; `None` if its radius is not positive.
pub(super) fn circle(centre: (f64, f64), radius: f64) -> Option<Path> {
    PathBuilder::from_circle(centre.0 as f32, centre.1 as f32, radius as f32)
}

/// The colour of a code `#rgb` or `#rrggbb`; `None` for any other text, which SVG does not draw either.
pub(super) fn colour(code: &str) -> Option<Color> {
    let digits = code.strip_prefix('#').filter(|digits| digits.bytes().all(|b| b.is_ascii_hexdigit()))?;
    let value = u32::from_str_radix(digits, 16).ok()?;
    let [r, g, b] = match digits.len() {
        3 => [8, 4, 0].map(|shift| (value >> shift & 15) * 17),
        6 => [16, 8, 0].map(|shift| value >> shift & 255),
        _ => return None,
    };
    Some(Color::from_rgba8(r as u8, g as u8, b as u8, 255))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Place = Place { x: 0.0, y: 0.0, width: 4.0, height: 4.0 };

    fn block(code: &str, place: Place) -> PaintShape {
        PaintShape::Fill { path: rectangle(place).unwrap(), colour: colour(code).unwrap() }
    }

    /// Paints 4 × 4 pixels and tells which of them are painted, row by row.
    fn painted(shapes: &[PaintShape]) -> [[bool; 4]; 4] {
        let mut pixels = Pixmap::new(4, 4).unwrap();
        paint(shapes, Transform::identity(), None, &mut pixels);
        std::array::from_fn(|y| std::array::from_fn(|x| pixels.pixel(x as u32, y as u32).unwrap().alpha() > 0))
    }

    #[test]
    fn colours_are_read_in_both_lengths() {
        assert_eq!(colour("#f08"), Some(Color::from_rgba8(255, 0, 136, 255)));
        assert_eq!(colour("#10ff0A"), Some(Color::from_rgba8(16, 255, 10, 255)));
        for other in ["", "#", "red", "#12", "#+12345", "#é0", "10ff0a"] {
            assert_eq!(colour(other), None, "{other}");
        }
    }

    #[test]
    fn clips_within_clips_keep_what_both_show_and_moves_take_them_along() {
        let left = Place { width: 2.0, ..WHOLE };
        let top = Place { height: 1.0, ..WHOLE };
        let inner = PaintShape::Clipped { place: top, shapes: vec![block("#000", WHOLE)] };
        let both = PaintShape::Clipped { place: left, shapes: vec![inner] };
        let row = [true, true, false, false];
        assert_eq!(painted(std::slice::from_ref(&both)), [row, [false; 4], [false; 4], [false; 4]]);
        let moved = PaintShape::Moved { x: 1.0, y: 2.0, shapes: vec![both] };
        assert_eq!(painted(&[moved]), [[false; 4], [false; 4], [false, true, true, false], [false; 4]]);
    }

    #[test]
    fn images_fill_their_boxes_and_the_last_shape_lies_on_top() {
        let mut pixels = Pixmap::new(2, 1).unwrap();
        let image = Pixmap::from_vec(vec![255, 0, 0, 255], tiny_skia::IntSize::from_wh(1, 1).unwrap()).unwrap();
        let left = Place { x: 0.0, y: 0.0, width: 1.0, height: 1.0 };
        let shapes = [block("#00f", left), PaintShape::Image { place: left, pixels: image }];
        paint(&shapes, Transform::identity(), None, &mut pixels);
        assert_eq!(pixels.data(), [255, 0, 0, 255, 0, 0, 0, 0]);
    }
}
