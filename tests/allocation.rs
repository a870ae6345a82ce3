//! Tests that the core does not allocate. Every heap allocation of the process is counted, per thread.

use crate::reference::{Layered, planar};
use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};
use goniochrome::optics::interface::Model;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::table::blob::{Blob, Contents, Precision};
use goniochrome::table::{
    FacetLobe, HalfVectorWarp, OrderArrays, OrderLayout, OrderTable, Periodicity, ScatterLayout, ScatterSampler,
    ScatterTable,
};
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

#[test]
fn tables_of_orders_do_not_allocate() {
    let mut bytes = [0; 1024];
    let counted = allocation_counter::measure(|| {
        let layout = OrderLayout::new([3, 2], Periodicity::X, [1600.0; 2]).expect("a good grid");
        let arrays = OrderArrays {
            orders: &[[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]],
            wavelength_nm: &[450.0, 650.0],
            index: &[1.0; 2],
            rgb_weights: &[[0.5; 3]; 2],
            strength: &[0.1; 36],
        };
        let table = OrderTable::new(layout, &arrays).expect("a good table");
        let blob = Blob { space: None, contents: Contents::Orders(table) };
        let length = blob.required_len(Precision::Half).expect("a small blob");
        blob.write(Precision::Half, &mut bytes[..length]).expect("enough room");
        let Ok(Blob { contents: Contents::Orders(table), .. }) = Blob::read(&bytes[..length]) else { panic!("orders") };
        let view = table.view(glam::Vec3::Z).expect("above the horizon");
        black_box((view.light(0, 0), view.light_between(0, 0.5, 2), view.sample(1, 0.5), view.probability(1, 0)));
    });
    assert_eq!(counted.count_total, 0);
}

#[test]
fn scatter_tables_do_not_allocate() {
    let (mut bytes, mut pairs, mut cumulative, mut out) = ([0; 4096], [0.0; 8], [0.0; 256], [0.0; 3]);
    let counted = allocation_counter::measure(|| {
        let layout = ScatterLayout::new([2, 2], [4, 4], 1).expect("a good grid");
        let warp = HalfVectorWarp::new([&[1.0, 2.0], &[1.0, 1.0]], &mut pairs).expect("a good warp");
        let lobes = [FacetLobe::reflection(glam::Vec3::Z).to_numbers()];
        let table = ScatterTable::new(&[0.1; 3 * 4 * 17], layout, warp, &lobes, 3).expect("a good table");
        let cumulative = &mut cumulative[..ScatterSampler::required_len(&layout)];
        let sampler = ScatterSampler::new(&table, cumulative).expect("enough room");
        let blob = Blob { space: None, contents: Contents::Scatter(table, sampler) };
        let length = blob.required_len(Precision::Half).expect("a small blob");
        blob.write(Precision::Half, &mut bytes[..length]).expect("enough room");
        let Ok(Blob { contents: Contents::Scatter(table, sampler), .. }) = Blob::read(&bytes[..length]) else {
            panic!("a scatter table")
        };
        let (wi, wo) = (glam::Vec3::new(0.6, 0.0, 0.8), glam::Vec3::Z);
        table.albedo(wi, &mut out);
        black_box((table.rgb(wi, wo), table.reflected(wi, 0, &mut out), sampler.pdf(wi, wo)));
        black_box(sampler.sample(wi, [0.5; 2]));
    });
    assert_eq!(counted.count_total, 0);
}
