//! Timing of the stages by criterion.

use criterion::{BenchmarkId, Criterion, Throughput};

use crate::stages::Work;

/// A visitor that times each piece of work of a stage, under its name and the kind of lanes.
pub fn time(c: &mut Criterion, lanes: &'static str) -> impl FnMut(&Work, &mut dyn FnMut()) {
    move |work, run| {
        let mut group = c.benchmark_group(work.stage);
        group.throughput(Throughput::Elements(work.amount as u64));
        group.bench_function(BenchmarkId::new(work.name, lanes), |b| b.iter(&mut *run));
        group.finish();
    }
}
