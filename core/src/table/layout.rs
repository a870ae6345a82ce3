//! Grid of directions of a [`ScatterTable`](super::ScatterTable), and interpolation on it.

use super::error::TableError;
use crate::measure::bins::DirectionBins;
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use glam::Vec3;

/// Grid of incident directions × outgoing bins.
///
/// - Incident polar angles are uniform in θ: θ_i = (row + ½) (π/2)/rows. Colours of films and Fresnel coefficients vary
///   with θ at a similar rate everywhere; with eight rows uniform in cos θ the first 20° would have no direction. The
///   middles of the rows avoid 0°, where φ is undefined, and 90°, where no light arrives.
/// - Incident azimuths are φ_i = 2π column/columns + π/M for M outgoing azimuths: middles of outgoing bins. An
///   isotropic surface has one column.
/// - Outgoing bins are uniform in cos θ_o from the horizon, all of equal solid angle, and in the azimuth **relative to
///   the incident one**, φ_o − φ_i; bin k lies around 2πk/M. Lobes keep their bins as the light moves around the
///   normal, so interpolation between columns moves a lobe instead of blending two. Retro-reflection is in the middle
///   of bin 0, the mirror direction in that of bin M/2. M is a multiple of the columns, so relative bins are the
///   absolute ones, renumbered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScatterLayout {
    theta: u32,
    phi: u32,
    bins: DirectionBins,
}

/// Node of an interpolation on a grid of directions, with its weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GridNode {
    /// Index of the incident direction or of the outgoing bin.
    pub index: usize,
    /// Interpolation weight in [0, 1]; the weights of one direction add up to 1.
    pub weight: f32,
}

/// Largest number of rows or columns. With it, indices of a whole table fit in 64 bits and single precision
/// distinguishes bins.
const MAX_SIDE: u32 = 1024;

impl ScatterLayout {
    /// Grid of `theta` × `phi` incident directions and of bins of outgoing ones; each side is from 1 to 1024.
    ///
    /// # Errors
    /// [`TableError::Layout`] if a side is out of range, or `bins.phi` is not a multiple of `phi`.
    pub fn new(theta: u32, phi: u32, bins: DirectionBins) -> Result<Self, TableError> {
        let in_range = [theta, phi, bins.cos, bins.phi].iter().all(|n| (1..=MAX_SIDE).contains(n));
        if in_range && bins.phi.is_multiple_of(phi) { Ok(Self { theta, phi, bins }) } else { Err(TableError::Layout) }
    }

    /// Number of rows of incident directions.
    #[must_use]
    pub fn theta(&self) -> u32 {
        self.theta
    }

    /// Number of columns of incident directions.
    #[must_use]
    pub fn phi(&self) -> u32 {
        self.phi
    }

    /// Outgoing bins, row by row in cos θ_o, columns in φ_o − φ_i.
    #[must_use]
    pub fn bins(&self) -> DirectionBins {
        self.bins
    }

    /// Number of incident directions, which are ordered by rows in θ_i.
    #[must_use]
    pub fn incident_count(&self) -> usize {
        self.theta as usize * self.phi as usize
    }

    /// Number of pairs of an incident direction and an outgoing bin.
    #[must_use]
    pub fn count(&self) -> usize {
        self.incident_count() * self.bins.count()
    }

    /// Angles θ_i and φ_i of an incident direction, in radians.
    #[must_use]
    pub fn incident(&self, index: usize) -> [f64; 2] {
        let columns = self.phi.max(1) as usize;
        let (row, column) = (index / columns, index % columns);
        let theta = (row as f64 + 0.5) / f64::from(self.theta) * core::f64::consts::FRAC_PI_2;
        [theta, core::f64::consts::TAU * (self.first_bin(column) as f64 + 0.5) / f64::from(self.bins.phi)]
    }

    /// Absolute azimuth bin that contains the incident directions of a column: relative bins are counted from it.
    #[must_use]
    pub fn first_bin(&self, column: usize) -> usize {
        column * (self.bins.phi / self.phi.max(1)) as usize
    }

    /// Middle of an outgoing bin: cos θ_o, and φ_o − φ_i in radians.
    #[must_use]
    pub fn outgoing(&self, bin: usize) -> [f64; 2] {
        let columns = self.bins.phi.max(1) as usize;
        let (row, column) = (bin / columns, bin % columns);
        let cos = (row as f64 + 0.5) / f64::from(self.bins.cos);
        [cos, core::f64::consts::TAU * column as f64 / f64::from(self.bins.phi)]
    }

    /// Interpolation nodes for an incident direction (θ, φ) in radians: linear in θ, constant beyond the first and the
    /// last row; linear and periodic in φ.
    #[must_use]
    pub fn incident_nodes(&self, theta: f32, phi: f32) -> [GridNode; 4] {
        let rows = clamped(theta / FRAC_PI_2 * self.theta as f32 - 0.5, self.theta);
        let columns = periodic((phi - PI / self.bins.phi as f32) / TAU, self.phi);
        product(rows, columns, self.phi)
    }

    /// Interpolation nodes for an outgoing direction of cos θ and the relative azimuth φ in radians: linear in cos θ,
    /// constant beyond the middles of the first and the last row; linear and periodic in φ.
    #[must_use]
    pub fn outgoing_nodes(&self, cos_theta: f32, phi: f32) -> [GridNode; 4] {
        let rows = clamped(cos_theta * self.bins.cos as f32 - 0.5, self.bins.cos);
        product(rows, periodic(phi / TAU, self.bins.phi), self.bins.phi)
    }

    /// Interpolation nodes for `wi` and for `wo`; `None` unless both lie above the horizon.
    #[inline]
    pub(super) fn nodes(&self, wi: Vec3, wo: Vec3) -> Option<([GridNode; 4], [GridNode; 4])> {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return None;
        }
        let phi = azimuth(wi);
        Some((self.incident_nodes(polar(wi), phi), self.outgoing_nodes(wo.z.min(1.0), azimuth(wo) - phi)))
    }

    /// Integral of a bin's interpolation weight over cos θ dω: what one unit of f in the bin adds to the albedo.
    pub(super) fn projected_share(&self, bin: usize) -> f32 {
        let rows = self.bins.cos as f32;
        let row = bin / self.bins.phi.max(1) as usize;
        // A tent around the middle of a row has its moment there. The first and the last are constant in their outer
        // half.
        let mut moment = (row as f32 + 0.5) / (rows * rows);
        if rows > 1.0 {
            let cut = 1.0 / (24.0 * rows * rows);
            moment += if row == 0 { cut } else { 0.0 };
            moment -= if row + 1 == self.bins.cos as usize { cut } else { 0.0 };
        }
        moment * TAU / self.bins.phi as f32
    }
}

/// Polar angle θ of a vector.
#[inline]
pub(super) fn polar(w: Vec3) -> f32 {
    libm::atan2f(libm::hypotf(w.x, w.y), w.z)
}

/// Azimuth φ of a vector, in (−π, π]; 0 along the normal.
#[inline]
pub(super) fn azimuth(w: Vec3) -> f32 {
    libm::atan2f(w.y, w.x)
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
    let whole = libm::floorf(place);
    let weight = place - whole;
    let below = whole as u32 % count.max(1);
    [
        GridNode { index: below as usize, weight: 1.0 - weight },
        GridNode { index: ((below + 1) % count.max(1)) as usize, weight },
    ]
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
        ScatterLayout::new(4, 3, DirectionBins { cos: 5, phi: 6 }).unwrap()
    }

    #[test]
    fn the_middle_of_a_bin_has_no_other_node() {
        let layout = layout();
        let alone = |nodes: [GridNode; 4], index| {
            let share: f32 = nodes.iter().filter(|node| node.index == index).map(|node| node.weight).sum();
            assert!((share - 1.0).abs() < 1e-5, "{index}: {nodes:?}");
        };
        for index in 0..layout.incident_count() {
            let [theta, phi] = layout.incident(index).map(|x| x as f32);
            alone(layout.incident_nodes(theta, phi), index);
            alone(layout.incident_nodes(theta, phi - TAU), index);
        }
        for bin in 0..layout.bins().count() {
            let [cos, phi] = layout.outgoing(bin).map(|x| x as f32);
            alone(layout.outgoing_nodes(cos, phi), bin);
        }
    }

    #[test]
    fn incident_azimuths_are_the_middles_of_absolute_bins() {
        let layout = layout();
        for index in 0..layout.incident_count() {
            let [theta, phi] = layout.incident(index);
            let wi = glam::DVec3::new(
                libm::sin(theta) * libm::cos(phi),
                libm::sin(theta) * libm::sin(phi),
                libm::cos(theta),
            );
            let bin = layout.bins().index(wi);
            let [_, _, from, to] = layout.bins().bounds(bin);
            assert!((phi - 0.5 * (from + to)).abs() < 1e-12);
            assert_eq!(bin % 6, layout.first_bin(index % 3));
        }
    }

    #[test]
    fn weights_add_up_to_1_and_nan_does_not_panic() {
        let layout = layout();
        for theta in [-1.0, 0.0, 0.1, 0.7, 1.5, 2.0, f32::NAN, f32::INFINITY] {
            for phi in [-7.0, -0.0, 3.0, 6.283_185_5, 100.0, f32::NAN, f32::INFINITY] {
                for nodes in [layout.incident_nodes(theta, phi), layout.outgoing_nodes(theta, phi)] {
                    assert!(nodes.iter().all(|node| node.index < 30));
                    if phi.is_finite() {
                        assert!((nodes.iter().map(|node| node.weight).sum::<f32>() - 1.0).abs() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn shares_of_the_projected_hemisphere_add_up_to_pi() {
        for (cos, phi) in [(1, 1), (2, 3), (16, 32)] {
            let layout = ScatterLayout::new(1, 1, DirectionBins { cos, phi }).unwrap();
            let sum: f32 = (0..layout.bins().count()).map(|bin| layout.projected_share(bin)).sum();
            assert!((sum - PI).abs() < 1e-5, "{cos} × {phi}: {sum}");
        }
    }

    #[test]
    fn grids_that_do_not_fit_are_refused() {
        for (theta, phi, cos, around) in
            [(0, 1, 1, 1), (1, 0, 1, 1), (1, 1, 0, 1), (1, 1, 1, 0), (1, 2, 1, 3), (1025, 1, 1, 1)]
        {
            let bins = DirectionBins { cos, phi: around };
            assert_eq!(ScatterLayout::new(theta, phi, bins), Err(TableError::Layout));
        }
    }
}
