//! Times the stage `phase` of `goniochrome_benches::stages`, in single and double precision.

use criterion::{Criterion, criterion_group, criterion_main};
use goniochrome::simd::lanes::{F32, F64};
use goniochrome_benches::criterion::time;
use goniochrome_benches::stages::phase;

fn benches(c: &mut Criterion) {
    phase::<F32>(&mut time(c, "f32"));
    phase::<F64>(&mut time(c, "f64"));
}

criterion_group!(all, benches);
criterion_main!(all);
