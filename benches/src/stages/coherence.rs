use std::hint::black_box;

use goniochrome::geometry::side::Side;
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::Lanes;
use goniochrome::trace::ledger::Specular;
use goniochrome::trace::waves::Sink;

use super::{Visit, Work};

const EXITS: usize = 64;

/// The coherent sum of 64 rays that leave in two directions, added as amplitudes.
///
/// # Panics
/// If a result is wrong.
pub fn coherence<V: Lanes>(visit: Visit<'_>) {
    let amplitude = |i: usize| ComplexLanes::new(V::splat(1.0 / (i + 1) as f64), V::splat(-0.5 / (i + 1) as f64));
    let fields: Vec<_> = (0..EXITS).map(|i| Polarised::both(amplitude(i))).collect();
    let run = || {
        let mut sum = Specular::<V>::new();
        for (i, &field) in black_box(&fields).iter().enumerate() {
            sum.exit(if i % 2 == 0 { Side::Above } else { Side::Below }, field);
        }
        sum.response()
    };
    // 1 + 1/3 + 1/5 + …, 32 terms.
    let odd: f64 = (0..EXITS).step_by(2).map(|i| 1.0 / (i + 1) as f64).sum();
    assert!((run().reflection.s.lane(0).re - odd).abs() < 64.0 * V::UNIT_ROUNDOFF * odd);
    let amount = (EXITS * V::WIDTH) as f64;
    visit(&Work { stage: "coherence", name: "specular sum", unit: "wavelength·exits", amount }, &mut || {
        black_box(run());
    });
}
