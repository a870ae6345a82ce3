//! What the four coherences say of a flat film, where each has a known answer.

use goniochrome::bins::DirectionBins;
use goniochrome_cli::bumpy::Bumpy;
use goniochrome_cli::coherent::{scatter_bins, scatter_orders};
use goniochrome_cli::estimate::Precision;
use goniochrome_cli::scatter::{Coherence, Request, Scattered, scatter};

use crate::scene::{between, cell, extruded, towards};

const THETA_DEG: f64 = 40.0;
const WAVELENGTH_NM: f64 = 550.0;
const INDEX: f64 = 1.5;
const THICKNESS_NM: f64 = 300.0;
/// Waves below 1e-13 are dropped; orders are followed for 64 hits, 0.2⁶⁴.
const DROPPED: f64 = 1e-6;

fn found(coherence: Coherence) -> Scattered {
    let flat = extruded(&[[0.0, 0.0], [3000.0, 0.0]], 3000.0, &[("top", 0.0), ("bottom", THICKNESS_NM)]);
    let interfaces = [("top", between([1.0, 0.0], [INDEX, 0.0])), ("bottom", between([INDEX, 0.0], [1.0, 0.0]))];
    let scene = cell(&flat, [3000.0, 3000.0], &interfaces);
    let bumpy = Bumpy::new(&scene).expect("a good mesh");
    let bins = DirectionBins { cos: 8, phi: 16 };
    let request = Request { coherence, rays: 1024, seed: 3, bins, precision: Precision::F64, threads: 2 };
    let wi = towards(THETA_DEG, 100.0);
    match coherence {
        Coherence::Bin => scatter_bins(&bumpy, wi, WAVELENGTH_NM, &request).expect("a good mesh"),
        Coherence::Cell => scatter_orders(&bumpy, wi, WAVELENGTH_NM, &request, 64).expect("a good mesh"),
        _ => scatter(&bumpy, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0),
    }
}

/// R of s and p of one face.
fn fresnel() -> [f64; 2] {
    let (sin, cos) = THETA_DEG.to_radians().sin_cos();
    let inside = (1.0 - (sin / INDEX).powi(2)).sqrt();
    [(cos - INDEX * inside) / (cos + INDEX * inside), (INDEX * cos - inside) / (INDEX * cos + inside)].map(|r| r * r)
}

#[test]
fn where_paths_interfere_a_flat_film_is_airys() {
    let sin = THETA_DEG.to_radians().sin();
    let phase = 2.0 * std::f64::consts::TAU * THICKNESS_NM / WAVELENGTH_NM * (INDEX * INDEX - sin * sin).sqrt();
    let airy = fresnel().map(|r| {
        let f = 4.0 * r / (1.0 - r).powi(2) * (0.5 * phase).sin().powi(2);
        f / (1.0 + f)
    });
    let expected = 0.5 * (airy[0] + airy[1]);
    for coherence in [Coherence::Ray, Coherence::Bin, Coherence::Cell] {
        let found = found(coherence);
        println!("{coherence:?}: {} for {expected}", found.reflected.value);
        // Orders in which nothing leaves hold noise, of either sign.
        let allowed = DROPPED + 4.0 * found.reflected.std_error;
        assert!((found.reflected.value - expected).abs() < allowed, "{coherence:?}");
        let strongest = found.bins.iter().map(|bin| bin.value).fold(0.0, f64::max);
        assert!((strongest - expected).abs() < allowed, "{coherence:?}: all in one bin");
        if coherence != Coherence::Cell {
            assert!((found.transmitted.value - (1.0 - expected)).abs() < DROPPED, "{coherence:?}");
        }
    }
}

#[test]
fn a_starting_ray_whose_waves_have_no_sum_is_followed_without_interference() {
    // Glass, a gap of air, silver: beyond the critical angle the wave in the gap decays, and near the plasmon of silver its reflection is so
    // strong that every loop through the gap gains.
    let flat = extruded(&[[0.0, 0.0], [3000.0, 0.0]], 3000.0, &[("glass", 0.0), ("silver", 20.0)]);
    let interfaces = [("glass", between([1.5, 0.0], [1.0, 0.0])), ("silver", between([1.0, 0.0], [0.055, 3.32]))];
    let scene = cell(&flat, [3000.0, 3000.0], &interfaces);
    let bumpy = Bumpy::new(&scene).expect("a good mesh");
    let bins = DirectionBins { cos: 8, phi: 16 };
    let request = |coherence| Request { coherence, rays: 1024, seed: 3, bins, precision: Precision::F64, threads: 2 };
    let found = |coherence| {
        let found = scatter(&bumpy, towards(THETA_DEG + 10.0, 100.0), &[WAVELENGTH_NM], &request(coherence), &|| ());
        found.expect("what has no sum is not an error").remove(0)
    };
    let (ray, none) = (found(Coherence::Ray), found(Coherence::None));
    assert_eq!((ray.without_interference.value, none.without_interference.value), (1.0, 0.0));
    // Without interference the wave in the gap is alone, and everything comes back.
    for found in [&ray, &none] {
        assert!((found.reflected.value - 1.0).abs() < 1e-12 && found.imbalance.value.abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn without_interference_the_faces_add_as_powers() {
    let expected = fresnel().map(|r| 2.0 * r / (1.0 + r)).iter().sum::<f64>() / 2.0;
    let found = found(Coherence::None);
    // Weak paths play roulette.
    let allowed = 4.0 * found.reflected.std_error + DROPPED;
    assert!((found.reflected.value - expected).abs() <= allowed, "{:?} for {expected}", found.reflected);
}
