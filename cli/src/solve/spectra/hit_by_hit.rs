//! `--method hits`: the bound on the work of a sum of rays hit by hit, and the fall-back of sums that do not converge.
//!
//! A sum hit by hit diverges where a loop of absorbing or evanescent waves gains, and takes millions of generations
//! where a loop hardly loses. Closed loops are the sum's limit; where it has none, they are the solution of the same
//! equations. So the error of a sum is known, and where it is too large the sample falls back to closed loops.

use goniochrome::trace::waves::Limits;

use crate::solve::precision::Precision;
use crate::solve::spectra::samples::{Sample, Spectra};

/// The largest error of a sample that does not fall back.
fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-5,
        Precision::F64 => 1e-9,
    }
}

/// Limits with no more generations than a stack of so many planes can afford: on average a generation visits every
/// plane once.
pub(super) fn affordable(limits: Limits, planes: usize) -> Limits {
    /// 0.15 s for each group of wavelengths on a core of 2020. The paper's three films ring longest at 89 degrees, for
    /// 350 000 generations of 6 visits.
    const MAX_VISITS: usize = 2_500_000;
    let generations = u32::try_from(MAX_VISITS / planes).unwrap_or(u32::MAX).max(1);
    Limits { generations: generations.min(limits.generations), ..limits }
}

/// Compares sums hit by hit with `closed`, the spectra of the same grid with closed loops. Sums within the tolerance
/// get their error bar; the others fall back to `closed`.
pub(super) fn replace_unconverged(mut summed: Spectra, closed: &Spectra, precision: Precision) -> Spectra {
    let tolerance = tolerance(precision);
    for (sample, closed) in summed.samples.iter_mut().zip(&closed.samples) {
        let differences = differences(sample, closed);
        // NaN is not within the tolerance.
        if differences.iter().all(|difference| *difference <= tolerance) {
            sample.truncated = differences.into_iter().fold(0.0, f64::max);
        } else {
            *sample = *closed;
            summed.fell_back += 1;
        }
    }
    summed
}

/// The differences between two samples in R and T, for s and p.
fn differences(a: &Sample, b: &Sample) -> [f64; 4] {
    let all = |sample: &Sample| {
        let Sample { reflectance: r, transmittance: t, .. } = sample;
        [r.s, r.p, t.s, t.p]
    };
    let (a, b) = (all(a), all(b));
    std::array::from_fn(|i| (a[i] - b[i]).abs())
}
