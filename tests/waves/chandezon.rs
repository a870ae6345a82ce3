//! The coordinate-transformation method against other programs, closed forms and laws of physics.

use goniochrome_waves::chandezon::{GraphModes, enough_orders, suits};
use goniochrome_waves::convergence::{Goal, converge};
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::profile::{Graph, Profile, Slice};
use goniochrome_waves::response::{Order, Response};
use goniochrome_waves::{Complex64, WaveError};

use crate::data::{index, largest_difference, list, number, read};
use crate::lamellar::tangential;

/// Aluminium at 550 nm.
const ALUMINIUM: Complex64 = Complex64::new(0.96, 6.69);

fn solve(graph: &Graph, wavelength_nm: f64, [kx, ky]: [f64; 2], max_order: usize) -> Response {
    GraphModes::new(graph, wavelength_nm, kx, max_order).expect("modes").response(ky).expect("response")
}

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

/// The limits of the cases of `gratings.json` are the largest differences that the file states between the programs
/// that made them, or between their truncations.
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

/// Steep smooth metal, half as high as its period: 31 orders reach 1e-4.
#[test]
fn steep_sinusoid() {
    let silver = Complex64::new(0.06, 3.6);
    let surface = sinusoid(1000.0, 500.0, 400, 1.0, silver);
    for q in [[0.3, 0.0], [0.3, 0.25]] {
        let change = largest_change(&solve(&surface, 550.0, q, 15), &solve(&surface, 550.0, q, 25));
        assert!(change <= 1e-4, "{q:?}: {change:.1e}");
    }
}

/// Random polygons, jagged and with vertical walls: efficiencies are finite, none is negative, and no power is made.
/// Rounding of the deepest, 1.5 periods high, is below 1e-8.
#[test]
fn random_polygons() {
    let mut state = 1_u64;
    let mut random = move || {
        // Knuth's MMIX generator.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for case in 0..60 {
        let period = 300.0 + 1500.0 * random();
        let mut x: Vec<f64> = (0..2 + case % 5).map(|_| period * random()).collect();
        x.sort_by(f64::total_cmp);
        x[1] = if random() < 0.3 { x[0] } else { x[1] };
        let height = 1.5 * period * random() * random();
        let points: Vec<[f64; 2]> = x.iter().map(|&x| [x, height * random()]).collect();
        let lossless = case % 2 == 0;
        let below = Complex64::new(0.1 + 2.0 * random(), if lossless { 0.0 } else { 7.0 * random() });
        let surface = graph(period, 1.0 + 0.6 * random(), below, &points);
        let sine = surface.above * random();
        let (y, x) = (std::f64::consts::TAU * random()).sin_cos();
        let max_order = enough_orders(&surface, 550.0).expect("orders");
        let response = solve(&surface, 550.0, [sine * x, sine * y], max_order);
        let found = efficiencies(&response);
        assert!(found.iter().flatten().all(|e| e.is_finite() && *e >= -1e-12), "{surface:?}");
        for p in 0..2 {
            let reflected: f64 = found[..2 * max_order + 1].iter().map(|e| e[p]).sum();
            let whole: f64 = found.iter().map(|e| e[p]).sum();
            let error = if lossless { (whole - 1.0).abs() } else { reflected - 1.0 };
            assert!(error <= 1e-8, "{surface:?} {max_order}: {error:.1e}");
        }
    }
}

/// The error bar of a disc's efficiencies from [`enough_orders`] upwards is true.
#[test]
fn error_bar() {
    let points = [[0.0, 105.0], [182.0, 105.0], [210.0, 0.0], [530.0, 0.0], [558.0, 105.0]];
    let disc = graph(740.0, 1.58, ALUMINIUM, &points);
    let q = [0.4, 0.3];
    let goal = Goal { target: 1e-3, first: enough_orders(&disc, 550.0).expect("orders"), limit: 60 };
    let found =
        converge(goal, |max_order| Ok::<_, WaveError>(vec![solve(&disc, 550.0, q, max_order)])).expect("response");
    let error = largest_change(&found.responses[0], &solve(&disc, 550.0, q, 50));
    assert!(found.met && found.max_order <= 25, "{} {}", found.error_bar, found.max_order);
    assert!(error <= found.error_bar, "{error:.1e} {:.1e}", found.error_bar);
}

/// Corners of a trapezoidal ridge of glass: period 800 nm, walls of 75°.
const RIDGE: [[f64; 2]; 5] = [[0.0, 0.0], [200.0, 0.0], [260.0, 220.0], [500.0, 220.0], [560.0, 0.0]];

/// Lossless surfaces keep all power at any truncation that has the travelling orders.
#[test]
fn energy() {
    let walls = [[0.0, 800.0], [300.0, 800.0], [300.0, 0.0], [800.0, 0.0]];
    for points in [RIDGE.as_slice(), walls.as_slice()] {
        for (above, below) in [(1.0, 1.5), (1.5, 1.0)] {
            let surface = graph(800.0, above, Complex64::from(below), points);
            for q in [[0.0, 0.0], [0.3, 0.0], [0.25, 0.6]] {
                for max_order in [10, 15, 20] {
                    let error = energy_error(&surface, q, max_order);
                    assert!(error <= 1e-10, "{above} {q:?} {max_order}: {error:.1e}");
                }
            }
        }
    }
}

/// Largest difference of the sum of all orders from 1.
fn energy_error(surface: &Graph, q: [f64; 2], max_order: usize) -> f64 {
    let found = efficiencies(&solve(surface, 500.0, q, max_order));
    let sums = [0, 1].map(|p| found.iter().map(|e| e[p]).sum::<f64>());
    sums.iter().fold(0.0, |largest: f64, sum| largest.max((sum - 1.0).abs()))
}

/// At k_y = 1 below glass, components along y do not determine the field in air. The method shifts ε of air by 1e-8
/// there and loses half of the digits.
#[test]
fn light_along_the_grooves_at_the_limit_of_total_reflection() {
    let surface = graph(800.0, 1.5, Complex64::from(1.0), &RIDGE);
    let error = energy_error(&surface, [0.1, 1.0], 15);
    assert!(error <= 1e-6, "{error:.1e}");
}

/// Orders that pass off, and grazing light, have finite fields.
#[test]
fn rayleigh_anomalies() {
    for below in [Complex64::from(1.5), ALUMINIUM] {
        let surface = graph(600.0, 1.0, below, &RIDGE.map(|[x, h]| [0.75 * x, h]));
        for (wavelength, q) in
            [(600.0, [0.0, 0.0]), (300.0, [0.5, 0.0]), (480.0, [0.2, 0.0]), (550.0, [0.0, 0.999_999])]
        {
            let [power, near] = [q, [q[0] + 1e-6, q[1]]].map(|q| efficiencies(&solve(&surface, wavelength, q, 15)));
            for (at, near) in power.iter().flatten().zip(near.iter().flatten()) {
                assert!(at.is_finite() && *at >= -1e-12 && *at <= 1.0 + 1e-10, "{below} {q:?}: {at}");
                // Efficiencies are continuous, with a change of √(2 · 1e-6) k_z and a factor for their slope.
                assert!((at - near).abs() <= 1e-2, "{below} {wavelength} {q:?}: {at} {near}");
            }
        }
    }
}

/// Largest difference of an amplitude from the Fourier modal method at 51 orders: its own error, 1.6e-3 on the sloping
/// walls, which falls as the inverse of the number of orders. This method's change from 31 to 61 orders is 9e-5.
const MAX_AMPLITUDE_DIFFERENCE: f64 = 2e-3;

/// Agreement with the Fourier modal method on glass: vertical walls, and sloping ones as 60 slices. Amplitudes are
/// compared, so that phases agree too.
#[test]
fn agreement_with_lamellar() {
    let glass = Complex64::from(1.5);
    let steps = 60;
    let slice = |i: i32| {
        let share = (f64::from(i) + 0.5) / f64::from(steps);
        Slice {
            thickness_nm: 220.0 / f64::from(steps),
            edges_nm: vec![260.0 - 60.0 * share, 500.0 + 60.0 * share],
            eta: vec![glass, Complex64::ONE],
        }
    };
    let walls = Slice { thickness_nm: 220.0, edges_nm: vec![230.0, 530.0], eta: vec![glass, Complex64::ONE] };
    let vertical = [[230.0, 0.0], [230.0, 220.0], [530.0, 220.0], [530.0, 0.0]];
    let pairs = [(RIDGE.as_slice(), (0..steps).map(slice).collect()), (vertical.as_slice(), vec![walls])];
    for (points, slices) in pairs {
        let surface = graph(800.0, 1.0, glass, points);
        let profile = Profile { period_nm: 800.0, above: 1.0, below: glass, slices };
        for [kx, ky] in [[0.3, 0.0], [0.25, 0.6]] {
            let modes = Modes::new(&profile, 500.0, kx, 25).expect("modes").response(ky).expect("response");
            let found = solve(&surface, 500.0, [kx, ky], 15);
            for (orders, others) in [(&found.reflected, &modes.reflected), (&found.transmitted, &modes.transmitted)] {
                for order in orders.iter().filter(|order| order.vertical.im == 0.0) {
                    let other = others.iter().find(|other| other.index == order.index).expect("order is kept");
                    for (a, b) in order.jones.iter().flatten().zip(other.jones.iter().flatten()) {
                        let difference = (a - b).norm();
                        assert!(
                            difference <= MAX_AMPLITUDE_DIFFERENCE,
                            "{points:?} {kx} {ky} {:?}: {difference:.1e}",
                            order.index
                        );
                    }
                }
            }
            let change = largest_change(&found, &modes);
            assert!(change <= 1e-4, "{points:?} {kx} {ky}: {change:.1e}");
        }
    }
}

/// Light in another order of the truncation has the same efficiencies as light of its own.
#[test]
fn shifted_light() {
    let foil = sinusoid(1000.0, 100.0, 200, 1.0, ALUMINIUM);
    let modes = GraphModes::new(&foil, 550.0, 0.1, 12).expect("modes");
    let waves = modes.waves(-0.3).expect("waves");
    let shifted = waves.response_at(1).expect("response");
    let own = solve(&foil, 550.0, [0.1 + 0.55, -0.3], 12);
    let change = largest_change(&shifted, &own);
    assert!(change <= 1e-9, "{change:.1e}");
    assert_eq!(waves.response_at(5).err(), Some(WaveError::Light));
    assert_eq!(waves.response_at(13).err(), Some(WaveError::Light));
}

#[test]
fn domain() {
    let good = graph(800.0, 1.0, ALUMINIUM, &RIDGE);
    assert!(suits(&good, 550.0));
    assert!((10..=20).contains(&enough_orders(&good, 550.0).expect("orders")));
    let deep = graph(800.0, 1.0, ALUMINIUM, &RIDGE.map(|[x, h]| [x, 10.0 * h]));
    let long = graph(80_000.0, 1.0, ALUMINIUM, &RIDGE);
    assert!(!suits(&deep, 550.0) && !suits(&long, 550.0));
    for points in [vec![], vec![[5.0, 0.0], [2.0, 0.0]], vec![[0.0, f64::NAN]], vec![[900.0, 0.0]]] {
        let bad = graph(800.0, 1.0, ALUMINIUM, &points);
        assert_eq!(GraphModes::new(&bad, 550.0, 0.0, 5).err(), Some(WaveError::Profile), "{points:?}");
        assert!(!suits(&bad, 550.0));
    }
    assert_eq!(GraphModes::new(&good, 0.0, 0.0, 5).err(), Some(WaveError::Light));
    let modes = GraphModes::new(&good, 550.0, 0.6, 5).expect("modes");
    assert_eq!(modes.response(0.8).err(), Some(WaveError::Light));
    assert_eq!(modes.response(f64::NAN).err(), Some(WaveError::Light));
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

/// Reciprocity holds as well as the fields have converged: to rounding for a smooth surface, to the change from 20 to
/// 30 orders for one with corners.
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
