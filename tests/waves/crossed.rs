//! Surfaces with two periods: an independent program, laws of physics, and surfaces with one period or none.

use std::f64::consts::TAU;

use goniochrome_waves::crossed::CrossedModes;
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::light::Light;
use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Profile, Slice, Strip};
use goniochrome_waves::response::{Order, Response};
use goniochrome_waves::{Complex64, WaveError};

use crate::data::{list, number, read};

const SILVER: Complex64 = Complex64::new(0.06, 3.59);
const RESIN: Complex64 = Complex64::new(1.6, 0.1);

/// Light from polar angle `theta` and azimuth `phi` in degrees, in a medium of index `above`.
fn light(wavelength_nm: f64, above: f64, theta: f64, phi: f64) -> Light {
    let (sin, cos) = phi.to_radians().sin_cos();
    Light { wavelength_nm, tangential: [cos, sin].map(|along| -above * theta.to_radians().sin() * along) }
}

/// Layer with a rectangle of index `inside` from one corner to the other.
fn rectangle(thickness_nm: f64, from: [f64; 2], to: [f64; 2], outside: Complex64, inside: Complex64) -> CrossedSlice {
    CrossedSlice {
        thickness_nm,
        strip_edges_nm: vec![from[1], to[1]],
        strips: vec![
            Strip { edges_nm: vec![from[0], to[0]], eta: vec![inside, outside] },
            Strip { edges_nm: vec![], eta: vec![outside] },
        ],
    }
}

fn film(thickness_nm: f64, eta: Complex64) -> CrossedSlice {
    CrossedSlice { thickness_nm, strip_edges_nm: vec![], strips: vec![Strip { edges_nm: vec![], eta: vec![eta] }] }
}

/// Two patterns without symmetry and a film between them.
fn bodies(above: f64, below: Complex64, eta: [Complex64; 3]) -> CrossedProfile {
    let ell = CrossedSlice {
        thickness_nm: 130.0,
        strip_edges_nm: vec![40.0, 200.0, 330.0],
        strips: vec![
            Strip { edges_nm: vec![100.0, 400.0], eta: vec![eta[0], above.into()] },
            Strip { edges_nm: vec![100.0, 220.0, 480.0], eta: vec![eta[0], above.into(), eta[1]] },
            Strip { edges_nm: vec![], eta: vec![above.into()] },
        ],
    };
    let pillar = rectangle(90.0, [30.0, 120.0], [260.0, 370.0], eta[2], eta[0]);
    CrossedProfile { period_nm: [520.0, 430.0], above, below, slices: vec![ell, film(60.0, eta[1]), pillar] }
}

fn solve(profile: &CrossedProfile, light: &Light, max_order: [usize; 2]) -> Response {
    CrossedModes::new(profile, light, max_order).and_then(|modes| modes.response()).expect("response")
}

fn at(orders: &[Order], index: [i32; 2]) -> &Order {
    orders.iter().find(|order| order.index == index).expect("order is kept")
}

/// Sums of reflected and transmitted efficiencies in s and in p.
fn total(response: &Response) -> [f64; 2] {
    let up = response.reflected.iter().map(|order| response.reflected_efficiency(order));
    let down = response.transmitted.iter().map(|order| response.transmitted_efficiency(order));
    up.chain(down).fold([0.0, 0.0], |sum, share| [sum[0] + share[0], sum[1] + share[1]])
}

/// Largest difference of the Jones matrices of travelling orders, those of the second list by another index.
fn difference(a: &[Order], b: &[Order], index: impl Fn([i32; 2]) -> [i32; 2]) -> f64 {
    let travelling = a.iter().filter(|order| order.vertical.re > 1e-3);
    travelling.fold(0.0_f64, |largest, order| {
        let other = at(b, index(order.index));
        let pairs = order.jones.as_flattened().iter().zip(other.jones.as_flattened());
        pairs.fold(largest, |largest, (a, b)| largest.max((a - b).norm()))
    })
}

#[test]
fn pillars_agree_with_an_independent_program() {
    // The record is good to 1.6e-4.
    const TOLERANCE: f64 = 1e-3;
    let reference = read("crossed.json");
    for case in list(&reference, "cases") {
        let (period, width) = (number(case, "period_nm"), number(case, "width_nm"));
        let pillar = rectangle(number(case, "height_nm"), [0.0; 2], [width; 2], 1.0.into(), number(case, "n").into());
        let profile = CrossedProfile {
            period_nm: [period; 2],
            above: 1.0,
            below: number(case, "n_substrate").into(),
            slices: vec![pillar],
        };
        for record in list(case, "data") {
            let light =
                light(number(record, "wavelength_nm"), 1.0, number(record, "theta_deg"), number(record, "phi_deg"));
            let response = solve(&profile, &light, [4, 4]);
            for (i, numbers) in list(record, "orders").iter().enumerate() {
                let index = [0, 1].map(|axis| i32::try_from(numbers[axis].as_i64().unwrap()).unwrap());
                let up = response.reflected_efficiency(at(&response.reflected, index));
                let down = response.transmitted_efficiency(at(&response.transmitted, index));
                for (key, found) in [("R_s", up[0]), ("R_p", up[1]), ("T_s", down[0]), ("T_p", down[1])] {
                    let expected = record[key][i].as_f64().unwrap();
                    assert!((found - expected).abs() <= TOLERANCE, "{light:?} {index:?} {key}: {found}, {expected}");
                }
            }
        }
    }
}

#[test]
fn power_is_kept_at_any_truncation() {
    const TOLERANCE: f64 = 1e-10;
    let profile = bodies(1.1, 1.45.into(), [2.0, 1.6, 1.33].map(Complex64::from));
    for max_order in [[0, 0], [1, 1], [2, 0], [0, 3], [2, 2], [3, 2]] {
        for (theta, phi) in [(0.0, 0.0), (20.0, 0.0), (35.0, 90.0), (50.0, 217.0), (85.0, 300.0)] {
            let found = total(&solve(&profile, &light(500.0, 1.1, theta, phi), max_order));
            assert!(found.iter().all(|sum| (sum - 1.0).abs() <= TOLERANCE), "{max_order:?} {theta} {phi}: {found:?}");
        }
    }
}

#[test]
fn mirror_order_is_reciprocal() {
    const TOLERANCE: f64 = 1e-9;
    let profile = bodies(1.0, SILVER, [SILVER, RESIN, 1.33.into()]);
    for (theta, phi) in [(10.0, 20.0), (40.0, 120.0), (75.0, 250.0)] {
        let there = solve(&profile, &light(550.0, 1.0, theta, phi), [2, 2]);
        let back = solve(&profile, &light(550.0, 1.0, theta, phi + 180.0), [2, 2]);
        let (there, back) = (at(&there.reflected, [0, 0]).jones, at(&back.reflected, [0, 0]).jones);
        // Both ways s is taken with the other sign, and so is p: the mixed elements change places and sign.
        for [from, to] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let sign = if from == to { 1.0 } else { -1.0 };
            assert!((there[from][to] - back[to][from] * sign).norm() <= TOLERANCE, "{there:?} {back:?}");
        }
    }
}

#[test]
fn all_reflected_orders_are_reciprocal() {
    const TOLERANCE: f64 = 1e-9;
    let profile = bodies(1.0, SILVER, [SILVER, RESIN, 1.33.into()]);
    let there = light(400.0, 1.0, 25.0, 120.0);
    let response = solve(&profile, &there, [2, 2]);
    let opposite = Light { tangential: there.tangential.map(|k| -k), ..there };
    let backwards = CrossedModes::new(&profile, &opposite, [2, 2]).expect("modes");
    let mut count = 0;
    for order in response.reflected.iter().filter(|order| order.vertical.re > 0.0) {
        // Light against the order leaves against the light: their truncations hold the same waves.
        let back = backwards.response_at(order.index.map(|number| -number)).expect("response");
        let other = at(&back.reflected, order.index);
        let power = |response: &Response, order: &Order, from: usize, to: usize| {
            order.vertical.re / response.incident_vertical * order.jones[from][to].norm_sqr()
        };
        for (from, to) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (a, b) = (power(&response, order, from, to), power(&back, other, to, from));
            assert!((a - b).abs() <= TOLERANCE, "{:?} {from}{to}: {a} {b}", order.index);
        }
        count += 1;
    }
    assert!(count >= 4, "{count}");
    assert_eq!(backwards.response_at([3, 0]), Err(WaveError::Light));
    assert_eq!(backwards.response_at([2, 2]), Err(WaveError::Light));
}

#[test]
fn straight_passage_is_reciprocal() {
    const TOLERANCE: f64 = 1e-9;
    let over = bodies(1.0, 1.5.into(), [SILVER, RESIN, 1.33.into()]);
    // Turned upside down by half a turn about the x axis: y and z change sign.
    let mut under = CrossedProfile { above: 1.5, below: 1.0.into(), ..over.clone() };
    under.slices.reverse();
    for slice in &mut under.slices {
        slice.strip_edges_nm = slice.strip_edges_nm.iter().rev().map(|edge| under.period_nm[1] - edge).collect();
        slice.strips.reverse();
        // The strip over the period's end stays last.
        slice.strips.rotate_left(1);
    }
    for (theta, phi) in [(10.0, 20.0), (35.0, 120.0)] {
        let there = light(550.0, 1.0, theta, phi);
        let [k_x, k_y] = there.tangential;
        let back = Light { tangential: [-k_x, k_y], ..there };
        let (there, back) = (solve(&over, &there, [2, 2]), solve(&under, &back, [2, 2]));
        let (down, up) = (at(&there.transmitted, [0, 0]), at(&back.transmitted, [0, 0]));
        for [from, to] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
            let found =
                [down.jones[from][to].norm_sqr() * down.vertical.re, up.jones[to][from].norm_sqr() * up.vertical.re];
            let shares = [found[0] / there.incident_vertical, found[1] / back.incident_vertical];
            assert!((shares[0] - shares[1]).abs() <= TOLERANCE, "{theta} {phi} {from}{to}: {shares:?}");
        }
    }
}

/// Amplitudes reflected and transmitted by films in s or in p, by characteristic matrices (Born & Wolf, section 1.6).
fn films(etas: &[Complex64], thicknesses_nm: &[f64], light: &Light, p: bool) -> [Complex64; 2] {
    let q2 = light.tangential[0].powi(2) + light.tangential[1].powi(2);
    let vertical = |eta: Complex64| (eta * eta - q2).sqrt();
    let admittance = |eta: Complex64| if p { eta * eta / vertical(eta) } else { vertical(eta) };
    let last = etas[etas.len() - 1];
    let (mut e, mut h) = (Complex64::ONE, admittance(last));
    for (&eta, thickness) in etas[1..etas.len() - 1].iter().zip(thicknesses_nm).rev() {
        let phase = vertical(eta) * (TAU * thickness / light.wavelength_nm);
        let (sin, cos, y) = (phase.sin(), phase.cos(), admittance(eta));
        (e, h) = (cos * e - Complex64::I * sin / y * h, cos * h - Complex64::I * y * sin * e);
    }
    let y = admittance(etas[0]);
    // Of the electric field along the surface; the magnetic field of p is minus as much reflected.
    let (r, t) = ((y * e - h) / (y * e + h), 2.0 * y / (y * e + h));
    if p { [-r, t * admittance(last) / last / (y / etas[0])] } else { [r, t] }
}

#[test]
fn flat_layers_have_their_closed_form() {
    const TOLERANCE: f64 = 1e-9;
    let stacks: [(&[Complex64], &[f64]); 4] = [
        (&[1.0.into(), 1.5.into()], &[]),
        (&[1.5.into(), 1.0.into(), 1.5.into()], &[150.0]),
        (&[1.0.into(), 2.3.into(), 1.38.into(), SILVER, 1.5.into()], &[80.0, 120.0, 30.0]),
        (&[1.3.into(), RESIN, SILVER], &[700.0]),
    ];
    for (etas, thicknesses) in stacks {
        let layers = etas[1..etas.len() - 1].iter().zip(thicknesses);
        let profile = CrossedProfile {
            period_nm: [700.0, 400.0],
            above: etas[0].re,
            below: etas[etas.len() - 1],
            slices: layers.map(|(&eta, &thickness)| film(thickness, eta)).collect(),
        };
        for (theta, phi) in [(0.0, 0.0), (30.0, 70.0), (55.0, 200.0), (88.0, 310.0)] {
            let light = light(520.0, profile.above, theta, phi);
            let modes = CrossedModes::new(&profile, &light, [1, 2]).unwrap();
            assert_eq!(modes.decompositions(), 0);
            let response = modes.response().unwrap();
            for (orders, side) in [(&response.reflected, 0), (&response.transmitted, 1)] {
                for order in orders {
                    let expected = |p| {
                        if order.index == [0, 0] { films(etas, thicknesses, &light, p)[side] } else { Complex64::ZERO }
                    };
                    let [[ss, sp], [ps, pp]] = order.jones;
                    let found = [(ss, expected(false)), (pp, expected(true)), (sp, 0.0.into()), (ps, 0.0.into())];
                    for (found, expected) in found {
                        assert!((found - expected).norm() <= TOLERANCE, "{light:?} {order:?}: {expected}");
                    }
                }
            }
        }
    }
}

/// Surfaces that do not depend on y: a dielectric ridge on a film, and a metal one on metal.
fn lamellar() -> [Profile; 2] {
    let ridge = |thickness_nm, eta| Slice { thickness_nm, edges_nm: vec![110.0, 300.0], eta };
    let film = Slice { thickness_nm: 70.0, edges_nm: vec![], eta: vec![2.0.into()] };
    let period_nm = 640.0;
    [
        Profile {
            period_nm,
            above: 1.0,
            below: 1.45.into(),
            slices: vec![ridge(220.0, vec![1.7.into(), 1.0.into()]), film, ridge(50.0, vec![RESIN, 1.2.into()])],
        },
        Profile { period_nm, above: 1.0, below: SILVER, slices: vec![ridge(60.0, vec![SILVER, 1.0.into()])] },
    ]
}

#[test]
fn profile_without_y_or_without_x_is_lamellar() {
    const TOLERANCE: f64 = 1e-9;
    for profile in lamellar() {
        let crossed = |turned: bool| CrossedProfile {
            period_nm: if turned { [500.0, profile.period_nm] } else { [profile.period_nm, 500.0] },
            above: profile.above,
            below: profile.below,
            slices: profile
                .slices
                .iter()
                .map(|slice| {
                    let (edges, eta) = (slice.edges_nm.clone(), slice.eta.clone());
                    let strips = eta.iter().map(|&eta| Strip { edges_nm: vec![], eta: vec![eta] }).collect();
                    CrossedSlice {
                        thickness_nm: slice.thickness_nm,
                        strip_edges_nm: if turned { edges.clone() } else { vec![] },
                        strips: if turned { strips } else { vec![Strip { edges_nm: edges, eta }] },
                    }
                })
                .collect(),
        };
        for (theta, phi) in [(0.0, 0.0), (25.0, 0.0), (40.0, 65.0), (70.0, 190.0)] {
            let straight = light(550.0, 1.0, theta, phi);
            let [k_x, k_y] = straight.tangential;
            let expected = Modes::new(&profile, straight.wavelength_nm, k_x, 5).unwrap().response(k_y).unwrap();
            for turned in [false, true] {
                // By 90 degrees: x goes to y, and y to −x. At normal incidence s is +y, which does not turn.
                if turned && theta == 0.0 {
                    continue;
                }
                let light = if turned { Light { tangential: [-k_y, k_x], ..straight } } else { straight };
                let found = solve(&crossed(turned), &light, if turned { [1, 5] } else { [5, 1] });
                let index = |[m, n]: [i32; 2]| if turned { [n, m] } else { [m, n] };
                let up = difference(&expected.reflected, &found.reflected, index);
                let down = difference(&expected.transmitted, &found.transmitted, index);
                assert!(up <= TOLERANCE && down <= TOLERANCE, "{theta} {phi} {turned}: {up:e} {down:e}");
                for order in found.reflected.iter().filter(|order| index(order.index)[1] != 0) {
                    assert!(order.jones.as_flattened().iter().all(|j| j.norm() <= TOLERANCE), "{order:?}");
                }
            }
        }
    }
}

#[test]
fn exchange_of_axes_mirrors_the_orders() {
    const TOLERANCE: f64 = 1e-9;
    let profile = bodies(1.0, 1.5.into(), [SILVER, RESIN, 1.33.into()]);
    let exchanged = CrossedProfile {
        period_nm: [430.0, 520.0],
        slices: vec![
            CrossedSlice {
                thickness_nm: 130.0,
                strip_edges_nm: vec![100.0, 220.0, 400.0, 480.0],
                strips: vec![
                    Strip { edges_nm: vec![40.0, 330.0], eta: vec![SILVER, 1.0.into()] },
                    Strip { edges_nm: vec![40.0, 200.0], eta: vec![SILVER, 1.0.into()] },
                    Strip { edges_nm: vec![], eta: vec![1.0.into()] },
                    Strip { edges_nm: vec![200.0, 330.0], eta: vec![RESIN, 1.0.into()] },
                ],
            },
            film(60.0, RESIN),
            rectangle(90.0, [120.0, 30.0], [370.0, 260.0], 1.33.into(), SILVER),
        ],
        ..profile.clone()
    };
    let straight = light(550.0, 1.0, 37.0, 65.0);
    let [k_x, k_y] = straight.tangential;
    let found = solve(&profile, &straight, [2, 3]);
    let other = solve(&exchanged, &Light { tangential: [k_y, k_x], ..straight }, [3, 2]);
    for (orders, others) in [(&found.reflected, &other.reflected), (&found.transmitted, &other.transmitted)] {
        for order in orders {
            let [m, n] = order.index;
            for (from, to) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let [a, b] = [order, at(others, [n, m])].map(|order| order.jones[from][to].norm());
                assert!((a - b).abs() <= TOLERANCE, "{:?} {from}{to}: {a} {b}", order.index);
            }
        }
    }
}

#[test]
fn place_and_description_do_not_matter() {
    const TOLERANCE: f64 = 1e-9;
    let pillar = |x: f64, y: f64| CrossedProfile {
        period_nm: [500.0, 400.0],
        above: 1.0,
        below: RESIN,
        slices: vec![rectangle(150.0, [x, y], [x + 200.0, y + 150.0], 1.0.into(), SILVER)],
    };
    let light = light(480.0, 1.0, 25.0, 140.0);
    let expected = solve(&pillar(0.0, 0.0), &light, [2, 2]);

    // Cut into more strips and layers, none of which changes anything, and with edges between equal media.
    let mut cut = pillar(0.0, 0.0);
    let slice = &mut cut.slices[0];
    slice.thickness_nm = 50.0;
    slice.strip_edges_nm = vec![0.0, 70.0, 150.0, 300.0];
    let covered = Strip { edges_nm: vec![0.0, 80.0, 200.0], eta: vec![SILVER, SILVER, 1.0.into()] };
    let empty = Strip { edges_nm: vec![10.0, 90.0], eta: vec![1.0.into(); 2] };
    slice.strips = vec![slice.strips[0].clone(), covered, empty, slice.strips[1].clone()];
    cut.slices = vec![cut.slices[0].clone(), pillar(0.0, 0.0).slices[0].clone()];
    cut.slices[1].thickness_nm = 100.0;
    let modes = CrossedModes::new(&cut, &light, [2, 2]).unwrap();
    assert_eq!(modes.decompositions(), 1);
    let found = modes.response().unwrap();
    assert!(difference(&expected.reflected, &found.reflected, |index| index) <= TOLERANCE);

    // Moved: orders keep their powers.
    let moved = solve(&pillar(230.0, 170.0), &light, [2, 2]);
    for (order, other) in expected.reflected.iter().zip(&moved.reflected) {
        let [a, b] = [expected.reflected_efficiency(order), moved.reflected_efficiency(other)];
        assert!((a[0] - b[0]).abs() <= TOLERANCE && (a[1] - b[1]).abs() <= TOLERANCE, "{order:?} {other:?}");
    }
}

#[test]
fn anomalies_have_finite_answers() {
    const TOLERANCE: f64 = 1e-10;
    // Orders graze in air, in the substrate and in the film.
    let film_index = Complex64::from(2.0);
    for (wavelength, period) in [(500.0, 500.0), (750.0, 500.0), (1000.0, 500.0), (500.0, 500.0 + 1e-9)] {
        let profile = CrossedProfile {
            period_nm: [period, 450.0],
            above: 1.0,
            below: 1.5.into(),
            slices: vec![
                rectangle(100.0, [0.0, 0.0], [250.0, 200.0], 1.0.into(), 1.5.into()),
                film(80.0, film_index),
                rectangle(100.0, [0.0, 0.0], [250.0, 200.0], 1.0.into(), 1.5.into()),
                film(80.0, 1.0.into()),
            ],
        };
        let found = total(&solve(&profile, &light(wavelength, 1.0, 0.0, 0.0), [2, 2]));
        assert!(found.iter().all(|sum| (sum - 1.0).abs() <= TOLERANCE), "{wavelength} {period}: {found:?}");
    }
}

#[test]
fn thick_and_opaque_layers_are_safe() {
    let pillar = |thickness| CrossedProfile {
        period_nm: [300.0, 300.0],
        above: 1.0,
        below: 1.5.into(),
        slices: vec![rectangle(thickness, [0.0; 2], [150.0; 2], RESIN, SILVER), film(thickness, SILVER)],
    };
    let light = light(600.0, 1.0, 30.0, 40.0);
    let [thin, thick] = [5e3, 5e6].map(|thickness| solve(&pillar(thickness), &light, [2, 2]));
    // 5 µm of resin leave exp(−10) of the amplitude on the way to the film and back.
    assert!(difference(&thin.reflected, &thick.reflected, |index| index) <= 1e-4);
    assert!(thick.transmitted.iter().all(|order| order.jones.as_flattened().iter().all(|j| j.norm() < 1e-100)));
}

#[test]
fn wrong_input_is_refused() {
    let good = bodies(1.0, 1.5.into(), [SILVER, RESIN, 1.33.into()]);
    let light = light(550.0, 1.0, 10.0, 0.0);
    let refused = |profile: &CrossedProfile, light: &Light| CrossedModes::new(profile, light, [1, 1]).unwrap_err();
    for spoil in [
        (|p| p.period_nm[1] = 0.0) as fn(&mut CrossedProfile),
        |p| p.slices[0].thickness_nm = f64::NAN,
        |p| p.slices[0].strips.truncate(2),
        |p| p.slices[0].strips[0].eta.truncate(1),
        |p| p.slices[0].strip_edges_nm[2] = 430.0,
        |p| p.below = Complex64::ZERO,
    ] {
        let mut profile = good.clone();
        spoil(&mut profile);
        assert_eq!(refused(&profile, &light), WaveError::Profile);
    }
    for tangential in [[1.0, 0.0], [0.8, 0.8], [f64::NAN, 0.0]] {
        assert_eq!(refused(&good, &Light { tangential, ..light }), WaveError::Light);
    }
    assert_eq!(refused(&good, &Light { wavelength_nm: 0.0, ..light }), WaveError::Light);
}
