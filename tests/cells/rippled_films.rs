//! Rippled thin films with coherence `ray`: what they reflect depends on the film, not on the bins.

use std::f64::consts::TAU;

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Scattered, scatter};
use num_complex::Complex64;

use crate::height_field::HeightField;
use crate::scene::towards;

const PERIOD_NM: f64 = 40_000.0;
/// Number of squares along each side: neighbouring facets turn by up to 3° at the largest slope.
const SQUARES: usize = 64;
const WAVELENGTH_NM: f64 = 550.0;

/// A film that follows a sum of three sines of this root mean square slope.
fn film(rms_slope: f64, thickness_nm: f64, [index, substrate]: [f64; 2]) -> HeightField {
    // Numbers of waves along x and y, and phase. Each sine has the mean square slope 3⁻¹ rms_slope².
    const WAVES: [([f64; 2], f64); 3] = [([1.0, 2.0], 0.3), ([-2.0, 1.0], 1.1), ([3.0, 0.0], 2.0)];
    let height = |x: f64, y: f64| -> f64 {
        let sine = |&([m, n], phase): &([f64; 2], f64)| {
            let slope = (2.0f64 / 3.0).sqrt() * rms_slope * PERIOD_NM / TAU;
            slope / m.hypot(n) * (TAU * (m * x + n * y) + phase).sin()
        };
        WAVES.iter().map(sine).sum()
    };
    let along = |i: usize| i as f64 / SQUARES as f64;
    let heights_nm = (0..SQUARES * SQUARES).map(|i| height(along(i % SQUARES), along(i / SQUARES))).collect();
    HeightField {
        period_nm: [PERIOD_NM; 2],
        squares: [SQUARES; 2],
        heights_nm,
        depths_nm: vec![thickness_nm],
        media: vec![[1.0, 0.0], [index, 0.0], [substrate, 0.0]],
    }
}

/// What one film reflects of unpolarised light that meets it at the cosine `cos`, after Airy.
fn airy([index, substrate]: [f64; 2], thickness_nm: f64, cos: f64) -> f64 {
    let inside = |n: f64| (1.0 - (1.0 - cos * cos) / (n * n)).sqrt();
    let (c, s) = (inside(index), inside(substrate));
    let round_trip = Complex64::from_polar(1.0, 2.0 * TAU * index * thickness_nm * c / WAVELENGTH_NM);
    let of = |r: [f64; 2]| ((r[0] + r[1] * round_trip) / (1.0 + r[0] * r[1] * round_trip)).norm_sqr();
    let r_s = |a: f64, cos_a: f64, b: f64, cos_b: f64| (a * cos_a - b * cos_b) / (a * cos_a + b * cos_b);
    let r_p = |a: f64, cos_a: f64, b: f64, cos_b: f64| (b * cos_a - a * cos_b) / (b * cos_a + a * cos_b);
    let pair = |r: &dyn Fn(f64, f64, f64, f64) -> f64| of([r(1.0, cos, index, c), r(index, c, substrate, s)]);
    0.5 * (pair(&r_s) + pair(&r_p))
}

/// The mean over facets, weighted by their area seen from `wi`, of what the local film reflects: its thickness is the
/// vertical one times the cosine of the slope.
fn local_films(field: &HeightField, wi: DVec3) -> f64 {
    let corner = |i: usize, j: usize| {
        let step = PERIOD_NM / SQUARES as f64;
        DVec3::new(i as f64 * step, j as f64 * step, field.heights_nm[j % SQUARES * SQUARES + i % SQUARES])
    };
    let indices = [field.media[1][0], field.media[2][0]];
    let [mut sum, mut whole] = [0.0; 2];
    for (i, j) in (0..SQUARES).flat_map(|i| (0..SQUARES).map(move |j| (i, j))) {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        for area in [(b - a).cross(c - a), (c - a).cross(d - a)] {
            let (seen, normal) = (area.dot(wi).max(0.0), area.normalize());
            whole += seen;
            if seen > 0.0 {
                sum += seen * airy(indices, field.depths_nm[0] * normal.z, normal.dot(wi));
            }
        }
    }
    sum / whole
}

/// The light that a film scatters into so many bins in cos θ, and twice as many in φ.
fn scattered(field: &HeightField, wi: DVec3, cos: u32, precision: Precision) -> Scattered {
    let scene = field.scene();
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let bins = DirectionBins { cos, phi: 2 * cos };
    let request = ScatterRequest { coherence: Coherence::Ray, rays: 8192, seed: 0, bins, precision, threads: 2 };
    scatter(&mesh_scene, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0)
}

#[test]
fn what_a_film_reflects_does_not_depend_on_the_bins_in_any_digit() {
    for precision in [Precision::F32, Precision::F64] {
        let field = film(0.2, 420.0, [1.33, 1.0]);
        let [coarse, fine] = [8, 128].map(|cos| scattered(&field, towards(20.0, 50.0), cos, precision));
        assert_eq!(coarse.reflected, fine.reflected);
        assert_eq!(coarse.transmitted, fine.transmitted);
        let sum: f64 = fine.bins.iter().map(|bin| bin.value).sum();
        assert!((sum - fine.reflected.value).abs() < 1e-12, "{sum} {:?}", fine.reflected);
    }
}

/// Facets interfere with their neighbours, and light walks within the film: neither is in the mean over local films.
#[test]
fn a_rippled_film_reflects_what_its_local_films_do_and_keeps_power() {
    const MAX_IMBALANCE: f64 = 0.005;
    let (mut worst, mut imbalance) = (0.0f64, 0.0f64);
    for indices in [[1.33, 1.0], [1.6, 1.5], [2.4, 1.5], [1.5, 4.0]] {
        for (rms_slope, thickness_nm) in [(0.05, 200.0), (0.1, 900.0), (0.2, 420.0), (0.3, 300.0), (0.3, 900.0)] {
            for theta_deg in [0.0, 30.0] {
                let (field, wi) = (film(rms_slope, thickness_nm, indices), towards(theta_deg, 70.0));
                let found = scattered(&field, wi, 8, Precision::F32);
                let expected = local_films(&field, wi);
                let allowed = 0.1 * expected + 0.002 + 4.0 * found.reflected.std_error;
                let apart = (found.reflected.value - expected).abs();
                let case = format!("n {indices:?}, slope {rms_slope}, {thickness_nm} nm, {theta_deg}°");
                assert!(apart <= allowed, "{case}: R = {}, local films {expected}", found.reflected.value);
                let lost = found.imbalance.value.abs() - 4.0 * found.imbalance.std_error;
                assert!(lost <= MAX_IMBALANCE, "{case}: {:?}", found.imbalance);
                worst = worst.max(apart / allowed);
                imbalance = imbalance.max(lost);
            }
        }
    }
    println!("rippled films: off by up to {worst:.2} of what is allowed, imbalance up to {imbalance:.4}");
}
