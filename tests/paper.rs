//! Tests of the colours of the paper's figures 3 and 4, in both models.

use crate::reference::{Layered, reflectance, visible};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::optics::interface::Model;
use num_complex::Complex64;

/// Tolerance of colours that are stated to two digits.
const STATED_DIGITS: f64 = 0.01;

fn colour(stack: &Layered, model: Model, theta_deg: f64) -> [f64; 3] {
    let wavelengths = visible(5.0);
    let mut weights = vec![[0.0; 3]; wavelengths.len()];
    xyz_weights(&wavelengths, Illuminant::E, Quadrature::Interpolated, &mut weights).expect("a good grid");
    RgbSpace::Paper.from_xyz(xyz(&weights, reflectance(stack, theta_deg, &wavelengths, model)))
}

fn holds(stack: &Layered, model: Model, expected: &[(f64, [f64; 3])]) {
    for &(theta_deg, want) in expected {
        let got = colour(stack, model, theta_deg);
        println!("{model:?} {theta_deg}: {got:.3?}");
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() <= STATED_DIGITS), "{theta_deg} deg: {got:?} {want:?}");
    }
}

fn figure_3() -> Layered {
    Layered { eta: [1.0, 2.4].map(Complex64::from).to_vec(), thickness_nm: vec![300.0] }
}

fn figure_4() -> Layered {
    let eta = [1.0, 2.4, 1.0, 2.4, 1.0, 2.4, 1.0].map(Complex64::from).to_vec();
    Layered { eta, thickness_nm: vec![180.0; 5] }
}

#[test]
fn figure_3_is_red_violet_in_the_papers_model() {
    let expected = [(0.0, [0.55, 0.55, 0.71]), (30.0, [0.69, 0.47, 0.79]), (60.0, [1.00, 0.29, 0.83])];
    holds(&figure_3(), Model::Paper, &expected);
}

#[test]
fn figure_3_has_no_colour_in_exact_physics() {
    for theta_deg in [0.0, 30.0, 60.0] {
        let rho = reflectance(&figure_3(), theta_deg, &visible(5.0), Model::Physical);
        assert!(rho.iter().all(|r| (r - 1.0).abs() < 1e-12), "a lossless film on a perfect mirror reflects all light");
    }
}

#[test]
fn figure_4_turns_from_orange_to_green_in_exact_physics() {
    let expected = [(0.0, [1.39, 0.72, -0.01]), (60.0, [0.48, 0.60, 0.47])];
    holds(&figure_4(), Model::Physical, &expected);
    let [r, g, b] = colour(&figure_4(), Model::Physical, 80.0);
    assert!(b > g && b > r, "bluish at 80 degrees: {r} {g} {b}");
}

#[test]
fn figure_4_is_not_orange_in_the_papers_model() {
    let [r, g, b] = colour(&figure_4(), Model::Paper, 0.0);
    assert!(!(r > 1.2 * g && g > 2.0 * b), "{r} {g} {b}");
}
