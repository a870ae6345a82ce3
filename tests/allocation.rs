//! Tests that the core does not allocate. Every heap allocation of the process is counted, per thread.

use crate::reference::{Layered, planar};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::optics::interface::Model;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;
use std::hint::black_box;

fn trace_all<V: Lanes>(limits: Limits) -> u64 {
    let mut workspace = Box::new(Workspace::<V>::new());
    let mut counted = 0;
    for case in planar() {
        let stack = Layered::from(&case);
        stack.with_prepared::<V, _>(60.0, &case.wavelength_nm[..V::WIDTH.min(8)], Model::Physical, |prepared| {
            counted += allocation_counter::measure(|| {
                black_box(prepared.response());
                for summation in [Summation::ClosedLoops, Summation::Generations(limits)] {
                    black_box(trace_planar(prepared, summation, workspace.memory()).expect("the stack fits"));
                }
            })
            .count_total;
        });
    }
    counted
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocation_counter::measure(|| drop(black_box(vec![1u8; 100]))).count_total, 1);
}

#[test]
fn tracing_and_colour_do_not_allocate() {
    assert_eq!(trace_all::<F32>(Limits::SINGLE), 0);
    assert_eq!(trace_all::<F64>(Limits::DOUBLE), 0);
    let colour = allocation_counter::measure(|| {
        let grid: [f64; 81] = core::array::from_fn(|i| 380.0 + 5.0 * i as f64);
        let mut weights = [[0.0; 3]; 81];
        xyz_weights(&grid, Illuminant::D65, Quadrature::Interpolated, &mut weights).expect("a good grid");
        black_box(RgbSpace::Srgb.from_xyz(xyz(&weights, grid.map(|nm| nm / 800.0))));
    });
    assert_eq!(colour.count_total, 0);
}
