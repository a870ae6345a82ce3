//! The BRDF disc: every direction of the hemisphere as one picture. The radius is the angle θ from the normal, 0° in
//! the centre and 90° at the rim; the azimuth φ runs anticlockwise from the right.

use std::f64::consts::TAU;

use super::encode::{hex, srgb8};
use super::place::Place;
use super::raster::Raster;
use super::svg::{AXIS, Anchor, Canvas, SOFT_INK, Style, text_width};
use super::{OutOfGamut, Picture};

/// Samples per pixel along each axis, which keep the rim and sharp fringes smooth.
const OVERSAMPLING: u32 = 2;

/// Linear RGB of directions beyond the data.
const UNKNOWN: [f32; 3] = [0.84; 3];

/// The content of one disc.
#[derive(Clone, Copy)]
pub struct Disc<'a> {
    /// Title, or caption in a grid.
    pub label: &'a str,
    /// Linear RGB at `(theta_deg, phi_deg)`, with φ in 0..360.
    pub rgb: &'a dyn Fn(f64, f64) -> [f32; 3],
    /// Largest θ with data; beyond it the disc is pale grey.
    pub theta_max_deg: f64,
    /// Whether the colour depends on φ, which then gets labels.
    pub azimuthal: bool,
}

/// Shape of a [`Mark`].
#[derive(Debug, Clone, PartialEq)]
pub enum MarkShape {
    /// Circle around the direction.
    Ring,
    /// Upright cross in the direction.
    Cross,
    /// Dot of a linear RGB colour at the direction.
    Dot([f32; 3]),
    /// Text whose middle lies in the direction.
    Text(String),
}

/// A mark at a direction of a disc.
#[derive(Debug, Clone, PartialEq)]
pub struct Mark {
    /// Angle from the normal, in degrees.
    pub theta_deg: f64,
    /// Azimuth, in degrees.
    pub phi_deg: f64,
    /// What is drawn there.
    pub shape: MarkShape,
}

/// A picture of one large disc with a scale of θ below it.
#[must_use]
pub fn disc(disc: &Disc) -> Picture {
    marked_disc(disc, &[], &[])
}

/// A picture of one large disc with directions marked, a scale of θ below it and notes below that.
#[must_use]
pub fn marked_disc(disc: &Disc, marks: &[Mark], notes: &[String]) -> Picture {
    const RADIUS: f64 = 170.0;
    let noted = notes.iter().map(|note| text_width(note, Style::tick().size)).fold(0.0, f64::max);
    let titled = text_width(disc.label, Style::title().size).max(noted) + 40.0;
    let width = (2.0 * RADIUS + 120.0).max(titled).ceil();
    let centre = (0.5 * width, RADIUS + if disc.azimuthal { 70.0 } else { 50.0 });
    let mut canvas = Canvas::default();
    canvas.text(centre.0, 28.0, Anchor::Middle, Style::title(), disc.label);
    let out_of_gamut = draw_disc(&mut canvas, centre, RADIUS, disc);
    for mark in marks {
        draw_mark(&mut canvas, centre, RADIUS, mark);
    }
    if disc.azimuthal {
        let (x, y) = centre;
        canvas.text(x + RADIUS + 8.0, y + 4.0, Anchor::Start, Style::tick(), "φ = 0°");
        canvas.text(x, y - RADIUS - 9.0, Anchor::Middle, Style::tick(), "90°");
        canvas.text(x - RADIUS - 8.0, y + 4.0, Anchor::End, Style::tick(), "180°");
        canvas.text(x, y + RADIUS + 18.0, Anchor::Middle, Style::tick(), "270°");
    }
    let below = centre.1 + RADIUS + if disc.azimuthal { 34.0 } else { 16.0 };
    canvas.line((centre.0, below), (centre.0 + RADIUS, below), AXIS, 1.0);
    for theta in [0.0, 30.0, 60.0, 90.0] {
        let x = centre.0 + RADIUS * theta / 90.0;
        canvas.line((x, below - 4.0), (x, below + 4.0), AXIS, 1.0);
        canvas.text(x, below + 19.0, Anchor::Middle, Style::tick(), &format!("{theta}°"));
    }
    canvas.text(centre.0 - 16.0, below + 4.0, Anchor::End, Style::tick(), "angle from the normal θ");
    for (line, note) in (0u32..).zip(notes) {
        canvas.text(centre.0, below + 44.0 + 17.0 * f64::from(line), Anchor::Middle, Style::tick(), note);
    }
    let lines = notes.len() as f64;
    let height = below + 34.0 + if notes.is_empty() { 0.0 } else { 8.0 + 17.0 * lines };
    Picture::new(width, height, canvas).showing(out_of_gamut)
}

impl std::fmt::Debug for Disc<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { label, theta_max_deg, azimuthal, .. } = self;
        f.debug_struct("Disc")
            .field("label", label)
            .field("theta_max_deg", theta_max_deg)
            .field("azimuthal", azimuthal)
            .finish_non_exhaustive()
    }
}

fn draw_mark(canvas: &mut Canvas, centre: (f64, f64), radius: f64, mark: &Mark) {
    const SIZE: f64 = 6.0;
    const DOT: f64 = 3.5;
    let (sin, cos) = mark.phi_deg.to_radians().sin_cos();
    let at = radius * mark.theta_deg / 90.0;
    let (x, y) = (centre.0 + at * cos, centre.1 - at * sin);
    if let MarkShape::Text(text) = &mark.shape {
        canvas.text(x, y + 4.0, Anchor::Middle, Style { colour: "#ddd", ..Style::tick() }, text);
        return;
    }
    if let MarkShape::Dot(rgb) = mark.shape {
        canvas.dot((x, y), DOT + 1.6, "#000");
        canvas.dot((x, y), DOT + 0.8, "#fff");
        canvas.dot((x, y), DOT, &hex(rgb));
        return;
    }
    // Dark under light, as for the rings.
    for (colour, width) in [("#000", 3.0), ("#fff", 1.4)] {
        if mark.shape == MarkShape::Cross {
            canvas.line((x - SIZE, y), (x + SIZE, y), colour, width);
            canvas.line((x, y - SIZE), (x, y + SIZE), colour, width);
        } else {
            canvas.ring((x, y), SIZE, colour, width, 1.0);
        }
    }
}

/// A picture of discs in a grid, row by row, with their labels as captions.
///
/// # Panics
/// If the number of discs is not that of rows times columns.
#[must_use]
pub fn disc_grid(title: &str, row_labels: &[String], column_labels: &[String], discs: &[Disc]) -> Picture {
    assert_eq!(discs.len(), row_labels.len() * column_labels.len(), "a grid needs a disc in each place");
    const RADIUS: f64 = 74.0;
    const MARGIN: f64 = 24.0;
    let style = Style::label();
    let widest = row_labels.iter().map(|label| text_width(label, style.size)).fold(0.0, f64::max);
    let left = MARGIN + if widest > 0.0 { widest + 16.0 } else { 0.0 };
    let columns = column_labels.iter().map(|label| text_width(label, style.size) + 16.0);
    let captions = discs.iter().map(|disc| text_width(disc.label, Style::tick().size) + 16.0);
    let pitch = columns.chain(captions).fold(2.0 * RADIUS + 18.0, f64::max);
    let captioned = discs.iter().any(|disc| !disc.label.is_empty());
    let row_pitch = 2.0 * RADIUS + if captioned { 40.0 } else { 18.0 };
    let top = if column_labels.iter().any(|label| !label.is_empty()) { 84.0 } else { 56.0 };

    let mut canvas = Canvas::default();
    let mut out_of_gamut = OutOfGamut::default();
    canvas.text(MARGIN, 32.0, Anchor::Start, Style::title(), title);
    for (column, label) in column_labels.iter().enumerate() {
        canvas.text(left + (column as f64 + 0.5) * pitch, top - 14.0, Anchor::Middle, style, label);
    }
    for (row, label) in row_labels.iter().enumerate() {
        let y = top + row as f64 * row_pitch + RADIUS;
        canvas.text(left - 12.0, y + 4.0, Anchor::End, style, label);
        for column in 0..column_labels.len() {
            let disc = &discs[row * column_labels.len() + column];
            let x = left + (column as f64 + 0.5) * pitch;
            out_of_gamut += draw_disc(&mut canvas, (x, y), RADIUS, disc);
            canvas.text(x, y + RADIUS + 18.0, Anchor::Middle, Style::tick(), disc.label);
        }
    }
    let bottom = top + row_labels.len() as f64 * row_pitch;
    let note = "θ = 0° in the centre, rings at 30° and 60°, 90° at the rim";
    canvas.text(MARGIN, bottom + 14.0, Anchor::Start, Style { colour: SOFT_INK, ..Style::tick() }, note);
    let width = (left + column_labels.len() as f64 * pitch)
        .max(MARGIN + text_width(note, Style::tick().size))
        .max(MARGIN + text_width(title, Style::title().size));
    Picture::new((width + MARGIN).ceil(), (bottom + 32.0).ceil(), canvas).showing(out_of_gamut)
}

fn draw_disc(canvas: &mut Canvas, centre: (f64, f64), radius: f64, disc: &Disc) -> OutOfGamut {
    let place = Place { x: centre.0 - radius, y: centre.1 - radius, width: 2.0 * radius, height: 2.0 * radius };
    let (raster, out_of_gamut) = sampled(disc, (4.0 * radius).ceil() as u32);
    canvas.image(place, &raster);
    for theta in [30.0, 60.0] {
        // Dark under light: one of the two shows on every colour.
        canvas.ring(centre, radius * theta / 90.0, "#000", 1.5, 0.22);
        canvas.ring(centre, radius * theta / 90.0, "#fff", 0.75, 0.75);
    }
    canvas.ring(centre, radius, AXIS, 1.0, 1.0);
    out_of_gamut
}

/// Samples a disc into `side` × `side` pixels, averaged in linear light; coverage fades out at the rim.
fn sampled(disc: &Disc, side: u32) -> (Raster, OutOfGamut) {
    let samples = side * OVERSAMPLING;
    let coordinate = |i: u32| (2.0 * f64::from(i) + 1.0) / f64::from(samples) - 1.0;
    let mut out_of_gamut = OutOfGamut::default();
    let raster = Raster::new(side, side, |column, row| {
        let (mut sum, mut inside) = ([0.0_f32; 3], 0_u32);
        for j in 0..OVERSAMPLING {
            for i in 0..OVERSAMPLING {
                let (x, y) = (coordinate(column * OVERSAMPLING + i), -coordinate(row * OVERSAMPLING + j));
                let theta_deg = 90.0 * x.hypot(y);
                if theta_deg > 90.0 {
                    continue;
                }
                inside += 1;
                let rgb = if theta_deg <= disc.theta_max_deg {
                    (disc.rgb)(theta_deg, y.atan2(x).rem_euclid(TAU).to_degrees())
                } else {
                    UNKNOWN
                };
                sum = std::array::from_fn(|c| sum[c] + rgb[c]);
            }
        }
        let mean = sum.map(|c| c / inside.max(1) as f32);
        if inside > 0 {
            out_of_gamut += OutOfGamut::of(mean);
        }
        let [r, g, b] = srgb8(mean);
        let coverage = 255 * inside / (OVERSAMPLING * OVERSAMPLING);
        [r, g, b, coverage as u8]
    });
    (raster, out_of_gamut)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(picture: &Picture, x: f64, y: f64) -> [u8; 3] {
        let pixels = crate::plot::picture::tests::pixels(picture, 1.0);
        pixels.pixel(x as u32, y as u32).map(|p| [p.red(), p.green(), p.blue()]).unwrap()
    }

    /// A target: red inside 45°, blue outside, green for φ from 80° to 100°.
    fn target(theta: f64, phi: f64) -> [f32; 3] {
        match (theta < 45.0, (80.0..100.0).contains(&phi)) {
            (_, true) => [0.0, 1.0, 0.0],
            (true, _) => [1.0, 0.0, 0.0],
            (false, _) => [0.0, 0.0, 1.0],
        }
    }

    #[test]
    fn directions_stand_where_the_convention_says() {
        let picture = disc(&Disc { label: "", rgb: &target, theta_max_deg: 80.0, azimuthal: false });
        let (cx, cy, per_degree) = (0.5 * picture.size().0, 220.0, 170.0 / 90.0);
        assert_eq!(at(&picture, cx + 40.0 * per_degree, cy), [255, 0, 0]);
        assert_eq!(at(&picture, cx + 50.0 * per_degree, cy), [0, 0, 255]);
        assert_eq!(at(&picture, cx, cy - 50.0 * per_degree), [0, 255, 0], "φ = 90° is up");
        assert_eq!(at(&picture, cx, cy + 50.0 * per_degree), [0, 0, 255], "φ = 270° is down");
        assert_eq!(at(&picture, cx - 85.0 * per_degree, cy), srgb8(UNKNOWN), "no data beyond 80°");
        assert_eq!(at(&picture, cx + 95.0 * per_degree, cy), [255, 255, 255], "outside the disc");
    }

    #[test]
    fn the_angles_of_the_rings_are_labelled() {
        let labelled = |azimuthal| disc(&Disc { label: "Three films", rgb: &target, theta_max_deg: 90.0, azimuthal });
        for text in [">Three films<", ">0°<", ">30°<", ">60°<", ">90°<"] {
            assert!(labelled(false).svg().contains(text), "{text} is missing");
        }
        assert!(labelled(true).svg().contains("φ = 0°") && !labelled(false).svg().contains("φ = 0°"));
    }

    #[test]
    fn a_grid_shows_every_disc_in_its_place() {
        let colours = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0]];
        let fills = colours.map(|rgb| move |_: f64, _: f64| rgb);
        let discs: Vec<_> =
            fills.iter().map(|rgb| Disc { label: "", rgb, theta_max_deg: 90.0, azimuthal: false }).collect();
        let names = |list: [&str; 2]| list.map(str::to_owned);
        let picture = disc_grid("Grid", &names(["", ""]), &names(["N = 4", "N = 8"]), &discs);
        let centre = |column: f64, row: f64| (24.0 + (column + 0.5) * 166.0 + 5.0, 84.0 + 74.0 + row * 166.0);
        for (i, rgb) in colours.iter().enumerate() {
            let (x, y) = centre((i % 2) as f64, (i / 2) as f64);
            assert_eq!(at(&picture, x, y), srgb8(*rgb), "disc {i}");
        }
        assert!(picture.svg().contains(">N = 8<") && picture.svg().contains(">Grid<"));
    }
}
