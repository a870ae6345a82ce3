//! A finish in a material: `roughnessFactor`, and `KHR_materials_anisotropy` for two roughnesses.
//!
//! glTF's facets are GGX, with correlated masking. Its roughness is the square root of our α. For two, the extension
//! has α_b = roughness² along one axis and α_t = α_b + (1 − α_b) strength² along the other, which the rotation turns
//! from the tangent.

use std::f64::consts::FRAC_PI_2;

use goniochrome::microfacet::{Distribution, Finish, Masking};
use serde_json::{Value, json};

use super::fit::round;

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
pub fn words(finish: Finish<'_>) -> String {
    let [x, y] = finish.alpha().unwrap_or_default();
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
    use super::*;

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
                assert_eq!(words(finish).contains("Beckmann"), distribution == Distribution::Beckmann);
            }
        }
        let mut smooth = json!({ "pbrMetallicRoughness": { "roughnessFactor": 0 } });
        add(&mut smooth, None);
        assert_eq!(smooth["pbrMetallicRoughness"]["roughnessFactor"], json!(0));
    }
}
