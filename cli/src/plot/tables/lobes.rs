//! Pictures of the directions of scattering cells: the outgoing hemisphere, and lobes in the plane of incidence.

use std::f64::consts::PI;

use glam::Vec3;
use goniochrome::colour::Quadrature;
use goniochrome::table::ScatterTable as Lookup;

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::disc::{Disc, Mark, MarkShape, marked_disc};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::ScatterTable;

/// Angle of the light of which the outgoing hemisphere is shown, unless the user names another.
const THETA_DEG: f64 = 30.0;

/// The unit vector of angles in degrees.
fn direction_deg(theta: f64, phi: f64) -> Vec3 {
    direction(theta.to_radians(), phi.to_radians()).as_vec3()
}

/// Number of azimuths averaged within the last row of bins, which reaches the normal.
const AROUND: u32 = 48;

/// The table's colour, smooth at the normal.
///
/// A table is constant from its last row of bins to the normal, where all azimuths meet, so that these bins would look
/// like spokes. Inside the circle through the middles of that row, the picture is therefore the harmonic function with
/// the circle's values, which has neither peak nor edge of its own. Its value is a mean over the circle by Poisson's
/// kernel, a Cauchy distribution wrapped around it: equal steps of its quantiles weigh equally.
fn smooth(lookup: &Lookup<'_>, wi: Vec3, theta_deg: f64, phi_deg: f64) -> [f32; 3] {
    let rows = f64::from(lookup.layout().bins().cos);
    let circle_deg = (1.0 - 0.5 / rows).acos().to_degrees();
    let share = theta_deg / circle_deg;
    if share >= 1.0 {
        return lookup.rgb(wi, direction_deg(theta_deg, phi_deg));
    }
    let width = (1.0 - share) / (1.0 + share);
    let mut sum = [0.0; 3];
    for i in 0..AROUND {
        let quantile = (f64::from(i) + 0.5) / f64::from(AROUND) - 0.5;
        let turn = 2.0 * (width * (PI * quantile).tan()).atan();
        let rgb = lookup.rgb(wi, direction_deg(circle_deg, phi_deg + turn.to_degrees()));
        sum = std::array::from_fn(|c| sum[c] + rgb[c]);
    }
    sum.map(|c| c / AROUND as f32)
}

/// The disc of outgoing directions for light from one direction.
///
/// # Errors
/// More than one angle of the light.
pub fn outgoing(table: &ScatterTable, name: &str, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let &[theta_deg] = theta_deg.unwrap_or(&[THETA_DEG]) else {
        return Err(Error::usage("--theta: the disc of a cell shows the light of one direction; name one angle"));
    };
    let lookup = Lookup::new(table.rgb.as_flattened(), table.layout, 3).map_err(Error::failed)?;
    let wi = direction_deg(theta_deg, phi_deg);
    let bins = table.layout.bins();
    // The brightest is a middle of a bin: between them values are interpolated.
    let brightest = (0..bins.count())
        .map(|bin| {
            let [cos, relative] = table.layout.outgoing(bin);
            let [r, g, b] = lookup.rgb(wi, direction_deg(cos.acos().to_degrees(), phi_deg + relative.to_degrees()));
            r.max(g).max(b)
        })
        .fold(0.0, f32::max);
    let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };
    let rgb = |theta: f64, phi: f64| smooth(&lookup, wi, theta, phi).map(|c| c * scale);
    let label = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    let notes = [
        format!("f scaled to its brightest component, {brightest:.3} per sr"),
        format!("{} × {} bins; ring: the light, cross: its mirror direction", bins.cos, bins.phi),
    ];
    let marks = [
        Mark { theta_deg, phi_deg, shape: MarkShape::Ring },
        Mark { theta_deg, phi_deg: phi_deg + 180.0, shape: MarkShape::Cross },
    ];
    let disc = Disc { label: &label, rgb: &rgb, theta_max_deg: 90.0, azimuthal: true };
    Ok(marked_disc(&disc, &marks, &notes))
}

/// Luminance of f cos θ_o in the plane of incidence, one curve for each angle of the light; θ_o < 0 is the
/// light's own side.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn lobes(table: &ScatterTable, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let weights = visible_weights(&table.wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
    let luminance: Vec<f32> = (0..table.layout.count())
        .map(|pair| weights.iter().zip(table.spectrum(pair)).map(|(w, f)| w[1] * f64::from(f)).sum::<f64>() as f32)
        .collect();
    let lookup = Lookup::new(&luminance, table.layout, 1).map_err(Error::failed)?;
    let series: Vec<Series> = theta_deg
        .iter()
        .zip(PALETTE.iter().cycle())
        .map(|(&theta, colour)| {
            let wi = direction_deg(theta, phi_deg);
            let points = (-180..=180).map(|half| {
                let theta_o = 0.5 * f64::from(half);
                let wo = direction_deg(theta_o, phi_deg + 180.0);
                (theta_o, f64::from(lookup.rgb(wi, wo)[0] * wo.z))
            });
            Series {
                label: format!("light at {theta}°"),
                colour: (*colour).to_owned(),
                points: points.collect(),
                dash: Dash::None,
            }
        })
        .collect();
    let title = format!("{name}: lobes in the plane φ = {phi_deg}°");
    let label = "Outgoing angle: light’s side < 0 < mirror side, °";
    Ok(line_chart(&title, label, "Luminance of f cos θ (1/sr)", &series, LineOptions::default()))
}

#[cfg(test)]
mod tests {
    use goniochrome::measure::bins::DirectionBins;
    use goniochrome::table::ScatterLayout;

    use super::*;

    /// Means of 48 quantiles err by less than a twentieth of the range wherever the kernel is wider than a bin.
    const QUANTILES: f32 = 0.05;

    #[test]
    fn the_normal_is_the_mean_of_all_azimuths_and_the_last_row_is_kept() {
        let layout = ScatterLayout::new(1, 1, DirectionBins { cos: 2, phi: 8 }).unwrap();
        let values: Vec<f32> = (0..16).map(|bin| (bin % 2) as f32).collect();
        let lookup = Lookup::new(&values, layout, 1).unwrap();
        let wi = direction_deg(30.0, 0.0);
        let middle = 0.75_f64.acos().to_degrees();
        for phi in [0.0, 45.0, 100.0] {
            assert!((smooth(&lookup, wi, 0.0, phi)[0] - 0.5).abs() < QUANTILES);
            let (inside, on) = (smooth(&lookup, wi, 0.9999 * middle, phi)[0], smooth(&lookup, wi, middle, phi)[0]);
            assert!((inside - on).abs() < QUANTILES, "{phi}: {inside} beside {on}");
        }
        assert!((smooth(&lookup, wi, middle, 45.0)[0] - 1.0).abs() < 1e-3);
    }
}
