//! Axes of charts: ranges, ticks, and the places of values.

use super::place::Place;
use super::svg::{AXIS, Anchor, Canvas, GRID, Style, text_width};

/// The map of one axis from values to canvas coordinates.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scale {
    range: (f64, f64),
    kind: ScaleKind,
    canvas: (f64, f64),
}

/// The division of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ScaleKind {
    Linear,
    /// Linear with ticks at multiples of 15, as on a protractor.
    Degrees,
    Log,
}

impl ScaleKind {
    /// The kind of an axis by its label: degrees if it ends in °, else linear.
    pub(super) fn of_label(label: &str) -> Self {
        if label.ends_with('°') { Self::Degrees } else { Self::Linear }
    }
}

impl Scale {
    pub(super) fn new(range: (f64, f64), kind: ScaleKind, canvas: (f64, f64)) -> Self {
        Self { range, kind, canvas }
    }

    /// The coordinate of a value; `None` for values without a place, such as 0 on a logarithmic axis.
    pub(super) fn at(&self, value: f64) -> Option<f64> {
        let map = |v: f64| if self.kind == ScaleKind::Log { v.log10() } else { v };
        let (low, high) = (map(self.range.0), map(self.range.1));
        let place = self.canvas.0 + (map(value) - low) / (high - low) * (self.canvas.1 - self.canvas.0);
        place.is_finite().then_some(place)
    }

    /// The ticks in the range: value and label.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        match self.kind {
            ScaleKind::Log => log_ticks(self.range),
            ScaleKind::Degrees if self.range.1 - self.range.0 >= 60.0 => linear_ticks(self.range, 15.0),
            _ => linear_ticks(self.range, step_of(self.range)),
        }
    }
}

/// Width of the ticks and the turned label of a y axis to the left of a plot.
pub(super) fn left_margin(range: (f64, f64), kind: ScaleKind) -> f64 {
    let scale = Scale::new(range, kind, (0.0, 1.0));
    (widest_tick(&scale) + 42.0).max(70.0)
}

fn widest_tick(scale: &Scale) -> f64 {
    scale.ticks().iter().map(|tick| text_width(&tick.1, Style::tick().size)).fold(0.0, f64::max)
}

/// Draws the axes around a plot: grid, ticks, labels with units.
pub(super) fn draw_axes(canvas: &mut Canvas, plot: Place, x: &Scale, y: &Scale, labels: (&str, &str), grid: bool) {
    for (value, label) in y.ticks() {
        let Some(at) = y.at(value) else { continue };
        if grid {
            canvas.line((plot.x, at), (plot.right(), at), GRID, 1.0);
        } else {
            canvas.line((plot.x - 5.0, at), (plot.x, at), AXIS, 1.0);
        }
        canvas.text(plot.x - 9.0, at + 4.0, Anchor::End, Style::tick(), &label);
    }
    for (value, label) in x.ticks() {
        let Some(at) = x.at(value) else { continue };
        canvas.line((at, plot.bottom()), (at, plot.bottom() + 5.0), AXIS, 1.0);
        canvas.text(at, plot.bottom() + 19.0, Anchor::Middle, Style::tick(), &label);
    }
    let middle = (plot.x + 0.5 * plot.width, plot.y + 0.5 * plot.height);
    canvas.text(middle.0, plot.bottom() + 41.0, Anchor::Middle, Style::label(), labels.0);
    canvas.turned_text(plot.x - 24.0 - widest_tick(y), middle.1, -90.0, Anchor::Middle, Style::label(), labels.1);
}

/// The range of values, widened to whole ticks and never empty.
pub(super) fn range_of(values: impl Iterator<Item = f64>, log: bool) -> (f64, f64) {
    let usable = values.filter(|v| v.is_finite() && (!log || *v > 0.0));
    let (low, high) = usable.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    if low > high {
        return if log { (1e-3, 1.0) } else { (0.0, 1.0) };
    }
    if log {
        let (low, high) = (low.log10().floor(), high.log10().ceil());
        return (10_f64.powf(low), 10_f64.powf(if high > low { high } else { low + 1.0 }));
    }
    let margin = if high > low { 0.0 } else { 0.5 * high.abs().max(1e-6) };
    let (low, high) = (low - margin, high + margin);
    let step = step_of((low, high));
    // A value within rounding of a tick needs no further tick.
    (((low / step + 1e-9).floor()) * step, ((high / step - 1e-9).ceil()) * step)
}

/// A step of 1, 2, 2.5 or 5 times a power of ten that gives about six ticks.
fn step_of((low, high): (f64, f64)) -> f64 {
    let span = high - low;
    let unit = 10_f64.powf((span / 5.0).log10().floor());
    let rough = span / 5.0 / unit;
    let off = |step: f64| (step / rough).ln().abs();
    unit * [1.0, 2.0, 2.5, 5.0].into_iter().min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(1.0)
}

fn linear_ticks(range: (f64, f64), step: f64) -> Vec<(f64, String)> {
    let unit = step.log10().floor();
    // 0.25 needs one decimal more than 0.2.
    let odd = (step / 10_f64.powf(unit) - 2.5).abs() < 1e-6;
    let decimals = (if odd { 1.0 } else { 0.0 } - unit).max(0.0) as usize;
    let (first, last) = ((range.0 / step - 1e-6).ceil(), (range.1 / step + 1e-6).floor());
    let count = (last - first).clamp(0.0, 20.0) as u32;
    (0..=count)
        .map(|i| (first + f64::from(i)) * step)
        .map(|value| (value, format!("{:.decimals$}", value + 0.0).replace('-', "−")))
        .collect()
}

/// Decades, thinned out to at most nine, or 1, 2 and 5 where there are fewer than three.
fn log_ticks((low, high): (f64, f64)) -> Vec<(f64, String)> {
    let (first, last) = ((low.log10() - 1e-9).ceil() as i32, (high.log10() + 1e-9).floor() as i32);
    let every = usize::try_from((last - first) / 9 + 1).unwrap_or(1);
    let mut ticks: Vec<_> =
        (first..=last).step_by(every).map(|power| (10_f64.powi(power), power_of_ten(power))).collect();
    if last - first < 2 {
        for power in first - 1..=last {
            for factor in [2.0, 5.0] {
                let value = factor * 10_f64.powi(power);
                if low <= value && value <= high {
                    ticks.push((value, format!("{factor}·{}", power_of_ten(power))));
                }
            }
        }
    }
    ticks
}

/// `10⁻³`; 1 and 10 stay plain.
fn power_of_ten(power: i32) -> String {
    match power {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        _ => {
            let digit = |c: char| {
                c.to_digit(10).map_or('⁻', |d| ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize])
            };
            format!("10{}", power.to_string().chars().map(digit).collect::<String>())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: (f64, f64), kind: ScaleKind) -> Vec<String> {
        Scale::new(range, kind, (0.0, 1.0)).ticks().into_iter().map(|tick| tick.1).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(labels((0.0, 89.0), ScaleKind::of_label("angle / °")), ["0", "15", "30", "45", "60", "75"]);
        assert_eq!(labels((0.0, 1.0), ScaleKind::Linear), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels((380.0, 780.0), ScaleKind::Linear), ["400", "450", "500", "550", "600", "650", "700", "750"]);
        assert_eq!(labels((-0.5, 0.75), ScaleKind::Linear), ["−0.50", "−0.25", "0.00", "0.25", "0.50", "0.75"]);
        assert_eq!(labels((1e-4, 10.0), ScaleKind::Log), ["10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1", "10"]);
        assert_eq!(labels((0.1, 1.0), ScaleKind::Log), ["10⁻¹", "1", "2·10⁻¹", "5·10⁻¹"]);
        assert!(labels((1e-17, 1.0), ScaleKind::Log).len() <= 9);
    }

    #[test]
    fn ranges_hold_their_values_and_are_never_empty() {
        assert_eq!(range_of([0.02, 0.97].into_iter(), false), (0.0, 1.0));
        assert_eq!(range_of([3e-4, 0.0, 0.02, f64::NAN].into_iter(), true), (1e-4, 0.1));
        assert_eq!(range_of([1e-3].into_iter(), true), (1e-3, 1e-2));
        assert_eq!(range_of([].into_iter(), false), (0.0, 1.0));
        for value in [0.0, 1.0, -7.0] {
            let (low, high) = range_of([value, value].into_iter(), false);
            assert!(low < value && value < high, "{value}: {low} to {high}");
        }
    }

    #[test]
    fn values_stand_in_proportion() {
        let linear = Scale::new((0.0, 4.0), ScaleKind::Linear, (100.0, 0.0));
        assert_eq!((linear.at(0.0), linear.at(1.0), linear.at(f64::NAN)), (Some(100.0), Some(75.0), None));
        let log = Scale::new((1e-4, 1.0), ScaleKind::Log, (0.0, 80.0));
        assert!((log.at(1e-3).unwrap() - 20.0).abs() < 1e-9);
        assert_eq!((log.at(0.0), log.at(-1.0)), (None, None));
    }
}
