//! Grid of directions of a [`ScatterTable`](super::ScatterTable), and interpolation on it.

use super::angles::{azimuth, polar};
use super::error::TableError;
use core::f32::consts::TAU;
use glam::Vec3;

/// Grid of incident directions × nodes of the warped square of half vectors, and number of facet lobes.
///
/// - Incident polar angles run from 0 to [`ScatterLayout::THETA_MAX`], equally spaced. Beyond the last, values are
///   held.
/// - Incident azimuths are φ_i = 2π column/columns − π. An isotropic surface has one column. Along the normal there is
///   no azimuth: all columns of the first row should hold the same values.
/// - The square (x, y) is that of [`HalfVectorWarp`](super::HalfVectorWarp): x = 0 is the half vector along the normal,
///   y runs once around it. Its nodes are x = j/(U − 1) and y = k/V; y is periodic. At x = 0 there is no azimuth
///   either, and all nodes should hold the same value.
///
/// Each incident direction has [`ScatterLayout::places`] values: first those of the nodes, x fastest, then those of the
/// lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScatterLayout {
    incident: [u32; 2],
    square: [u32; 2],
    lobes: u32,
}

/// Node of an interpolation on a grid of directions, with its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridNode {
    /// Index of the incident direction or of the node of the square.
    pub index: usize,
    /// Interpolation weight in [0, 1]; the weights of one direction add up to 1.
    pub weight: f32,
}

/// Largest number of rows, columns or lobes. With it, indices of a whole table fit in 64 bits and single precision
/// distinguishes nodes.
const MAX_SIDE: u32 = 1024;

impl ScatterLayout {
    /// Largest incident polar angle of a table, in radians: 89°. A facet's light at 90° is grazing: the surface shows
    /// no area there.
    pub const THETA_MAX: f64 = 89.0 / 180.0 * core::f64::consts::PI;

    /// Grid of `incident` = [rows in θ_i, columns in φ_i] and `square` = [U nodes in x, V in y], with a number of facet
    /// lobes. Rows and U are from 2 to 1024, columns and V from 1, lobes from 0.
    ///
    /// # Errors
    /// [`TableError::Layout`] if a number is out of range.
    pub fn new(incident: [u32; 2], square: [u32; 2], lobes: u32) -> Result<Self, TableError> {
        let ([rows, columns], [u, v]) = (incident, square);
        let in_range = [rows, u].iter().all(|n| (2..=MAX_SIDE).contains(n))
            && [columns, v].iter().all(|n| (1..=MAX_SIDE).contains(n))
            && lobes <= MAX_SIDE;
        if in_range { Ok(Self { incident, square, lobes }) } else { Err(TableError::Layout) }
    }

    /// Numbers of rows and columns of incident directions.
    #[must_use]
    pub fn incident_sides(&self) -> [u32; 2] {
        self.incident
    }

    /// Numbers of nodes of the square along x and along y.
    #[must_use]
    pub fn square_sides(&self) -> [u32; 2] {
        self.square
    }

    /// Number of facet lobes.
    #[must_use]
    pub fn lobes(&self) -> usize {
        self.lobes as usize
    }

    /// Whether the table has one incident azimuth: it counts the azimuths of half vectors from the incident one.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        self.incident[1] == 1
    }

    /// Number of incident directions, which are ordered by rows in θ_i.
    #[must_use]
    pub fn incident_count(&self) -> usize {
        self.incident[0] as usize * self.incident[1] as usize
    }

    /// Number of nodes of the square.
    #[must_use]
    pub fn node_count(&self) -> usize {
        self.square[0] as usize * self.square[1] as usize
    }

    /// Number of values of each incident direction in each channel: of the nodes, then of the lobes.
    #[must_use]
    pub fn places(&self) -> usize {
        self.node_count() + self.lobes()
    }

    /// Number of values of each channel.
    #[must_use]
    pub fn count(&self) -> usize {
        self.incident_count() * self.places()
    }

    /// Angles θ_i and φ_i of an incident direction, in radians.
    #[must_use]
    pub fn incident(&self, index: usize) -> [f64; 2] {
        let [rows, columns] = self.incident.map(|n| n.max(1) as usize);
        let theta = (index / columns) as f64 / (rows - 1).max(1) as f64 * Self::THETA_MAX;
        let phi = core::f64::consts::TAU * (index % columns) as f64 / columns as f64 - core::f64::consts::PI;
        [theta, if self.is_isotropic() { 0.0 } else { phi }]
    }

    /// Place (x, y) of a node in the square.
    #[must_use]
    pub fn node(&self, index: usize) -> [f64; 2] {
        let [u, v] = self.square.map(|n| n.max(1) as usize);
        [(index % u) as f64 / (u - 1).max(1) as f64, (index / u) as f64 / v as f64]
    }

    /// Node in whose box a place of the square lies: the box reaches half a step to either side of its node. All nodes
    /// at x = 0 are one, and share the box of the first.
    #[must_use]
    pub fn nearest_node(&self, x: f64, y: f64) -> usize {
        let [u, v] = self.square.map(f64::from);
        let column = ((x * (u - 1.0) + 0.5).max(0.0) as u32).min(self.square[0] - 1);
        let row = (y * v + 0.5).max(0.0) as u32 % self.square[1].max(1);
        if column == 0 { 0 } else { (row * self.square[0] + column) as usize }
    }

    /// Interpolation nodes for an incident direction: linear in θ, constant beyond the last row; linear and periodic in
    /// φ.
    #[must_use]
    pub fn incident_nodes(&self, wi: Vec3) -> [GridNode; 4] {
        let [rows, columns] = self.incident;
        let row = polar(wi) * ((rows - 1) as f32 / Self::THETA_MAX as f32);
        let around = if self.is_isotropic() {
            [GridNode { index: 0, weight: 1.0 }, GridNode::default()]
        } else {
            periodic(azimuth(wi) * (1.0 / TAU) + 0.5, columns)
        };
        product(clamped(row, rows), around, columns)
    }

    /// Interpolation nodes for a place (x, y) of the square: linear in x, and linear and periodic in y.
    #[must_use]
    pub fn square_nodes(&self, x: f32, y: f32) -> [GridNode; 4] {
        let [columns, rows] = self.square_axes(x, y);
        product(rows, columns, self.square[0])
    }

    /// Two columns and two rows of nodes between which a place (x, y) of the square lies.
    #[inline]
    pub(super) fn square_axes(&self, x: f32, y: f32) -> [[GridNode; 2]; 2] {
        let [u, v] = self.square;
        [clamped(x * (u - 1) as f32, u), periodic(y, v)]
    }

    /// Azimuth from which those of half vectors count: 0, or that of the light in isotropic tables.
    #[must_use]
    #[inline]
    pub fn origin(&self, wi: Vec3) -> f32 {
        if self.is_isotropic() { azimuth(wi) } else { 0.0 }
    }
}

/// Linear interpolation at `place` among `count` nodes, constant beyond the ends.
#[inline]
pub(super) fn clamped(place: f32, count: u32) -> [GridNode; 2] {
    let last = (count - 1) as f32;
    let place = place.max(0.0).min(last);
    let below = (place as u32).min(count.saturating_sub(2));
    let weight = place - below as f32;
    [
        GridNode { index: below as usize, weight: 1.0 - weight },
        GridNode { index: (below + 1).min(count - 1) as usize, weight },
    ]
}

/// Linear interpolation at a fraction of the full circle, among `count` nodes around it.
#[inline]
fn periodic(fraction: f32, count: u32) -> [GridNode; 2] {
    let place = (fraction - libm::floorf(fraction)) * count as f32;
    let whole = place as u32;
    let weight = place - whole as f32;
    // A fraction just below 0 is rounded to the whole circle.
    let below = if whole < count { whole } else { 0 };
    let above = if below + 1 < count { below + 1 } else { 0 };
    [GridNode { index: below as usize, weight: 1.0 - weight }, GridNode { index: above as usize, weight }]
}

/// Bilinear interpolation: products of the weights of two rows and two columns of a grid `width` wide.
#[inline]
pub(super) fn product(rows: [GridNode; 2], columns: [GridNode; 2], width: u32) -> [GridNode; 4] {
    core::array::from_fn(|i| {
        let (row, column) = (rows[i / 2], columns[i % 2]);
        GridNode { index: row.index * width as usize + column.index, weight: row.weight * column.weight }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> ScatterLayout {
        ScatterLayout::new([4, 3], [5, 6], 2).unwrap()
    }

    fn direction([theta, phi]: [f64; 2]) -> Vec3 {
        let ((sin, cos), (sin_phi, cos_phi)) = (libm::sincos(theta), libm::sincos(phi));
        Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32)
    }

    #[test]
    fn a_node_has_no_other_node() {
        let layout = layout();
        let alone = |nodes: [GridNode; 4], index| {
            let share: f32 = nodes.iter().filter(|node| node.index == index).map(|node| node.weight).sum();
            assert!((share - 1.0).abs() < 1e-5, "{index}: {nodes:?}");
        };
        // The first row has no azimuth.
        for index in 3..layout.incident_count() {
            alone(layout.incident_nodes(direction(layout.incident(index))), index);
        }
        for index in 0..layout.node_count() {
            let [x, y] = layout.node(index);
            alone(layout.square_nodes(x as f32, y as f32), index);
            alone(layout.square_nodes(x as f32, y as f32 - 1.0), index);
            assert_eq!(layout.nearest_node(x, y), if x > 0.0 { index } else { 0 });
        }
    }

    #[test]
    fn boxes_reach_half_a_step_to_either_side() {
        let layout = layout();
        for (x, y, node) in
            [(0.0, 0.0, 0), (0.124, 0.083, 0), (0.126, 0.0, 1), (0.126, 0.084, 6), (0.0, 0.084, 0), (1.0, 0.99, 4)]
        {
            assert_eq!(layout.nearest_node(x, y), node, "{x} {y}");
        }
    }

    #[test]
    fn weights_add_up_to_1_and_nan_does_not_panic() {
        let layout = layout();
        for x in [-1.0, -0.0, 0.0, 0.1, 0.7, 1.0, 2.0, f32::NAN, f32::INFINITY] {
            for y in [-7.0, -0.0, 0.3, 1.0, 100.0, f32::NAN, f32::INFINITY] {
                for nodes in [layout.incident_nodes(Vec3::new(x, y, 0.5)), layout.square_nodes(x, y)] {
                    assert!(nodes.iter().all(|node| node.index < 30));
                    if x.is_finite() && y.is_finite() {
                        assert!((nodes.iter().map(|node| node.weight).sum::<f32>() - 1.0).abs() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn grids_that_do_not_fit_are_refused() {
        for (incident, square, lobes) in [
            ([1, 1], [2, 1], 0),
            ([2, 0], [2, 1], 0),
            ([2, 1], [1, 1], 0),
            ([2, 1], [2, 0], 0),
            ([1025, 1], [2, 1], 0),
            ([2, 1], [2, 1], 1025),
        ] {
            assert_eq!(ScatterLayout::new(incident, square, lobes), Err(TableError::Layout));
        }
        assert_eq!(layout().places(), 32);
        assert_eq!(layout().count(), 384);
    }
}
