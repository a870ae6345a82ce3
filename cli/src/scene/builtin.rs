//! Built-in materials: data files of refractiveindex.info (CC0) and a few biological materials.

use goniochrome::optics::medium::Extrapolate;

use super::diagnostics::SourceText;
use super::parts::NamedMedium;
use super::refractive_index_info;
use crate::support::error::Result;

/// Material: name, data file, and its source in short.
type Material = (&'static str, &'static str, &'static str);

#[rustfmt::skip]
const MATERIALS: &[Material] = &[
    ("air", include_str!("../../data/materials/air-Ciddor.yml"),
        "Ciddor, Appl. Opt. 35, 1566 (1996): dry air, 15 °C; beyond 1690 nm within 3.1e-7"),
    ("vacuum", include_str!("../../data/materials/vacuum.yml"),
        "by definition"),
    ("water", include_str!("../../data/materials/H2O-Daimon-20C.yml"),
        "Daimon and Masumura, Appl. Opt. 46, 3811 (2007): 20 °C, without absorption"),
    ("SiO2", include_str!("../../data/materials/SiO2-Malitson.yml"),
        "Malitson, J. Opt. Soc. Am. 55, 1205 (1965): fused silica"),
    ("TiO2", include_str!("../../data/materials/TiO2-Siefke.yml"),
        "Siefke et al., Adv. Opt. Mater. 4, 1780 (2016): amorphous film"),
    ("TiO2-rutile", include_str!("../../data/materials/TiO2-Devore-o.yml"),
        "DeVore, J. Opt. Soc. Am. 41, 416 (1951): ordinary ray; it absorbs below 420 nm, where there are no data"),
    ("MgF2", include_str!("../../data/materials/MgF2-Dodge-o.yml"),
        "Dodge, Appl. Opt. 23, 1980 (1984): crystal, ordinary ray; evaporated films have less"),
    ("Al2O3", include_str!("../../data/materials/Al2O3-Malitson-o.yml"),
        "Malitson and Dodge, J. Opt. Soc. Am. 62, 1405 (1972): sapphire, ordinary ray"),
    ("CaCO3", include_str!("../../data/materials/CaCO3-Ghosh-o.yml"),
        "Ghosh, Opt. Commun. 163, 95 (1999): calcite, ordinary ray"),
    ("N-BK7", include_str!("../../data/materials/N-BK7.yml"),
        "Schott, catalogue of January 2017"),
    ("Si", include_str!("../../data/materials/Si-Green-2008.yml"),
        "Green, Sol. Energ. Mat. Sol. Cells 92, 1305 (2008): crystal, 300 K"),
    ("Ag", include_str!("../../data/materials/Ag-Johnson.yml"),
        "Johnson and Christy, Phys. Rev. B 6, 4370 (1972)"),
    ("Al", include_str!("../../data/materials/Al-Rakic.yml"),
        "Rakić, Appl. Opt. 34, 4755 (1995)"),
    ("Au", include_str!("../../data/materials/Au-Johnson.yml"),
        "Johnson and Christy, Phys. Rev. B 6, 4370 (1972)"),
    ("Cr", include_str!("../../data/materials/Cr-Johnson.yml"),
        "Johnson and Christy, Phys. Rev. B 9, 5056 (1974)"),
    ("Cu", include_str!("../../data/materials/Cu-Johnson.yml"),
        "Johnson and Christy, Phys. Rev. B 6, 4370 (1972)"),
    ("Ti", include_str!("../../data/materials/Ti-Johnson.yml"),
        "Johnson and Christy, Phys. Rev. B 9, 5056 (1974)"),
    ("cellulose-plastic", include_str!("../../data/materials/cellulose-plastic-Sultanova.yml"),
        "Sultanova et al., Acta Phys. Pol. A 116, 585 (2009): an ester; below 437 nm within 0.002"),
    ("chitin", include_str!("../../data/materials/chitin.yml"),
        "Leertouwer et al., Opt. Express 19, 24061 (2011): without pigment, formula continued from 400 to 600 nm"),
    ("keratin", include_str!("../../data/materials/keratin.yml"),
        "Leertouwer et al., Opt. Express 19, 24061 (2011): formula continued from 400 to 600 nm"),
    ("melanin", include_str!("../../data/materials/melanin.yml"),
        "Stavenga et al., Light Sci. Appl. 4, e243 (2015)"),
    ("guanine", include_str!("../../data/materials/guanine.yml"),
        "Levy-Lior et al., Cryst. Growth Des. 8, 507 (2008): in the plane of a plate, one value"),
];

/// Names of the built-in materials.
pub fn names() -> impl Iterator<Item = &'static str> {
    MATERIALS.iter().map(|&(name, ..)| name)
}

/// Built-in material by its name, in upper or lower case.
#[must_use]
pub fn get(name: &str, extrapolate: Extrapolate) -> Option<Result<NamedMedium>> {
    let &(name, text, _) = MATERIALS.iter().find(|(known, ..)| known.eq_ignore_ascii_case(name))?;
    let label = format!("built-in material {name}");
    let medium = refractive_index_info::parse(&SourceText { label: &label, text }, extrapolate);
    Some(medium.map(|medium| NamedMedium { name: name.to_owned(), medium }))
}

/// List of the built-in materials, one a line: name, range of wavelengths with data, and source.
///
/// # Errors
/// A data file that cannot be read; the tests read every built-in one.
pub fn list() -> Result<String> {
    let mut lines = String::new();
    let width = names().map(str::len).max().unwrap_or(0);
    for &(name, text, source) in MATERIALS {
        let label = format!("built-in material {name}");
        let [from, to] =
            refractive_index_info::parse(&SourceText { label: &label, text }, Extrapolate::Refuse)?.borrow().range_nm();
        let digits = if from < 1.0 { 3 } else { 0 };
        let range =
            if name == "vacuum" { "any wavelength".to_owned() } else { format!("{from:.digits$} to {to:.0} nm") };
        lines.push_str(&format!("{name:width$}  {range:17}  {source}\n"));
    }
    Ok(lines)
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
            // The last row of Mathar's table, J. Opt. A 9, 470 (2007).
            ("air", 14_100.0, 1.000_272_640, 0.0, 1e-7),
            ("cellulose-plastic", 589.3, 1.4701, 0.0, 5e-4),
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

    /// A scene is sampled from 380 to 780 nm; rutile absorbs below 420 nm, where its publication has no data.
    #[test]
    fn all_but_rutile_cover_the_visible() {
        let short = names().filter(|name| {
            let material = get(name, Extrapolate::Refuse).unwrap().unwrap();
            let [from, to] = material.medium.borrow().range_nm();
            from > 380.0 || to < 780.0
        });
        assert_eq!(short.collect::<Vec<_>>(), ["TiO2-rutile"]);
    }

    #[test]
    fn the_list_has_a_line_for_each_material_with_range_and_source() {
        let list = list().unwrap();
        assert_eq!(list.lines().count(), names().count());
        let line = |name: &str| list.lines().find(|line| line.split(' ').next() == Some(name)).unwrap().to_owned();
        assert!(line("TiO2-rutile").contains("430 to 1530 nm") && line("TiO2-rutile").contains("DeVore"));
        assert!(line("vacuum").contains("any wavelength"));
    }

    #[test]
    fn names_ignore_case() {
        assert_eq!(get("sio2", Extrapolate::Refuse).unwrap().unwrap().name, "SiO2");
        assert!(get("unobtainium", Extrapolate::Refuse).is_none());
    }
}
