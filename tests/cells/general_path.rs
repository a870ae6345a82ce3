//! Tests of the tracer of interfering paths where the result is known: planes, conformal films, energy.

use goniochrome::measure::bins::DirectionBins;
use goniochrome_cli::scene::Scene;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Scattered, scatter};
use serde_json::Value;

use crate::scene::{between, cell, extruded, towards};

fn traced(
    scene: &Scene,
    theta_deg: f64,
    phi_deg: f64,
    wavelengths: &[f64],
    rays: u32,
    precision: Precision,
) -> Vec<Scattered> {
    let mesh_scene = MeshScene::new(scene).expect("a good mesh");
    let request = ScatterRequest {
        coherence: Coherence::Ray,
        rays,
        seed: 1,
        bins: DirectionBins { cos: 16, phi: 32 },
        precision,
        threads: 2,
    };
    scatter(&mesh_scene, towards(theta_deg, phi_deg), wavelengths, &request, &|| ()).expect("a good mesh")
}

/// Tolerance of the planar tracer. Even in double precision a thin metal film under a clear medium is 5e-6 off.
const SINGLE: f64 = 1e-5;

#[test]
fn planes_reflect_as_the_independent_transfer_matrix_says() {
    planes_reflect_as(include_str!("../data/planar.json"), Precision::F32, SINGLE);
}

#[test]
fn planes_under_a_weakly_absorbing_medium_reflect_as_the_independent_solution_says() {
    planes_reflect_as(include_str!("../data/weak_ambient.json"), Precision::F64, SINGLE);
}

fn planes_reflect_as(reference: &str, precision: Precision, tolerance: f64) {
    let reference: Value = serde_json::from_str(reference).expect("the reference is JSON");
    let list = |value: &Value| -> Vec<f64> {
        value.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
    };
    for case in reference["cases"].as_array().expect("cases") {
        let name = case["name"].as_str().expect("a name");
        let n: Vec<Vec<f64>> = case["n"].as_array().expect("indices").iter().map(list).collect();
        let thickness = list(&case["thickness_nm"]);
        let names: Vec<String> = (0..=thickness.len()).map(|i| format!("p{i}")).collect();
        let mut depth = 0.0;
        let sheets: Vec<(&str, f64)> = names
            .iter()
            .enumerate()
            .map(|(i, name)| {
                let at = (name.as_str(), depth);
                depth += thickness.get(i).copied().unwrap_or(0.0);
                at
            })
            .collect();
        let flat = extruded(&[[0.0, 0.0], [2000.0, 0.0]], 2000.0, &sheets);
        let pair = |i: usize| [n[i][0], n[i][1]];
        let interfaces: Vec<(&str, String)> =
            names.iter().enumerate().map(|(i, name)| (name.as_str(), between(pair(i), pair(i + 1)))).collect();
        let scene = cell(&flat, [2000.0, 2000.0], &interfaces);
        let wavelengths = list(&case["wavelength_nm"]);
        // A tube's cross-section is taken by moduli, |q_n|/|η|, where the exact power has real parts: the square of
        // Im q_n/Re q_n = (k/n)/cos²θ apart. An ambient medium that does not absorb leaves no difference.
        let second_order = |theta: f64| (n[0][1] / n[0][0] / theta.to_radians().cos().powi(2)).powi(2);
        let mut worst: f64 = 0.0;
        for (row, theta) in list(&case["theta_deg"]).into_iter().enumerate() {
            // All starting rays give the same: one for each batch is enough.
            let found = traced(&scene, theta, 37.0, &wavelengths, 32, precision);
            for (column, found) in found.iter().enumerate() {
                let of = |key: &str| case[key][row][column].as_f64().expect("a number");
                let (r, t) = (0.5 * (of("R_s") + of("R_p")), 0.5 * (of("T_s") + of("T_p")));
                let error = (found.reflected.value - r).abs().max((found.transmitted.value - t).abs());
                worst = worst.max(error);
                let allowed = tolerance + second_order(theta);
                assert!(error <= allowed, "{name} at {theta}°: {error:e}");
            }
        }
        println!("{name}: {worst:.1e}");
    }
}

/// Three conformal films on a slope: as polygons, and as a coating of the lowest facets.
#[test]
fn a_conformal_multilayer_is_its_coating() {
    // A roof of 10 degrees with facets much longer than the films are thick, since the films differ at the edges.
    let slope = 10f64.to_radians().tan();
    let (half, thin) = (400_000.0, [120.0, 90.0, 150.0]);
    let points = [[0.0, 0.0], [half, half * slope], [2.0 * half, 0.0]];
    // Thicknesses are measured across the film, heights along z.
    let heights = thin.map(|t| t * (1.0 + slope * slope).sqrt());
    let sheets =
        [("a", 0.0), ("b", heights[0]), ("c", heights[0] + heights[1]), ("d", heights[0] + heights[1] + heights[2])];
    let n = [1.0, 2.0, 1.4, 1.8, 1.5].map(|n| [n, 0.0]);
    let interfaces: Vec<(&str, String)> =
        ["a", "b", "c", "d"].iter().enumerate().map(|(i, name)| (*name, between(n[i], n[i + 1]))).collect();
    let period = [2.0 * half, 500.0];
    let polygons = cell(&extruded(&points, 500.0, &sheets), period, &interfaces);
    let coating = "coating = [{ material = 2.0, thickness_nm = 120.0 }, { material = 1.4, thickness_nm = 90.0 }, \
                   { material = 1.8, thickness_nm = 150.0 }]";
    let coated_interface = [("a", format!("{}\n{coating}", between(n[0], n[4])))];
    let coated = cell(&extruded(&points, 500.0, &[("a", 0.0)]), period, &coated_interface);

    let wavelengths = [450.0, 500.0, 550.0, 600.0, 650.0, 700.0];
    for (theta, phi) in [(0.0, 0.0), (30.0, 90.0), (40.0, 30.0)] {
        let [a, b] = [&polygons, &coated].map(|scene| traced(scene, theta, phi, &wavelengths, 2048, Precision::F64));
        for ((a, b), nm) in a.iter().zip(&b).zip(wavelengths) {
            let difference = a.reflected.value - b.reflected.value;
            println!("{theta} {nm}: {:.5} {difference:.1e}", b.reflected.value);
            assert!(difference.abs() <= 1e-3, "{theta}° {nm} nm: {} {}", a.reflected.value, b.reflected.value);
        }
    }
}

#[test]
fn a_bumpy_film_keeps_its_power_where_paths_interfere() {
    let interfaces = [("upper", between([1.0, 0.0], [1.6, 0.0])), ("lower", between([1.6, 0.0], [1.0, 0.0]))];
    let scene = cell(include_str!("../data/cells/bumpy-film.obj"), [20_000.0, 20_000.0], &interfaces);
    for theta in [0.0, 30.0] {
        let found = &traced(&scene, theta, 37.0, &[550.0], 16_384, Precision::F64)[0];
        let sum = found.reflected.value + found.transmitted.value;
        println!(
            "{theta}: R + T = {sum:.5}, imbalance {:.1e} ± {:.1e}",
            found.imbalance.value, found.imbalance.std_error
        );
        assert!((sum - 1.0).abs() <= 0.01 + 4.0 * found.imbalance.std_error, "{sum}");
    }
}
