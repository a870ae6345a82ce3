//! The lobe that stands in for a delta in direction: a spherical Gaussian.
//!
//! It is that of von Mises and Fisher, κ/(2π(1 − exp(−2κ))) exp(κ(cos γ − 1)) at the angle γ from the exact direction,
//! with κ = 1/σ²: for small σ a Gaussian of standard deviation σ along each axis. It is divided by its share above the
//! horizon, so that f cos θ_o integrates to the power of the delta.

use std::f64::consts::TAU;

use glam::DVec3;

/// Angle in units of σ beyond which a lobe is left out: exp(−5²/2) is 4e-6 of its peak.
const REACH: f64 = 5.0;

/// A Gaussian lobe of a standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaussian {
    /// Standard deviation σ in radians.
    pub spread: f64,
}

impl Gaussian {
    /// Angle in radians beyond which the lobe is left out.
    #[must_use]
    pub fn reach(self) -> f64 {
        REACH * self.spread
    }

    /// f cos θ_o in the exact direction of a delta of power 1.
    #[must_use]
    pub fn peak(self, direction: DVec3) -> f64 {
        let kappa = self.spread.powi(-2);
        let above = below_normal(direction.z.asin() / self.spread);
        kappa / (TAU * -(-2.0 * kappa).exp_m1()) / above
    }

    /// The lobe at the cosine of an angle from its direction, over its peak.
    #[must_use]
    pub fn at(self, cos: f64) -> f64 {
        if cos > self.reach().min(TAU / 2.0).cos() { (self.spread.powi(-2) * (cos - 1.0)).exp() } else { 0.0 }
    }
}

/// The normal distribution's integral from −∞ to x ≥ 0, to 1.5e-4 (Bowling et al. 2009).
fn below_normal(x: f64) -> f64 {
    1.0 / (1.0 + (-x * (1.5976 + 0.07056 * x * x)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_a_lobe_above_the_horizon_follows_the_normal_distribution() {
        for (x, share) in [(0.0, 0.5), (0.5, 0.691_462), (1.0, 0.841_345), (2.0, 0.977_250), (3.0, 0.998_650)] {
            assert!((below_normal(x) - share).abs() < 1.5e-4, "{x}: {}", below_normal(x));
        }
    }
}
