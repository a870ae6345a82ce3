//! The materials that come with the program: files of refractiveindex.info (CC0) and a few biological ones.

use goniochrome::medium::Extrapolate;

use super::source::Source;
use super::{NamedMedium, nk};
use crate::error::Result;

/// Name and data file.
const MATERIALS: &[(&str, &str)] = &[
    ("air", include_str!("../../data/materials/air-Ciddor.yml")),
    ("vacuum", include_str!("../../data/materials/vacuum.yml")),
    ("water", include_str!("../../data/materials/H2O-Daimon-20C.yml")),
    ("SiO2", include_str!("../../data/materials/SiO2-Malitson.yml")),
    ("TiO2", include_str!("../../data/materials/TiO2-Siefke.yml")),
    ("TiO2-rutile", include_str!("../../data/materials/TiO2-Devore-o.yml")),
    ("MgF2", include_str!("../../data/materials/MgF2-Dodge-o.yml")),
    ("Al2O3", include_str!("../../data/materials/Al2O3-Malitson-o.yml")),
    ("CaCO3", include_str!("../../data/materials/CaCO3-Ghosh-o.yml")),
    ("N-BK7", include_str!("../../data/materials/N-BK7.yml")),
    ("Si", include_str!("../../data/materials/Si-Green-2008.yml")),
    ("Ag", include_str!("../../data/materials/Ag-Johnson.yml")),
    ("Al", include_str!("../../data/materials/Al-Rakic.yml")),
    ("Au", include_str!("../../data/materials/Au-Johnson.yml")),
    ("Cr", include_str!("../../data/materials/Cr-Johnson.yml")),
    ("Cu", include_str!("../../data/materials/Cu-Johnson.yml")),
    ("Ti", include_str!("../../data/materials/Ti-Johnson.yml")),
    ("cellulose", include_str!("../../data/materials/cellulose-Sultanova.yml")),
    ("chitin", include_str!("../../data/materials/chitin.yml")),
    ("keratin", include_str!("../../data/materials/keratin.yml")),
    ("melanin", include_str!("../../data/materials/melanin.yml")),
    ("guanine", include_str!("../../data/materials/guanine.yml")),
];

/// The names of the built-in materials.
pub fn names() -> impl Iterator<Item = &'static str> {
    MATERIALS.iter().map(|&(name, _)| name)
}

/// The built-in material of that name, upper or lower case.
#[must_use]
pub fn get(name: &str, extrapolate: Extrapolate) -> Option<Result<NamedMedium>> {
    let &(name, text) = MATERIALS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
    let label = format!("built-in material {name}");
    let medium = nk::parse(&Source { label: &label, text }, extrapolate);
    Some(medium.map(|medium| NamedMedium { name: name.to_owned(), medium }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eta(name: &str, nm: f64) -> (f64, f64) {
        let eta = get(name, Extrapolate::Refuse).unwrap().unwrap().medium.borrow().eta(nm).unwrap();
        (eta.re, eta.im)
    }

    /// Tables are quoted exactly; the k of glass is 1e-8.
    const K_DIGITS: f64 = 1e-9;

    /// Values quoted by the publications and by glass catalogues, to the digits quoted.
    #[test]
    fn indices_are_the_published_ones() {
        for (name, nm, n, k, digits) in [
            ("air", 589.3, 1.000_277, 0.0, 1e-6),
            ("water", 589.3, 1.333, 0.0, 5e-4),
            ("SiO2", 587.6, 1.458_46, 0.0, 5e-6),
            ("MgF2", 589.3, 1.3777, 0.0, 1e-4),
            ("Al2O3", 589.3, 1.768, 0.0, 5e-4),
            ("CaCO3", 589.3, 1.6584, 0.0, 2e-4),
            ("N-BK7", 587.5618, 1.5168, 9.7e-9, 5e-6),
            ("TiO2-rutile", 589.3, 2.613, 0.0, 5e-4),
            ("chitin", 400.0, 1.572, 0.0, 5e-4),
            ("chitin", 500.0, 1.552, 0.0, 5e-4),
            ("chitin", 600.0, 1.541, 0.0, 5e-4),
            ("keratin", 400.0, 1.569, 0.0, 5e-4),
            ("keratin", 500.0, 1.556, 0.0, 5e-4),
            ("keratin", 600.0, 1.548, 0.0, 5e-4),
            ("melanin", 500.0, 1.648 + 0.0948, 0.56 * (-500.0f64 / 270.0).exp(), 1e-9),
            ("guanine", 500.0, 1.83, 0.0, 1e-12),
            ("Ag", 548.6, 0.06, 3.586, 1e-12),
            ("Au", 616.8, 0.21, 3.272, 1e-12),
            ("Cu", 616.8, 0.30, 3.205, 1e-12),
            ("Cr", 549.0, 3.18, 3.33, 1e-12),
            ("Ti", 549.0, 2.54, 3.43, 1e-12),
            ("Si", 550.0, 4.077, 0.027_968, 1e-12),
        ] {
            let (found_n, found_k) = eta(name, nm);
            assert!((found_n - n).abs() <= digits, "{name} at {nm} nm: n = {found_n}, expected {n}");
            assert!((found_k - k).abs() <= K_DIGITS, "{name} at {nm} nm: k = {found_k}, expected {k}");
        }
    }

    #[test]
    fn every_material_holds_over_its_range_and_no_further() {
        for name in names() {
            let material = get(name, Extrapolate::Refuse).unwrap().unwrap();
            let medium = material.medium.borrow();
            let [from, to] = medium.range_nm();
            for step in 0..=1000 {
                let nm = from * (to / from).powf(f64::from(step) / 1000.0);
                assert!(medium.eta(nm.clamp(from, to)).is_ok(), "{name} at {nm} nm: {:?}", medium.eta(nm));
            }
            assert!(medium.eta(from * 0.99).is_err() && medium.eta(to * 1.01).is_err(), "{name}");
            let clamped = get(name, Extrapolate::Clamp).unwrap().unwrap();
            assert_eq!(clamped.medium.borrow().eta(from * 0.5).unwrap(), medium.eta(from).unwrap(), "{name}");
        }
    }

    /// A scene is sampled from 380 to 780 nm; only these two publications stop short of that.
    #[test]
    fn all_but_two_cover_the_visible() {
        let short = names().filter(|name| {
            let material = get(name, Extrapolate::Refuse).unwrap().unwrap();
            let [from, to] = material.medium.borrow().range_nm();
            from > 380.0 || to < 780.0
        });
        assert_eq!(short.collect::<Vec<_>>(), ["TiO2-rutile", "cellulose"]);
    }

    #[test]
    fn names_ignore_case() {
        assert_eq!(get("sio2", Extrapolate::Refuse).unwrap().unwrap().name, "SiO2");
        assert!(get("unobtainium", Extrapolate::Refuse).is_none());
    }
}
