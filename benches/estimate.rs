//! Times an estimate from end to end: the 20-layer stack at 90 angles and 81 wavelengths, s and p, one thread and two.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use goniochrome::optics::interface::Model;
use goniochrome_benches::twenty_layers;
use goniochrome_cli::solve::planar_scene::PlanarScene;
use goniochrome_cli::solve::precision::Precision;
use goniochrome_cli::solve::spectra::{Method, SpectraRequest, spectra};
use std::hint::black_box;

fn estimate(c: &mut Criterion) {
    let scene = twenty_layers();
    let planar = PlanarScene::new(&scene).expect("a planar scene");
    let theta: Vec<f64> = (0..90).map(f64::from).collect();
    let wavelengths: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let mut group = c.benchmark_group("estimate");
    group.throughput(Throughput::Elements((theta.len() * wavelengths.len()) as u64));
    for (name, method, precision, threads) in [
        ("closed form f32, 1 thread", Method::Stack, Precision::F32, 1),
        ("closed form f64, 1 thread", Method::Stack, Precision::F64, 1),
        ("ray tracing f32, 1 thread", Method::Trace, Precision::F32, 1),
        ("ray tracing f32, 2 threads", Method::Trace, Precision::F32, 2),
        ("hit by hit f32, 1 thread", Method::Hits, Precision::F32, 1),
    ] {
        let request = SpectraRequest { model: Model::Physical, method, precision, threads };
        let run = || spectra(&planar, black_box(&theta), &wavelengths, &request, &|| ()).expect("a good grid");
        assert!(run().worst(|sample| sample.reflectance.s) <= 1.0 + 1e-5);
        if method == Method::Hits {
            group.sample_size(10);
        }
        group.bench_function(BenchmarkId::from_parameter(name), |b| b.iter(run));
    }
    group.finish();
}

criterion_group!(all, estimate);
criterion_main!(all);
