//! Lobes of a mirror-like surface with a finish.

use goniochrome::colour::Quadrature;
use goniochrome::microfacet::{Finish, Lobe};

use crate::colour::visible_weights;
use crate::plot::Picture;
use crate::plot::line_chart::{Dash, LineOptions, PALETTE, Series, line_chart};
use crate::support::direction::direction;
use crate::support::error::Result;
use crate::table::finish::returned;
use crate::table::mirror::{MirrorTable, neighbours};

/// Steps of the outgoing angle in half a degree on either side of the normal.
const STEPS: i16 = 180;

/// Places in roughnesses from the mirror direction, where a narrow lobe is drawn too.
const NEAR: i16 = 40;

/// Luminance of f cos θ_o in the plane of incidence, one curve for each angle of the light; θ_o < 0 is the light's own
/// side. Both directions are of a table of one surface.
///
/// # Errors
/// None of the wavelengths is visible.
pub fn lobes(table: &MirrorTable, finish: &Finish<'_>, name: &str, theta_deg: &[f64], phi_deg: f64) -> Result<Picture> {
    let weights = visible_weights(&table.wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
    let reflectance: Vec<f64> = table.unpolarised().collect();
    let luminance: Vec<f64> = reflectance
        .chunks(table.wavelength_nm.len())
        .map(|spectrum| weights.iter().zip(spectrum).map(|(weight, rho)| weight[1] * rho).sum())
        .collect();
    let rho = |theta: f64| {
        let (below, above, weight) = neighbours(&table.theta_deg, theta);
        luminance[below] + weight * (luminance[above] - luminance[below])
    };
    let singles: Vec<f32> = reflectance.iter().map(|rho| *rho as f32).collect();
    let returned = returned(finish, &table.theta_deg, &singles, weights.len());
    let returned: f64 = weights.iter().zip(returned).map(|(weight, returned)| weight[1] * f64::from(returned)).sum();
    // Tabulated facets are drawn as if they were of this roughness.
    let [x, y] = finish.alpha().unwrap_or([0.1; 2]);
    let curve = |(&theta, colour): (&f64, &&str)| {
        let wi = direction(theta.to_radians(), phi_deg.to_radians()).as_vec3();
        let point = |theta_o: f64| {
            let wo = direction(theta_o.to_radians(), (phi_deg + 180.0).to_radians()).as_vec3();
            let leaving = |lobe: Lobe| {
                let [value, multiple] = [lobe.value, lobe.multiple].map(f64::from);
                (value * rho(f64::from(lobe.cos_d).acos().to_degrees()) + multiple * returned) * f64::from(wo.z)
            };
            (theta_o, finish.lobe(wi, wo).map_or(0.0, leaving))
        };
        // Evenly spaced, and around the mirror direction as finely as the lobe is narrow.
        let even = (-STEPS..=STEPS).map(|half| 0.5 * f64::from(half));
        let step = 0.25 * f64::from(x.min(y)).to_degrees();
        let near = (-NEAR..=NEAR).map(|i| theta + step * f64::from(i)).filter(|theta_o| theta_o.abs() < 90.0);
        let mut angles: Vec<f64> = even.chain(near).collect();
        angles.sort_by(f64::total_cmp);
        let points = angles.into_iter().map(point).collect();
        Series { label: format!("light at {theta}°"), colour: (*colour).to_owned(), points, dash: Dash::None }
    };
    let series: Vec<Series> = theta_deg.iter().zip(PALETTE.iter().cycle()).map(curve).collect();
    let rough = match finish.alpha() {
        None => "tabulated facets".into(),
        Some(_) if finish.is_isotropic() => format!("roughness {x}"),
        Some(_) => format!("roughness {x}, {y}"),
    };
    let title = format!("{name}, {rough}: lobes in the plane φ = {phi_deg}°");
    let label = "Outgoing angle: light’s side < 0 < mirror side, °";
    Ok(line_chart(&title, label, "Luminance of f cos θ (1/sr)", &series, LineOptions::default()))
}

#[cfg(test)]
mod tests {
    use goniochrome::microfacet::{Distribution, Masking};

    use super::*;

    #[test]
    fn the_lobe_of_a_mirror_is_that_of_its_facets() {
        let table = MirrorTable {
            theta_deg: vec![0.0, 89.0],
            wavelength_nm: vec![400.0, 550.0, 700.0],
            reflectance_s: vec![1.0; 6],
            reflectance_p: vec![1.0; 6],
            ..MirrorTable::default()
        };
        let finish = Finish::new(Distribution::Ggx, Masking::Correlated, [0.1, 0.4]).unwrap();
        let picture = lobes(&table, &finish, "mirror", &[0.0, 45.0], 0.0).unwrap();
        let svg = picture.svg();
        assert!(svg.contains("roughness 0.1, 0.4") && svg.contains("light at 45°"), "{svg}");
        // Along the normal f = D/4 = 1/(4π α_x α_y) = 1.99; the axis goes to 2.
        assert!(svg.contains(">2<") || svg.contains(">2.0<"), "{svg}");
        let invisible = MirrorTable { wavelength_nm: vec![1400.0, 1550.0, 1700.0], ..table };
        assert!(lobes(&invisible, &finish, "mirror", &[0.0], 0.0).is_err());
    }
}
