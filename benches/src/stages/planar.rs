use std::hint::black_box;

use goniochrome::simd::lanes::Lanes;
use goniochrome::trace::planar::{Summation, Workspace, rounding, trace_planar};
use goniochrome::trace::waves::Limits;

use super::{Visit, Work};
use crate::{MAX_PLANES, beetle, group};

/// Power in flight, enough for 1e-5 in reflectance.
const LIMITS: Limits = Limits { in_flight: 1e-12, ..Limits::SINGLE };

/// Rays through the 20-layer stack at 30 degrees, loops closed and hit by hit.
pub fn planar<V: Lanes>(visit: Visit<'_>) {
    let stack = beetle();
    let mut workspace = Box::new(Workspace::<V, MAX_PLANES>::new());
    stack.with_optics::<V, _>(0.5, &group::<V>(), |optics| {
        let closed = optics.reflectance(optics.reflection()).s.lane(0);
        for (name, summation) in
            [("closed loops", Summation::ClosedLoops), ("hit by hit", Summation::Generations(LIMITS))]
        {
            let traced = trace_planar(optics, summation, workspace.memory()).expect("the stack fits");
            assert!((traced.ledger.reflected.s.lane(0) - closed).abs() < 1e-5);
            let amount = traced.trace.visits as f64 * V::WIDTH as f64;
            visit(&Work { stage: "trace planar", name, unit: "wavelength·states", amount }, &mut || {
                black_box(trace_planar(black_box(optics), summation, workspace.memory()).expect("the stack fits"));
            });
            if summation == Summation::ClosedLoops {
                visit(
                    &Work { stage: "trace planar", name: "rounding", unit: "wavelength·states", amount },
                    &mut || {
                        black_box(rounding(black_box(optics), workspace.memory().totals));
                    },
                );
            }
        }
    });
}
