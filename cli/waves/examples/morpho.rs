//! Times one solve of the ridge of a Morpho scale, for `benches/peers/waves`: `morpho WAVES_JSON MAX_ORDER SOLVES`.
//!
//! Reads the case `morpho_ridge` and solves its record of wavelength 480 nm, θ = 30°, φ = 40° (conical) in s and p.
//! Prints one line of JSON: milliseconds of processor time of each solve and its parts, and the efficiencies.

use std::error::Error;
use std::time::Instant;

use goniochrome_waves::Complex64;
use goniochrome_waves::lamellar::Modes;
use goniochrome_waves::profile::{Profile, Slice};
use serde_json::{Value, json};

const WAVELENGTH_NM: f64 = 480.0;
const THETA_DEG: f64 = 30.0;
const PHI_DEG: f64 = 40.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, max_order, solves] = arguments.as_slice() else {
        return Err("usage: morpho WAVES_JSON MAX_ORDER SOLVES".into());
    };
    let (max_order, solves): (usize, usize) = (max_order.parse()?, solves.parse()?);
    let file: Value = serde_json::from_str(&std::fs::read_to_string(path)?)?;
    let cases = file["cases"].as_array().ok_or("cases")?;
    let case = cases.iter().find(|case| case["name"] == "morpho_ridge").ok_or("morpho_ridge")?;
    let profile = read(case).ok_or("a case of another form")?;
    let (sin_phi, cos_phi) = PHI_DEG.to_radians().sin_cos();
    let sin_theta = THETA_DEG.to_radians().sin();
    let mut milliseconds = Vec::new();
    let mut decomposing = Vec::new();
    let mut last = None;
    for _ in 0..solves {
        let start = Instant::now();
        let modes = Modes::new(&profile, WAVELENGTH_NM, -sin_theta * cos_phi, max_order)?;
        decomposing.push(start.elapsed().as_secs_f64() * 1e3);
        let response = modes.response(-sin_theta * sin_phi)?;
        milliseconds.push(start.elapsed().as_secs_f64() * 1e3);
        last = Some((modes.decompositions(), response));
    }
    let (decompositions, response) = last.ok_or("SOLVES must be 1 or more")?;
    let orders: Vec<Value> = response
        .reflected
        .iter()
        .filter(|order| order.vertical.im == 0.0)
        .map(|order| json!([order.index[0], response.reflected_efficiency(order)]))
        .collect();
    let report = json!({
        "milliseconds": milliseconds,
        "decomposing": decomposing,
        "decompositions": decompositions,
        "slices": profile.slices.len(),
        "orders": 2 * max_order + 1,
        "reflected": orders,
    });
    println!("{report}");
    Ok(())
}

fn read(case: &Value) -> Option<Profile> {
    let index = |value: &Value| Some(Complex64::new(value[0].as_f64()?, value[1].as_f64()?));
    let period_nm = case["period_nm"].as_f64()?;
    let slice = |layer: &Value| {
        let edges = layer["edges"].as_array()?;
        let edges = &edges[..edges.len() - 1];
        Some(Slice {
            thickness_nm: layer["thickness_nm"].as_f64()?,
            edges_nm: edges.iter().map(|edge| Some(edge.as_f64()? * period_nm)).collect::<Option<_>>()?,
            eta: layer["n"].as_array()?.iter().map(index).collect::<Option<_>>()?,
        })
    };
    Some(Profile {
        period_nm,
        above: index(&case["above"])?.re,
        below: index(&case["below"])?,
        slices: case["layers_from_top"].as_array()?.iter().map(slice).collect::<Option<_>>()?,
    })
}
