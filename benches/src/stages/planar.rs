use std::hint::black_box;

use goniochrome::simd::lanes::Lanes;
use goniochrome::trace::planar::{Summation, Workspace, rounding, trace_planar};

use super::{Visit, Work};
use crate::{LIMITS, MAX_PLANES, beetle, group};

/// Rays through the 20-layer stack at 30 degrees: with loops closed, and hit by hit.
///
/// # Panics
/// If a result is wrong.
pub fn planar<V: Lanes>(visit: Visit<'_>) {
    let stack = beetle();
    let mut workspace = Box::new(Workspace::<V, MAX_PLANES>::new());
    stack.with_prepared::<V, _>(0.5, &group::<V>(), |prepared| {
        let closed = prepared.reflectance(prepared.reflection()).s.lane(0);
        for (name, summation) in
            [("closed loops", Summation::ClosedLoops), ("hit by hit", Summation::Generations(LIMITS))]
        {
            let traced = trace_planar(prepared, summation, workspace.memory()).expect("the stack fits");
            assert!((traced.ledger.reflected.s.lane(0) - closed).abs() < 1e-5);
            let amount = traced.trace.visits as f64 * V::WIDTH as f64;
            visit(&Work { stage: "trace planar", name, unit: "wavelength·states", amount }, &mut || {
                black_box(trace_planar(black_box(prepared), summation, workspace.memory()).expect("the stack fits"));
            });
            if summation == Summation::ClosedLoops {
                visit(
                    &Work { stage: "trace planar", name: "rounding", unit: "wavelength·states", amount },
                    &mut || {
                        black_box(rounding(black_box(prepared), workspace.memory().totals));
                    },
                );
            }
        }
    });
}
