//! How many wavelengths a colour needs: the paper's section 4.4 and figure 6.

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, VISIBLE_NM};

use crate::colours::{Colour, colours};
use crate::error::Result;
use crate::estimate::{Request, Spectra, spectra};
use crate::picture::{LineOptions, PALETTE, Picture, Series, line_chart};
use crate::planar::Planar;

/// What the colours are made with.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// Angles of incidence.
    pub theta_deg: &'a [f64],
    /// The light.
    pub illuminant: Illuminant,
    /// The space in which the error is taken.
    pub space: RgbSpace,
    /// How to compute.
    pub request: Request,
}

/// The colour error that a number of samples makes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Midpoint samples from 380 to 780 nm.
    pub samples: u16,
    /// Largest error of a component over all angles.
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
/// As [`spectra`].
pub fn sampled(planar: &Planar<'_>, count: u16, setting: &Setting<'_>) -> Result<Vec<Colour>> {
    setting.colours(&setting.spectra(planar, &midpoints(count))?, Quadrature::Sampled)
}

/// Colours at every angle from sums over 1 nm.
///
/// # Errors
/// As [`spectra`].
pub fn converged(planar: &Planar<'_>, setting: &Setting<'_>) -> Result<Vec<Colour>> {
    setting.colours(&setting.spectra(planar, &every_nm())?, Quadrature::Interpolated)
}

fn every_nm() -> Vec<f64> {
    (VISIBLE_NM[0]..=VISIBLE_NM[1]).map(f64::from).collect()
}

impl Setting<'_> {
    fn spectra(&self, planar: &Planar<'_>, wavelength_nm: &[f64]) -> Result<Spectra> {
        spectra(planar, self.theta_deg, wavelength_nm, &self.request, &|| ())
    }

    fn colours(&self, spectra: &Spectra, quadrature: Quadrature) -> Result<Vec<Colour>> {
        colours(spectra, self.illuminant, self.space, quadrature)
    }
}

/// The error curve: `progress` is given the spectra behind the exact colours, and then those of each count.
///
/// # Errors
/// As [`spectra`].
pub fn error_curve(
    planar: &Planar<'_>,
    counts: &[u16],
    setting: &Setting<'_>,
    progress: &dyn Fn(&Spectra),
) -> Result<Vec<Point>> {
    let colours = |wavelength_nm: &[f64], quadrature| {
        let spectra = setting.spectra(planar, wavelength_nm)?;
        progress(&spectra);
        setting.colours(&spectra, quadrature)
    };
    let exact = colours(&every_nm(), Quadrature::Interpolated)?;
    let point = |&samples: &u16| {
        let got = colours(&midpoints(samples), Quadrature::Sampled)?;
        let differences = got.iter().zip(&exact).flat_map(|(a, b)| (0..3).map(|c| (a.rgb[c] - b.rgb[c]).abs()));
        Ok(Point { samples, error: differences.fold(0.0, f64::max) })
    };
    counts.iter().map(point).collect()
}

/// Error against samples, one curve for each labelled scene.
#[must_use]
pub fn picture(title: &str, curves: &[(String, Vec<Point>)]) -> Picture {
    let series: Vec<Series> = curves
        .iter()
        .zip(PALETTE.iter().cycle())
        .map(|((label, points), colour)| Series {
            label: label.clone(),
            colour: (*colour).to_owned(),
            points: points.iter().map(|point| (f64::from(point.samples), point.error)).collect(),
            dashed: false,
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
