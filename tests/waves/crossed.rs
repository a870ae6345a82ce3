//! Surfaces with two periods.

use std::f64::consts::TAU;

use goniochrome_waves::crossed::CrossedModes;
use goniochrome_waves::light::Light;
use goniochrome_waves::profile::{CrossedProfile, CrossedSlice, Strip};
use goniochrome_waves::response::Response;
use goniochrome_waves::Complex64;

/// Light from polar angle `theta` and azimuth `phi` in degrees, in a medium of index `above`.
fn light(wavelength_nm: f64, above: f64, theta: f64, phi: f64) -> Light {
    let (sin, azimuth) = (theta.to_radians().sin(), phi.to_radians());
    Light { wavelength_nm, tangential: [-above * sin * azimuth.cos(), -above * sin * azimuth.sin()] }
}

/// Layer with a rectangle of index `inside` from `from` to `to`.
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

fn solve(profile: &CrossedProfile, light: &Light, max_order: [usize; 2]) -> Response {
    CrossedModes::new(profile, light, max_order).and_then(|modes| modes.response()).unwrap()
}

/// Sums of reflected and transmitted efficiencies in s and in p.
fn total(response: &Response) -> [f64; 2] {
    let up = response.reflected.iter().map(|order| response.reflected_efficiency(order));
    let down = response.transmitted.iter().map(|order| response.transmitted_efficiency(order));
    up.chain(down).fold([0.0, 0.0], |sum, share| [sum[0] + share[0], sum[1] + share[1]])
}

#[test]
fn scratch() {
    let reference: serde_json::Value = serde_json::from_str(include_str!("../data/crossed.json")).unwrap();
    let case = &reference["cases"][0];
    let profile = CrossedProfile {
        period_nm: [600.0, 600.0],
        above: 1.0,
        below: 1.5.into(),
        slices: vec![rectangle(200.0, [0.0, 0.0], [300.0, 300.0], 1.0.into(), 1.5.into())],
    };
    for m in 2..8 {
        let mut worst = 0.0_f64;
        let mut energy = 0.0_f64;
        let start = std::time::Instant::now();
        for data in case["data"].as_array().unwrap() {
            let number = |key: &str| data[key].as_f64().unwrap();
            let light = light(number("wavelength_nm"), 1.0, number("theta_deg"), number("phi_deg"));
            let response = solve(&profile, &light, [m, m]);
            eprint!("{:.1e} ", total(&response).into_iter().fold(0.0_f64, |e, t| e.max((t - 1.0).abs())));
            energy = total(&response).into_iter().fold(energy, |e, t| e.max((t - 1.0).abs()));
            for (i, order) in data["orders"].as_array().unwrap().iter().enumerate() {
                let index = [0, 1].map(|k| i32::try_from(order[k].as_i64().unwrap()).unwrap());
                let at = response.reflected.iter().position(|order| order.index == index).unwrap();
                let r = response.reflected_efficiency(&response.reflected[at]);
                let t = response.transmitted_efficiency(&response.transmitted[at]);
                for (key, value) in [("R_s", r[0]), ("R_p", r[1]), ("T_s", t[0]), ("T_p", t[1])] {
                    worst = worst.max((value - data[key][i].as_f64().unwrap()).abs());
                }
            }
        }
        println!("{m} {worst:e} energy {energy:e} {:?}", start.elapsed() / 9);
    }
}
