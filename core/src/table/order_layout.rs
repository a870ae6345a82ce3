//! Grid of directions of an [`OrderTable`](super::OrderTable).

use super::error::TableError;
use super::layout::{GridNode, clamped, product};
use glam::{DVec3, Vec3};

/// Largest angle α or β of a grid, in degrees: at 90° no light arrives.
const MAX_DEG: f32 = 89.0;
/// Largest number of nodes along α or β.
const MAX_SIDE: u32 = 1024;

/// Axes along which a surface repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Periodicity {
    /// The surface repeats along its tangent x and does not depend on y: lines along y.
    X,
    /// The surface repeats along its binormal y and does not depend on x: lines along x.
    Y,
    /// The surface repeats along both.
    Both,
}

impl Periodicity {
    /// Whether the surface is made of lines, and so its own mirror image across them.
    #[must_use]
    pub fn has_lines(self) -> bool {
        self != Self::Both
    }

    /// Component of a vector along the first axis of the grid, then along the second.
    fn components<T>(self, x: T, y: T) -> [T; 2] {
        if self == Self::Y { [y, x] } else { [x, y] }
    }
}

/// Grid of directions from which light arrives, in cone angles.
///
/// The direction of node (i, j) has the component sin α_i along the axis of the period (x, or y for
/// [`Periodicity::Y`]), cos α_i sin β_j along the other, and cos α_i cos β_j along the normal. All nodes of one α share
/// one wavevector across the lines, and so the eigenmodes of the lines. α is uniform from −89° to 89°. β is uniform
/// from 0 to 89° if there are lines, whose mirror symmetry makes β and −β equal, and else from −89° to 89°. An odd
/// number of nodes along α has one at 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderLayout {
    nodes: [u32; 2],
    periodicity: Periodicity,
    period_nm: [f32; 2],
}

impl OrderLayout {
    /// Grid of α × β `nodes`, each from 2 to 1024, for a surface with these periods along x and y. The period of an
    /// axis along which the surface does not vary does not count.
    ///
    /// # Errors
    /// [`TableError::OrderLayout`] if a number of nodes is out of range or a period is not positive and finite.
    pub fn new(nodes: [u32; 2], periodicity: Periodicity, period_nm: [f32; 2]) -> Result<Self, TableError> {
        let nodes_fit = nodes.iter().all(|n| (2..=MAX_SIDE).contains(n));
        let periods_fit = period_nm.iter().all(|period| *period > 0.0 && period.is_finite());
        if nodes_fit && periods_fit { Ok(Self { nodes, periodicity, period_nm }) } else { Err(TableError::OrderLayout) }
    }

    /// Numbers of nodes along α and along β.
    #[must_use]
    pub fn nodes(&self) -> [u32; 2] {
        self.nodes
    }

    /// Axes along which the surface repeats.
    #[must_use]
    pub fn periodicity(&self) -> Periodicity {
        self.periodicity
    }

    /// Periods along x and y.
    #[must_use]
    pub fn period_nm(&self) -> [f32; 2] {
        self.period_nm
    }

    /// Number of nodes.
    #[must_use]
    pub fn count(&self) -> usize {
        self.nodes[0] as usize * self.nodes[1] as usize
    }

    /// Angles α and β of a node, in radians. Nodes are ordered by rows of one β, along which α runs.
    #[must_use]
    pub fn angles(&self, node: usize) -> [f64; 2] {
        let width = self.nodes[0].max(1) as usize;
        let place = |index: usize, count: u32| index as f64 / f64::from(count.max(2) - 1);
        let max = f64::from(MAX_DEG).to_radians();
        let (alpha, beta) = (place(node % width, self.nodes[0]), place(node / width, self.nodes[1]));
        let beta = if self.periodicity.has_lines() { beta } else { 2.0 * beta - 1.0 };
        [(2.0 * alpha - 1.0) * max, beta * max]
    }

    /// Unit vector of a node, towards the light.
    #[must_use]
    pub fn direction(&self, node: usize) -> DVec3 {
        let [(sin_a, cos_a), (sin_b, cos_b)] = self.angles(node).map(libm::sincos);
        let [x, y] = self.periodicity.components(sin_a, cos_a * sin_b);
        DVec3::new(x, y, cos_a * cos_b)
    }

    /// Interpolation nodes of a unit vector above the horizon: linear in α and β, constant beyond the last nodes.
    #[must_use]
    pub fn interpolation(&self, direction: Vec3) -> [GridNode; 4] {
        let [along, across] = self.periodicity.components(direction.x, direction.y);
        let max = MAX_DEG.to_radians();
        let alpha = libm::atan2f(along, libm::hypotf(across, direction.z));
        let beta = libm::atan2f(across, direction.z);
        let beta = if self.periodicity.has_lines() { beta.abs() / max } else { 0.5 * (beta / max + 1.0) };
        let at = |place: f32, count: u32| clamped(place * (count - 1) as f32, count);
        product(at(beta, self.nodes[1]), at(0.5 * (alpha / max + 1.0), self.nodes[0]), self.nodes[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_interpolate_to_themselves() {
        for periodicity in [Periodicity::X, Periodicity::Y, Periodicity::Both] {
            let layout = OrderLayout::new([5, 4], periodicity, [700.0, 500.0]).unwrap();
            for node in 0..layout.count() {
                let direction = layout.direction(node);
                assert!((direction.length() - 1.0).abs() < 1e-12);
                let [alpha, beta] = layout.angles(node);
                let along = if periodicity == Periodicity::Y { direction.y } else { direction.x };
                assert!((along - alpha.sin()).abs() < 1e-12 && (direction.z - alpha.cos() * beta.cos()).abs() < 1e-12);
                let nodes = layout.interpolation(direction.as_vec3());
                let weight: f32 = nodes.iter().filter(|n| n.index == node).map(|n| n.weight).sum();
                // Angles in single precision, times the number of nodes.
                assert!((weight - 1.0).abs() < 1e-4, "{periodicity:?} {node}: {nodes:?}");
            }
        }
    }

    #[test]
    fn lines_are_their_own_mirror_image() {
        let layout = OrderLayout::new([7, 5], Periodicity::X, [700.0, 700.0]).unwrap();
        let w = Vec3::new(0.3, 0.5, 0.7).normalize();
        assert_eq!(layout.interpolation(w), layout.interpolation(Vec3::new(w.x, -w.y, w.z)));
    }

    #[test]
    fn impossible_grids_are_refused() {
        let refused = |nodes, period| OrderLayout::new(nodes, Periodicity::X, period) == Err(TableError::OrderLayout);
        assert!(refused([1, 4], [700.0; 2]) && refused([4, 1025], [700.0; 2]));
        assert!(refused([4, 4], [0.0, 700.0]) && refused([4, 4], [f32::INFINITY, 700.0]));
    }
}
