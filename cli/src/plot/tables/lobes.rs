//! Pictures of the directions of scattering cells: the outgoing hemisphere, and lobes in the plane of incidence.

use glam::Vec3;
use goniochrome::colour::Quadrature;
use goniochrome::table::ScatterTable as Lookup;

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::disc::{Disc, Mark, MarkShape, marked_disc};
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::{ScatterLookup, ScatterTable};

/// Angle of the light of which the outgoing hemisphere is shown, unless the user names another.
const THETA_DEG: f64 = 30.0;

/// Steps of 90° in which the brightest direction is looked for.
const STEPS: u32 = 90;

/// Largest sine of the angle from the plane of incidence at which a lobe of flat facets lies in it: single precision
/// through some ten reflections.
const IN_PLANE: f32 = 1e-4;

/// The unit vector of angles in degrees.
fn direction_deg(theta: f64, phi: f64) -> Vec3 {
    direction(theta.to_radians(), phi.to_radians()).as_vec3()
}

/// The luminance of s and ρ, ready to be looked up.
fn luminance(table: &ScatterTable) -> Result<ScatterLookup> {
    let weights = visible_weights(&table.wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
    let luminance = (0..table.layout.count())
        .map(|place| weights.iter().zip(table.spectrum(place)).map(|(w, s)| w[1] * f64::from(s)).sum::<f64>() as f32)
        .collect();
    table.lookup(luminance, 1)
}

/// The lobes of flat facets that leave with light from `wi`: their directions and ρ in three channels.
fn facet_lobes(lookup: &Lookup<'_>, wi: Vec3) -> Vec<(Vec3, [f32; 3])> {
    let mut rho = [0.0; 3];
    let lobe = |lobe| Some((lookup.reflected(wi, lobe, &mut rho)?, rho));
    let lobes = (0..lookup.layout().lobes()).filter_map(lobe);
    lobes.filter(|(_, rho)| rho.iter().any(|channel| *channel > 0.0)).collect()
}

/// Polar angle and azimuth of a unit vector, in degrees.
fn angles_deg(w: Vec3) -> [f64; 2] {
    let w = w.as_dvec3();
    [w.truncate().length().atan2(w.z).to_degrees(), w.y.atan2(w.x).to_degrees()]
}

/// f cos θ_o, the light that leaves per solid angle. Towards the horizon f itself grows beyond all bounds.
fn leaving(lookup: &Lookup<'_>, wi: Vec3, wo: Vec3) -> [f32; 3] {
    lookup.rgb(wi, wo).map(|f| f * wo.z)
}

/// The disc of f cos θ_o in all outgoing directions, for light from one direction. Lobes of flat facets are dots of
/// their colours, the brightest lobe as bright as can be.
///
/// # Errors
/// More than one angle of the light, no visible wavelength.
pub fn outgoing(table: &ScatterTable, name: &str, theta_deg: Option<&[f64]>, phi_deg: f64) -> Result<Picture> {
    let &[theta_deg] = theta_deg.unwrap_or(&[THETA_DEG]) else {
        return Err(Error::usage("--theta: the disc of a cell shows the light of one direction; name one angle"));
    };
    let prepared = table.lookup(table.metadata.screen_rgb(&table.rgb).into_flattened(), 3)?;
    let lookup = prepared.table()?;
    let wi = direction_deg(theta_deg, phi_deg);
    let mut brightest = 0.0f32;
    for theta in 0..STEPS {
        for phi in 0..4 * STEPS {
            let [theta, phi] = [theta, phi].map(|step| f64::from(step) * 90.0 / f64::from(STEPS));
            brightest = largest(leaving(&lookup, wi, direction_deg(theta, phi))).max(brightest);
        }
    }
    let scale = if brightest > 0.0 { 1.0 / brightest } else { 0.0 };
    let rgb = |theta: f64, phi: f64| leaving(&lookup, wi, direction_deg(theta, phi)).map(|c| c * scale);
    let label = format!("{name}: light from θ = {theta_deg}°, φ = {phi_deg}°");
    let mut notes = vec![
        format!("f cos θ scaled to its brightest component, {brightest:.3} per sr"),
        "ring: the light, cross: its mirror direction".to_owned(),
    ];
    let mut marks = vec![
        Mark { theta_deg, phi_deg, shape: MarkShape::Ring },
        Mark { theta_deg, phi_deg: phi_deg + 180.0, shape: MarkShape::Cross },
    ];
    let lobes = facet_lobes(&lookup, wi);
    if !lobes.is_empty() {
        let prepared = luminance(table)?;
        let share: f32 = facet_lobes(&prepared.table()?, wi).iter().map(|(_, [luminance, ..])| luminance).sum();
        let (count, plural) = (lobes.len(), if lobes.len() == 1 { "lobe" } else { "lobes" });
        notes.push(format!("dots: {count} exact {plural} of flat facets, {:.1} % of the light", 100.0 * share));
        let most = lobes.iter().map(|(_, rho)| largest(*rho)).fold(f32::MIN_POSITIVE, f32::max);
        marks.extend(lobes.into_iter().map(|(wo, rho)| {
            let [theta_deg, phi_deg] = angles_deg(wo);
            Mark { theta_deg, phi_deg, shape: MarkShape::Dot(rho.map(|c| c / most)) }
        }));
    }
    let disc = Disc { label: &label, rgb: &rgb, theta_max_deg: 90.0, azimuthal: true };
    Ok(marked_disc(&disc, &marks, &notes))
}

/// The largest component of a colour.
fn largest([r, g, b]: [f32; 3]) -> f32 {
    r.max(g).max(b)
}

/// Luminance of f cos θ_o in the plane of incidence, one curve for each angle of the light; θ_o < 0 is the
/// light's own side. Lobes of flat facets that leave in the plane have no f: they are stems, on the same axis, whose
/// height is ρ.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn lobes(table: &ScatterTable, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let prepared = luminance(table)?;
    let lookup = prepared.table()?;
    let plane = direction_deg(90.0, phi_deg + 180.0);
    let mut stems = 0;
    let mut series = Vec::new();
    for (&theta, colour) in theta_deg.iter().zip(PALETTE.iter().cycle()) {
        let wi = direction_deg(theta, phi_deg);
        let points = (-180..=180).map(|half| {
            let theta_o = 0.5 * f64::from(half);
            let wo = direction_deg(theta_o, phi_deg + 180.0);
            (theta_o, f64::from(lookup.rgb(wi, wo)[0] * wo.z))
        });
        let line =
            |label: String, points: Vec<(f64, f64)>, dash| Series { label, colour: (*colour).to_owned(), points, dash };
        series.push(line(format!("light at {theta}°"), points.collect(), Dash::None));
        for (wo, [rho, ..]) in facet_lobes(&lookup, wi) {
            let across = wo - wo.dot(plane) * plane - wo.z * Vec3::Z;
            if across.length() < IN_PLANE {
                let theta_o = f64::from(wo.dot(plane)).asin().to_degrees();
                series.push(line(String::new(), vec![(theta_o, 0.0), (theta_o, rho.into())], Dash::Long));
                stems += 1;
            }
        }
    }
    let title = format!("{name}: lobes in the plane φ = {phi_deg}°");
    let label = "Outgoing angle: light’s side < 0 < mirror side, °";
    let axis = match stems {
        0 => "Luminance of f cos θ (1/sr)",
        _ => "Luminance of f cos θ (1/sr); dashes: exact lobes, share ρ",
    };
    Ok(line_chart(&title, label, axis, &series, LineOptions::default()))
}

#[cfg(test)]
mod tests {
    use glam::Mat3;
    use goniochrome::table::{FacetLobe, ScatterLayout};

    use super::*;
    use crate::table::scatter::Energy;

    /// A table of two incident azimuths in which s = 1/π everywhere, and the facets' mirror lobe holds a quarter of the
    /// light.
    fn even() -> ScatterTable {
        let layout = ScatterLayout::new([3, 2], [4, 6], 1).unwrap();
        let places = layout.places();
        let value = |i: usize| if i % places < layout.node_count() { std::f32::consts::FRAC_1_PI } else { 0.25 };
        let values: Vec<f32> = (0..layout.count()).map(value).collect();
        ScatterTable {
            rgb: values.iter().map(|s| [*s, 0.5 * s, 0.25 * s]).collect(),
            luminance_error: vec![0.0; layout.count()],
            energy: vec![Energy::default(); layout.incident_count()],
            warp: [vec![1.0; 2], vec![1.0; 2]],
            lobes: vec![FacetLobe { index: 1.0, matrix: Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)) }],
            wavelength_nm: vec![550.0],
            metadata: Default::default(),
            values,
            layout,
        }
    }

    /// The pixels of a disc's picture along a circle about its centre, at 40° from the normal.
    fn circle(picture: &Picture) -> Vec<[u8; 3]> {
        let pixels = crate::plot::picture::tests::pixels(picture, 1.0);
        let (x, y, radius) = (0.5 * picture.size().0, 240.0, 170.0 * 40.0 / 90.0);
        let at = |i: u32| {
            let (sin, cos) = (f64::from(i).to_radians() + 0.1).sin_cos();
            pixels.pixel((x + radius * cos) as u32, (y - radius * sin) as u32).unwrap()
        };
        (0..360).map(at).map(|p| [p.red(), p.green(), p.blue()]).collect()
    }

    #[test]
    fn a_disc_of_an_even_table_has_no_spokes() {
        let picture = outgoing(&even(), "even", Some(&[0.0]), 0.0).unwrap();
        let circle = circle(&picture);
        let [least, most] = [u8::min, u8::max].map(|of| circle.iter().map(|p| p[0]).reduce(of).unwrap());
        assert!(most - least <= 1 && most > 100, "{least} {most}");
    }

    #[test]
    fn facet_lobes_are_dots_with_their_number_and_share() {
        let picture = outgoing(&even(), "even", Some(&[60.0]), 0.0).unwrap();
        assert!(picture.svg().contains("dots: 1 exact lobe of flat facets, 25.0 % of the light"), "{}", picture.svg());
        // The mirror direction is left of the centre, under the cross.
        let pixels = crate::plot::picture::tests::pixels(&picture, 1.0);
        let (x, y) = (0.5 * picture.size().0 - 170.0 * 60.0 / 90.0, 240.0);
        let dot = pixels.pixel((x + 2.0) as u32, (y - 2.0) as u32).unwrap();
        assert!(dot.red() == 255 && dot.green() < 200 && dot.blue() < dot.green(), "{dot:?}");
        let without =
            ScatterTable { layout: ScatterLayout::new([3, 2], [4, 6], 0).unwrap(), lobes: Vec::new(), ..even() };
        let places = even().layout.places();
        let bare = |i: &usize| i % places != places - 1;
        let kept: Vec<usize> = (0..even().layout.count()).filter(bare).collect();
        let without = ScatterTable {
            values: kept.iter().map(|&i| even().values[i]).collect(),
            rgb: kept.iter().map(|&i| even().rgb[i]).collect(),
            luminance_error: vec![0.0; kept.len()],
            ..without
        };
        assert!(!outgoing(&without, "even", None, 0.0).unwrap().svg().contains("dots"));
    }

    #[test]
    fn facet_lobes_in_the_plane_are_stems() {
        let picture = lobes(&even(), "even", &[20.0, 50.0], 30.0).unwrap();
        let svg = picture.svg();
        assert!(svg.contains("dashes: exact lobes") && svg.matches("stroke-dasharray").count() == 2, "{svg}");
    }
}
