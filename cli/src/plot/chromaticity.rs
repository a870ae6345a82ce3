//! The CIE 1931 chromaticity diagram: the path of a colour in the whole diagram and enlarged, with swatches along it.

use std::ops::Add;

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM, xyz_weights};

use super::axis::{Scale, ScaleKind, draw_axes};
use super::encode::hex;
use super::place::Place;
use super::raster::Raster;
use super::svg::{AXIS, Anchor, Canvas, Dash, INK, SOFT_INK, Style, text_width};
use super::{OutOfGamut, Picture};

/// Chromaticities of sRGB's red, green and blue.
const SRGB_PRIMARIES: [[f64; 2]; 3] = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]];

/// Wavelengths labelled along the spectral locus, far enough apart to be read.
const NAMED_NM: [f64; 8] = [460.0, 480.0, 500.0, 520.0, 540.0, 560.0, 580.0, 600.0];

/// Ranges of x and y in the whole diagram: the locus reaches x = 0.735 and y = 0.834.
const WHOLE: [(f64, f64); 2] = [(0.0, 0.8), (0.0, 0.9)];

/// Smallest span of the enlargement: the eye cannot tell nearer chromaticities apart.
const MIN_SPAN: f64 = 0.04;

/// Share of white in the colours of the diagram, so that lines and letters stand out.
const PALENESS: f64 = 0.6;

/// The colour of a surface at an angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourAt {
    /// Angle from the normal, in degrees.
    pub theta_deg: f64,
    /// CIE 1931 XYZ, with Y = 1 for a reflectance of 1.
    pub xyz: [f64; 3],
}

/// The chromaticity x, y of a colour; `None` for black, which has none.
#[must_use]
pub fn xy([x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let sum = x + y + z;
    (sum > 0.0 && y > 0.0 && sum.is_finite()).then(|| [x / sum, y / sum])
}

/// A picture of the path of a colour over the angle, with the colours of `marked` as marks and swatches, and the white
/// of the light.
#[must_use]
pub fn chromaticity(title: &str, light: Illuminant, path: &[ColourAt], marked: &[ColourAt]) -> Picture {
    const SIDE: f64 = 360.0;
    let white = white(light);
    let whole = Panel { place: Place { x: 70.0, y: 62.0, width: SIDE * 8.0 / 9.0, height: SIDE }, ranges: WHOLE };
    let near = Panel {
        place: Place { x: whole.place.right() + 92.0, y: 62.0, width: SIDE, height: SIDE },
        ranges: enlarged(path.iter().chain(marked).filter_map(|place| xy(place.xyz)), white),
    };
    let width = near.place.right() + 28.0;
    let mut canvas = Canvas::default();
    canvas.text(whole.place.x, 28.0, Anchor::Start, Style::title().fitted(title, width - 90.0), title);
    let note = format!("white cross: {light:?}; triangle: sRGB; dashed box: the part on the right");
    canvas.text(whole.place.x, 48.0, Anchor::Start, Style { colour: SOFT_INK, ..Style::tick() }, &note);

    whole.draw(&mut canvas, white, path);
    canvas.clipped(whole.place, |canvas| whole.outline(canvas, near.ranges));
    whole.name_wavelengths(&mut canvas);
    near.draw(&mut canvas, white, path);
    near.mark(&mut canvas, marked);
    let bottom = draw_swatches(&mut canvas, whole.place.x, width - 28.0, whole.place.bottom() + 74.0, marked);
    let out_of_gamut = marked.iter().map(|place| OutOfGamut::of(srgb(place.xyz))).fold(OutOfGamut::default(), Add::add);
    Picture::new(width.ceil(), (bottom + 12.0).ceil(), canvas).showing(out_of_gamut)
}

/// Chromaticity of a perfect reflector under a light.
fn white(light: Illuminant) -> [f64; 2] {
    let grid: Vec<f64> = (VISIBLE_NM[0]..=VISIBLE_NM[1]).map(f64::from).collect();
    let mut weights = vec![[0.0; 3]; grid.len()];
    let sum = xyz_weights(&grid, light, Quadrature::Sampled, &mut weights)
        .map(|()| weights.iter().fold([0.0; 3], |sum, w| std::array::from_fn(|c| sum[c] + w[c])));
    sum.ok().and_then(xy).expect("white is neither black nor invisible")
}

/// Chromaticity of light of one wavelength.
fn monochromatic(nm: f64) -> [f64; 2] {
    let mut weight = [[0.0; 3]];
    let made = xyz_weights(&[nm], Illuminant::E, Quadrature::Sampled, &mut weight);
    made.ok().and_then(|()| xy(weight[0])).expect("the wavelengths of the locus are visible")
}

/// The spectral locus every 2 nm from 400 to 700 nm; beyond, it hardly moves.
fn locus() -> Vec<[f64; 2]> {
    (200..=350).map(|half| monochromatic(2.0 * f64::from(half))).collect()
}

/// Ranges of x and y of a square a little larger than the points and the white.
fn enlarged(points: impl Iterator<Item = [f64; 2]>, white: [f64; 2]) -> [(f64, f64); 2] {
    let (mut low, mut high) = (white, white);
    for point in points {
        for c in 0..2 {
            low[c] = low[c].min(point[c]);
            high[c] = high[c].max(point[c]);
        }
    }
    let half = 0.62 * (high[0] - low[0]).max(high[1] - low[1]).max(MIN_SPAN);
    std::array::from_fn(|c| {
        let middle = 0.5 * (low[c] + high[c]);
        (middle - half, middle + half)
    })
}

/// A part of the diagram at a place of the canvas.
struct Panel {
    place: Place,
    ranges: [(f64, f64); 2],
}

impl Panel {
    fn scales(&self) -> [Scale; 2] {
        let place = self.place;
        [
            Scale::new(self.ranges[0], ScaleKind::Linear, (place.x, place.right())),
            Scale::new(self.ranges[1], ScaleKind::Linear, (place.bottom(), place.y)),
        ]
    }

    /// The place of a chromaticity on the canvas.
    fn at(&self, [x, y]: [f64; 2]) -> (f64, f64) {
        let [across, up] = self.scales();
        (across.at(x).unwrap_or(f64::NAN), up.at(y).unwrap_or(f64::NAN))
    }

    /// Draws colours, locus, triangle, path and white point inside labelled axes.
    fn draw(&self, canvas: &mut Canvas, white: [f64; 2], path: &[ColourAt]) {
        let locus = locus();
        let Place { width, height, .. } = self.place;
        let (columns, lines) = ((2.0 * width) as u32, (2.0 * height) as u32);
        let along = |(low, high): (f64, f64), share: f64| low + share * (high - low);
        let colours = Raster::new(columns, lines, |i, j| {
            let x = along(self.ranges[0], (f64::from(i) + 0.5) / f64::from(columns));
            let y = along(self.ranges[1], 1.0 - (f64::from(j) + 0.5) / f64::from(lines));
            if inside(&locus, [x, y]) { pale([x, y]) } else { [255; 4] }
        });
        let closed = |points: &[[f64; 2]]| -> Vec<(f64, f64)> {
            points.iter().chain(points.first()).map(|&point| self.at(point)).collect()
        };
        canvas.image(self.place, &colours);
        canvas.clipped(self.place, |canvas| {
            canvas.curve(&closed(&locus), SOFT_INK, 1.2, Dash::None);
            canvas.curve(&closed(&SRGB_PRIMARIES), "#fff", 2.6, Dash::None);
            canvas.curve(&closed(&SRGB_PRIMARIES), SOFT_INK, 1.0, Dash::None);
            let points: Vec<_> = path.iter().map(|place| xy(place.xyz)).collect();
            for run in points.split(Option::is_none) {
                let run: Vec<_> = run.iter().flatten().map(|&point| self.at(point)).collect();
                canvas.curve(&run, "#fff", 4.0, Dash::None);
                canvas.curve(&run, INK, 1.8, Dash::None);
            }
            let (x, y) = self.at(white);
            for (colour, stroke) in [("#000", 3.2), ("#fff", 1.6)] {
                canvas.line((x - 5.0, y), (x + 5.0, y), colour, stroke);
                canvas.line((x, y - 5.0), (x, y + 5.0), colour, stroke);
            }
        });
        canvas.frame(self.place, AXIS, 1.0);
        let [x, y] = self.scales();
        draw_axes(canvas, self.place, &x, &y, ("CIE 1931 x", "CIE 1931 y"), false);
    }

    /// Draws a dashed box around ranges of x and y.
    fn outline(&self, canvas: &mut Canvas, [(left, right), (bottom, top)]: [(f64, f64); 2]) {
        let corners = [[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]];
        canvas.curve(&corners.map(|corner| self.at(corner)), INK, 1.0, Dash::Long);
    }

    /// Writes wavelengths beside the locus, outside it.
    fn name_wavelengths(&self, canvas: &mut Canvas) {
        const ASIDE: f64 = 9.0;
        let middle = self.at([1.0 / 3.0, 1.0 / 3.0]);
        for nm in NAMED_NM {
            let (x, y) = self.at(monochromatic(nm));
            let length = (x - middle.0).hypot(y - middle.1);
            let (right, down) = ((x - middle.0) / length, (y - middle.1) / length);
            let name = if nm == NAMED_NM[NAMED_NM.len() - 1] { format!("{nm} nm") } else { nm.to_string() };
            // Left of the y axis there is no room: numbers at the edge stand inside the locus.
            let at_edge = x - 34.0 < self.place.x;
            let anchor = if right < 0.0 && down > 0.0 { Anchor::End } else { Anchor::Start };
            let aside = if at_edge { ASIDE } else { ASIDE * right };
            canvas.line((x, y), (x + 0.5 * ASIDE * right, y + 0.5 * ASIDE * down), SOFT_INK, 1.2);
            canvas.text(x + aside, y + 4.0 + ASIDE * down, anchor, Style { size: 10.5, ..Style::tick() }, &name);
        }
    }

    /// Draws rings filled with their colour, and their angles where no other text stands.
    fn mark(&self, canvas: &mut Canvas, marked: &[ColourAt]) {
        const RADIUS: f64 = 6.0;
        let placed: Vec<_> = marked.iter().filter_map(|place| Some((place, self.at(xy(place.xyz)?)))).collect();
        let ring = |&(_, (x, y)): &(_, (f64, f64))| Place { x, y, width: 0.0, height: 0.0 }.grown(RADIUS);
        let mut taken: Vec<Place> = placed.iter().map(ring).collect();
        for (place, (x, y)) in placed {
            canvas.dot((x, y), RADIUS, &hex(srgb(place.xyz)));
            canvas.ring((x, y), RADIUS, "#fff", 2.6, 1.0);
            canvas.ring((x, y), RADIUS + 1.0, INK, 1.2, 1.0);
            let name = format!("{}°", place.theta_deg);
            let width = text_width(&name, Style::label().size);
            let spots = [
                (x + 11.0, y + 4.0),
                (x - 11.0 - width, y + 4.0),
                (x - 0.5 * width, y - 12.0),
                (x - 0.5 * width, y + 20.0),
            ];
            let room = |&&(left, base): &&(f64, f64)| {
                let text = Place { x: left, y: base - 11.0, width, height: 13.0 };
                taken.iter().all(|other| !overlap(text, *other))
            };
            if let Some(&(left, base)) = spots.iter().find(room) {
                canvas.text(left, base, Anchor::Start, Style { bold: true, ..Style::label() }, &name);
                taken.push(Place { x: left, y: base - 11.0, width, height: 13.0 });
            }
        }
    }
}

fn overlap(a: Place, b: Place) -> bool {
    a.x < b.right() && b.x < a.right() && a.y < b.bottom() && b.y < a.bottom()
}

fn srgb(xyz: [f64; 3]) -> [f32; 3] {
    RgbSpace::Srgb.from_xyz(xyz).map(|c| c as f32)
}

/// The brightest sRGB colour of a chromaticity, mixed with white.
fn pale([x, y]: [f64; 2]) -> [u8; 4] {
    let rgb = RgbSpace::Srgb.from_xyz([x, y, 1.0 - x - y]);
    let largest = rgb.into_iter().fold(1e-9, f64::max);
    let [r, g, b] = super::srgb8(rgb.map(|c| (PALENESS + (1.0 - PALENESS) * (c / largest).clamp(0.0, 1.0)) as f32));
    [r, g, b, 255]
}

/// Whether a polygon holds a point: a ray to the right then crosses an odd number of edges.
fn inside(polygon: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let last = polygon.len() - 1;
    let crossed = (0..polygon.len()).filter(|&i| {
        let (a, b) = (polygon[i], polygon[if i == 0 { last } else { i - 1 }]);
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    });
    crossed.count() % 2 == 1
}

/// Draws a row of colours with their angles and codes; returns the y coordinate of its end.
fn draw_swatches(canvas: &mut Canvas, left: f64, right: f64, top: f64, marked: &[ColourAt]) -> f64 {
    let pitch = ((right - left) / marked.len().max(1) as f64).min(90.0);
    for (i, place) in marked.iter().enumerate() {
        let block = Place { x: left + i as f64 * pitch, y: top, width: pitch - 8.0, height: 40.0 };
        let (centre, code) = (block.x + 0.5 * block.width, hex(srgb(place.xyz)));
        let fitted = |style: Style, text: &str| style.fitted(text, pitch - 2.0);
        let angle = format!("{}°", place.theta_deg);
        canvas.text(centre, top - 7.0, Anchor::Middle, fitted(Style::label(), &angle), &angle);
        canvas.block(block, &code);
        canvas.frame(block.grown(-0.25), super::svg::GRID, 0.5);
        canvas.text(centre, block.bottom() + 16.0, Anchor::Middle, fitted(Style::tick(), &code), &code);
    }
    top + 40.0 + 22.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_points_and_the_locus_are_where_the_cie_has_them() {
        // CIE 15: D65 and E to the published digits; the locus at 520 nm.
        const PUBLISHED: f64 = 2e-4;
        for (found, expected) in [
            (white(Illuminant::D65), [0.3127, 0.3290]),
            (white(Illuminant::E), [1.0 / 3.0, 1.0 / 3.0]),
            (monochromatic(520.0), [0.0743, 0.8338]),
            (monochromatic(700.0), [0.7347, 0.2653]),
        ] {
            assert!((0..2).all(|c| (found[c] - expected[c]).abs() < PUBLISHED), "{found:?} {expected:?}");
        }
        assert_eq!(xy([0.0; 3]), None);
    }

    #[test]
    fn the_locus_holds_srgb_and_white_but_not_purple() {
        let locus = locus();
        assert!(SRGB_PRIMARIES.iter().all(|&corner| inside(&locus, corner)));
        assert!(inside(&locus, [0.3127, 0.329]));
        assert!(!inside(&locus, [0.5, 0.1]) && !inside(&locus, [0.01, 0.3]) && !inside(&locus, [0.8, 0.1]));
    }

    #[test]
    fn angles_swatches_and_axes_are_named_and_the_path_is_drawn() {
        let place = |theta_deg, xyz| ColourAt { theta_deg, xyz };
        let path = [place(0.0, [0.41, 0.21, 0.02]), place(60.0, [0.36, 0.72, 0.12]), place(80.0, [0.0; 3])];
        let picture = chromaticity("Film", Illuminant::D65, &path, &path);
        for text in [">Film<", ">CIE 1931 x<", ">CIE 1931 y<", ">0°<", ">60°<", ">80°<", ">520<", ">600 nm<", "#000000"]
        {
            assert!(picture.svg().contains(text), "{text} is missing");
        }
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        // Red of the first mark lies in the enlargement, whose axes hold both points.
        let red = pixels.pixels().iter().filter(|p| p.red() > 170 && p.green() < 60 && p.blue() < 60).count();
        assert!(red > 100, "{red}");
    }

    #[test]
    fn one_colour_is_enlarged_no_further_than_the_eye_sees() {
        let [x, y] = enlarged([[0.31, 0.33]].into_iter(), [0.3127, 0.329]);
        assert!(x.1 - x.0 >= MIN_SPAN && (x.1 - x.0 - (y.1 - y.0)).abs() < 1e-12);
    }
}
