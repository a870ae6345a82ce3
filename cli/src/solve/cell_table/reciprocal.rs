//! Reciprocity imposed on a finished table.

use crate::table::scatter::ScatterTable;

/// Replaces f(wi, wo) by ½ [f(wi, wo) + f(wo, wi)], two estimates of the same number. The table then has less noise,
/// and path tracers may use it from either end.
///
/// f(wo, wi) is looked up in the table itself, linear between its incident directions and bins, for the middle of each
/// bin inside the grid: θ_o between the first and the last θ_i, and θ_i between the middles of the first and the last
/// row of bins. Elsewhere, close to the horizon and to the normal, f(wi, wo) stays. The energies stay as traced.
pub fn reciprocal(table: &mut ScatterTable) {
    let layout = table.layout;
    let wavelengths = table.wavelength_nm.len();
    let bins = layout.bins().count();
    let ends = |first: f64, last: f64| first..=last;
    let thetas = ends(layout.incident(0)[0], layout.incident(layout.incident_count() - 1)[0]);
    let cosines = ends(layout.outgoing(0)[0], layout.outgoing(bins - 1)[0]);
    let (traced, traced_error) = (table.brdf.clone(), table.luminance_error.clone());
    for incident in 0..layout.incident_count() {
        let [theta_i, phi_i] = layout.incident(incident);
        for bin in 0..bins {
            let [cos_o, relative] = layout.outgoing(bin);
            let theta_o = cos_o.acos();
            if !(thetas.contains(&theta_o) && cosines.contains(&theta_i.cos())) {
                continue;
            }
            let from = layout.incident_nodes(theta_o as f32, (phi_i + relative) as f32);
            let to = layout.outgoing_nodes(theta_i.cos() as f32, -relative as f32);
            let nodes = from.map(|i| to.map(|o| (i.index, o.index, i.weight * o.weight)));
            let nodes = nodes.as_flattened().iter().filter(|node| node.2 > 0.0);
            for w in 0..wavelengths {
                let at = |incident: usize, bin: usize| traced[(incident * wavelengths + w) * bins + bin];
                let reverse: f32 = nodes.clone().map(|&(i, o, weight)| weight * at(i, o)).sum();
                table.brdf[(incident * wavelengths + w) * bins + bin] = 0.5 * (at(incident, bin) + reverse);
            }
            let variance = |weight: f32, error: f32| f64::from(weight * error).powi(2);
            let reverse: f64 = nodes.map(|&(i, o, weight)| variance(weight, traced_error[i * bins + o])).sum();
            let own = variance(1.0, traced_error[incident * bins + bin]);
            table.luminance_error[incident * bins + bin] = (0.5 * (own + reverse).sqrt()) as f32;
        }
    }
}
