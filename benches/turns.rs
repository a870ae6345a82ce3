//! sin and cos of a reduced phase, and whole propagators: lanes per second.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use goniochrome::complex::ComplexLanes;
use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome::turns::{cis, propagate};
use std::hint::black_box;

fn bench<V: Lanes>(c: &mut Criterion, name: &str) {
    let mut group = c.benchmark_group("turns");
    group.throughput(Throughput::Elements(V::WIDTH as u64));
    let turn = V::from_fn(|i| 0.9 * (i as f64 / V::WIDTH as f64) - 0.45);
    let check = cis(turn).norm_sqr().lane(0);
    assert!((check - 1.0).abs() < 8.0 * V::UNIT_ROUNDOFF, "{check}");
    group.bench_function(BenchmarkId::new("cis", name), |b| b.iter(|| cis(black_box(turn))));
    let path = ComplexLanes::new(V::Precise::from_fn(|i| 700.3 + i as f64), V::Precise::from_fn(|i| 0.01 * i as f64));
    group.bench_function(BenchmarkId::new("propagate", name), |b| b.iter(|| propagate::<V>(black_box(path))));
    group.finish();
}

fn benches(c: &mut Criterion) {
    bench::<F32>(c, "f32");
    bench::<F64>(c, "f64");
}

criterion_group!(all, benches);
criterion_main!(all);
