//! Pictures of tables of scattering cells: the outgoing hemisphere, lobes in the plane of incidence.

use goniochrome::colour::{Illuminant, Quadrature};
use goniochrome::table::ScatterTable as Lookup;

use glam::Vec3;

use crate::colours::visible_weights;
use crate::error::{Error, Result};
use crate::picture::{Disc, LineOptions, Mark, PALETTE, Picture, Series, line_chart, marked_disc};
use crate::scatter_table::ScatterTable;

/// Where the light of a direction goes unless the user names another.
const THETA_DEG: f64 = 30.0;

/// The unit vector at angles in degrees.
fn direction(theta_deg: f64, phi_deg: f64) -> Vec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
    Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
}

/// The disc of outgoing directions for light from one.
pub fn outgoing(table: &ScatterTable, name: &str, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let &[theta_deg] = theta_deg.unwrap_or(&[THETA_DEG]) else {
        return Err(Error::usage("--theta: the disc of a cell shows the light of one direction; name one angle"));
    };
    let lookup = Lookup::new(table.rgb.as_flattened(), table.layout, 3).map_err(Error::failed)?;
    let wi = direction(theta_deg, phi_deg);
    let bins = table.layout.bins();
    // The brightest is a middle of a bin: between them values are interpolated.
    let brightest = (0..bins.count())
        .map(|bin| {
            let [cos, relative] = table.layout.outgoing(bin);
            let [r, g, b] = lookup.rgb(wi, direction(cos.acos().to_degrees(), phi_deg + relative.to_degrees()));
            r.max(g).max(b)
        })
        .fold(0.0, f32::max);
    let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };
    let rgb = |theta: f64, phi: f64| lookup.rgb(wi, direction(theta, phi)).map(|c| c * scale);
    let label = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    let notes = [
        format!("f scaled to its brightest component, {brightest:.3} per sr"),
        format!("{} × {} bins; ring: the light, cross: its mirror direction", bins.cos, bins.phi),
    ];
    let marks = [Mark { theta_deg, phi_deg, cross: false }, Mark { theta_deg, phi_deg: phi_deg + 180.0, cross: true }];
    let disc = Disc { label: &label, rgb: &rgb, theta_max_deg: 90.0, azimuthal: true };
    Ok(marked_disc(&disc, &marks, &notes))
}

/// Luminance of f cos θ_o in the plane of incidence, one curve for each angle of the light; θ_o < 0 is the light's own side.
pub fn lobes(table: &ScatterTable, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let illuminant = match table.metadata.get("illuminant").map(String::as_str) {
        Some("E") => Illuminant::E,
        _ => Illuminant::D65,
    };
    let weights = visible_weights(&table.wavelength_nm, illuminant, Quadrature::Interpolated)?;
    let bins = table.layout.bins().count();
    let luminance: Vec<f32> = (0..table.layout.count())
        .map(|pair| {
            let f = |w| f64::from(table.row(pair / bins, w)[pair % bins]);
            weights.iter().enumerate().map(|(w, weight)| weight[1] * f(w)).sum::<f64>() as f32
        })
        .collect();
    let lookup = Lookup::new(&luminance, table.layout, 1).map_err(Error::failed)?;
    let series: Vec<Series> = theta_deg
        .iter()
        .zip(PALETTE.iter().cycle())
        .map(|(&theta, colour)| {
            let wi = direction(theta, phi_deg);
            let points = (-180..=180).map(|half| {
                let theta_o = 0.5 * f64::from(half);
                let wo = direction(theta_o, phi_deg + 180.0);
                (theta_o, f64::from(lookup.rgb(wi, wo)[0] * wo.z))
            });
            Series {
                label: format!("light at {theta}°"),
                colour: (*colour).to_owned(),
                points: points.collect(),
                dashed: false,
            }
        })
        .collect();
    let title = format!("{name}: lobes in the plane φ = {phi_deg}°");
    let label = "Outgoing angle: light’s side < 0 < mirror side, °";
    Ok(line_chart(&title, label, "Luminance of f cos θ (1/sr)", &series, LineOptions::default()))
}
