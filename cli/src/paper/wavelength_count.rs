//! The number of wavelengths that a colour needs: the paper's section 4.4 and figure 6.

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM};

use crate::plot::{Dash, LineOptions, PALETTE, Picture, Series, line_chart};
use crate::solve::colours::{Colour, colours};
use crate::solve::integral::Integral;
use crate::solve::planar_scene::PlanarScene;
use crate::solve::spectra::{Spectra, SpectraRequest, spectra};
use crate::support::error::Result;

/// The conditions under which colours are computed.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// Angles of incidence in degrees.
    pub theta_deg: &'a [f64],
    /// The illuminant.
    pub illuminant: Illuminant,
    /// The colour space in which errors are taken.
    pub space: RgbSpace,
    /// The model, the method and the precision of spectra.
    pub request: SpectraRequest,
}

/// A point of an error curve: the colour error of a number of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Number of midpoint samples from 380 to 780 nm.
    pub samples: u16,
    /// Largest error of a linear component over all angles.
    pub error: f64,
}

/// The midpoints of `count` equal parts of the visible range.
#[must_use]
pub fn midpoints(count: u16) -> Vec<f64> {
    let [first, last] = VISIBLE_NM.map(f64::from);
    (0..count).map(|i| first + (last - first) * (f64::from(i) + 0.5) / f64::from(count)).collect()
}

/// Colours at every angle from `count` midpoint samples, as the paper sums them.
///
/// # Errors
/// What [`spectra`] refuses: media that are unknown at a wavelength, or angles out of range.
pub fn sampled(planar: &PlanarScene<'_>, count: u16, setting: &Setting<'_>) -> Result<Vec<Colour>> {
    setting.colours(&setting.spectra(planar, count)?)
}

/// Colours at every angle by the integral over the wavelength.
///
/// # Errors
/// What [`Integral::new`] refuses: media that are unknown at visible wavelengths, or films too thick to integrate.
pub fn converged(planar: &PlanarScene<'_>, setting: &Setting<'_>) -> Result<Vec<Colour>> {
    let integral = Integral::new(planar, VISIBLE_NM.map(f64::from), setting.illuminant, &setting.request)?;
    let colours = integral.colours(setting.theta_deg)?;
    Ok(colours.into_iter().map(|xyz| Colour { xyz, rgb: setting.space.from_xyz(xyz) }).collect())
}

impl Setting<'_> {
    fn spectra(&self, planar: &PlanarScene<'_>, count: u16) -> Result<Spectra> {
        spectra(planar, self.theta_deg, &midpoints(count), &self.request, &|| ())
    }

    fn colours(&self, spectra: &Spectra) -> Result<Vec<Colour>> {
        colours(spectra, self.illuminant, self.space, Quadrature::Sampled)
    }
}

/// The curve of the colour error against the number of samples. `progress` is called with the spectra of each count.
///
/// # Errors
/// What [`sampled`] and [`converged`] refuse.
pub fn error_curve(
    planar: &PlanarScene<'_>,
    counts: &[u16],
    setting: &Setting<'_>,
    progress: &dyn Fn(&Spectra),
) -> Result<Vec<Point>> {
    let exact = converged(planar, setting)?;
    let point = |&samples: &u16| {
        let spectra = setting.spectra(planar, samples)?;
        progress(&spectra);
        let got = setting.colours(&spectra)?;
        let differences = got.iter().zip(&exact).flat_map(|(a, b)| (0..3).map(|c| (a.rgb[c] - b.rgb[c]).abs()));
        Ok(Point { samples, error: differences.fold(0.0, f64::max) })
    };
    counts.iter().map(point).collect()
}

/// A picture of error against the number of samples, one curve for each labelled scene.
#[must_use]
pub fn picture(title: &str, curves: &[(String, Vec<Point>)]) -> Picture {
    let series: Vec<Series> = curves
        .iter()
        .zip(PALETTE.iter().cycle())
        .map(|((label, points), colour)| Series {
            label: label.clone(),
            colour: (*colour).to_owned(),
            points: points.iter().map(|point| (f64::from(point.samples), point.error)).collect(),
            dash: Dash::None,
        })
        .collect();
    let options = LineOptions { log_y: true, ..LineOptions::default() };
    line_chart(title, "Number of wavelengths", "Largest error of a linear component", &series, options)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn midpoints_part_the_visible_range_evenly() {
        assert_eq!(midpoints(4), [430.0, 530.0, 630.0, 730.0]);
    }
}
