//! Tests of coherence `none` against an independent polarised path tracer, bin by bin.

use goniochrome::measure::bins::DirectionBins;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, scatter};
use serde_json::Value;

use crate::scene::{between, cell, towards};

/// Standard errors by which a total or a bin may differ.
const SIGMAS: f64 = 4.0;
/// Share of bins that may differ by more than three standard errors.
const BEYOND_THREE: f64 = 0.01;
/// Allowed imbalance of a lossless ledger besides the power truncated.
const LEDGER: f64 = 1e-4;
/// Power that may be truncated.
const TRUNCATED: f64 = 1e-4;
const RAYS: u32 = 32_768;

fn holds(name: &str, obj: &str, reference: &str, interfaces: &[(&str, String)]) {
    let reference: Value = serde_json::from_str(reference).expect("the reference is JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    let period = [0, 1].map(|axis| number(&reference["period_nm"][axis]));
    let scene = cell(obj, period, interfaces);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let grid = DirectionBins { cos: 8, phi: 16 };
    let (mut compared, mut beyond_three) = (0u32, 0u32);
    for case in reference["cases"].as_array().expect("cases") {
        let wi = towards(number(&case["theta_deg"]), number(&case["phi_deg"]));
        let request = ScatterRequest {
            coherence: Coherence::None,
            rays: RAYS,
            seed: 1,
            bins: grid,
            precision: Precision::F64,
            threads: 2,
        };
        let found = &scatter(&mesh_scene, wi, &[550.0], &request, &|| ()).expect("a good mesh")[0];

        // Rays that the reference lost at edges are missing from its totals.
        let lost = number(&case["lost_power"]) + number(&case["truncated_power"]);
        for (what, got, key) in [("R", found.reflected, "R"), ("T", found.transmitted, "T")] {
            let (want, error) = (number(&case[key]), number(&case[format!("{key}_se")]));
            let allowed = SIGMAS * got.std_error.hypot(error) + lost;
            let (theta, difference) = (&case["theta_deg"], got.value - want);
            println!("{name} {theta}: {what} {:.6}, off by {difference:.1e} of {allowed:.1e}", got.value);
            assert!(difference.abs() <= allowed, "{name} at {theta}: {what} = {} for {want}", got.value);
        }
        let ledger = found.imbalance.value.abs();
        assert!(ledger <= LEDGER + found.truncated.value, "{name}: the ledger misses {ledger:e}");
        assert!(found.truncated.value <= TRUNCATED, "{name}: truncated {:e}", found.truncated.value);

        for bins in groups(case, grid) {
            let sum = |of: &dyn Fn(usize) -> f64| bins.iter().map(|&bin| of(bin)).sum::<f64>();
            let entry = |key: &str, bin: usize| number(&case[key][bin / 16][bin % 16]);
            let difference = sum(&|bin| found.bins[bin].value - entry("reflected", bin));
            let variance = sum(&|bin| found.bins[bin].std_error.powi(2) + entry("reflected_se", bin).powi(2));
            // A bin into which no ray fell may hold the power of one ray.
            let sigma = variance.sqrt().max(1.0 / f64::from(RAYS));
            let sigmas = (difference.abs() - lost).max(0.0) / sigma;
            assert!(sigmas <= SIGMAS, "{name}: bins {bins:?} are {sigmas:.1} standard errors off");
            compared += 1;
            beyond_three += u32::from(sigmas > 3.0);
        }
    }
    println!("{name}: {beyond_three} of {compared} bins beyond three standard errors");
    assert!(f64::from(beyond_three) <= BEYOND_THREE * f64::from(compared));
}

/// The groups of bins to compare: single bins, except those that share a lobe on their common edge.
fn groups(case: &Value, grid: DirectionBins) -> Vec<Vec<usize>> {
    let place = |bin: &Value| {
        let [i, j] = [0, 1].map(|axis| bin[axis].as_u64().expect("a bin") as usize);
        i * grid.phi as usize + j
    };
    let merged: Vec<Vec<usize>> = case["merge_groups"]
        .as_array()
        .expect("groups")
        .iter()
        .map(|group| group["bins"].as_array().expect("bins").iter().map(place).collect())
        .collect();
    let alone = (0..grid.count()).filter(|bin| !merged.iter().any(|group| group.contains(bin)));
    alone.map(|bin| vec![bin]).chain(merged.clone()).collect()
}

#[test]
fn grooves_of_mirror() {
    holds(
        "vgroove-mirror",
        include_str!("../data/cells/vgroove-mirror.obj"),
        include_str!("../data/cells/vgroove-mirror.json"),
        &[("mirror_surface", "above = 1.0\nbelow = \"mirror\"".into())],
    );
}

#[test]
fn bumps_of_glass() {
    holds(
        "bumps-glass",
        include_str!("../data/cells/bumps-glass.obj"),
        include_str!("../data/cells/bumps-glass.json"),
        &[("surface", between([1.0, 0.0], [1.5, 0.0]))],
    );
}

#[test]
fn a_bumpy_film() {
    holds(
        "bumpy-film",
        include_str!("../data/cells/bumpy-film.obj"),
        include_str!("../data/cells/bumpy-film.json"),
        &[("upper", between([1.0, 0.0], [1.6, 0.0])), ("lower", between([1.6, 0.0], [1.0, 0.0]))],
    );
}
