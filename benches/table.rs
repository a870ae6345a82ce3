//! Times the stage `table` of `goniochrome_benches::stages`.

use criterion::{Criterion, criterion_group, criterion_main};
use goniochrome_benches::criterion::time;
use goniochrome_benches::stages::table;

fn benches(c: &mut Criterion) {
    table(&mut time(c, ""));
}

criterion_group!(all, benches);
criterion_main!(all);
