//! Pictures of the spectra of cells: between two directions, and of all reflected light together.

use glam::Vec3;
use goniochrome::colour::{Quadrature, xyz};
use goniochrome::table::ScatterTable as Lookup;

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::chromaticity::{ColourAt, chromaticity};
use crate::plot::heat_map::{HeatAxis, heat_map};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::ScatterTable;

/// Steps of θ in maps and paths; tables hold a dozen rows, linear in between.
const STEPS: u32 = 90;

/// A picture of f against the wavelength, one curve for each angle of the light. The light comes from the first azimuth
/// of `phi_deg` and goes towards the second, at `theta_out_deg` or else at the angle of the light. f leaves lobes of
/// flat facets out.
///
/// # Errors
/// A table that cannot be looked up.
pub fn spectra(
    table: &ScatterTable,
    name: &str,
    theta_deg: &[f64],
    theta_out_deg: Option<f64>,
    phi_deg: [f64; 2],
) -> Result<Picture> {
    let [phi, phi_out] = phi_deg;
    let prepared = table.spectral_lookup()?;
    let lookup = prepared.table()?;
    let series: Vec<Series> = theta_deg
        .iter()
        .zip(PALETTE.iter().cycle())
        .map(|(&theta, colour)| {
            let theta_out = theta_out_deg.unwrap_or(theta);
            let mut f = vec![0.0; table.wavelength_nm.len()];
            lookup.eval(direction_deg(theta, phi), direction_deg(theta_out, phi_out), &mut f);
            Series {
                label: format!("θ {theta}° → {theta_out}°"),
                colour: (*colour).to_owned(),
                points: table.wavelength_nm.iter().copied().zip(f.into_iter().map(f64::from)).collect(),
                dash: Dash::None,
            }
        })
        .collect();
    let title = format!("{name}: light from φ = {phi}° towards φ = {}°", phi_out.rem_euclid(360.0));
    let label = if table.lobes.is_empty() { "BRDF f (1/sr)" } else { "BRDF f (1/sr), without exact lobes" };
    Ok(line_chart(&title, "Wavelength (nm)", label, &series, LineOptions::default()))
}

/// The unit vector of angles in degrees.
fn direction_deg(theta: f64, phi: f64) -> Vec3 {
    direction(theta.to_radians(), phi.to_radians()).as_vec3()
}

/// The share of the light from (θ, φ) that is reflected in all directions together, at each wavelength.
fn reflected(lookup: &Lookup<'_>, theta_deg: f64, phi_deg: f64) -> Vec<f64> {
    let mut albedo = vec![0.0; lookup.channels()];
    lookup.albedo(direction_deg(theta_deg, phi_deg), &mut albedo);
    albedo.into_iter().map(f64::from).collect()
}

/// The light reflected in all directions together, lobes of flat facets included, over angle and wavelength.
///
/// # Errors
/// A table of one wavelength.
pub fn map(table: &ScatterTable, name: &str, phi_deg: f64) -> Result<Picture> {
    if table.wavelength_nm.len() < 2 {
        return Err(Error::usage("--kind map: the table has one wavelength; a map needs two or more"));
    }
    let theta: Vec<f64> = (0..=STEPS).map(f64::from).collect();
    let prepared = table.spectral_lookup()?;
    let lookup = prepared.table()?;
    let values: Vec<f64> = theta.iter().flat_map(|&theta| reflected(&lookup, theta, phi_deg)).collect();
    Ok(heat_map(
        &format!("{name}: reflected in all directions, light at φ = {phi_deg}°"),
        HeatAxis { label: "Wavelength (nm)", coordinates: &table.wavelength_nm },
        HeatAxis { label: "Angle of incidence (°)", coordinates: &theta },
        &values,
        "Albedo",
        None,
    ))
}

/// The path of the colour of all reflected light together over the angle, with the colours at `theta_deg` marked.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn colour_path(table: &ScatterTable, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let light = table.metadata.illuminant();
    let weights = visible_weights(&table.wavelength_nm, light, Quadrature::Interpolated)?;
    let prepared = table.spectral_lookup()?;
    let lookup = prepared.table()?;
    let at = |theta_deg: f64| ColourAt { theta_deg, xyz: xyz(&weights, reflected(&lookup, theta_deg, phi_deg)) };
    let path: Vec<_> = (0..STEPS).map(|theta| at(f64::from(theta))).collect();
    let marked: Vec<_> = theta_deg.iter().map(|&theta| at(theta)).collect();
    let title = format!("{name}: colour of all reflected light over the angle of incidence, φ = {phi_deg}°");
    Ok(chromaticity(&title, light, &path, &marked))
}
