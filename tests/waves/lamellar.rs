//! The Fourier modal method against efficiencies from an independent program.

use goniochrome_waves::Complex64;
use goniochrome_waves::WaveError;
use goniochrome_waves::convergence::{Goal, converge};
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

/// Aluminium by error bars: within what is stated for each record and what the reference changed by.
#[test]
fn error_bars_hold_for_the_recorded_cases() {
    let waves = read("waves.json");
    for (name, target, first, limit) in [("silicon_lines", 1e-3, 7, 40), ("aluminium_track", 5e-3, 15, 54)] {
        let case = list(&waves, "cases").iter().find(|case| case["name"] == name).expect("case");
        let profile = profile(case);
        for record in list(case, "data") {
            let [kx, ky] = tangential(number(record, "theta_deg"), number(record, "phi_deg"));
            let wavelength = number(record, "wavelength_nm");
            let solve =
                |max_order| Ok::<_, WaveError>(vec![Modes::new(&profile, wavelength, kx, max_order)?.response(ky)?]);
            let found = converge(Goal { target, first, limit }, solve).expect("a response");
            let error = largest_difference(&found.responses[0], record);
            let known = number(record, "change_between_truncations");
            assert!(error <= found.error_bar + known, "{name} {record}: {error:e} {:e}", found.error_bar);
        }
    }
}

#[test]
fn slices_that_differ_by_a_shift_share_a_decomposition() {
    let slice = |from: f64, to: f64, thickness_nm: f64| Slice {
        thickness_nm,
        edges_nm: vec![from, to],
        eta: vec![Complex64::new(1.56, 0.06), 1.0.into()],
    };
    let over_the_end = Slice { eta: vec![1.0.into(), Complex64::new(1.56, 0.06)], ..slice(50.0, 550.0, 80.0) };
    let stack = |slices: Vec<Slice>| Profile { period_nm: 700.0, above: 1.0, below: 1.56.into(), slices };
    let shared = stack(vec![slice(100.0, 300.0, 60.0), slice(350.0, 550.0, 70.0), over_the_end.clone()]);
    // Edges that differ by more than rounding do not share.
    let apart = stack(vec![slice(100.0, 300.0, 60.0), slice(350.0, 550.0 + 1e-7, 70.0), over_the_end]);
    let solve = |profile: &Profile, count: usize| {
        let modes = Modes::new(profile, 500.0, 0.3, 8).expect("modes");
        assert_eq!(modes.decompositions(), count);
        modes.response(0.4).expect("response")
    };
    // The third slice, from 550 to 750, is as wide too.
    let (shared, apart) = (solve(&shared, 1), solve(&apart, 2));
    for (one, other) in shared.reflected.iter().zip(&apart.reflected) {
        for (one, other) in one.jones.as_flattened().iter().zip(other.jones.as_flattened()) {
            // The edge of 1e-7 nm is 1e-9 of a wavelength.
            assert!((one - other).norm() <= 1e-8, "{one} {other}");
        }
    }
    let morpho = read("waves.json");
    let case = list(&morpho, "cases").iter().find(|case| case["name"] == "morpho_ridge").expect("case");
    assert_eq!(Modes::new(&profile(case), 500.0, 0.0, 3).expect("modes").decompositions(), 9);
}
