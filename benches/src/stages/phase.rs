use std::hint::black_box;

use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::Lanes;
use goniochrome::simd::phase::{cis, propagate};

use super::{Visit, Work};

/// Phases: sine and cosine of a reduced phase, and whole propagators.
///
/// # Panics
/// If a result is wrong.
pub fn phase<V: Lanes>(visit: Visit<'_>) {
    let work = |name| Work { stage: "phase", name, unit: "wavelengths", amount: V::WIDTH as f64 };
    let phase = V::from_fn(|i| 0.9 * (i as f64 / V::WIDTH as f64) - 0.45);
    let check = cis(phase).norm_sqr().lane(0);
    assert!((check - 1.0).abs() < 8.0 * V::UNIT_ROUNDOFF, "{check}");
    visit(&work("cis"), &mut || {
        black_box(cis(black_box(phase)));
    });
    let path = ComplexLanes::new(V::Precise::from_fn(|i| 700.3 + i as f64), V::Precise::from_fn(|i| 0.01 * i as f64));
    visit(&work("propagate"), &mut || {
        black_box(propagate::<V>(black_box(path)));
    });
}
