//! Colours of chosen wavelengths against sums over 0.01 nm.

use goniochrome::colour::{Quadrature, RgbSpace, VISIBLE_NM};
use goniochrome::optics::interface::Model;

use super::*;
use crate::scene::parse;
use crate::solve::colours::colours;
use crate::solve::fidelity::largest_error;
use crate::solve::precision::Precision;
use crate::solve::spectra::{Method, spectra};

/// The number of steps of 0.01 nm in the visible range.
const FINE: u32 = 40_000;
const REQUEST: SpectraRequest =
    SpectraRequest { model: Model::Physical, method: Method::Stack, precision: Precision::F64, threads: 2 };
const VISIBLE: [f64; 2] = [VISIBLE_NM[0] as f64, VISIBLE_NM[1] as f64];

/// A scene file's stack in air: index and thickness of each layer.
fn stack(layers: &[(&str, f64)], substrate: &str) -> String {
    let layers: Vec<String> =
        layers.iter().map(|(eta, nm)| format!("{{ material = {eta}, thickness_nm = {nm:?} }}")).collect();
    format!("[stack]\nambient = 1.0\nlayers = [{}]\nsubstrate = {substrate}\n", layers.join(", "))
}

/// The number of chosen wavelengths, and the largest ΔE2000 of their colours: as the program tells it, and from a sum
/// over samples so fine that they need no interpolation.
fn found(scene: &str, theta_deg: &[f64]) -> (usize, f64, f64) {
    let scene = parse("scene", scene).unwrap();
    let planar = PlanarScene::new(&scene).unwrap();
    let choice = choose(&planar, theta_deg, VISIBLE, Illuminant::D65, &REQUEST).unwrap();
    let kept = spectra(&planar, theta_deg, &choice.wavelength_nm, &REQUEST, &|| ()).unwrap();
    let told = largest_error(&kept, &choice.xyz, Illuminant::D65).unwrap().0;

    let grid: Vec<f64> = (0..=FINE).map(|i| VISIBLE[0] + 400.0 * f64::from(i) / f64::from(FINE)).collect();
    let fine = spectra(&planar, theta_deg, &grid, &REQUEST, &|| ()).unwrap();
    let sums = colours(&fine, Illuminant::D65, RgbSpace::Srgb, Quadrature::Sampled);
    let sums: Vec<[f64; 3]> = sums.unwrap().into_iter().map(|colour| colour.xyz).collect();
    (choice.wavelength_nm.len(), told, largest_error(&kept, &sums, Illuminant::D65).unwrap().0)
}

#[test]
fn films_of_any_thickness_have_their_colour() {
    /// The promised ΔE2000 for films from 10 nm to 200 µm.
    const PROMISED: f64 = 0.1;
    for (thickness_nm, substrate) in
        [10.0, 300.0, 3e3, 2e4, 7.3e4, 2e5].into_iter().flat_map(|nm| [(nm, "1.0"), (nm, "1.52"), (nm, "\"Si\"")])
    {
        let (count, told, error) = found(&stack(&[("1.58", thickness_nm)], substrate), &[0.0, 60.0]);
        println!("{thickness_nm} nm on {substrate}: {count} wavelengths, told {told:.3}, error {error:.3}");
        assert!(error <= PROMISED, "{thickness_nm} nm on {substrate}: {error}");
        assert!(thickness_nm > 1e3 || count == 81, "thin films keep the table's usual size: {count}");
    }
}

#[test]
fn lines_at_grazing_incidence_are_seen() {
    // Between air and a good metal a film's fringes are lines of a tenth of their distance.
    let (count, told, error) = found(&stack(&[("2.909", 33_315.0)], "[0.0753, 3.399]"), &[0.0, 75.0, 88.0]);
    println!("{count} wavelengths, told {told:.3}, error {error:.3}");
    assert!(error <= 0.1 && (told - error).abs() <= MAX_DELTA_E, "told {told} of {error}");
}

/// The promised ΔE2000 for stacks that resonate.
const RESONANT: f64 = 0.3;

#[test]
fn resonant_stacks_have_their_colour() {
    let metal = |nm: f64| ("[0.05, 3.5]", nm);
    let mirror = |pairs: usize, first: (&'static str, f64), second| [first, second].repeat(pairs);
    let (high, low) = (("2.35", 58.5), ("1.46", 94.2));
    let cavity = |pairs, spacer| [mirror(pairs, high, low), vec![spacer], mirror(pairs, low, high)].concat();
    for (name, layers, substrate) in [
        ("metal, glass, metal", vec![metal(40.0), ("1.46", 500.0), metal(40.0)], "1.5"),
        ("four pairs around a cavity", cavity(4, ("2.35", 117.0)), "1.5"),
        (
            "four pairs as they stand",
            [mirror(4, high, low), vec![("1.46", 188.4)], mirror(4, high, low)].concat(),
            "1.5",
        ),
        ("ten pairs around a cavity", cavity(10, ("2.35", 117.0)), "1.5"),
        ("six pairs around 5 µm", cavity(6, ("1.46", 5000.0)), "1.5"),
        ("silver etalon of 20 µm", vec![metal(30.0), ("1.46", 2e4), metal(30.0)], "1.5"),
        ("two coupled cavities", [cavity(5, ("2.35", 117.0)), vec![low], cavity(5, ("2.35", 117.0))].concat(), "1.5"),
    ] {
        let (count, told, error) = found(&stack(&layers, substrate), &[0.0, 45.0, 75.0]);
        println!("{name}: {count} wavelengths, told {told:.3}, error {error:.3}");
        assert!(error <= RESONANT && (told - error).abs() <= RESONANT, "{name}: {error}, told {told}");
    }
}

#[test]
fn random_stacks_have_their_colour() {
    let mut seed = 7_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for case in 0..60 {
        let count = 1 + (8.0 * random()) as usize;
        let layers: Vec<(String, f64)> = (0..count)
            .map(|_| match (4.0 * random()) as u32 {
                0 => (format!("[{:.3}, {:.3}]", 0.05 + random(), 2.0 + 3.0 * random()), 3.0 + 40.0 * random()),
                1 => (format!("{:.3}", 1.3 + 1.2 * random()), 10_f64.powf(2.0 + 2.5 * random())),
                _ => (format!("{:.3}", 1.3 + 1.2 * random()), 20.0 + 400.0 * random()),
            })
            .collect();
        let layers: Vec<(&str, f64)> = layers.iter().map(|(eta, nm)| (eta.as_str(), *nm)).collect();
        let (count, told, error) = found(&stack(&layers, "1.5"), &[0.0, 85.0 * random()]);
        println!("{case}: {count} wavelengths, told {told:.3}, error {error:.3}");
        assert!(error <= RESONANT && (told - error).abs() <= RESONANT, "{layers:?}: {error}, told {told}");
    }
}

#[test]
fn a_full_table_tells_its_error() {
    // A millimetre has 4000 fringes, of which 8192 wavelengths see two each.
    let (count, told, error) = found(&stack(&[("1.5", 1e6)], "1.0"), &[0.0]);
    println!("{count} wavelengths, told {told:.3}, error {error:.3}");
    assert_eq!(count, MAX_WAVELENGTHS);
    assert!(told > MAX_DELTA_E && (told - error).abs() <= 0.1 * error, "told {told} of {error}");
}

#[test]
fn invisible_spectra_are_resolved_too() {
    let scene = parse("scene", &stack(&[("1.5", 2e4)], "1.0")).unwrap();
    let planar = PlanarScene::new(&scene).unwrap();
    let choice = choose(&planar, &[0.0], [800.0, 1600.0], Illuminant::D65, &REQUEST).unwrap();
    // 37 fringes.
    assert!((150..1500).contains(&choice.wavelength_nm.len()), "{}", choice.wavelength_nm.len());
    assert_eq!((choice.wavelength_nm[0], *choice.wavelength_nm.last().unwrap()), (800.0, 1600.0));
}
