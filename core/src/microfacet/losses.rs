//! What facets of a finish lose, computed when a compensation is made.
//!
//! E(wi) = ∫ D G₂/(cos θ_i cos θ_o) cos θ_o (wi·m) dω_m over the normals m that reflect above the horizon. For slopes
//! p of m, that is where wi.z + 2 wi·p − wi.z p² > 0: at each azimuth, a range of radii from 0 on.

use super::compensation::Compensation;
use super::error::FinishError;
use super::finish::Finish;
use super::visible::GAUSS;
use crate::simd::lanes::sqrt;
use core::f64::consts::{PI, TAU};
use glam::{DVec3, Vec3};
use libm::{asinh, atan2, cos, cosh, sin, sinh};

/// Parts of the range of radii and of half a turn, each with four Gauss nodes.
const RADII: u16 = 16;
const HALF_TURN: u16 = 8;
/// Azimuths of directions, over a quarter of a turn for roughnesses along x and y, over a turn for tabulated facets.
const AZIMUTHS: u16 = 8;
const AZIMUTHS_OF_TABLE: u16 = 24;
/// Smallest cosine of a direction, which stands for the horizon.
const GRAZING: f64 = 1e-5;
/// Largest slope over the roughness; GGX facets beyond have 1e-5 of what grazing directions see.
const STEEPEST: f64 = 1e5;
/// Slope over the roughness up to which nodes are evenly spaced; beyond, their distance grows with the slope.
const EVEN: f64 = 0.5;

impl<'a> Finish<'a> {
    /// The finish with energy compensation: light that meets further facets is returned, in proportion to what the
    /// facets lose. Computes the losses in `memory`, of [`Compensation::LEN`] elements, within a second.
    ///
    /// # Errors
    /// [`FinishError::Losses`] if the memory has another length.
    pub fn compensated(self, memory: &'a mut [f32]) -> Result<Self, FinishError> {
        if memory.len() != Compensation::LEN {
            return Err(FinishError::Losses);
        }
        for (node, loss) in memory.iter_mut().enumerate() {
            *loss = self.loss(Compensation::cosine(node).max(GRAZING));
        }
        Ok(self.with_compensation(Compensation::of(memory)?))
    }

    /// 1 − E of directions of one cosine, in [0, 1].
    fn loss(&self, cosine: f64) -> f32 {
        let (azimuths, turn) = match (self.is_isotropic(), self.facets()) {
            (true, _) => (1, 0.0),
            (false, None) => (AZIMUTHS, 0.25 * TAU),
            (false, Some(_)) => (AZIMUTHS_OF_TABLE, TAU),
        };
        let sine = sqrt(1.0 - cosine * cosine);
        let mut kept = 0.0;
        for azimuth in 0..azimuths {
            let phi = turn * (f64::from(azimuth) + 0.5) / f64::from(azimuths);
            kept += self.reflected(DVec3::new(sine * cos(phi), sine * sin(phi), cosine));
        }
        (1.0 - kept / f64::from(azimuths)).clamp(0.0, 1.0) as f32
    }

    /// E of a direction.
    fn reflected(&self, wi: DVec3) -> f64 {
        // Tabulated facets are as rough as GGX facets of which a grazing direction sees as much.
        let roughness = self.alpha().unwrap_or([2.0 * self.visible_area(Vec3::X); 2]);
        let [x, y] = roughness.map(|alpha| f64::from(alpha.max(f32::MIN_POSITIVE)));
        let from = atan2(y * wi.y, x * wi.x);
        // Equally rough facets are the same on both sides of the light.
        let (start, parts, scale) = if self.is_isotropic() { (0.0, HALF_TURN, 2.0) } else { (-PI, 2 * HALF_TURN, 1.0) };
        let single = wi.as_vec3();
        let mut sum = 0.0;
        nodes([start, PI], parts, |psi, of_azimuth| {
            let [x, y] = [x * cos(from + psi), y * sin(from + psi)];
            let (along, square) = (x * wi.x + y * wi.y, x * x + y * y);
            let root = sqrt(along * along + wi.z * wi.z * square);
            let end = if along < 0.0 { wi.z / (root - along) } else { (along + root) / (wi.z * square) };
            nodes([0.0, asinh(end.min(STEEPEST) / EVEN)], RADII, |t, of_radius| {
                let radius = EVEN * sinh(t);
                let normal = DVec3::new(radius * x, radius * y, 1.0);
                let over = 1.0 / sqrt(normal.length_squared());
                let m = normal * over;
                let cosine = wi.dot(m);
                let wo = (2.0 * cosine * m - wi).as_vec3();
                if wo.z > 0.0 {
                    let value = f64::from(self.density(m.as_vec3()) * self.shadowing(single, wo) * wo.z);
                    let slopes = radius * EVEN * cosh(t) * over * over * over;
                    sum += of_azimuth * of_radius * slopes * 4.0 * cosine * value;
                }
            });
        });
        scale * x * y * sum
    }
}

/// Calls `of` with each node and its weight of a quadrature in equal parts of a range.
fn nodes([from, to]: [f64; 2], parts: u16, mut of: impl FnMut(f64, f64)) {
    let half = 0.5 * (to - from) / f64::from(parts);
    for part in 0..parts {
        let middle = from + half * f64::from(2 * part + 1);
        for [x, weight] in GAUSS {
            of(middle + half * x, half * weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::{Distribution, Masking};

    #[test]
    fn losses_between_nodes_are_nearly_those_of_the_facets() {
        /// Bound of the error of linear interpolation that the number of nodes was chosen for.
        const ERROR: f32 = 2e-4;
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            for masking in [Masking::Correlated, Masking::Separable] {
                for alpha in [0.05, 0.1, 0.3, 1.0] {
                    let finish = Finish::new(distribution, masking, [alpha; 2]).unwrap();
                    let mut memory = [0.0; Compensation::LEN];
                    let losses = finish.compensated(&mut memory).unwrap().compensation().unwrap();
                    for node in 1..Compensation::LEN {
                        let cosine = 0.5 * (Compensation::cosine(node - 1) + Compensation::cosine(node));
                        let (found, wanted) = (losses.loss(cosine as f32), finish.loss(cosine));
                        assert!((found - wanted).abs() < ERROR, "{finish:?} {cosine}: {found} for {wanted}");
                    }
                }
            }
        }
        let finish = Finish::new(Distribution::Ggx, Masking::Correlated, [0.3; 2]).unwrap();
        assert_eq!(finish.compensated(&mut [0.0; 128]), Err(FinishError::Losses));
    }
}
