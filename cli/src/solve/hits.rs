//! `--method hits`: what bounds the work of a sum of rays hit by hit, and what stands in for a sum that does not converge.
//!
//! A sum hit by hit diverges where a loop of absorbing or evanescent waves gains, and takes millions of generations
//! where one hardly loses. Closed loops are its limit, and the solution of the same equations where it has none. So its
//! error is known, and where it is too large the sample falls back to closed loops.

use goniochrome::trace::waves::Limits;

use crate::solve::precision::Precision;
use crate::solve::spectra::{Sample, Spectra};

/// The largest error of a sample that is not replaced.
fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-5,
        Precision::F64 => 1e-9,
    }
}

/// The limits with as many generations as a stack of so many planes may take: on average one visits every plane once.
pub(crate) fn affordable(limits: Limits, planes: usize) -> Limits {
    /// 0.15 s for each group of wavelengths on a core of 2020. The paper's three films ring longest at 89 degrees, for
    /// 350 000 generations of 6 visits.
    const VISITS: usize = 2_500_000;
    let generations = u32::try_from(VISITS / planes).unwrap_or(u32::MAX).max(1);
    Limits { generations: generations.min(limits.generations), ..limits }
}

/// Sums hit by hit with their error bars; those further than the tolerance from `closed`, the same with loops closed,
/// fall back to that.
pub(crate) fn settled(mut summed: Spectra, closed: &Spectra, precision: Precision) -> Spectra {
    let tolerance = tolerance(precision);
    for (sample, closed) in summed.samples.iter_mut().zip(&closed.samples) {
        let differences = differences(sample, closed);
        // What is no number is not within the tolerance.
        if differences.iter().all(|difference| *difference <= tolerance) {
            sample.truncated = differences.into_iter().fold(0.0, f64::max);
        } else {
            *sample = *closed;
            summed.fell_back += 1;
        }
    }
    summed
}

/// By how much each reflectance and transmittance differs.
fn differences(a: &Sample, b: &Sample) -> [f64; 4] {
    let all = |sample: &Sample| {
        let Sample { reflectance: r, transmittance: t, .. } = sample;
        [r.s, r.p, t.s, t.p]
    };
    let (a, b) = (all(a), all(b));
    std::array::from_fn(|i| (a[i] - b[i]).abs())
}
