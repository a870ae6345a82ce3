//! Tables of the presets between their directions, against direct tracing counted in the same places.

use glam::DVec3;
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace};
use goniochrome::table::{HalfVectorGrid, HalfVectorWarp, tent_solid_angles};
use goniochrome_cli::colour::visible_weights;
use goniochrome_cli::scene::load;
use goniochrome_cli::solve::cell_table::{Sides, TableRequest, default_rays, default_sides, estimate, lobe_directions};
use goniochrome_cli::solve::mesh_scene::MeshScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::scatter::{Coherence, ScatterRequest, Tracing, scatter};
use goniochrome_cli::table::scatter::ScatterTable;

const WAVELENGTH_NM: [f64; 1] = [550.0];
/// Starting rays of the reference: its noise is a fifth of the limits, or less.
const RAYS: u32 = 1 << 16;
/// Angles θ and φ of the light in degrees, away from the tables' directions.
const DIRECTIONS: [[f64; 2]; 6] =
    [[34.0, 15.0], [56.0, 15.0], [34.0, 45.0], [56.0, 75.0], [51.8, 271.8], [17.5, 278.8]];

fn direction([theta, phi]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.to_radians().sin_cos(), phi.to_radians().sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// The power that the table sends into each place for light from `wi`.
fn powers(table: &ScatterTable, warp: &HalfVectorWarp<'_>, wi: DVec3) -> Vec<f64> {
    let (layout, wi) = (table.layout, wi.as_vec3());
    let columns = layout.square_sides()[0] as usize;
    let incident = layout.incident_nodes(wi);
    let value = |place: usize| -> f64 {
        incident.iter().map(|node| f64::from(node.weight * table.row(node.index, 0)[place])).sum()
    };
    let mut powers: Vec<f64> =
        (0..layout.places()).map(|place| if place < layout.node_count() { 0.0 } else { value(place) }).collect();
    tent_solid_angles(&layout, warp, wi, layout.origin(wi), |node, part| {
        // All nodes at the normal are one place.
        let place = if node % columns == 0 { 0 } else { node };
        powers[place] += value(node) * f64::from(part / wi.z);
    });
    powers
}

/// Σ |difference| / Σ power at each direction, and the relative difference of the albedo.
fn differences(name: &str) -> Vec<[f64; 2]> {
    let scene = load(name).unwrap();
    let mesh_scene = MeshScene::new(&scene).unwrap();
    let weights = visible_weights(&WAVELENGTH_NM, Illuminant::D65, Quadrature::Interpolated).unwrap();
    let Sides { incident, half_vectors } = default_sides(&mesh_scene);
    let (coherence, precision) = (Coherence::None, Precision::F32);
    let tracing = Tracing {
        coherence,
        rays: default_rays(&mesh_scene, &WAVELENGTH_NM, coherence),
        seed: 0,
        precision,
        threads: 2,
    };
    let (target_error, weights, space) = (None, &weights[..], RgbSpace::Srgb);
    let request =
        TableRequest { incident, half_vectors, tracing, target_error, weights, space, share: None, reciprocal: false };
    let table = estimate(&mesh_scene, &WAVELENGTH_NM, &request, None, &|| ()).unwrap();
    let mut memory = vec![0.0; HalfVectorWarp::required_len([table.warp[0].len(), table.warp[1].len()])];
    let warp = HalfVectorWarp::new([&table.warp[0], &table.warp[1]], &mut memory).unwrap();
    DIRECTIONS
        .iter()
        .map(|&angles| {
            let wi = direction(angles);
            let lobes = lobe_directions(&table.lobes, wi);
            let grid = HalfVectorGrid::new(table.layout, warp, wi, &lobes);
            let request = ScatterRequest { coherence, rays: RAYS, seed: 7, bins: &grid, precision, threads: 2 };
            let direct = &scatter(&mesh_scene, wi, &WAVELENGTH_NM, &request, &|| ()).unwrap()[0].bins;
            let powers = powers(&table, &warp, wi);
            let whole: f64 = direct.iter().map(|bin| bin.value).sum();
            let off: f64 = direct.iter().zip(&powers).map(|(bin, power)| (bin.value - power).abs()).sum();
            let differences = [off / whole, powers.iter().sum::<f64>() / whole - 1.0];
            println!("{name} {angles:?}: L1 {:.3}, albedo {:+.2} %", differences[0], 100.0 * differences[1]);
            differences
        })
        .collect()
}

/// Asserts a limit of Σ |difference| / Σ power, of at most 2.
fn within(name: &str, limit: f64) {
    for [off, albedo] in differences(name) {
        assert!(off <= limit && albedo.abs() <= limit, "{name}: {off} {albedo}");
    }
}

#[test]
fn rolling_glass_is_within_8_per_cent_between_directions() {
    within("bumpy-glass", 0.08);
}

#[test]
fn brushed_metal_is_within_8_per_cent_and_its_albedo_within_half_a_per_cent() {
    for [off, albedo] in differences("brushed-metal") {
        assert!(off <= 0.08 && albedo.abs() <= 5e-3, "{off} {albedo}");
    }
}

#[test]
fn beetle_pits_are_within_12_per_cent_between_directions() {
    within("beetle-pits", 0.12);
}

#[test]
fn lobes_of_pyramids_and_flakes_are_within_15_per_cent_between_directions() {
    within("silicon-pyramids", 0.15);
    within("pigment-paint", 0.15);
}
