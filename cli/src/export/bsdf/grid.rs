//! The grid on which the file samples the BRDF.
//!
//! The format interpolates linearly over θ_i and φ_i at a fixed place of the warped square. The warp is therefore the
//! same for all incident directions: a fixed place is then a fixed half vector, along which the BRDF is smooth. A warp
//! that follows the lobe would move the half vector as well (measured: no gain in the lobe, and large errors where the
//! lobe meets the horizon). The warp is free only in how densely half vectors lie over θ_m and over φ_m. Facets of two
//! roughnesses are the exception: their warp turns half vectors with φ_i.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use goniochrome::table::Periodicity;

use super::density::Density;
use crate::export::OrderLobes;

/// Largest number of values in a file: 256 MiB.
pub const MAX_VALUES: usize = 1 << 26;
/// Samples over θ_i, and along each side of the square, for a lobe around the mirror direction, whose masking changes
/// over a scale of cos θ_o ≈ α.
const OF_LOBE: [f64; 2] = [240.0, 217.0];
/// Samples as of a lobe, for facets of two roughnesses.
const OF_TWO: [f64; 2] = [120.0, 307.0];
/// Steps of a quarter of the turn of φ_i, for facets of two roughnesses.
const TURNS: usize = 8;
/// Knots of the density over v in each step of φ_i.
const KNOTS: usize = 2;
/// Smallest number of samples along each side of the square, and of φ_i.
const MIN_SAMPLES: f64 = 4.0;
/// Density e of θ_i at the horizon, where masking changes over a scale of cos θ_i, for a lobe and for orders: samples
/// lie closer there by (1 + e)/e.
const GRAZING: [f64; 2] = [1.0, 0.3];
/// Largest θ_i in radians; a direction at 90° sees nothing.
const MAX_THETA: f64 = 89.99 / 180.0 * PI;
/// Share of a lobe's half vectors whose density is 1/(θ_m + α/2), a fixed number for each factor of θ_m beyond the
/// lobe's core; the others lie evenly over the square. For facets of one roughness, and of two.
const LOGARITHMIC: [f64; 2] = [0.85, 0.5];
/// Columns of the warp, which resolve the core of the smoothest lobe, α = 0.001, whose u is 0.02; for facets of two
/// roughnesses fewer, since the file repeats the warp for each φ_i.
const COLUMNS: [usize; 2] = [1024, 128];
/// Excess density of φ_m across the plane of incidence, where a lobe meets the horizon at grazing angles, over that
/// along it.
const ACROSS: f64 = 5.0;

/// Columns of the warp over v for orders, a multiple of 4 so that their azimuths are among them.
const SPOKES: usize = 128;
/// Density of half vectors over u at the normal, over that at the horizon. Elsewhere they are even over θ_m.
const LEAST_RADIAL: f64 = 0.05;
/// Nodes over v for each factor e of the distance from an order's azimuth, on each of four sides.
const PER_SIDE: f64 = 3.75;
/// Widths of a lobe over half vectors within which nodes over v are even.
const CORE: f64 = 3.0;
/// Widths of a lobe over half vectors between directions of the light, over θ_i and over φ_i.
const PER_LOBE: [f64; 2] = [3.0, 8.0];
/// Largest factor by which samples along an axis may lie closer than is needed.
const MAX_FINER: f64 = 2.0;

/// The grid of a tensor file.
#[derive(Clone, Debug)]
pub struct BsdfGrid {
    /// Incident angles θ_i in radians, increasing.
    pub theta: Vec<f64>,
    /// Incident azimuths φ_i in radians, from −π to π; one of them for isotropic tables.
    pub phi: Vec<f64>,
    /// Density of half vectors over u.
    pub across: Axis,
    /// Density of half vectors over v for each φ_i.
    pub along: Vec<Axis>,
}

/// Density over a side of the square, and the nodes that follow it.
#[derive(Clone, Debug)]
pub struct Axis {
    /// The density.
    pub density: Density,
    /// Nodes: each place, and the density there over its mean.
    pub nodes: Vec<(f64, f64)>,
}

impl Axis {
    /// The axis of a density with a number of nodes.
    #[must_use]
    pub fn new(density: Density, side: usize) -> Self {
        Self { nodes: density.nodes(side), density }
    }
}

impl BsdfGrid {
    /// The grid for a lobe of a roughness α along x and y around the mirror direction, in a number of channels.
    ///
    /// Facets of two roughnesses are symmetric in x and in y. One quarter of the turn of φ_i is enough, the one into
    /// which Mitsuba mirrors directions. Nodes over v turn with φ_i, see `turned`.
    #[must_use]
    pub fn of_lobe(alpha: [f64; 2], channels: usize) -> Self {
        let least = alpha[0].min(alpha[1]);
        // Values for each sample: the channels, and the luminance.
        let scale = |[theta, side]: [f64; 2], turns: usize| {
            let values = ((channels + 1) * turns) as f64 * theta * side * side;
            (MAX_VALUES as f64 / values).cbrt().min(1.0)
        };
        if alpha[0] == alpha[1] {
            let [theta, side] = OF_LOBE.map(|count| (scale(OF_LOBE, 1) * count) as usize);
            let density = [radial(least, LOGARITHMIC[0], COLUMNS[0]), across()];
            return Self::of(density, side, grazing(theta, GRAZING[0]), vec![0.0]);
        }
        let [theta, side] = OF_TWO.map(|count| (scale(OF_TWO, TURNS + 1) * count) as usize);
        Self {
            theta: grazing(theta, GRAZING[0]),
            phi: (0..=TURNS).map(|turn| FRAC_PI_2 * turn as f64 / TURNS as f64 - PI).collect(),
            across: Axis::new(radial(least, LOGARITHMIC[1], COLUMNS[1]), side),
            along: (0..=TURNS).map(|turn| Axis::new(turned(turn), side)).collect(),
        }
    }

    /// The grid for lobes around diffraction orders.
    ///
    /// The half vector of an order lies along its grating vector, whatever the direction of the light: for lines always
    /// at one azimuth, and nodes lie close to that. A lobe is half as wide over half vectors as over directions.
    #[must_use]
    pub fn of_orders(lobes: &OrderLobes) -> Self {
        let room = MAX_VALUES as f64 / (lobes.channels() + 1) as f64;
        let width = 0.5 * lobes.spread();
        let along = match lobes.periodicity() {
            Periodicity::Both => Density::uniform(),
            lines => beside(if lines == Periodicity::X { 0.0 } else { 0.25 }, CORE * width / TAU),
        };
        // One σ of a lobe between nodes of half vectors; several between directions of the light, with which the half
        // vector of an order moves slowly.
        let around = match lobes.periodicity() {
            Periodicity::Both => TAU / width,
            _ => 4.0 * PER_SIDE * (0.25 * TAU / (CORE * width)).ln_1p(),
        };
        let side = (FRAC_PI_2 / width * around).sqrt();
        let wanted = [side, side, FRAC_PI_2 / (PER_LOBE[0] * width), TAU / (PER_LOBE[1] * width)];
        let scale = (room / wanted.iter().product::<f64>()).powf(0.25).min(MAX_FINER);
        let [_, side, theta, phi] = wanted.map(|count| (count * scale).max(2.0 * MIN_SAMPLES).floor());
        let even = |i: usize, count: f64| i as f64 / (count - 1.0);
        Self::of(
            [Density(vec![LEAST_RADIAL, 1.0]), along],
            side as usize,
            grazing(theta as usize, GRAZING[1]),
            (0..phi as usize).map(|i| TAU * even(i, phi) - PI).collect(),
        )
    }

    fn of(density: [Density; 2], side: usize, theta: Vec<f64>, phi: Vec<f64>) -> Self {
        let [across, along] = density.map(|density| Axis::new(density, side));
        Self { theta, along: vec![along; phi.len()], phi, across }
    }

    /// Whether the BRDF is isotropic, so that φ_m counts from φ_i.
    #[must_use]
    pub fn isotropic(&self) -> bool {
        self.phi.len() == 1
    }

    /// Number of samples along each side of the square.
    #[must_use]
    pub fn side(&self) -> usize {
        self.across.nodes.len()
    }

    /// Number of incident directions.
    #[must_use]
    pub fn slices(&self) -> usize {
        self.theta.len() * self.phi.len()
    }
}

/// Angles θ_i in radians that lie closer towards the horizon, by (1 + density)/density there.
fn grazing(count: usize, density: f64) -> Vec<f64> {
    let at = |i: usize| {
        let rest = 1.0 - i as f64 / (count - 1) as f64;
        (FRAC_PI_2 * (1.0 - density * (rest * (1.0 / density).ln_1p()).exp_m1())).clamp(0.0, MAX_THETA)
    };
    (0..count).map(at).collect()
}

/// The density over u of a lobe's half vectors, where dθ_m = π u du; a part of them is logarithmic.
fn radial(alpha: f64, logarithmic: f64, columns: usize) -> Density {
    let core = 0.5 * alpha;
    // The integral over u becomes 1.
    let scale = 2.0 * FRAC_PI_2 / ((FRAC_PI_2 + core) / core).ln();
    let at = |i: usize| {
        let u = i as f64 / (columns - 1) as f64;
        logarithmic * scale * u / (FRAC_PI_2 * u * u + core) + 1.0 - logarithmic
    };
    Density((0..columns).map(at).collect())
}

/// The density over v of half vectors that turn with the light by a number of steps.
///
/// Beside the horizon f changes with the azimuth of m from the plane of incidence, and the format interpolates over φ_i
/// at a fixed place of the warped square. That place therefore has m turn as φ_i does: nodes are even over a turn and a
/// quarter. Those that have not yet come to v = 0, or that have passed v = 1, share the cell there.
fn turned(turn: usize) -> Density {
    let quarter = KNOTS * TURNS;
    let passed = KNOTS * turn;
    let mut density = vec![1.0; 4 * quarter + 1];
    // The mean density of a cell is 1 and that of the nodes that share it; its other end has 1.
    density[0] += 2.0 * (quarter - passed) as f64;
    density[4 * quarter] += 2.0 * passed as f64;
    Density(density)
}

/// The density over v of half vectors beside two opposite azimuths, the first of them at `v` below 1/2: 1/(distance +
/// width), a fixed number for each factor of the distance beyond the width.
fn beside(v: f64, width: f64) -> Density {
    let at = |i: usize| {
        let turn = 2.0 * (i as f64 / SPOKES as f64 - v);
        let distance = 0.5 * (turn - turn.round()).abs();
        1.0 / (distance + width)
    };
    Density((0..=SPOKES).map(at).collect())
}

/// The density over v of a lobe's half vectors, highest at ±90° from the plane of incidence, where φ_m = 2πv − π.
fn across() -> Density {
    Density([0.0, ACROSS, 0.0, ACROSS, 0.0].map(|more| 1.0 + more).to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_of_facets_of_two_roughnesses_turn_with_the_light() {
        let grid = BsdfGrid::of_lobe([0.1, 0.4], 3);
        assert!((grid.phi[0] + PI).abs() < 1e-12 && (grid.phi[TURNS] + FRAC_PI_2).abs() < 1e-12);
        assert!(grid.slices() * grid.side().pow(2) * 4 <= MAX_VALUES);
        for turn in 0..TURNS {
            let [here, next] = [turn, turn + 1].map(|turn| &grid.along[turn].nodes);
            let mut turned = 0;
            for (a, b) in here.iter().zip(next) {
                // Beyond the cells at both ends.
                let cell = 1.0 / (4 * KNOTS * TURNS) as f64;
                if a.0 > cell && b.0 < 1.0 - cell {
                    assert!((b.0 - a.0 - 0.25 / TURNS as f64).abs() < 1e-9, "{a:?} {b:?}");
                    turned += 1;
                }
            }
            // Of a turn and a quarter, all but a quarter, a step and two cells.
            assert!(f64::from(turned) > 0.74 * grid.side() as f64, "{turned}");
        }
    }
}
