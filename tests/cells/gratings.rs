//! Tests of coherence `cell` against rigorous solvers: Fourier modal method, C method, finite elements.

use goniochrome_cli::scene::Scene;
use goniochrome_cli::solve::diffraction::{OrdersRequest, orders};
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use serde::Deserialize;

use crate::scene::{between, cell, extruded, towards};

#[derive(Deserialize)]
struct Gratings {
    cases: Vec<Grating>,
}

#[derive(Deserialize)]
struct Grating {
    name: String,
    period_nm: f64,
    profile: Profile,
    n_substrate: [f64; 2],
    data: Vec<Data>,
}

#[derive(Deserialize)]
struct Profile {
    points_nm: Vec<[f64; 2]>,
}

#[derive(Deserialize)]
#[allow(non_snake_case, reason = "keys of the reference")]
struct Data {
    wavelength_nm: f64,
    theta_deg: f64,
    orders_R: Vec<i32>,
    R_s: Vec<f64>,
    R_p: Vec<f64>,
}

/// Efficiency below which orders are not compared.
const STRONG: f64 = 0.005;
const RAYS: u32 = 65_536;
/// Number of hits: single scattering, for which the weight was derived.
const HITS: u32 = 1;

fn scene(grating: &Grating) -> Scene {
    let mut points = grating.profile.points_nm.clone();
    let (first, last) = (points[0], points[points.len() - 1]);
    // A wall at the end of the period closes the profile.
    if last[1] != first[1] {
        points.push([grating.period_nm, first[1]]);
    }
    let obj = extruded(&points, 500.0, &[("s", 0.0)]);
    cell(&obj, [grating.period_nm, 500.0], &[("s", between([1.0, 0.0], grating.n_substrate))])
}

/// Each angle with the largest difference of unpolarised efficiency over the strong orders.
fn worst(letter: &str) -> Vec<(f64, f64)> {
    let gratings: Gratings = serde_json::from_str(include_str!("../data/gratings.json")).expect("the reference");
    let grating = gratings.cases.iter().find(|g| g.name.starts_with(letter)).expect("the grating");
    let scene = scene(grating);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let request =
        OrdersRequest { rays: RAYS, seed: 1, max_order: Some(40), hits: HITS, precision: Precision::F64, threads: 2 };
    let each = grating.data.iter().map(|data| {
        let wi = towards(data.theta_deg, 180.0);
        let found = orders(&mesh_scene, wi, &[data.wavelength_nm], &request, &|| ()).expect("a good mesh").orders;
        let mut worst: f64 = 0.0;
        for (place, &m) in data.orders_R.iter().enumerate() {
            let rigorous = 0.5 * (data.R_s[place] + data.R_p[place]);
            let order = found.iter().find(|order| order.index == [m, 0]).expect("every order that travels is found");
            let k_x = data.theta_deg.to_radians().sin() + f64::from(m) * data.wavelength_nm / grating.period_nm;
            // The angle is computed from a cosine, which halves its digits near the normal.
            assert!((order.theta_deg.to_radians().sin() - k_x.abs()).abs() < 1e-7, "direction of order {m}");
            if rigorous > STRONG {
                let ours = 0.5 * (order.efficiency.s.value + order.efficiency.p.value);
                println!("    order {m:3}: {ours:.4}, rigorous {rigorous:.4}");
                worst = worst.max((ours - rigorous).abs());
            }
        }
        println!("{} {} nm {}°: {worst:.4}", grating.name, data.wavelength_nm, data.theta_deg);
        (data.theta_deg, worst)
    });
    each.collect()
}

fn holds(letter: &str, up_to_20_deg: f64, at_45_deg: f64) {
    for (theta_deg, worst) in worst(letter) {
        let allowed = if theta_deg <= 20.0 { up_to_20_deg } else { at_45_deg };
        assert!(worst <= allowed, "{letter} at {theta_deg}: {worst}");
    }
}

#[test]
fn lamellar_glass() {
    holds("a_", 0.0015, 0.0015);
}

#[test]
fn lamellar_silver() {
    holds("b_", 0.015, 0.04);
}

#[test]
fn blazed_silver() {
    holds("d_", 0.035, 0.035);
}

#[test]
fn triangles_of_glass() {
    holds("e_", 0.002, 0.002);
}

#[test]
fn compact_disc_has_the_right_directions_and_unreliable_efficiencies() {
    // Physical optics does not hold for grooves as wide as λ.
    assert!(worst("c_").iter().all(|(_, worst)| *worst < 0.2));
}

#[test]
fn a_flat_interface_reflects_into_the_zeroth_order_alone() {
    let flat = extruded(&[[0.0, 0.0], [4000.0, 0.0]], 500.0, &[("s", 0.0)]);
    let scene = cell(&flat, [4000.0, 500.0], &[("s", between([1.0, 0.0], [1.5, 0.0]))]);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let request =
        OrdersRequest { rays: 4096, seed: 1, max_order: None, hits: HITS, precision: Precision::F64, threads: 1 };
    let found = orders(&mesh_scene, towards(0.0, 0.0), &[550.0], &request, &|| ()).expect("a good mesh").orders;
    for order in found {
        let expected = if order.index == [0, 0] { 0.04 } else { 0.0 };
        assert!((order.efficiency.s.value - expected).abs() < 1e-4, "{order:?}");
        assert!((order.efficiency.p.value - expected).abs() < 1e-4, "{order:?}");
    }
}

#[test]
fn a_shallow_mirror_keeps_its_power() {
    let points: Vec<[f64; 2]> =
        (0..=64).map(|i| [125.0 * f64::from(i), 40.0 * (f64::from(i) / 64.0 * std::f64::consts::TAU).cos()]).collect();
    let obj = extruded(&points, 500.0, &[("s", 0.0)]);
    let scene = cell(&obj, [8000.0, 500.0], &[("s", "above = 1.0\nbelow = \"mirror\"".into())]);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let request =
        OrdersRequest { rays: RAYS, seed: 1, max_order: Some(40), hits: HITS, precision: Precision::F64, threads: 2 };
    let found = orders(&mesh_scene, towards(20.0, 180.0), &[550.0], &request, &|| ()).expect("a good mesh").orders;
    let sum: f64 = found.iter().map(|order| 0.5 * (order.efficiency.s.value + order.efficiency.p.value)).sum();
    assert!((sum - 1.0).abs() < 0.01, "{sum}");
}
