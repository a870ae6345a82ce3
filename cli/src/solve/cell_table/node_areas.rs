//! From powers in boxes to values at nodes.

use goniochrome::table::{HalfVectorWarp, ScatterLayout, tent_solid_angles};

use crate::support::direction::direction;

/// What the nodes of a table stand for, for light of one incident direction.
pub(crate) struct NodeAreas {
    /// Solid angle of each node's tent over cos θ_i.
    area: Vec<f64>,
    columns: usize,
    level: Option<usize>,
}

/// Number of half-vector angles that have one place each, whatever the azimuth: those of light along the normal in a
/// table that counts azimuths from the light.
pub(crate) fn level_columns(layout: &ScatterLayout, incident: usize) -> Option<usize> {
    (layout.is_isotropic() && incident == 0).then(|| layout.square_sides()[0] as usize)
}

impl NodeAreas {
    /// The areas for one incident direction of a table.
    pub fn new(layout: &ScatterLayout, warp: &HalfVectorWarp<'_>, incident: usize) -> Self {
        let [theta, phi] = layout.incident(incident);
        let wi = direction(theta, phi).as_vec3();
        let mut areas = Self {
            area: vec![0.0; layout.node_count()],
            columns: layout.square_sides()[0] as usize,
            level: level_columns(layout, incident),
        };
        tent_solid_angles(layout, warp, wi, layout.origin(wi), |node, part| {
            let node = areas.shared(node);
            areas.area[node] += f64::from(part) / theta.cos();
        });
        areas
    }

    /// The node that holds what counts at a node: those of the normal share one.
    fn shared(&self, node: usize) -> usize {
        match self.level {
            Some(columns) => node % columns,
            None if node.is_multiple_of(self.columns) => 0,
            None => node,
        }
    }

    /// Divides the powers in the boxes of all nodes by the nodes' areas, which makes them s = f cos θ_i cos θ_o. What
    /// follows the nodes, the lobes, stays. Negative values become 0: where starting rays interfere, a box without
    /// light holds noise of either sign.
    pub fn divide(&self, powers: &mut [f32]) {
        let nodes = self.area.len();
        for node in (0..nodes).rev().filter(|&node| self.shared(node) == node) {
            if self.area[node] > 0.0 {
                powers[node] = (f64::from(powers[node]) / self.area[node]) as f32;
            } else if node % self.columns > 0 {
                // The box is a sliver at the horizon that the quadrature does not see.
                powers[node - 1] += std::mem::take(&mut powers[node]);
            }
        }
        for node in 0..nodes {
            powers[node] = powers[self.shared(node)];
        }
        powers.iter_mut().for_each(|value| *value = value.max(0.0));
    }
}
