//! Materials of glTF 2.0: single films as `KHR_materials_iridescence`.
//!
//! The extension describes one clear film in air on a dielectric or a metal, with Schlick's Fresnel terms, phases of 0
//! or π and Gaussian fits of the observer; [`iridescence`] is its formula. No parameters reproduce exact physics. The
//! file therefore holds those whose colours come nearest, and states in the material's `extras` how near they come.
//!
//! Light that a clear film on a clear substrate transmits is written too ([`transmission`]), and a finish as the
//! material's roughness ([`roughness`]). The file is complete: a sphere wears the material ([`body`]).
//!
//! Colours are compared as ΔE2000 at 0, 1, … 85° in D65, where a perfect mirror is L* = 100: see
//! `crate::colour::difference`. Exact colours may leave the gamut of sRGB and are not clipped.

pub mod film;
pub mod iridescence;
mod simplex;
pub mod fit;
pub mod body;
pub mod transmission;
pub mod roughness;

use goniochrome::colour::VISIBLE_NM;
use goniochrome::microfacet::Finish;
use serde_json::{Value, json};

use self::film::{Base, Behind, SingleFilm};
use self::fit::{MAX_DEG, Parameters, angles, fit, round};
use self::transmission::transmitted;
use super::lut::exact_rgb;
use crate::colour::difference::{Lab, Summary, delta_e, lab};
use crate::scene::{OwnedFinish, Scene};
use crate::solve::planar_scene::PlanarScene;
use crate::support::error::{Error, Result};
use crate::support::text;

/// Angles in degrees at which `extras` and the terminal show both colours.
const SHOWN_DEG: [u16; 7] = [0, 15, 30, 45, 60, 75, 85];

/// Largest optical path. Longer ones have a thousand fringes and more in the visible range, which no eye and no formula
/// of three Gaussians tells from their mean.
const MAX_PATH_NM: f64 = 4e5;

/// A fitted material, and its difference from exact colours.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The scene's name.
    pub name: String,
    /// The film of the scene.
    pub film: SingleFilm,
    /// The finish of the material.
    pub finish: Option<Finish<'static>>,
    /// Whether it stands for tabulated facets.
    pub tabulated: bool,
    /// Whether the finish has energy compensation, which materials have not.
    pub compensated: bool,
    /// The fitted parameters.
    pub parameters: Parameters,
    /// ΔE2000 of the fitted parameters.
    pub residual: Summary,
    /// ΔE2000 of the film's own values in the extension's formula.
    pub unfitted: Summary,
    /// Exact linear sRGB at each angle of [`angles`].
    pub exact: Vec<[f64; 3]>,
}

impl Fitted {
    /// Fits the material to a scene.
    ///
    /// # Errors
    /// A scene that the extension cannot describe, with the reason.
    pub fn new(scene: &Scene) -> Result<Self> {
        let planar = PlanarScene::new(scene)
            .map_err(|error| Error::failed(format_args!("glTF's iridescence is a plane film: {error}")))?;
        let film = SingleFilm::of(&planar)?;
        if planar.longest_optical_path_nm(VISIBLE_NM.map(f64::from))? > MAX_PATH_NM {
            let name = &scene.name;
            return Err(Error::failed(format_args!(
                "{name}: the film is too thick to interfere; leave iridescence out"
            )));
        }
        let finish = scene.finish.as_ref().map(roughness::equivalent);
        let tabulated = scene.finish.as_ref().is_some_and(|finish| finish.tabulated().is_some());
        let exact = exact_rgb(&planar, &angles())?;
        let colours: Vec<Lab> = exact.iter().map(|rgb| lab(*rgb)).collect();
        let (parameters, residual) = fit(&film, &colours);
        let unfitted = Summary::of(&Parameters::of(&film).differences(&colours));
        let compensated = scene.finish.as_ref().is_some_and(OwnedFinish::is_compensated);
        let name = scene.name.clone();
        Ok(Self { name, film, finish, tabulated, compensated, parameters, residual, unfitted, exact })
    }

    /// The text of a glTF 2.0 file: a sphere that wears the material.
    #[must_use]
    pub fn json(&self) -> String {
        let Parameters { factor, ior, thickness_nm, base } = self.parameters;
        let (metallic, colour) = match base {
            // White: light that is not reflected is transmitted unchanged.
            Base::Dielectric { .. } => (0, [1.0; 3]),
            Base::Metal { f0 } => (1, f0),
        };
        let mut extensions = json!({
            "KHR_materials_iridescence": {
                "iridescenceFactor": factor,
                "iridescenceIor": ior,
                "iridescenceThicknessMaximum": thickness_nm,
            },
        });
        if let Base::Dielectric { ior } = base {
            extensions["KHR_materials_ior"] = json!({ "ior": ior });
        }
        let mut material = json!({
            "name": self.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [colour[0], colour[1], colour[2], 1.0],
                "metallicFactor": metallic,
                "roughnessFactor": 0,
            },
            "extensions": extensions,
            "extras": { "goniochrome": self.extras() },
        });
        transmission::add(&mut material, self.film.behind);
        roughness::add(&mut material, self.finish);
        let used: Vec<&String> =
            material["extensions"].as_object().into_iter().flat_map(|object| object.keys()).collect();
        let mut file = json!({
            "asset": { "version": "2.0", "generator": concat!("goniochrome ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": used,
            "materials": [material],
        });
        body::add(&mut file, self.finish.is_some_and(|finish| !finish.is_isotropic()));
        text::json(&format!("{file:#}\n"))
    }

    fn extras(&self) -> Value {
        let summary = |of: Summary| json!({ "mean": round(of.mean), "p95": round(of.p95), "max": round(of.largest) });
        let colours: Vec<Value> = self
            .shown()
            .map(|(theta, exact, gltf, delta)| {
                let [exact_rgb, gltf_rgb] = [exact, gltf].map(|rgb| rgb.map(round));
                let mut colours = json!({
                    "theta_deg": theta, "exact_rgb": exact_rgb, "gltf_rgb": gltf_rgb, "delta_e_2000": round(delta),
                });
                if self.film.behind != Behind::Opaque {
                    colours["exact_transmitted_rgb"] = json!(exact.map(|r| round(1.0 - r)));
                    colours["gltf_transmitted_grey"] = json!(round(transmitted(&self.parameters, theta.into())));
                }
                colours
            })
            .collect();
        json!({
            "film": { "ior_550nm": self.film.ior, "thickness_nm": self.film.thickness_nm },
            "transmission": transmission::words(self.film.behind, self.parameters.base),
            "finish": self.finish_words(),
            "compared": format!("0 to {MAX_DEG} degrees by 1, linear sRGB, D65; L* = 100 is a perfect mirror"),
            "delta_e_2000": summary(self.residual),
            "delta_e_2000_of_the_films_own_values": summary(self.unfitted),
            "colours": colours,
        })
    }

    fn finish_words(&self) -> Option<String> {
        let words = roughness::words(self.finish?, self.tabulated);
        let lost = if self.compensated { "; glTF has no energy compensation, which is left out" } else { "" };
        Some(format!("{words}{lost}"))
    }

    /// The rows of both reports: θ in degrees, exact linear sRGB, that of glTF, and ΔE2000.
    fn shown(&self) -> impl Iterator<Item = (u16, [f64; 3], [f64; 3], f64)> {
        SHOWN_DEG.into_iter().map(|theta| {
            let exact = self.exact[usize::from(theta)];
            let gltf = self.parameters.rgb(theta.into()).map(f64::from);
            (theta, exact, gltf, delta_e(lab(exact), lab(gltf)))
        })
    }

    /// The report for the terminal: the parameters, the residual, and both colours at some angles.
    #[must_use]
    pub fn report(&self) -> Vec<String> {
        let Parameters { factor, ior, thickness_nm, base } = self.parameters;
        let on = match base {
            Base::Dielectric { ior } => format!("on ior {ior:.3}"),
            Base::Metal { f0: [r, g, b] } => format!("on a metal of {r:.3}, {g:.3}, {b:.3}"),
        };
        let Summary { mean, p95, largest } = self.residual;
        let own = self.unfitted.p95;
        let mut lines = vec![
            format!("{thickness_nm:.1} nm of ior {ior:.3} {on}, factor {factor:.3}"),
            transmission::words(self.film.behind, base),
            format!(
                "from the exact colour at 0 to {MAX_DEG}°: mean ΔE2000 {mean:.2}, p95 {p95:.2}, largest {largest:.2} \
                 (p95 {own:.2} with the film's own values)"
            ),
        ];
        lines.extend(self.finish_words());
        let rgb = |[r, g, b]: [f64; 3]| format!("{r:7.4} {g:7.4} {b:7.4}");
        lines.extend(self.shown().map(|(theta, exact, gltf, delta)| {
            format!("{theta:3}°  exact {}  glTF {}  ΔE2000 {delta:5.2}", rgb(exact), rgb(gltf))
        }));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;

    fn fitted(thickness_nm: f64, base: &str) -> Fitted {
        let toml = format!(
            "[stack]\nambient = 1.0\nlayers = [{{ material = 1.33, thickness_nm = {thickness_nm:?} }}]\nsubstrate = {base}\n"
        );
        Fitted::new(&parse("film", &toml).unwrap()).unwrap()
    }

    #[test]
    fn a_film_on_glass_is_fitted_better_than_by_its_own_values() {
        let (mut fits, mut own) = (Vec::new(), Vec::new());
        for nm in (100..=800).step_by(25) {
            let film = fitted(f64::from(nm), "1.5");
            let exact: Vec<Lab> = film.exact.iter().map(|rgb| lab(*rgb)).collect();
            fits.extend(film.parameters.differences(&exact));
            own.extend(Parameters::of(&film.film).differences(&exact));
        }
        let (fits, own) = (Summary::of(&fits), Summary::of(&own));
        println!("n = 1.33 on 1.5, 100 to 800 nm by 25, 0 to {MAX_DEG}°: fitted {fits:?}, with its own values {own:?}");
        /// The 95th percentile of ΔE2000 that the book states.
        const STATED: f64 = 3.67;
        assert!(fits.p95 < own.p95 && fits.p95 <= STATED);
    }

    #[test]
    fn a_millimetre_is_no_thin_film() {
        let toml = "[stack]\nambient = 1\nlayers = [{ material = 1.33, thickness_nm = 1e6 }]\nsubstrate = 1.5\n";
        let error = Fitted::new(&parse("film", toml).unwrap()).unwrap_err().to_string();
        assert_eq!(error, "film: the film is too thick to interfere; leave iridescence out");
    }

    #[test]
    fn a_mirror_stays_white() {
        let film = fitted(300.0, "\"mirror\"");
        assert!(film.residual.largest < 0.1, "{:?}", film.residual);
        assert_eq!(film.parameters, Parameters::of(&film.film));
    }

    #[test]
    fn the_file_says_what_was_fitted() {
        let film = fitted(300.0, "1.5");
        let file: Value = serde_json::from_str(&film.json()).unwrap();
        let material = &file["materials"][0];
        let used = ["ior", "iridescence", "transmission", "volume"].map(|name| format!("KHR_materials_{name}"));
        assert_eq!(file["extensionsUsed"], json!(used));
        let film_of = &material["extensions"]["KHR_materials_iridescence"];
        assert_eq!(film_of["iridescenceThicknessMaximum"], json!(film.parameters.thickness_nm));
        assert_eq!(material["pbrMetallicRoughness"]["metallicFactor"], json!(0));
        assert_eq!(material["extras"]["goniochrome"]["delta_e_2000"]["p95"], json!(round(film.residual.p95)));
        assert!(film.report()[1].contains("solid body") && film.report()[1].contains("1.500"), "{:?}", film.report());
        let metal: Value = serde_json::from_str(&fitted(300.0, "\"Au\"").json()).unwrap();
        assert_eq!(metal["extensionsUsed"], json!(["KHR_materials_iridescence"]));
        assert_eq!(metal["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], json!(1));
        assert!(metal["materials"][0]["extras"]["goniochrome"]["colours"][0]["exact_transmitted_rgb"].is_null());
    }

    #[test]
    fn a_bubble_lets_light_through_and_has_a_body() {
        let bubble = fitted(300.0, "1.0");
        let file: Value = serde_json::from_str(&bubble.json()).unwrap();
        let material = &file["materials"][0];
        assert_eq!(material["extensions"]["KHR_materials_transmission"]["transmissionFactor"], json!(1));
        assert_eq!(material["pbrMetallicRoughness"]["baseColorFactor"], json!([1.0, 1.0, 1.0, 1.0]));
        assert!(material["extensions"]["KHR_materials_volume"].is_null() && material["doubleSided"] == json!(true));
        let facing = &material["extras"]["goniochrome"]["colours"][0];
        let (grey, exact) = (facing["gltf_transmitted_grey"].as_f64().unwrap(), &facing["exact_transmitted_rgb"]);
        assert!(grey > 0.85 && (0..3).all(|c| (exact[c].as_f64().unwrap() - grey).abs() < 0.1), "{grey} {exact}");
        let place = |list: &str, at: usize| file[list][at].clone();
        let mesh = &place("nodes", file["scenes"][0]["nodes"][0].as_u64().unwrap() as usize)["mesh"];
        assert_eq!(place("meshes", mesh.as_u64().unwrap() as usize)["primitives"][0]["material"], json!(0));
    }
}
