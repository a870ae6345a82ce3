//! Heat maps: a quantity over two axes in colour, for example reflectance over angle and wavelength.

use super::Picture;
use super::axis::{Scale, ScaleKind, draw_axes, left_margin, range_of};
use super::place::Place;
use super::raster::Raster;
use super::svg::{AXIS, Anchor, Canvas, Style};

/// Matplotlib's colour map viridis (CC0) at tenths: equal steps of the value look like equal steps.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [66, 190, 113],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// Colour where no value is known.
const UNKNOWN: [u8; 3] = [225, 225, 228];

/// One axis of a [`heat_map`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatAxis<'a> {
    /// Name and unit.
    pub label: &'a str,
    /// Coordinates of the values, strictly increasing, at least two.
    pub coordinates: &'a [f64],
}

/// A picture of `values[y][x]` (row-major) in colour, interpolated between samples, with a colour bar.
///
/// `range` fixes the ends of the bar; by default it covers the values.
///
/// # Panics
/// If the number of values is not that of the points, or an axis has fewer than two coordinates.
#[must_use]
pub fn heat_map(
    title: &str,
    x: HeatAxis,
    y: HeatAxis,
    values: &[f64],
    bar_label: &str,
    range: Option<(f64, f64)>,
) -> Picture {
    let (columns, rows) = (x.coordinates.len(), y.coordinates.len());
    assert!(columns >= 2 && rows >= 2 && values.len() == columns * rows, "a heat map needs a value at each point");
    let range = range.unwrap_or_else(|| range_of(values.iter().copied(), false));
    let ends = |axis: HeatAxis| (axis.coordinates[0], axis.coordinates[axis.coordinates.len() - 1]);
    let plot = Place { x: left_margin(ends(y), ScaleKind::of_label(y.label)), y: 50.0, width: 450.0, height: 336.0 };
    let bar = Place { x: plot.right() + 28.0, width: 16.0, ..plot };

    // Two pixels for each unit, as saved pictures have.
    let (wide, high) = (2.0 * plot.width, 2.0 * plot.height);
    let along = |axis: HeatAxis, fraction: f64| {
        let (low, high) = ends(axis);
        position(axis.coordinates, low + fraction * (high - low))
    };
    let across: Vec<_> = (0..wide as u32).map(|i| along(x, (f64::from(i) + 0.5) / wide)).collect();
    let down: Vec<_> = (0..high as u32).map(|i| along(y, 1.0 - (f64::from(i) + 0.5) / high)).collect();
    let colour = |value: f64| viridis((value - range.0) / (range.1 - range.0));
    let map = Raster::new(wide as u32, high as u32, |i, j| {
        let ((cx, wx), (cy, wy)) = (across[i as usize], down[j as usize]);
        let at = |row: usize, column: usize| values[row * columns + column];
        let row = |row: usize| at(row, cx) + wx * (at(row, cx + 1) - at(row, cx));
        colour(row(cy) + wy * (row(cy + 1) - row(cy)))
    });
    let steps = Raster::new(1, 256, |_, j| viridis(1.0 - f64::from(j) / 255.0));

    // The bar has as much room on its right as the y axis has on its left.
    let width = (bar.right() + left_margin(range, ScaleKind::of_label(bar_label))).ceil();
    let mut canvas = Canvas::default();
    canvas.text(plot.x, 28.0, Anchor::Start, Style::title().fitted(title, width - plot.x - 12.0), title);
    canvas.image(plot, &map);
    canvas.frame(plot, AXIS, 1.0);
    let x_scale = Scale::new(ends(x), ScaleKind::of_label(x.label), (plot.x, plot.right()));
    let y_scale = Scale::new(ends(y), ScaleKind::of_label(y.label), (plot.bottom(), plot.y));
    draw_axes(&mut canvas, plot, &x_scale, &y_scale, (x.label, y.label), false);

    canvas.image(bar, &steps);
    canvas.frame(bar, AXIS, 1.0);
    let scale = Scale::new(range, ScaleKind::of_label(bar_label), (bar.bottom(), bar.y));
    for (value, label) in scale.ticks() {
        let Some(at) = scale.at(value) else { continue };
        canvas.line((bar.right(), at), (bar.right() + 5.0, at), AXIS, 1.0);
        canvas.text(bar.right() + 9.0, at + 4.0, Anchor::Start, Style::tick(), &label);
    }
    canvas.turned_text(width - 12.0, bar.y + 0.5 * bar.height, -90.0, Anchor::Middle, Style::label(), bar_label);
    Picture::new(width, plot.bottom() + 54.0, canvas)
}

/// The interval of the coordinates that holds a value, and the fraction of it below the value.
fn position(coordinates: &[f64], value: f64) -> (usize, f64) {
    let cell = coordinates.partition_point(|&c| c <= value).clamp(1, coordinates.len() - 1) - 1;
    (cell, (value - coordinates[cell]) / (coordinates[cell + 1] - coordinates[cell]))
}

fn viridis(fraction: f64) -> [u8; 4] {
    let [r, g, b] = if fraction.is_nan() {
        UNKNOWN
    } else {
        let at = 10.0 * fraction.clamp(0.0, 1.0);
        let low = (at as usize).min(9);
        let weight = at - low as f64;
        let mix = |i: usize| f64::from(VIRIDIS[low][i]) * (1.0 - weight) + f64::from(VIRIDIS[low + 1][i]) * weight;
        [mix(0), mix(1), mix(2)].map(|c| c.round() as u8)
    };
    [r, g, b, 255]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::luminance;

    #[test]
    fn colours_brighten_with_the_value() {
        let brightness = |v: f64| {
            let [r, g, b, _] = viridis(v).map(f64::from);
            luminance([r, g, b])
        };
        assert!((0..100).all(|i| brightness(f64::from(i) / 100.0) < brightness(f64::from(i + 1) / 100.0)));
        assert_eq!((viridis(-3.0), viridis(7.0)), ([68, 1, 84, 255], [253, 231, 37, 255]));
        assert_eq!(viridis(f64::NAN)[..3], UNKNOWN);
    }

    #[test]
    fn values_are_found_in_uneven_intervals() {
        assert_eq!(position(&[0.0, 1.0, 5.0], 2.0), (1, 0.25));
        assert_eq!(position(&[0.0, 1.0, 5.0], 0.5), (0, 0.5));
        assert_eq!(position(&[0.0, 1.0, 5.0], 5.0), (1, 1.0));
    }

    #[test]
    fn the_first_row_lies_at_the_bottom_and_axes_are_named() {
        let picture = heat_map(
            "Map",
            HeatAxis { label: "angle / °", coordinates: &[0.0, 90.0] },
            HeatAxis { label: "wavelength / nm", coordinates: &[400.0, 700.0] },
            &[0.0, 1.0, 0.0, 0.0],
            "reflectance",
            Some((0.0, 1.0)),
        );
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        let green = |x, y| pixels.pixel(x, y).unwrap().green();
        assert!(green(517, 383) > 220, "bottom right holds the 1");
        assert!(green(73, 383) < 10 && green(73, 53) < 10 && green(517, 53) < 10);
        for text in [">Map<", ">angle / °<", ">wavelength / nm<", ">reflectance<", ">45<", ">700<", ">0.4<"] {
            assert!(picture.svg().contains(text), "{text} is missing");
        }
    }
}
