//! Times the stage `interface` of `goniochrome_benches::stages`, in single and double precision.

use criterion::{Criterion, criterion_group, criterion_main};
use goniochrome::simd::lanes::{F32, F64};
use goniochrome_benches::criterion::time;
use goniochrome_benches::stages::interface;

fn benches(c: &mut Criterion) {
    interface::<F32>(&mut time(c, "f32"));
    interface::<F64>(&mut time(c, "f64"));
}

criterion_group!(all, benches);
criterion_main!(all);
