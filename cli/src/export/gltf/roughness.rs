//! A finish in a material: `roughnessFactor`, and `KHR_materials_anisotropy` for two roughnesses.
//!
//! glTF's facets are GGX, with correlated masking. Its roughness is the square root of our α. For two, the extension
//! has α_b = roughness² along one axis and α_t = α_b + (1 − α_b) strength² along the other, which the rotation turns
//! from the tangent.
//!
//! Tabulated facets become GGX facets of the same median slope along each axis: half of GGX's normals have a slope
//! along an axis below α/√3. A mean square would not do, as that of GGX is infinite.

use std::f64::consts::{FRAC_PI_2, TAU};

use goniochrome::microfacet::{Distribution, FacetTable, Finish, MIN_ROUGHNESS, Masking};
use serde_json::{Value, json};

use super::fit::round;
use crate::scene::{FinishFacets, OwnedFinish};

/// The finish, or GGX facets in place of tabulated ones.
///
/// # Panics
/// Never: the roughness is within its range.
#[must_use]
pub fn equivalent(finish: &OwnedFinish) -> Finish<'static> {
    match finish.facets() {
        FinishFacets::Analytic(finish) => *finish,
        FinishFacets::Tabulated(facets, masking) => {
            let [x, y] = roughness(facets.table()).map(|alpha| (alpha as f32).clamp(MIN_ROUGHNESS, 1.0));
            let alpha = if facets.table().size()[1] == 1 { [x; 2] } else { [x, y] };
            Finish::new(Distribution::Ggx, *masking, alpha).expect("a roughness within its range")
        }
    }
}

/// √3 times the median slope of facets along x and y.
fn roughness(facets: FacetTable<'_>) -> [f64; 2] {
    /// Steps of sin²θ_m within a ring, and of the azimuth within a sector and within a turn at least.
    const STEPS: usize = 8;
    const TURN: usize = 128;
    let [rings, sectors] = facets.size();
    let nodes: Vec<f64> = facets.nodes().map(f64::from).collect();
    let around = TURN.div_ceil(sectors);
    // Slopes along both axes, and the part of the surface that has them: D over sin²θ_m and φ_m.
    let mut slopes = Vec::new();
    for (ring, step) in (0..rings * STEPS).map(|i| (i / STEPS, (i % STEPS) as f64 + 0.5)) {
        let [inner, outer] = [ring, ring + 1].map(|ring| FacetTable::sin_square(rings, ring));
        let out = step / STEPS as f64;
        let t = inner + out * (outer - inner);
        let tan = (t / (1.0 - t)).sqrt();
        for (sector, step) in (0..sectors * around).map(|i| (i / around, (i % around) as f64 + 0.5)) {
            let on = step / around as f64;
            let [[a, b], [c, d]] = [ring, ring + 1]
                .map(|ring| [sector, (sector + 1) % sectors].map(|sector| nodes[ring * sectors + sector]));
            let density = (1.0 - out) * (a + on * (b - a)) + out * (c + on * (d - c));
            let (sin, cos) = (TAU * (sector as f64 + on) / sectors as f64).sin_cos();
            slopes.push(([(tan * cos).abs(), (tan * sin).abs()], density * (outer - inner)));
        }
    }
    [0, 1].map(|axis| {
        slopes.sort_unstable_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
        let half = 0.5 * slopes.iter().map(|(_, part)| part).sum::<f64>();
        let mut sum = 0.0;
        let median = slopes.iter().find(|(_, part)| {
            sum += part;
            sum >= half
        });
        3f64.sqrt() * median.map_or(0.0, |(slope, _)| slope[axis])
    })
}

/// Adds a finish to a material.
pub fn add(material: &mut Value, finish: Option<Finish<'_>>) {
    let Some([x, y]) = finish.and_then(|finish| finish.alpha()) else { return };
    let [x, y] = [x, y].map(f64::from);
    let (least, most) = (x.min(y), x.max(y));
    material["pbrMetallicRoughness"]["roughnessFactor"] = json!(round(least.sqrt()));
    if least < most {
        material["extensions"]["KHR_materials_anisotropy"] = json!({
            "anisotropyStrength": round(((most - least) / (1.0 - least)).sqrt()),
            "anisotropyRotation": if x > y { 0.0 } else { round(FRAC_PI_2) },
        });
    }
}

/// A line of text on what becomes of a finish.
#[must_use]
pub fn words(finish: Finish<'_>, tabulated: bool) -> String {
    let [x, y] = finish.alpha().unwrap_or_default();
    if tabulated {
        let rough =
            if finish.is_isotropic() { format!("{x:.3}") } else { format!("{x:.3} along x and {y:.3} along y") };
        return format!(
            "a finish of tabulated facets, approximated by GGX facets of the same median slope: roughness {rough}, the \
             square of glTF's"
        );
    }
    let rough = if finish.is_isotropic() { format!("{x}") } else { format!("{x} along x and {y} along y") };
    let other = match (finish.distribution(), finish.masking()) {
        (Some(Distribution::Beckmann), _) => "; glTF's facets are GGX, with longer tails than Beckmann's",
        (_, Masking::Separable) => "; glTF's masking is correlated, brighter at grazing angles than separable masking",
        _ => "",
    };
    format!("a finish of roughness {rough}, the square of glTF's{other}")
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::OwnedFacets;

    /// α along x and y by the extension's formulas.
    fn alpha(material: &Value) -> [f64; 2] {
        let number = |value: &Value| value.as_f64();
        let along = number(&material["pbrMetallicRoughness"]["roughnessFactor"]).unwrap().powi(2);
        let extension = &material["extensions"]["KHR_materials_anisotropy"];
        let strength = number(&extension["anisotropyStrength"]).unwrap_or(0.0);
        let turned = number(&extension["anisotropyRotation"]).unwrap_or(0.0) > 1.0;
        let across = along + (1.0 - along) * strength * strength;
        if turned { [along, across] } else { [across, along] }
    }

    #[test]
    fn roughnesses_come_back_by_the_extensions_formulas() {
        /// Rounding of the roughness and of the strength to five digits, squared.
        const DIGITS: f64 = 2e-5;
        for wanted in [[0.3, 0.3], [0.1, 0.4], [0.4, 0.1], [1.0, 0.2], [0.001, 0.001], [1.0, 1.0]] {
            for distribution in [Distribution::Ggx, Distribution::Beckmann] {
                let finish = Finish::new(distribution, Masking::Correlated, wanted).unwrap();
                let mut material = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0 }, "extensions": {} });
                add(&mut material, Some(finish));
                for (found, wanted) in alpha(&material).into_iter().zip(wanted) {
                    assert!((found - f64::from(wanted)).abs() <= DIGITS, "{wanted}: {material}");
                }
                assert_eq!(words(finish, false).contains("Beckmann"), distribution == Distribution::Beckmann);
            }
        }
        let facets = |size: [usize; 2], alpha: [f32; 2]| {
            let ggx = Finish::new(Distribution::Ggx, Masking::Correlated, alpha).unwrap();
            let density: Vec<f32> = (0..(size[0] + 1) * size[1])
                .map(|node| {
                    let t = (FacetTable::sin_square(size[0], node / size[1]) as f32).min(0.999_999);
                    let (sin, cos) = (TAU as f32 * (node % size[1]) as f32 / size[1] as f32).sin_cos();
                    ggx.density(Vec3::new(t.sqrt() * cos, t.sqrt() * sin, (1.0 - t).sqrt()))
                })
                .collect();
            OwnedFinish::new(FinishFacets::Tabulated(OwnedFacets::new(size, &density).unwrap(), Masking::Separable))
        };
        for (size, alpha) in [([128, 1], [0.2; 2]), ([96, 72], [0.1, 0.4])] {
            /// Steps of the slopes and of the table, 1 % of each.
            const STEP: f32 = 0.02;
            let found = equivalent(&facets(size, alpha));
            for (found, wanted) in found.alpha().unwrap().into_iter().zip(alpha) {
                assert!((found / wanted - 1.0).abs() <= STEP, "{found} {wanted}");
            }
            assert_eq!(found.masking(), Masking::Separable);
            assert!(words(found, true).contains("approximated by GGX facets"));
        }
        let mut smooth = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0 } });
        add(&mut smooth, None);
        assert_eq!(smooth["pbrMetallicRoughness"]["roughnessFactor"], json!(0));
    }
}
