//! The Fourier modal method against efficiencies from an independent program.

use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::profile::{Profile, Slice};
use serde_json::Value;

use crate::data::{index, largest_difference, list, number, read};

/// Profile of a case of `waves.json`.
pub fn profile(case: &Value) -> Profile {
    let period_nm = number(case, "period_nm");
    let slice = |layer: &Value| Slice {
        thickness_nm: number(layer, "thickness_nm"),
        edges_nm: {
            let edges = list(layer, "edges");
            edges[..edges.len() - 1].iter().map(|edge| edge.as_f64().expect("edge") * period_nm).collect()
        },
        eta: list(layer, "n").iter().map(index).collect(),
    };
    Profile {
        period_nm,
        above: index(&case["above"]).re,
        below: index(&case["below"]),
        slices: list(case, "layers_from_top").iter().map(slice).collect(),
    }
}

/// Tangential wavevector of light from a direction in degrees, in air.
pub fn tangential(theta: f64, phi: f64) -> [f64; 2] {
    let (sin, cos) = phi.to_radians().sin_cos();
    [-theta.to_radians().sin() * cos, -theta.to_radians().sin() * sin]
}

/// Largest difference of a case from its record at a truncation.
fn difference(name: &str, max_order: usize) -> f64 {
    let waves = read("waves.json");
    let case = list(&waves, "cases").iter().find(|case| case["name"] == name).expect("case");
    let profile = profile(case);
    let mut largest = 0.0_f64;
    for record in list(case, "data") {
        let [kx, ky] = tangential(number(record, "theta_deg"), number(record, "phi_deg"));
        let modes = Modes::new(&profile, number(record, "wavelength_nm"), kx, max_order).expect("modes");
        let response = modes.response(ky).expect("response");
        let found = largest_difference(&response, record);
        println!(
            "{name} {max_order} {} {} {}: {found:.1e}",
            record["wavelength_nm"], record["theta_deg"], record["phi_deg"]
        );
        largest = largest.max(found);
    }
    largest
}

/// Largest difference of a lamellar case of `gratings.json` from its record at a truncation.
fn grating(name: &str, max_order: usize) -> f64 {
    let gratings = read("gratings.json");
    let case = list(&gratings, "cases").iter().find(|case| case["name"] == name).expect("case");
    let below = index(&case["n_substrate"]);
    let slice = Slice {
        thickness_nm: number(case, "depth_nm"),
        edges_nm: vec![0.0, number(&case["profile"], "ridge_width_nm")],
        eta: vec![below, 1.0.into()],
    };
    let profile = Profile { period_nm: number(case, "period_nm"), above: 1.0, below, slices: vec![slice] };
    let mut largest = 0.0_f64;
    for record in list(case, "data") {
        // There light travels towards +x.
        let [kx, ky] = tangential(-number(record, "theta_deg"), 0.0);
        let modes = Modes::new(&profile, number(record, "wavelength_nm"), kx, max_order).expect("modes");
        largest = largest.max(largest_difference(&modes.response(ky).expect("response"), record));
    }
    println!("{name} {max_order}: {largest:.1e}");
    largest
}

#[test]
fn lamellar_glass() {
    assert!(grating("a_lamellar_glass", 40) <= 1e-3);
}

#[test]
fn lamellar_silver() {
    assert!(grating("b_lamellar_silver", 90) <= 5e-3);
}

#[test]
fn disc_of_aluminium() {
    assert!(grating("c_cd_aluminium", 60) <= 5e-3);
}

#[test]
fn dielectric_ridge() {
    assert!(difference("dielectric_ridge", 30) <= 3e-4);
}

#[test]
fn morpho_ridge() {
    assert!(difference("morpho_ridge", 20) <= 3e-4);
}

#[test]
fn silicon_lines() {
    assert!(difference("silicon_lines", 40) <= 2e-3);
}

#[test]
fn aluminium_track() {
    assert!(difference("aluminium_track", 60) <= 5e-3);
}
