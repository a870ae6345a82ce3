//! Colours and sampling errors as the command line gives them, against the paper and an independent colour library.

use serde_json::Value;

use crate::user::{User, column, triples};

const RGB: [&str; 3] = ["R", "G", "B"];
const XYZ: [&str; 3] = ["X", "Y", "Z"];

fn worst(found: [f64; 3], wanted: [f64; 3]) -> f64 {
    found.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The values for the paper's scenes are known to two decimals.
const TWO_DECIMALS: f64 = 0.01;

#[test]
fn the_papers_films_have_its_colours() {
    let user = User::new();
    let cases: &[(&str, &[[f64; 3]])] = &[
        ("paper-fig3 --model paper --theta 0,30,60", &[[0.55, 0.55, 0.71], [0.69, 0.47, 0.79], [1.00, 0.29, 0.83]]),
        ("paper-fig4 --model physical --theta 0,60", &[[1.39, 0.72, -0.01], [0.48, 0.60, 0.47]]),
    ];
    for (what, wanted) in cases {
        let line = format!("colour {what} --illuminant E --space paper --wavelengths 380:780:5 --csv -");
        let found = triples(&user.ok(&line).stdout, RGB);
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.into_iter().zip(*wanted) {
            assert!(worst(found, *wanted) <= TWO_DECIMALS, "{what}: {found:?} where {wanted:?} belongs");
        }
    }
}

#[test]
fn a_film_on_a_mirror_is_colourless_in_exact_physics() {
    let csv = User::new().ok("colour paper-fig3 --theta 0,30,60 --csv -").stdout;
    for rgb in triples(&csv, RGB) {
        assert!(worst(rgb, [1.0; 3]) < 1e-3, "{rgb:?}: sRGB of the white that the observer's table sums to");
    }
    assert_eq!(csv.matches("#ffffff").count(), 3);
}

/// The paper reads its errors off a curve.
const OF_A_CURVE: f64 = 0.15;

#[test]
fn few_wavelengths_err_as_the_paper_says() {
    let user = User::new();
    for (line, wanted) in
        [("paper-fig6-300 --samples 10", vec![0.0145]), ("paper-fig6-3000 --samples 32,40", vec![0.088, 0.010])]
    {
        let found = column(&user.ok(&format!("sampling {line}")).stdout, "largest_error");
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() <= OF_A_CURVE, "{line}: {found} where {wanted} belongs");
        }
    }
}

/// Free-standing films of the reference: its name for them, scene, angle of incidence.
const FILMS: [(&str, &str, f64, u32); 4] = [
    ("film-2.4-300nm-0deg", "2.4", 300.0, 0),
    ("film-2.4-300nm-60deg", "2.4", 300.0, 60),
    ("film-2.4-3000nm-0deg", "2.4", 3000.0, 0),
    ("soap-1.33-420nm-30deg", "1.33", 420.0, 30),
];

/// The largest error of XYZ and RGB under both illuminants, and the number of wavelengths that `auto` took.
fn error(user: &User, reference: &Value, theta_deg: u32, wavelengths: &str) -> (f64, Option<usize>) {
    let mut largest: f64 = 0.0;
    let mut count = None;
    for (options, xyz, rgb) in [
        ("--illuminant E --space paper", "XYZ_E", "paper_rgb_E"),
        ("--illuminant D65 --space srgb", "XYZ_D65", "linear_srgb_D65"),
    ] {
        let ran = user.ok(&format!("colour film.toml --theta {theta_deg} {options} {wavelengths} --csv -"));
        count = ran.stderr.split_once(" wavelengths from ").map(|(count, _)| count.parse().expect("a count"));
        for (names, key) in [(XYZ, xyz), (RGB, rgb)] {
            let wanted: [f64; 3] = serde_json::from_value(reference[key].clone()).expect("three numbers");
            largest = largest.max(worst(triples(&ran.stdout, names)[0], wanted));
        }
    }
    (largest, count)
}

/// What `auto` promises: interference is sampled so that colours hold to this.
const AUTO: f64 = 2e-3;
/// What 81 samples do for films up to 3 µm.
const DEFAULT: f64 = 5e-3;

#[test]
fn films_have_the_colours_of_an_independent_library() {
    let reference: Value = serde_json::from_str(include_str!("../data/colour.json")).expect("the reference is JSON");
    let cases = reference["cases"].as_array().expect("a list of cases");
    for (name, n, thickness_nm, theta_deg) in FILMS {
        let case = cases.iter().find(|case| case["name"] == name).expect("every film has a reference");
        let layer = format!("{{ material = {n}, thickness_nm = {thickness_nm:?} }}");
        let scene = format!("[stack]\nambient = 1.0\nlayers = [{layer}]\nsubstrate = 1.0\n");
        let user = User::with(&[("film.toml", &scene)]);
        let (auto, count) = error(&user, case, theta_deg, "--wavelengths auto");
        let (default, _) = error(&user, case, theta_deg, "");
        println!(
            "{name}: auto {auto:.1e} with {} wavelengths, default {default:.1e}",
            count.expect("auto says how many")
        );
        assert!(auto <= AUTO, "{name}: {auto:e}");
        assert!(default <= DEFAULT, "{name}: {default:e}");
    }
    // flat-0.5 is a spectrum and no scene; the observer's own tests have it.
    assert_eq!(cases.len(), FILMS.len() + 1, "every case of the reference is tested");
}

#[test]
fn auto_says_how_many_wavelengths_it_takes_and_takes_as_many() {
    let user = User::new();
    for scene in ["soap-bubble", "paper-fig6-3000", "morpho-stack"] {
        let spectrum = user.ok(&format!("spectrum {scene} --wavelengths auto"));
        let rows = column(&spectrum.stdout, "wavelength_nm");
        let says = format!("{} wavelengths from 380 to 780 nm", rows.len());
        assert!(spectrum.stderr.starts_with(&says), "{}", spectrum.stderr);
        assert_eq!((rows[0], rows[rows.len() - 1]), (380.0, 780.0));
        let estimate = user.ok(&format!("estimate {scene} --wavelengths auto --angles 3 -o t.exr"));
        assert!(estimate.stderr.starts_with(&says), "{}", estimate.stderr);
        assert!(estimate.stderr.contains(&format!("3 angles × {} wavelengths", rows.len())), "{}", estimate.stderr);
        assert_eq!(user.ok(&format!("colour {scene} --wavelengths auto --quiet --csv -")).stderr, "");
    }
    let thick = column(&user.ok("spectrum paper-fig6-3000 --wavelengths auto").stdout, "R_s").len();
    let thin = column(&user.ok("spectrum paper-fig6-300 --wavelengths auto").stdout, "R_s").len();
    assert!(thick > 3 * thin, "ten times the film has fringes ten times as dense: {thick} and {thin}");
}
