//! Pictures of tables of mirror-like surfaces.

use goniochrome::colour::{Quadrature, xyz};

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::chromaticity::{ColourAt, chromaticity};
use crate::plot::disc::{Disc, disc as draw_disc};
use crate::plot::heat_map::{HeatAxis, heat_map};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::error::{Error, Result};
use crate::table::mirror::{MirrorTable, neighbours};

/// The colour of every direction, as in the paper's figures 3 and 4: radius θ, angle φ.
///
/// # Errors
/// A table without colours.
pub fn disc(table: &MirrorTable, name: &str) -> Result<Picture> {
    table.colours()?;
    let rgb = |theta_deg: f64, _phi_deg: f64| table.rgb_at(theta_deg);
    Ok(draw_disc(&Disc { label: name, rgb: &rgb, theta_max_deg: 90.0, azimuthal: false }))
}

/// Reflectance against the wavelength at the angles of the table nearest to `theta_deg`: s, p and their mean.
///
/// # Panics
/// If the table has no angle.
pub fn spectra(table: &MirrorTable, name: &str, theta_deg: &[f64]) -> Picture {
    let width = table.wavelength_nm.len();
    let series = theta_deg.iter().zip(PALETTE.iter().cycle()).flat_map(|(&wanted, colour)| {
        let distance = |angle: &usize| (table.theta_deg[*angle] - wanted).abs();
        let angle = (0..table.theta_deg.len())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("a table has at least one angle");
        let theta = table.theta_deg[angle];
        let curve = |label: String, dash, of: &dyn Fn(usize) -> f32| Series {
            label,
            colour: (*colour).to_owned(),
            points: (0..width).map(|i| (table.wavelength_nm[i], f64::from(of(angle * width + i)))).collect(),
            dash,
        };
        let (s, p) = (&table.reflectance_s, &table.reflectance_p);
        let mean = curve(format!("{theta:.0}°"), Dash::None, &|i| 0.5 * (s[i] + p[i]));
        // s and p coincide at normal incidence.
        let parts = (theta > 0.0).then(|| {
            [
                curve(format!("{theta:.0}° s"), Dash::Long, &|i| s[i]),
                curve(format!("{theta:.0}° p"), Dash::Short, &|i| p[i]),
            ]
        });
        [mean].into_iter().chain(parts.into_iter().flatten()).collect::<Vec<_>>()
    });
    let series: Vec<Series> = series.collect();
    line_chart(&format!("{name}: reflectance"), "Wavelength (nm)", "Reflectance", &series, LineOptions::default())
}

/// Unpolarised reflectance over angle and wavelength.
///
/// # Errors
/// A table of one angle or one wavelength.
pub fn map(table: &MirrorTable, name: &str) -> Result<Picture> {
    if table.wavelength_nm.len() < 2 || table.theta_deg.len() < 2 {
        return Err(Error::usage("--kind map: a map needs two angles and two wavelengths or more"));
    }
    let mean: Vec<f64> = table.unpolarised().collect();
    Ok(heat_map(
        &format!("{name}: unpolarised reflectance"),
        HeatAxis { label: "Wavelength (nm)", coordinates: &table.wavelength_nm },
        HeatAxis { label: "Angle of incidence (°)", coordinates: &table.theta_deg },
        &mean,
        "Reflectance",
        None,
    ))
}

/// The path of the colour of unpolarised light over the angle, with the colours at `theta_deg` marked.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn colour_path(table: &MirrorTable, name: &str, theta_deg: &[f64]) -> Result<Picture> {
    let light = table.metadata.illuminant();
    let weights = visible_weights(&table.wavelength_nm, light, Quadrature::Interpolated)?;
    let mean: Vec<f64> = table.unpolarised().collect();
    let rows = table.theta_deg.iter().zip(mean.chunks(weights.len()));
    let path: Vec<_> =
        rows.map(|(&theta_deg, row)| ColourAt { theta_deg, xyz: xyz(&weights, row.iter().copied()) }).collect();
    let marked: Vec<_> = theta_deg.iter().map(|&theta| between(&table.theta_deg, &path, theta)).collect();
    Ok(chromaticity(&format!("{name}: colour over the angle from the normal"), light, &path, &marked))
}

/// The colour between the two neighbours of an angle, held at the ends.
fn between(known_deg: &[f64], path: &[ColourAt], theta_deg: f64) -> ColourAt {
    let (below, above, weight) = neighbours(known_deg, theta_deg);
    let (low, high) = (path[below].xyz, path[above].xyz);
    ColourAt { theta_deg, xyz: std::array::from_fn(|c| low[c] + weight * (high[c] - low[c])) }
}
