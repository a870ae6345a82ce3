//! Tests of how the cost of ray tracing grows with the number of layers.

use crate::reference::Layered;
use goniochrome::optics::interface::Model;
use goniochrome::simd::lanes::{F64, Lanes};
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;
use num_complex::Complex64;

/// Layers of index 1.56 and 1.0 in turn, 100 nm each, on 1.56.
fn stack(layers: usize) -> Layered {
    let eta = |i: usize| Complex64::from(if i % 2 == 1 { 1.56 } else { 1.0 });
    Layered { eta: (0..=layers).map(eta).chain([1.56.into()]).collect(), thickness_nm: vec![100.0; layers] }
}

/// Number of visits of a trace through so many layers; its reflectance must agree with the closed form.
fn visits(layers: usize, summation: Summation) -> f64 {
    let mut workspace = Box::new(Workspace::<F64, 64>::new());
    stack(layers).with_prepared::<F64, _>(0.0, &[550.0], Model::Physical, |prepared| {
        let traced = trace_planar(prepared, summation, workspace.memory()).expect("the stack fits");
        let closed = prepared.reflectance(prepared.reflection());
        let difference = Lanes::lane(traced.ledger.reflected.s - closed.s, 0);
        assert!(difference.abs() < 1e-9, "{layers} layers: {difference:e}");
        traced.trace.visits as f64
    })
}

#[test]
fn visits_grow_no_faster_than_layers_squared() {
    let counts = [2, 4, 8, 15, 30, 60];
    for pair in counts.windows(2) {
        let (few, many) = (visits(pair[0], Summation::ClosedLoops), visits(pair[1], Summation::ClosedLoops));
        let layers = pair[1] as f64 / pair[0] as f64;
        println!("{} to {} layers: {few} to {many} visits", pair[0], pair[1]);
        assert!(many / few <= layers * layers);
    }
}

#[test]
fn hit_by_hit_is_polynomial() {
    // Unmerged, 60 layers have more than 2^60 paths before the first leaves at the bottom.
    let (few, many) =
        (visits(30, Summation::Generations(Limits::DOUBLE)), visits(60, Summation::Generations(Limits::DOUBLE)));
    println!("30 to 60 layers: {few} to {many} visits, exponent {:.2}", (many / few).log2());
    assert!(many / few < 2f64.powi(5));
}
