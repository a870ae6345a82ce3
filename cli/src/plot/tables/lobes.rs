//! Pictures of the directions of scattering cells: the outgoing hemisphere, and lobes in the plane of incidence.

use glam::Vec3;
use goniochrome::colour::Quadrature;

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::disc::{Disc, Mark, MarkShape, marked_disc};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::ScatterTable;

/// Angle of the light of which the outgoing hemisphere is shown, unless the user names another.
const THETA_DEG: f64 = 30.0;

/// Steps of 90° in which the brightest direction is looked for.
const STEPS: u32 = 90;

/// The unit vector of angles in degrees.
fn direction_deg(theta: f64, phi: f64) -> Vec3 {
    direction(theta.to_radians(), phi.to_radians()).as_vec3()
}

/// The disc of outgoing directions for light from one direction.
///
/// # Errors
/// More than one angle of the light.
pub fn outgoing(table: &ScatterTable, name: &str, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let &[theta_deg] = theta_deg.unwrap_or(&[THETA_DEG]) else {
        return Err(Error::usage("--theta: the disc of a cell shows the light of one direction; name one angle"));
    };
    let prepared = table.rgb_lookup()?;
    let lookup = prepared.table()?;
    let wi = direction_deg(theta_deg, phi_deg);
    let mut brightest = 0.0f32;
    for theta in 0..STEPS {
        for phi in 0..4 * STEPS {
            let [theta, phi] = [theta, phi].map(|step| f64::from(step) * 90.0 / f64::from(STEPS));
            let [r, g, b] = lookup.rgb(wi, direction_deg(theta, phi));
            brightest = brightest.max(r).max(g).max(b);
        }
    }
    let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };
    let rgb = |theta: f64, phi: f64| lookup.rgb(wi, direction_deg(theta, phi)).map(|c| c * scale);
    let label = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    let notes = [
        format!("f scaled to its brightest component, {brightest:.3} per sr"),
        "ring: the light, cross: its mirror direction".to_owned(),
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
        .map(|place| weights.iter().zip(table.spectrum(place)).map(|(w, f)| w[1] * f64::from(f)).sum::<f64>() as f32)
        .collect();
    let prepared = table.lookup(luminance, 1)?;
    let lookup = prepared.table()?;
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
