//! Tests of the colours of films against an independent colour library.

use crate::reference::{Layered, reflectance, visible};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::optics::interface::Model;
use num_complex::Complex64;
use serde::Deserialize;

#[derive(Deserialize)]
struct Colours {
    cases: Vec<ColourCase>,
}

#[derive(Deserialize)]
#[allow(non_snake_case, reason = "keys of the reference")]
struct ColourCase {
    name: String,
    XYZ_E: [f64; 3],
    XYZ_D65: [f64; 3],
    paper_rgb_E: [f64; 3],
    linear_srgb_D65: [f64; 3],
}

/// Unpolarised reflectance of a free-standing film in air.
fn film(n: f64, thickness_nm: f64, theta_deg: f64, wavelengths: &[f64]) -> Vec<f64> {
    let stack = Layered { eta: [1.0, n, 1.0].map(Complex64::from).to_vec(), thickness_nm: vec![thickness_nm] };
    reflectance(&stack, theta_deg, wavelengths, Model::Physical)
}

fn spectrum(case: &str, wavelengths: &[f64]) -> Vec<f64> {
    match case {
        "film-2.4-300nm-0deg" => film(2.4, 300.0, 0.0, wavelengths),
        "film-2.4-300nm-60deg" => film(2.4, 300.0, 60.0, wavelengths),
        "film-2.4-3000nm-0deg" => film(2.4, 3000.0, 0.0, wavelengths),
        "soap-1.33-420nm-30deg" => film(1.33, 420.0, 30.0, wavelengths),
        "flat-0.5" => vec![0.5; wavelengths.len()],
        other => panic!("no spectrum for {other}"),
    }
}

fn holds(step_nm: f64, tolerance: f64) {
    let cases = serde_json::from_str::<Colours>(include_str!("data/colour.json")).expect("the reference is JSON").cases;
    assert!(!cases.is_empty());
    let wavelengths = visible(step_nm);
    for case in cases {
        let rho = spectrum(&case.name, &wavelengths);
        let mut worst: f64 = 0.0;
        for (illuminant, space, want_xyz, want_rgb) in [
            (Illuminant::E, RgbSpace::Paper, case.XYZ_E, case.paper_rgb_E),
            (Illuminant::D65, RgbSpace::Srgb, case.XYZ_D65, case.linear_srgb_D65),
        ] {
            let mut weights = vec![[0.0; 3]; wavelengths.len()];
            xyz_weights(&wavelengths, illuminant, Quadrature::Interpolated, &mut weights).expect("a good grid");
            let got = xyz(&weights, rho.iter().copied());
            let rgb = space.from_xyz(got);
            for (a, b) in got.into_iter().chain(rgb).zip(want_xyz.into_iter().chain(want_rgb)) {
                worst = worst.max((a - b).abs());
            }
        }
        println!("{:24} step {step_nm} nm: {worst:.1e}", case.name);
        assert!(worst <= tolerance, "{} at {step_nm} nm: {worst:e}", case.name);
    }
}

#[test]
fn at_one_nanometre() {
    holds(1.0, 1e-4);
}

#[test]
fn at_the_default_grid_of_81_samples() {
    holds(5.0, 5e-3);
}

#[test]
fn every_sample_of_a_thick_film_counts() {
    // 100 µm of 1.5 on 3.5: more fringes than nanometres. Integrated by an independent program over 0.01 nm.
    let stack = Layered { eta: [1.0, 1.5, 3.5].map(Complex64::from).to_vec(), thickness_nm: vec![1e5] };
    const WANTED: [f64; 3] = [0.1791, 0.1884, 0.2051];
    /// Half of the last digit that is given.
    const DIGITS: f64 = 0.5e-4;
    for step_nm in [0.05, 0.04] {
        let wavelengths = visible(step_nm);
        let mut weights = vec![[0.0; 3]; wavelengths.len()];
        xyz_weights(&wavelengths, Illuminant::D65, Quadrature::Interpolated, &mut weights).expect("a good grid");
        let got = xyz(&weights, reflectance(&stack, 0.0, &wavelengths, Model::Physical));
        println!("step {step_nm} nm: {got:.5?}");
        assert!(got.iter().zip(WANTED).all(|(a, b)| (a - b).abs() <= DIGITS), "at {step_nm} nm: {got:?}");
    }
}
