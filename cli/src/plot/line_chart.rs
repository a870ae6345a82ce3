//! Line charts: spectra, profiles over the angle, errors.

use super::Picture;
use super::axis::{Scale, ScaleKind, draw_axes, left_margin, range_of};
use super::place::Place;
use super::svg::{AXIS, Anchor, Canvas, SOFT_INK, Style, text_width};

/// Colours of curves, by Okabe and Ito, which colour-blind readers can tell apart; the darkest on white come first.
pub const PALETTE: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

pub use super::svg::Dash;

/// One curve of a [`line_chart`].
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Entry in the legend; none if empty.
    pub label: String,
    /// Colour of the line as `#rrggbb`, for example from [`PALETTE`] or [`super::wavelength_colour`].
    pub colour: String,
    /// Points `(x, y)` in order; points that have no place on the axes leave a gap.
    pub points: Vec<(f64, f64)>,
    /// Dashes of the line, which tell curves apart without colour.
    pub dash: Dash,
}

/// The layout of a [`line_chart`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOptions {
    /// Whether the y axis is logarithmic.
    pub log_y: bool,
    /// Ends of the x axis; by default those of the data.
    pub x_range: Option<(f64, f64)>,
    /// Ends of the y axis; by default those of the data, widened to whole ticks.
    pub y_range: Option<(f64, f64)>,
    /// Width and height of the picture.
    pub size: (f64, f64),
}

impl Default for LineOptions {
    fn default() -> Self {
        Self { log_y: false, x_range: None, y_range: None, size: (640.0, 420.0) }
    }
}

/// A chart of curves over labelled axes, with a legend under the title.
#[must_use]
pub fn line_chart(title: &str, x_label: &str, y_label: &str, series: &[Series], options: LineOptions) -> Picture {
    let all = || series.iter().flat_map(|s| s.points.iter().copied());
    let x_range = options.x_range.unwrap_or_else(|| ends(all().map(|p| p.0)));
    let y_range = options.y_range.unwrap_or_else(|| {
        range_of(all().filter(|p| x_range.0 <= p.0 && p.0 <= x_range.1).map(|p| p.1), options.log_y)
    });
    let y_kind = if options.log_y { ScaleKind::Log } else { ScaleKind::of_label(y_label) };

    let (width, height) = options.size;
    let left = left_margin(y_range, y_kind);
    let mut canvas = Canvas::default();
    canvas.text(left, 28.0, Anchor::Start, Style::title().fitted(title, width - left - 12.0), title);
    let top = draw_legend(&mut canvas, series, left, width - 20.0);
    let plot = Place { x: left, y: top, width: width - left - 24.0, height: (height - top - 54.0).max(40.0) };
    let x = Scale::new(x_range, ScaleKind::of_label(x_label), (plot.x, plot.right()));
    let y = Scale::new(y_range, y_kind, (plot.bottom(), plot.y));
    draw_axes(&mut canvas, plot, &x, &y, (x_label, y_label), true);
    canvas.line((plot.x, plot.bottom()), (plot.right(), plot.bottom()), AXIS, 1.0);

    let mut drawn = false;
    // Half a stroke more: curves along an edge would else lose half of their width.
    canvas.clipped(plot.grown(1.5), |canvas| {
        for series in series {
            let points: Vec<_> = series.points.iter().map(|p| Some((x.at(p.0)?, y.at(p.1)?))).collect();
            for run in points.split(Option::is_none) {
                let run: Vec<_> = run.iter().flatten().copied().collect();
                drawn |= !run.is_empty();
                canvas.curve(&run, &series.colour, 1.8, series.dash);
            }
        }
    });
    if !drawn {
        let style = Style { colour: SOFT_INK, ..Style::label() };
        let why = if options.log_y { "no values above zero" } else { "no values" };
        canvas.text(plot.x + 0.5 * plot.width, plot.y + 0.5 * plot.height, Anchor::Middle, style, why);
    }
    Picture::new(width, height, canvas)
}

/// Draws the legend in as many lines as it needs; returns the y coordinate at which the plot may begin.
fn draw_legend(canvas: &mut Canvas, series: &[Series], left: f64, right: f64) -> f64 {
    const DASH: f64 = 28.0;
    let (mut x, mut y) = (left, 50.0);
    let mut any = false;
    for series in series.iter().filter(|series| !series.label.is_empty()) {
        let width = DASH + 7.0 + text_width(&series.label, Style::tick().size);
        if any && x + width > right {
            (x, y) = (left, y + 18.0);
        }
        canvas.curve(&[(x, y - 4.0), (x + DASH, y - 4.0)], &series.colour, 2.0, series.dash);
        canvas.text(x + DASH + 7.0, y, Anchor::Start, Style::tick(), &series.label);
        x += width + 16.0;
        any = true;
    }
    if any { y + 18.0 } else { 50.0 }
}

/// The smallest and the largest value, not widened: a spectrum fills its axis.
fn ends(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) =
        values.filter(|v| v.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low < high { (low, high) } else { range_of([low, high].into_iter(), false) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(label: &str, points: &[(f64, f64)]) -> Series {
        Series { label: label.into(), colour: "#ff0000".into(), points: points.into(), dash: Dash::None }
    }

    fn reds(picture: &Picture) -> Vec<(u32, u32)> {
        let pixels = crate::plot::picture::tests::pixels(picture, 1.0);
        let all = (0..pixels.height()).flat_map(|y| (0..pixels.width()).map(move |x| (x, y)));
        all.filter(|&(x, y)| pixels.pixel(x, y).is_some_and(|p| p.red() > 200 && p.green() < 60)).collect()
    }

    #[test]
    fn titles_axes_and_legend_are_named() {
        let picture = line_chart(
            "Film",
            "wavelength / nm",
            "reflectance",
            &[series("s, 45°", &[(400.0, 0.02), (700.0, 0.9)])],
            LineOptions::default(),
        );
        for text in [">Film<", ">wavelength / nm<", ">reflectance<", ">s, 45°<", ">400<", ">700<", ">0.0<", ">1.0<"] {
            assert!(picture.svg().contains(text), "{text} is missing");
        }
        assert_eq!(picture.size(), (640.0, 420.0));
    }

    #[test]
    fn a_rising_curve_rises_from_corner_to_corner() {
        let picture = line_chart("", "", "", &[series("", &[(0.0, 0.0), (1.0, 1.0)])], LineOptions::default());
        let reds = reds(&picture);
        let (first, last) = (reds.iter().min().unwrap(), reds.iter().max().unwrap());
        // Plot: x from 70 to 616, y from 50 (top) to 366.
        assert!(first.0.abs_diff(70) <= 3 && first.1.abs_diff(366) <= 3, "{first:?}");
        assert!(last.0.abs_diff(616) <= 3 && last.1.abs_diff(50) <= 3, "{last:?}");
    }

    #[test]
    fn nothing_is_drawn_outside_the_axes() {
        let wild = series("", &[(0.0, -50.0), (0.5, 0.5), (1.0, 50.0)]);
        let options = LineOptions { y_range: Some((0.0, 1.0)), ..LineOptions::default() };
        let reds = reds(&line_chart("", "", "", &[wild], options));
        assert!(!reds.is_empty() && reds.iter().all(|&(_, y)| (48..=368).contains(&y)));
    }

    #[test]
    fn decades_are_equally_far_apart_and_zeros_leave_gaps() {
        let options = LineOptions { log_y: true, ..LineOptions::default() };
        let curve = series("", &[(0.0, 1e-3), (0.4, 1e-3), (0.5, 0.0), (0.6, 1e-2), (1.0, 1.0)]);
        let reds = reds(&line_chart("", "", "", &[curve], options));
        let gap = 70 + 273;
        assert!(!reds.iter().any(|&(x, _)| x.abs_diff(gap) < 10));
        // 10⁻³ at y = 366 and 1 at 50 leave 10⁻² a third of the way up.
        assert!(reds.iter().any(|&(x, y)| x.abs_diff(70 + 328) < 3 && y.abs_diff(261) < 3));
        let empty = line_chart("", "", "", &[series("", &[(0.0, 0.0), (1.0, 0.0)])], options);
        assert!(empty.svg().contains("no values above zero"));
    }
}
