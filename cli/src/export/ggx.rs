//! The GGX lobe (Trowbridge-Reitz facets) that replaces the delta of a mirror-like surface, with Smith's masking and
//! shadowing, height correlated (Heitz, JCGT 2014).
//!
//! f = D(θ_m) G₂ ρ(θ_d) / (4 cos θ_i cos θ_o), with ρ at the angle θ_d between either direction and the half vector m.

use std::f64::consts::PI;

/// A GGX lobe of facets of roughness α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// Roughness α in (0, 1].
    pub alpha: f64,
}

impl Ggx {
    /// The density D of facet normals: ∫ D cos θ_m dω_m = 1.
    #[must_use]
    pub fn density(self, cos_m: f64) -> f64 {
        let square = self.alpha * self.alpha;
        let base = cos_m * cos_m * (square - 1.0) + 1.0;
        square / (PI * base * base)
    }

    /// The root sqrt(α² + (1 − α²) cos²θ) = cos θ (1 + 2Λ) in Smith's Λ.
    fn root(self, cos: f64) -> f64 {
        let square = self.alpha * self.alpha;
        (square + (1.0 - square) * cos * cos).sqrt()
    }

    /// The projected area of the visible facets per area of the macroscopic surface: cos θ / G₁.
    #[must_use]
    pub fn visible_area(self, cos: f64) -> f64 {
        0.5 * (cos + self.root(cos))
    }

    /// The factor G₂ / (4 cos θ_i cos θ_o), which is finite where only one of the cosines is 0.
    #[must_use]
    pub fn masking(self, cos_i: f64, cos_o: f64) -> f64 {
        0.5 / (cos_o * self.root(cos_i) + cos_i * self.root(cos_o))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_is_normalised_and_the_visible_area_is_that_of_its_facets() {
        for alpha in [0.1, 0.5, 1.0] {
            let ggx = Ggx { alpha };
            let (mut facing, mut visible) = (0.0, 0.0);
            let incidence = 1.1_f64;
            let (steps, around) = (4000, 256);
            for i in 0..steps {
                let theta = (f64::from(i) + 0.5) / f64::from(steps) * PI / 2.0;
                let ring = ggx.density(theta.cos()) * theta.sin() * PI / 2.0 / f64::from(steps) * 2.0 * PI;
                facing += ring * theta.cos();
                for k in 0..around {
                    let phi = f64::from(k) * 2.0 * PI / f64::from(around);
                    let cos = incidence.sin() * theta.sin() * phi.cos() + incidence.cos() * theta.cos();
                    visible += ring / f64::from(around) * cos.max(0.0);
                }
            }
            assert!((facing - 1.0).abs() < 1e-4, "{alpha}: {facing}");
            assert!((visible - ggx.visible_area(incidence.cos())).abs() < 1e-3, "{alpha}: {visible}");
        }
    }
}
