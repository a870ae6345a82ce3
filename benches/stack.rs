//! The closed form: preparation of a stack at one angle, and the recursion; wavelengths × layers per second.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use goniochrome::interface::Model;
use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome::stack::{Optics, OpticsArrays};
use goniochrome_benches::{MOST_PLANES, beetle, group};
use std::hint::black_box;

fn bench<V: Lanes>(c: &mut Criterion, name: &str) {
    let stack = beetle();
    let mut benches = c.benchmark_group("stack");
    benches.throughput(Throughput::Elements((V::WIDTH * stack.layers.len()) as u64));
    stack.with::<V, _>(&group::<V>(), |stack, media| {
        let mut memory = Box::new(OpticsArrays::<V, MOST_PLANES>::new());
        benches.bench_function(BenchmarkId::new("prepare", name), |b| {
            b.iter(|| Optics::new(stack, media, black_box(0.5), Model::Physical, memory.memory()).model());
        });
    });
    stack.with_optics::<V, _>(0.5, &group::<V>(), |optics| {
        let r = optics.reflectance(optics.reflection()).s.lane(0);
        assert!((0.0..1.0).contains(&r));
        benches.bench_function(BenchmarkId::new("reflection", name), |b| b.iter(|| black_box(optics).reflection()));
        benches.bench_function(BenchmarkId::new("response", name), |b| b.iter(|| black_box(optics).response()));
    });
    benches.finish();
}

fn benches(c: &mut Criterion) {
    bench::<F32>(c, "f32");
    bench::<F64>(c, "f64");
}

criterion_group!(all, benches);
criterion_main!(all);
