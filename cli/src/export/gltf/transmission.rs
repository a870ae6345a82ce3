//! Transmitted light in a material: `KHR_materials_transmission` and, for solid bodies, `KHR_materials_volume`.
//!
//! Both are approximate. glTF transmits the share 1 − max(R, G, B) of the light, equal in all channels, where R, G, B
//! are the reflectance; a clear film transmits 1 − R, 1 − G and 1 − B. A refracted ray follows the index of
//! `KHR_materials_ior`, which was fitted to reflected colours. Rasterisers do not trace rays into a body, but take its
//! thickness from the material.

use serde_json::{Value, json};

use super::body::MEAN_CHORD;
use super::film::{Base, Behind};
use super::fit::{Parameters, round};

/// Smallest share of light absorbed in the body that is written: below, attenuation distances would overflow.
const MIN_ABSORBED: f64 = 1e-6;

/// Adds the extensions for transmitted light to a material.
pub fn add(material: &mut Value, behind: Behind) {
    if behind == Behind::Opaque {
        return;
    }
    let extensions = &mut material["extensions"];
    extensions["KHR_materials_transmission"] = json!({ "transmissionFactor": 1 });
    match behind {
        Behind::Opaque => {}
        // The other wall of a bubble is seen from inside.
        Behind::Air => material["doubleSided"] = json!(true),
        Behind::Body { absorption_per_m, .. } => {
            let mut volume = json!({ "thicknessFactor": round(MEAN_CHORD) });
            let max = absorption_per_m.into_iter().fold(0.0, f64::max);
            if max * MEAN_CHORD > MIN_ABSORBED {
                volume["attenuationDistance"] = json!(1.0 / max);
                volume["attenuationColor"] = json!(absorption_per_m.map(|a| round((-a / max).exp())));
            }
            extensions["KHR_materials_volume"] = volume;
        }
    }
}

/// A line of text on how light is transmitted, and what is approximate in it.
#[must_use]
pub fn words(behind: Behind, base: Base) -> String {
    let grey = "transmitted light is grey, 1 less the largest of R, G, B, where a clear film lets 1 less each through";
    match (behind, base) {
        (Behind::Air, _) => format!("a thin wall of film with air on both sides, which does not refract; {grey}"),
        (Behind::Body { ior, .. }, Base::Dielectric { ior: fitted }) => format!(
            "a solid body, refracting by ior {fitted:.3}, which fits the reflected colours, where the substrate has {ior:.3}; {grey}"
        ),
        _ => "opaque: the substrate lets no light through".into(),
    }
}

/// The share of light that glTF transmits at an angle, equal in all channels; 0 for metals.
#[must_use]
pub fn transmitted(parameters: &Parameters, theta_deg: f64) -> f64 {
    let largest = |rgb: [f32; 3]| rgb.into_iter().fold(0.0, f32::max);
    if let Base::Metal { .. } = parameters.base {
        return 0.0;
    }
    let bare = largest(Parameters { factor: 0.0, ..*parameters }.rgb(theta_deg));
    let film = largest(Parameters { factor: 1.0, ..*parameters }.rgb(theta_deg));
    let reflected = f64::from(bare) + parameters.factor * f64::from(film - bare);
    (1.0 - reflected).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_swallows_light_by_the_law_of_its_medium() {
        let absorption_per_m = [2.0, 4.0, 1.0];
        let mut material = json!({ "extensions": {} });
        add(&mut material, Behind::Body { ior: 1.5, absorption_per_m });
        let volume = &material["extensions"]["KHR_materials_volume"];
        let distance = volume["attenuationDistance"].as_f64().unwrap();
        for (colour, absorption) in volume["attenuationColor"].as_array().unwrap().iter().zip(absorption_per_m) {
            // The extension: T(x) = c^(x/d).
            let over_a_metre = colour.as_f64().unwrap().powf(1.0 / distance);
            // Five digits of the colour, to the power 4.
            assert!((over_a_metre - (-absorption).exp()).abs() < 4.0 * 0.5e-5, "{over_a_metre}");
        }
    }

    #[test]
    fn a_medium_that_hardly_absorbs_is_clear() {
        for absorption in [0.0, 1e-320, 1e-8] {
            let mut material = json!({ "extensions": {} });
            add(&mut material, Behind::Body { ior: 1.5, absorption_per_m: [absorption; 3] });
            assert_eq!(material["extensions"]["KHR_materials_volume"], json!({ "thicknessFactor": 1.33333 }));
        }
    }

    #[test]
    fn only_bodies_have_a_volume_and_metals_transmit_nothing() {
        let keys = |behind| {
            let mut material = json!({ "extensions": {} });
            add(&mut material, behind);
            let extensions = material["extensions"].as_object().unwrap();
            (extensions.keys().cloned().collect::<Vec<_>>(), material["doubleSided"] == json!(true))
        };
        let [transmission, volume] = ["KHR_materials_transmission", "KHR_materials_volume"].map(str::to_owned);
        assert_eq!(keys(Behind::Opaque), (vec![], false));
        assert_eq!(keys(Behind::Air), (vec![transmission.clone()], true));
        let body = Behind::Body { ior: 1.5, absorption_per_m: [0.0; 3] };
        assert_eq!(keys(body), (vec![transmission, volume], false));
    }

    #[test]
    fn light_is_either_reflected_or_transmitted() {
        let base = Base::Dielectric { ior: 1.5 };
        let film = Parameters { factor: 1.0, ior: 1.33, thickness_nm: 300.0, base };
        for theta in [0.0, 45.0, 85.0] {
            let largest = film.rgb(theta).into_iter().fold(0.0, f32::max);
            assert!((transmitted(&film, theta) + f64::from(largest) - 1.0).abs() < 1e-6);
            assert_eq!(transmitted(&Parameters { base: Base::Metal { f0: [0.9; 3] }, ..film }, theta), 0.0);
        }
    }
}
