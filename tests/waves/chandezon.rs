//! The coordinate-transformation method against other programs, closed forms and laws of physics.

use goniochrome_waves::Complex64;
use goniochrome_waves::chandezon::GraphModes;
use goniochrome_waves::profile::Graph;
use goniochrome_waves::response::{Order, Response};

use crate::data::{index, largest_difference, list, number, read};
use crate::lamellar::tangential;

/// Aluminium at 550 nm.
const ALUMINIUM: Complex64 = Complex64::new(0.96, 6.69);

fn solve(graph: &Graph, wavelength_nm: f64, [kx, ky]: [f64; 2], max_order: usize) -> Response {
    GraphModes::new(graph, wavelength_nm, kx, max_order).expect("modes").response(ky).expect("response")
}

/// Interface of a preset's shape in aluminium under polycarbonate, or of other media.
fn graph(period_nm: f64, above: f64, below: Complex64, points_nm: &[[f64; 2]]) -> Graph {
    Graph { period_nm, above, below, points_nm: points_nm.to_vec() }
}

/// One period of a cosine of full height `depth_nm`, as a polygon of `corners` corners.
fn sinusoid(period_nm: f64, depth_nm: f64, corners: u32, above: f64, below: Complex64) -> Graph {
    let corner = |i: u32| {
        let turns = f64::from(i) / f64::from(corners);
        [period_nm * turns, 0.5 * depth_nm * (std::f64::consts::TAU * turns).cos()]
    };
    graph(period_nm, above, below, &(0..corners).map(corner).collect::<Vec<_>>())
}

/// Efficiencies of all reflected and transmitted orders.
fn efficiencies(response: &Response) -> Vec<[f64; 2]> {
    let up = response.reflected.iter().map(|order| response.reflected_efficiency(order));
    up.chain(response.transmitted.iter().map(|order| response.transmitted_efficiency(order))).collect()
}

/// Largest change of the efficiency of a reflected order that both responses keep.
fn largest_change(coarse: &Response, fine: &Response) -> f64 {
    let mut largest = 0.0_f64;
    for order in &coarse.reflected {
        if let Some(other) = fine.reflected.iter().find(|other| other.index == order.index) {
            let [a, b] = [coarse.reflected_efficiency(order), fine.reflected_efficiency(other)];
            largest = largest.max((a[0] - b[0]).abs()).max((a[1] - b[1]).abs());
        }
    }
    largest
}

/// Largest difference from a case of `gratings.json` at a truncation.
fn grating_difference(name: &str, max_order: usize) -> f64 {
    let gratings = read("gratings.json");
    let case = list(&gratings, "cases").iter().find(|case| case["name"] == name).expect("case");
    let points = list(&case["profile"], "points_nm");
    let points: Vec<[f64; 2]> = points.iter().map(|p| [0, 1].map(|i| p[i].as_f64().expect("length"))).collect();
    let graph = graph(number(case, "period_nm"), 1.0, index(&case["n_substrate"]), &points);
    let mut largest = 0.0_f64;
    for record in list(case, "data") {
        let kx = number(record, "theta_deg").to_radians().sin();
        let response = solve(&graph, number(record, "wavelength_nm"), [kx, 0.0], max_order);
        largest = largest.max(largest_difference(&response, record));
    }
    println!("{name}, orders up to {max_order}: {largest:.1e}");
    largest
}

/// The limits of the cases of `gratings.json` are the largest differences that the file states between the programs that
/// made them, or between their truncations.
#[test]
fn lamellar_silver() {
    assert!(grating_difference("b_lamellar_silver", 50) <= 3e-4);
}

#[test]
fn disc_aluminium() {
    assert!(grating_difference("c_cd_aluminium", 25) <= 3e-4);
}

#[test]
fn blazed_silver() {
    assert!(grating_difference("d_blazed_silver", 45) <= 1e-4);
}

#[test]
fn triangle_glass() {
    assert!(grating_difference("e_triangle_glass", 30) <= 2e-6);
}

/// The record's own change, from 2/3 of its orders, is up to 2.2e-3; this method's from 20 to 50 orders is 3e-5.
#[test]
fn conical_aluminium_track() {
    let waves = read("waves.json");
    let case = list(&waves, "cases").iter().find(|case| case["name"] == "aluminium_track").expect("case");
    let graph = graph(1600.0, 1.0, ALUMINIUM, &[[0.0, 110.0], [1050.0, 110.0], [1050.0, 0.0], [1600.0, 0.0]]);
    for record in list(case, "data") {
        let q = tangential(number(record, "theta_deg"), number(record, "phi_deg"));
        let found = largest_difference(&solve(&graph, number(record, "wavelength_nm"), q, 20), record);
        assert!(found <= 5e-3, "{record}: {found:.1e}");
    }
}

/// Fresnel's amplitudes of an order 0, s and p, in reflection and transmission as [`Order`] defines them.
fn fresnel(above: f64, below: Complex64, q: [f64; 2]) -> [[Complex64; 2]; 2] {
    let squared = q[0] * q[0] + q[1] * q[1];
    let [e1, e2] = [Complex64::from(above * above), below * below];
    let [k1, k2] = [(e1 - squared).sqrt(), (e2 - squared).sqrt()];
    let s = (k1 - k2) / (k1 + k2);
    let p = (e2 * k1 - e1 * k2) / (e2 * k1 + e1 * k2);
    [[s, p], [1.0 + s, (1.0 + p) * above / below]]
}

#[test]
fn flat_interface() {
    for (below, above) in [(Complex64::from(1.5), 1.0), (ALUMINIUM, 1.58), (Complex64::from(1.0), 1.5)] {
        for points in [vec![[0.0, 30.0]], vec![[100.0, 0.0], [350.0, 0.0]]] {
            let graph = graph(900.0, above, below, &points);
            for q in [[0.0, 0.0], [0.4, 0.0], [0.0, -0.6], [-0.5, 0.7]] {
                let response = solve(&graph, 550.0, q, 6);
                let [r, t] = fresnel(above, below, q);
                for (orders, expected) in [(&response.reflected, r), (&response.transmitted, t)] {
                    for order in orders {
                        for incident in 0..2 {
                            for outgoing in 0..2 {
                                let there = order.index == [0, 0] && incident == outgoing;
                                let expected = if there { expected[incident] } else { Complex64::ZERO };
                                let error = (order.jones[incident][outgoing] - expected).norm();
                                assert!(error <= 1e-9, "{below} {points:?} {q:?} {order:?}: {error:.1e}");
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A sinusoidal foil in aluminium: 9 orders reach 1e-5 in s and p.
#[test]
fn sinusoidal_foil() {
    let foil = sinusoid(1000.0, 100.0, 200, 1.0, ALUMINIUM);
    for q in [[0.0, 0.0], [0.34, 0.0], [0.2, -0.5]] {
        let change = largest_change(&solve(&foil, 550.0, q, 4), &solve(&foil, 550.0, q, 15));
        assert!(change <= 1e-5, "{q:?}: {change:.1e}");
    }
}

/// The sum of all orders of lossless surfaces converges to 1: the method does not conserve energy by itself.
#[test]
fn energy() {
    let trapezoid = [[0.0, 0.0], [200.0, 0.0], [260.0, 220.0], [500.0, 220.0], [560.0, 0.0]];
    for (above, below) in [(1.0, 1.5), (1.5, 1.0)] {
        for q in [[0.0, 0.0], [0.3, 0.0], [0.25, 0.6]] {
            let surface = graph(800.0, above, Complex64::from(below), &trapezoid);
            let sums = [0, 1].map(|p| efficiencies(&solve(&surface, 500.0, q, 25)).iter().map(|e| e[p]).sum::<f64>());
            for sum in sums {
                assert!((sum - 1.0).abs() <= 1e-10, "{above} {q:?}: {:.1e}", sum - 1.0);
            }
        }
    }
}

/// Largest difference, over orders, of the unpolarised efficiency there from that of the way back: light that arrives
/// against order m leaves in order m against the light that made it.
fn reciprocity_error(surface: &Graph, q: [f64; 2], max_order: usize) -> f64 {
    let there = solve(surface, 550.0, q, max_order);
    let total = |response: &Response, order: &Order| response.reflected_efficiency(order).iter().sum::<f64>();
    let mut largest = 0.0_f64;
    for order in there.reflected.iter().filter(|order| order.vertical.im == 0.0 && order.index[0] != 0) {
        let m = order.index[0];
        let back = [-(q[0] + f64::from(m) * 550.0 / surface.period_nm), -q[1]];
        let back = solve(surface, 550.0, back, max_order);
        let reverse = back.reflected.iter().find(|other| other.index[0] == m).expect("order is kept");
        largest = largest.max((total(&there, order) - total(&back, reverse)).abs());
    }
    largest
}

/// Reciprocity holds as well as the fields have converged: to rounding for a smooth surface, to the change from 20 to 30
/// orders for one with corners.
#[test]
fn reciprocity() {
    let q = [0.35, 0.5];
    let smooth = sinusoid(1600.0, 200.0, 200, 1.58, ALUMINIUM);
    let error = reciprocity_error(&smooth, q, 15);
    assert!(error <= 1e-9, "smooth: {error:.1e}");

    let points = [[0.0, 110.0], [496.0, 110.0], [525.0, 0.0], [1075.0, 0.0], [1104.0, 110.0]];
    let disc = graph(1600.0, 1.58, ALUMINIUM, &points);
    let change = largest_change(&solve(&disc, 550.0, q, 20), &solve(&disc, 550.0, q, 30));
    let error = reciprocity_error(&disc, q, 30);
    println!("reciprocity of the disc: {error:.1e}, change of truncation: {change:.1e}");
    assert!(error <= change, "disc: {error:.1e}, change of truncation {change:.1e}");
}
