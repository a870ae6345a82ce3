//! What several bounces among facets return.
//!
//! Facets of reflectance 1 reflect E(cos θ) of the light of a direction, and lose the rest to other facets. Kulla &
//! Conty ("Revisiting physically based shading at Imageworks", 2017) return it in proportion to what both directions
//! lose:
//!
//! f_ms(wi, wo) = F_ms (1 − E(cos θ_i)) (1 − E(cos θ_o))/(π (1 − E_avg))
//!
//! with E_avg = 2 ∫ E μ dμ. Each bounce reflects F_avg = 2 ∫ ρ(μ) μ dμ, and E_avg of it leaves. The first bounce is in
//! E already, so that F_ms = F_avg² E_avg/(1 − F_avg (1 − E_avg)) (Hill, "A multi-faceted exploration", 2018).

use super::error::FinishError;
use super::limits::LOSSES;
use crate::simd::lanes::sqrtf;
use crate::values::Values;
use core::f64::consts::PI;
use libm::{cos, sin};

/// Largest number that [`Compensation::returned`] gives; facets that lose nothing would need an infinite one.
const MAX_RETURNED: f64 = 1e30;

/// Energy compensation of a finish: what its facets lose to other facets, 1 − E, over cos θ.
///
/// The losses are linear between nodes at cos θ = (i/128)². Where facets differ along x and y, they are means over the
/// azimuth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensation<'a> {
    losses: Values<'a>,
}

impl<'a> Compensation<'a> {
    /// Number of losses.
    pub const LEN: usize = LOSSES;

    /// Compensation of losses that [`Finish::compensated`](super::Finish::compensated) has computed.
    ///
    /// # Errors
    /// [`FinishError::Losses`] unless there are [`Compensation::LEN`] numbers from 0 to 1.
    pub fn of(losses: &'a [f32]) -> Result<Self, FinishError> {
        Self::of_values(Values::Numbers(losses))
    }

    pub(crate) fn of_values(losses: Values<'a>) -> Result<Self, FinishError> {
        let fits = losses.len() == LOSSES && losses.iter().all(|loss| (0.0..=1.0).contains(&loss));
        fits.then_some(Self { losses }).ok_or(FinishError::Losses)
    }

    /// cos θ of a node.
    #[must_use]
    pub fn cosine(node: usize) -> f64 {
        let part = node as f64 / (LOSSES - 1) as f64;
        part * part
    }

    /// All losses.
    pub(crate) fn values(&self) -> Values<'a> {
        self.losses
    }

    /// Looks up the loss 1 − E of a direction by its cosine, which is clamped to [0, 1]; NaN counts as 0.
    #[must_use]
    #[inline]
    pub fn loss(&self, cos_theta: f32) -> f32 {
        const STEPS: usize = LOSSES - 1;
        let positive = cos_theta.max(0.0);
        let at = sqrtf(positive.min(1.0)) * STEPS as f32;
        let before = (at as u32 as usize).min(STEPS - 1);
        let [[low, high]] = self.losses.arrays([before]);
        low + (at - before as u32 as f32) * (high - low)
    }

    /// Mean loss 1 − E_avg = 2 ∫ (1 − E) μ dμ, the integral of what [`Compensation::loss`] interpolates.
    #[must_use]
    pub fn mean_loss(&self) -> f64 {
        let step = 1.0 / (LOSSES - 1) as f64;
        // Over x = √μ, 2 μ dμ = 4 x³ dx.
        (1..LOSSES)
            .map(|node| {
                let [a, b] = [node - 1, node].map(|node| step * node as f64);
                let [low, high] = [node - 1, node].map(|node| f64::from(self.losses.at(node)));
                let slope = (high - low) / step;
                let (a4, b4) = (a * a * a * a, b * b * b * b);
                (low - slope * a) * (b4 - a4) + 0.8 * slope * (b4 * b - a4 * a)
            })
            .sum()
    }

    /// F_ms/(π (1 − E_avg)) in 1/sr, by which [`Lobe::multiple`](super::Lobe::multiple) is multiplied, for the mean
    /// reflectance F_avg of the smooth surface ([`mean_reflectance`]) in a channel. F_avg is clamped to [0, 1];
    /// channels of colours may be beyond.
    #[must_use]
    pub fn returned(&self, mean_reflectance: f64) -> f32 {
        let loss = self.mean_loss();
        let reflected = mean_reflectance.clamp(0.0, 1.0);
        let (all, lost) = (reflected * reflected * (1.0 - loss), PI * loss * (1.0 - reflected * loss));
        if all > 0.0 && lost > 0.0 { (all / lost).min(MAX_RETURNED) as f32 } else { 0.0 }
    }
}

/// Mean reflectance F_avg = 2 ∫ ρ cos θ sin θ dθ of pairs of θ in radians, increasing, and ρ: linear between them and
/// constant beyond, as in tables of mirror-like surfaces. 0 without a pair.
#[must_use]
pub fn mean_reflectance(pairs: impl IntoIterator<Item = [f64; 2]>) -> f64 {
    let (mut sum, mut before) = (0.0, [0.0; 2]);
    for (place, [theta, rho]) in pairs.into_iter().enumerate() {
        let [from, low] = if place == 0 { [0.0, rho] } else { before };
        if theta > from {
            // ∫ (a + b θ) sin 2θ dθ by parts.
            let slope = (rho - low) / (theta - from);
            let cosines = low * cos(2.0 * from) - rho * cos(2.0 * theta);
            sum += 0.5 * cosines + 0.25 * slope * (sin(2.0 * theta) - sin(2.0 * from));
        }
        before = [theta, rho];
    }
    let [last, rho] = before;
    sum + rho * cos(last) * cos(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_those_of_the_interpolation() {
        let losses: [f32; LOSSES] = core::array::from_fn(|node| 0.5 - 0.25 * (node as f32 / 128.0));
        let compensation = Compensation::of(&losses).unwrap();
        // 4 ∫ (1/2 − x/4) x³ dx = 1/2 − 1/5. Each loss rounds by 2⁻²⁵.
        assert!((compensation.mean_loss() - 0.3).abs() < 1e-7, "{}", compensation.mean_loss());
        assert!((compensation.loss(0.25) - 0.375).abs() < 1e-6);
        for (cos, node) in [(-1.0, 0), (0.0, 0), (f32::NAN, 0), (1.0, 128), (7.0, 128)] {
            assert_eq!(compensation.loss(cos), losses[node], "{cos}");
        }
        // ρ = θ: ∫ θ sin 2θ dθ up to 1, then 1 beyond. 2 ∫ μ dμ = 1 for a constant.
        let wanted = 0.25 * sin(2.0) - 0.5 * cos(2.0) + cos(1.0) * cos(1.0);
        assert!((mean_reflectance([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]) - wanted).abs() < 1e-14);
        for theta in [0.0, 0.4, 1.5] {
            assert!((mean_reflectance([[theta, 0.3]]) - 0.3).abs() < 1e-14);
        }
        assert_eq!(mean_reflectance([]), 0.0);
    }

    #[test]
    fn several_bounces_return_the_sum_of_their_series() {
        let losses = [0.25; LOSSES];
        let compensation = Compensation::of(&losses).unwrap();
        for reflected in [0.0f64, 0.3, 0.9, 1.0] {
            // Bounce after bounce, from the second on.
            let series: f64 = (1..400).map(|n| 0.75 * reflected * (0.25 * reflected).powi(n)).sum();
            // What leaves the facets, of light that all directions lose: a quarter of the loss.
            let returned = f64::from(compensation.returned(reflected)) * PI * 0.25 * 0.25;
            // Rounding to single precision.
            assert!((returned - series).abs() < 1e-7, "{reflected}: {returned} for {series}");
        }
        assert_eq!(compensation.returned(-0.2), 0.0);
        assert_eq!(compensation.returned(1.3), compensation.returned(1.0));
        assert_eq!(Compensation::of(&[0.0; LOSSES]).unwrap().returned(1.0), 0.0);
        assert_eq!(Compensation::of(&[1.0; LOSSES]).unwrap().returned(1.0), 0.0);
        for bad in [&[0.5; LOSSES - 1][..], &[1.1; LOSSES], &[-0.1; LOSSES], &[f32::NAN; LOSSES]] {
            assert_eq!(Compensation::of(bad), Err(FinishError::Losses));
        }
    }
}
