//! Tests of the four coherences on a flat film, where each has a known result, and on small cells.

use goniochrome::colour::RgbSpace;
use goniochrome::measure::bins::DirectionBins;
use goniochrome_cli::solve::cell_table::{TableRequest, estimate};
use goniochrome_cli::solve::diffraction;
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Scattered, Tracing, scatter};
use goniochrome_cli::support::error::Result;
use goniochrome_cli::table::scatter::ScatterTable;

use crate::height_field::HeightField;
use crate::scene::{between, cell, extruded, towards};

const THETA_DEG: f64 = 40.0;
const WAVELENGTH_NM: f64 = 550.0;
const INDEX: f64 = 1.5;
const THICKNESS_NM: f64 = 300.0;
/// Bound of dropped waves: those below 1e-13, and those of orders after 64 hits, 0.2⁶⁴.
const DROPPED: f64 = 1e-6;

fn found(coherence: Coherence) -> Scattered {
    let flat = extruded(&[[0.0, 0.0], [3000.0, 0.0]], 3000.0, &[("top", 0.0), ("bottom", THICKNESS_NM)]);
    let interfaces = [("top", between([1.0, 0.0], [INDEX, 0.0])), ("bottom", between([INDEX, 0.0], [1.0, 0.0]))];
    let scene = cell(&flat, [3000.0, 3000.0], &interfaces);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let bins = DirectionBins { cos: 8, phi: 16 };
    let request = ScatterRequest { coherence, rays: 1024, seed: 3, bins, precision: Precision::F64, threads: 2 };
    let wi = towards(THETA_DEG, 100.0);
    scatter(&mesh_scene, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0)
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
        // Orders without light hold noise of either sign.
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
    // Glass, a gap of air, silver: beyond the critical angle the wave in the gap decays. Near silver's plasmon its
    // reflection is so strong that every loop through the gap gains.
    let flat = extruded(&[[0.0, 0.0], [3000.0, 0.0]], 3000.0, &[("glass", 0.0), ("silver", 20.0)]);
    let interfaces = [("glass", between([1.5, 0.0], [1.0, 0.0])), ("silver", between([1.0, 0.0], [0.055, 3.32]))];
    let scene = cell(&flat, [3000.0, 3000.0], &interfaces);
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let bins = DirectionBins { cos: 8, phi: 16 };
    let request =
        |coherence| ScatterRequest { coherence, rays: 1024, seed: 3, bins, precision: Precision::F64, threads: 2 };
    let found = |coherence| {
        let found =
            scatter(&mesh_scene, towards(THETA_DEG + 10.0, 100.0), &[WAVELENGTH_NM], &request(coherence), &|| ());
        found.expect("what has no sum is not an error").remove(0)
    };
    let (ray, none) = (found(Coherence::Ray), found(Coherence::None));
    assert_eq!((ray.without_interference.value, none.without_interference.value), (1.0, 0.0));
    // Without interference the wave in the gap carries no power, and everything is reflected.
    for found in [&ray, &none] {
        assert!((found.reflected.value - 1.0).abs() < 1e-12 && found.imbalance.value.abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn without_interference_the_faces_add_as_powers() {
    let expected = fresnel().map(|r| 2.0 * r / (1.0 + r)).iter().sum::<f64>() / 2.0;
    let found = found(Coherence::None);
    // Roulette on weak paths adds noise.
    let allowed = 4.0 * found.reflected.std_error + DROPPED;
    assert!((found.reflected.value - expected).abs() <= allowed, "{:?} for {expected}", found.reflected);
}

/// Bins of outgoing directions.
const BINS: DirectionBins = DirectionBins { cos: 4, phi: 8 };

/// The table of a cell at one wavelength, whose power is the luminance.
fn table(mesh_scene: &MeshScene<'_>, incident_phi: u32, tracing: Tracing) -> Result<ScatterTable> {
    let request = TableRequest {
        incident: [3, incident_phi],
        half_vectors: [4, 8],
        tracing,
        target_error: None,
        weights: &[[0.0, 1.0, 0.0]],
        space: RgbSpace::Srgb,
        share: None,
        reciprocal: false,
    };
    estimate(mesh_scene, &[WAVELENGTH_NM], &request, None, &|| ())
}

/// Small cells of one sheet and of two, with different heights.
fn small_cells() -> Vec<HeightField> {
    let cell = |i: usize| {
        let heights_nm = (0..4).map(|j| 40.0 * ((7 * i + 5 * j) % 11) as f64).collect();
        let film = i % 2 == 1;
        let depths_nm = if film { vec![300.0 + 50.0 * i as f64] } else { Vec::new() };
        let media = [[1.0, 0.0], [1.5, 0.002], [1.2, 0.0]];
        let media = media[..depths_nm.len() + 2].to_vec();
        HeightField { period_nm: [3000.0, 2000.0 + 100.0 * i as f64], squares: [2, 2], heights_nm, depths_nm, media }
    };
    (0..4).map(cell).collect()
}

/// Rays are divided into strata some 16 000 at a time. However many there are, all are traced, and in little memory.
#[test]
fn every_ray_that_is_asked_for_is_traced() {
    let cells = small_cells();
    let scene = cells[0].scene();
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let (coherence, precision) = (Coherence::None, Precision::F32);
    let of = |rays| {
        let tracing = Tracing { coherence, rays, seed: 2, precision, threads: 1 };
        table(&mesh_scene, 2, tracing).expect("a good mesh").energy
    };
    // 16 384, and the rest.
    let (few, many) = (of(2048), of(20_000));
    for (few, many) in few.iter().zip(&many) {
        assert_eq!((few.rays, many.rays), (2048, 20_000));
        let error = few.reflected.std_error.hypot(many.reflected.std_error);
        assert!((few.reflected.value - many.reflected.value).abs() <= 5.0 * error, "{few:?} {many:?}");
    }
}

/// Facets are planes, so what one sheet reflects leaves in lobes, whose directions fall into single bins of `scatter`.
#[test]
fn a_direction_of_a_table_is_what_scatter_finds_whatever_the_coherence() {
    /// Standard errors of the difference of two estimates beyond which none of some hundred lies by chance.
    const SIGMAS: f64 = 5.0;
    /// Share of the light of one ray of each estimate, where none was found by chance.
    const ONE_RAY: f64 = 1.0 / 2048.0;
    let mut lit = 0;
    for (number, field) in small_cells().iter().enumerate() {
        let scene = field.scene();
        let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
        for coherence in [Coherence::Ray, Coherence::None] {
            let request =
                ScatterRequest { coherence, rays: 2048, seed: 5, bins: BINS, precision: Precision::F64, threads: 1 };
            let table = table(&mesh_scene, 4, request.tracing()).expect("a good mesh");
            let incident = 4 + number;
            let [theta, phi] = table.layout.incident(incident);
            let wi = towards(theta.to_degrees(), phi.to_degrees());
            let found = scatter(&mesh_scene, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0);
            let energy = &table.energy[incident];
            let reflected_error = energy.reflected.std_error.hypot(found.reflected.std_error);
            for (ours, theirs, error) in [
                (energy.reflected.value, found.reflected.value, reflected_error),
                // Half of the difference is that of `scatter`: the table keeps no error of these.
                (energy.transmitted, found.transmitted.value, 2.0 * found.transmitted.std_error),
                (energy.absorbed, found.absorbed.value, 2.0 * found.absorbed.std_error),
            ] {
                let allowed = SIGMAS * error + ONE_RAY;
                assert!((ours - theirs).abs() < allowed, "{coherence:?} {field:?}: {energy:?} {found:?}");
            }
            if !field.depths_nm.is_empty() {
                continue;
            }
            let lookup = table.spectral_lookup().expect("a good warp");
            let lookup = lookup.table().expect("good values");
            let (mut power, mut variance, mut rho) = ([0.0; 32], [0.0; 32], [0.0]);
            for lobe in 0..table.layout.lobes() {
                if let Some(wo) = lookup.reflected(wi.as_vec3(), lobe, &mut rho) {
                    let error =
                        table.luminance_error[incident * table.layout.places() + table.layout.node_count() + lobe];
                    power[BINS.index(wo.as_dvec3())] += f64::from(rho[0]);
                    variance[BINS.index(wo.as_dvec3())] += f64::from(error).powi(2);
                }
            }
            for (bin, found) in found.bins.iter().enumerate() {
                let allowed = SIGMAS * found.std_error.hypot(variance[bin].sqrt()) + ONE_RAY;
                let (ours, theirs) = (power[bin], found.value);
                assert!((ours - theirs).abs() < allowed, "{coherence:?}, bin {bin}: {ours} {theirs}");
                lit += usize::from(theirs > 0.001);
            }
        }
    }
    assert!(lit >= 12, "{lit}");
}

#[test]
fn the_coherences_of_a_bumpy_film_differ() {
    let scene = goniochrome_cli::scene::load("bumpy-soap-film").expect("a preset");
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let [ray, none, bin] = [Coherence::Ray, Coherence::None, Coherence::Bin].map(|coherence| {
        let request =
            ScatterRequest { coherence, rays: 128, seed: 0, bins: BINS, precision: Precision::F32, threads: 2 };
        scatter(&mesh_scene, towards(0.0, 0.0), &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0)
    });
    let far = |a: &Scattered, b: &Scattered| {
        (a.reflected.value - b.reflected.value).abs() > 5.0 * a.reflected.std_error.hypot(b.reflected.std_error)
    };
    assert!(far(&ray, &none) && far(&none, &bin) && far(&ray, &bin), "{ray:?} {none:?} {bin:?}");
}

/// An isotropic table averages its azimuths as powers, also where starting rays interfere.
#[test]
fn an_isotropic_table_of_interfering_rays_keeps_what_each_azimuth_reflects() {
    let flat = HeightField {
        period_nm: [3000.0, 2000.0],
        squares: [1, 1],
        heights_nm: vec![0.0],
        depths_nm: vec![THICKNESS_NM],
        media: vec![[1.0, 0.0], [INDEX, 0.0], [1.0, 0.0]],
    };
    let scene = flat.scene();
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let tracing = Tracing { coherence: Coherence::Bin, rays: 64, seed: 0, precision: Precision::F64, threads: 1 };
    let [one, four] = [1, 4].map(|phi| table(&mesh_scene, phi, tracing).expect("a good mesh"));
    for theta in 0..3 {
        let (one_azimuth, isotropic) = (four.energy[4 * theta], one.energy[theta]);
        assert!((one_azimuth.reflected.value - isotropic.reflected.value).abs() < DROPPED, "{isotropic:?}");
        assert_eq!(isotropic.rays, 1024, "one ray in each batch of each azimuth");
    }
}

#[test]
fn a_table_of_orders_is_refused_with_the_command_that_computes_them() {
    let scene = small_cells()[0].scene();
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let tracing = Tracing { coherence: Coherence::Cell, rays: 64, seed: 0, precision: Precision::F64, threads: 1 };
    let error = table(&mesh_scene, 4, tracing).unwrap_err();
    assert!(error.exit_code() == 2 && error.to_string().contains("use orders"), "{error}");
}

#[test]
fn single_precision_is_honoured_where_starting_rays_interfere() {
    /// Rounding of sums of some thousand fields of magnitude 1.
    const SINGLE: f64 = 1e-5;
    let scene = small_cells()[1].scene();
    let mesh_scene = MeshScene::new(&scene).expect("a good mesh");
    let wi = towards(THETA_DEG, 100.0);
    let bins = [Precision::F32, Precision::F64].map(|precision| {
        let request =
            ScatterRequest { coherence: Coherence::Bin, rays: 256, seed: 3, bins: BINS, precision, threads: 1 };
        scatter(&mesh_scene, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh").remove(0).reflected.value
    });
    let orders = [Precision::F32, Precision::F64].map(|precision| {
        let request =
            diffraction::OrdersRequest { rays: 256, seed: 3, max_order: None, hits: 64, precision, threads: 1 };
        let found = diffraction::orders(&mesh_scene, wi, &[WAVELENGTH_NM], &request, &|| ()).expect("a good mesh");
        found.orders.iter().map(|order| order.efficiency.s.value).fold(0.0, f64::max)
    });
    for [single, double] in [bins, orders] {
        let apart = (single - double).abs();
        assert!(apart > 0.0 && apart < SINGLE && double > 0.001, "{single} {double}");
    }
}
