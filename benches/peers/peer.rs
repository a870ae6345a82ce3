//! `peer METHOD PRECISION REPEATS`: times the spectra of the 20-layer stack, and prints seconds of processor time and
//! results as JSON.

use goniochrome::optics::interface::Model;
use goniochrome_benches::clock::processor_time;
use goniochrome_benches::twenty_layers;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::spectra::{Method, Sample, SpectraRequest, spectra};
use std::env;
use std::error::Error;
use std::hint::black_box;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [method, precision, repeats] = &arguments[..] else {
        return Err("usage: peer METHOD PRECISION REPEATS".into());
    };
    let method = match method.as_str() {
        "stack" => Method::Stack,
        "trace" => Method::Trace,
        other => return Err(format!("no method {other}").into()),
    };
    let precision = if precision == "f64" { Precision::F64 } else { Precision::F32 };
    let request = SpectraRequest { model: Model::Physical, method, precision, threads: 1 };

    let scene = twenty_layers();
    let planar = PlanarScene::new(&scene)?;
    let theta: Vec<f64> = (0..90).map(f64::from).collect();
    let wavelengths: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let mut seconds = Vec::new();
    let mut result = spectra(&planar, &theta, &wavelengths, &request, &|| ())?;
    for _ in 0..repeats.parse::<usize>()? {
        let run = || spectra(&planar, black_box(&theta), &wavelengths, &request, &|| ());
        let (found, time) = processor_time(run);
        result = found?;
        seconds.push(time.as_secs_f64());
    }
    let column = |of: fn(&Sample) -> f64| result.samples.iter().map(of).collect::<Vec<_>>();
    let out = serde_json::json!({
        "seconds": seconds,
        "R_s": column(|sample| sample.reflectance.s),
        "R_p": column(|sample| sample.reflectance.p),
        "T_s": column(|sample| sample.transmittance.s),
        "T_p": column(|sample| sample.transmittance.p),
    });
    println!("{out}");
    Ok(())
}
