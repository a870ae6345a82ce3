//! Reducing the observer to a grid, a colour from a spectrum, and look-up in a table.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::table::MirrorTable;
use std::hint::black_box;

fn colour(c: &mut Criterion) {
    let grid: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let mut weights = vec![[0.0; 3]; grid.len()];
    c.bench_function("colour/weights of 81 wavelengths", |b| {
        b.iter(|| xyz_weights(black_box(&grid), Illuminant::D65, Quadrature::Interpolated, &mut weights));
    });
    let rho = vec![1.0; grid.len()];
    let rgb = RgbSpace::Srgb.from_xyz(xyz(&weights, rho.iter().copied()));
    assert!(rgb.iter().all(|c| (c - 1.0).abs() < 1e-3), "{rgb:?}");
    let mut group = c.benchmark_group("colour");
    group.throughput(Throughput::Elements(grid.len() as u64));
    group.bench_function("spectrum to RGB", |b| {
        b.iter(|| RgbSpace::Srgb.from_xyz(xyz(&weights, black_box(&rho).iter().copied())));
    });
    group.finish();
}

fn table(c: &mut Criterion) {
    let values: Vec<f32> = (0..270).map(|i| i as f32 / 270.0).collect();
    let table = MirrorTable::new(&values, 3, 1.55).expect("a good table");
    assert!(table.rgb(0.8)[1] > table.rgb(0.7)[1]);
    // Angles in an order that no predictor learns.
    let angles: Vec<f32> =
        (0..1024u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0 * 1.55).collect();
    let mut group = c.benchmark_group("table");
    group.throughput(Throughput::Elements(angles.len() as u64));
    group.bench_function("rgb", |b| {
        b.iter(|| {
            black_box(&angles).iter().fold([0.0f32; 3], |sum, &theta| {
                let rgb = table.rgb(theta);
                [sum[0] + rgb[0], sum[1] + rgb[1], sum[2] + rgb[2]]
            })
        });
    });
    group.finish();
}

criterion_group!(all, colour, table);
criterion_main!(all);
