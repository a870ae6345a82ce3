//! Reciprocity imposed on a finished table.

use glam::Vec3;

use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::table::scatter::{ScatterTable, warp_pairs};
use goniochrome::table::{HalfVectorWarp, ScatterLayout};

/// Replaces s(wi, wo) by ½ [s(wi, wo) + s(wo, wi)], two estimates of the same number. The table then has less noise,
/// and path tracers may use it from either end. Exchanged directions have the same half vector, so s(wo, wi) is looked
/// up in the same node, linear between incident directions; in an isotropic table, whose half vectors count from the
/// light, also between azimuths.
///
/// Nodes that reflect below the horizon, or beyond the table's largest θ_i, stay, as do lobes and energies.
///
/// # Errors
/// A warp without sense.
pub fn reciprocal(table: &mut ScatterTable) -> Result<()> {
    let layout = table.layout;
    let [pairs_u, pairs_v] = warp_pairs(&table.warp)?;
    let warp = HalfVectorWarp::from_pairs(&pairs_u, &pairs_v).map_err(Error::failed)?;
    let (wavelengths, places) = (table.wavelength_nm.len(), layout.places());
    let (traced, traced_error) = (table.values.clone(), table.luminance_error.clone());
    let least = ScatterLayout::THETA_MAX.cos() as f32;
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        let wi = direction(theta, phi).as_vec3();
        for node in 0..layout.node_count() {
            let [x, y] = layout.node(node).map(|place| place as f32);
            let (m, _) = warp.half_vector([x, y], layout.origin(wi));
            let wo: Vec3 = 2.0 * wi.dot(m) * m - wi;
            if wo.z < least || wi.dot(m) <= 0.0 {
                continue;
            }
            let from = layout.incident_nodes(wo);
            let [x, y] = warp.warped(wo, wi, layout.origin(wo)).place;
            let to = layout.square_nodes(x, y);
            let nodes = from.map(|i| to.map(|o| (i.index, o.index, i.weight * o.weight)));
            let nodes = nodes.as_flattened().iter().filter(|node| node.2 > 0.0);
            for w in 0..wavelengths {
                let at = |incident: usize, node: usize| traced[(incident * wavelengths + w) * places + node];
                let reverse: f32 = nodes.clone().map(|&(i, o, weight)| weight * at(i, o)).sum();
                table.values[(incident * wavelengths + w) * places + node] = 0.5 * (at(incident, node) + reverse);
            }
            let variance = |weight: f32, error: f32| f64::from(weight * error).powi(2);
            let reverse: f64 = nodes.map(|&(i, o, weight)| variance(weight, traced_error[i * places + o])).sum();
            let own = variance(1.0, traced_error[incident * places + node]);
            table.luminance_error[incident * places + node] = (0.5 * (own + reverse).sqrt()) as f32;
        }
    }
    Ok(())
}
