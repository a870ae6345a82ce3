//! Tests of the closed form and of ray tracing against independent transfer-matrix results.

use crate::reference::{Layered, PlanarCase, planar, weak_ambient};
use goniochrome::optics::interface::Model;
use goniochrome::optics::medium::MAX_AMBIENT_K;
use goniochrome::simd::complex::Polarised;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;
use num_complex::Complex64;

/// Rounding of a reference that is printed to 12 significant digits.
const PRINTED: f64 = 1e-12;
const SINGLE: f64 = 1e-5;
const DOUBLE_CLOSED_FORM: f64 = 1e-11;
const DOUBLE_TRACED: f64 = 1e-9;

/// The largest error, truncation and imbalance of a case.
struct Worst {
    error: f64,
    truncated: f64,
    imbalance: f64,
}

fn worst<V: Lanes>(case: &PlanarCase, summation: Option<Summation>) -> Worst {
    let stack = Layered::from(case);
    let mut worst = Worst { error: 0.0, truncated: 0.0, imbalance: 0.0 };
    let mut workspace = Box::new(Workspace::<V>::new());
    for (row, &theta) in case.theta_deg.iter().enumerate() {
        for (group, wavelengths) in case.wavelength_nm.chunks(V::WIDTH).enumerate() {
            let (r, t) = stack.with_prepared::<V, _>(theta, wavelengths, Model::Physical, |prepared| match summation {
                None => {
                    let response = prepared.response();
                    (prepared.reflectance(response.reflection), prepared.transmittance(response.transmission))
                }
                Some(summation) => {
                    let traced = trace_planar(prepared, summation, workspace.memory()).expect("the stack fits");
                    let Polarised { s, p } = traced.ledger.imbalance;
                    for lane in 0..V::WIDTH {
                        worst.truncated = worst.truncated.max(traced.ledger.truncated.lane(lane));
                        worst.imbalance = worst.imbalance.max(s.lane(lane).abs()).max(p.lane(lane).abs());
                    }
                    (traced.ledger.reflected, traced.ledger.transmitted)
                }
            });
            for (lane, _) in wavelengths.iter().enumerate() {
                let column = group * V::WIDTH + lane;
                for (got, want) in [(r.s, &case.R_s), (r.p, &case.R_p), (t.s, &case.T_s), (t.p, &case.T_p)] {
                    worst.error = worst.error.max((got.lane(lane) - want[row][column]).abs());
                }
            }
        }
    }
    worst
}

fn holds<V: Lanes>(summation: Option<Summation>, tolerance: f64) {
    for case in planar() {
        let Worst { error, truncated, imbalance } = worst::<V>(&case, summation);
        println!("{:24} error {error:.1e}  truncated {truncated:.1e}  imbalance {imbalance:.1e}", case.name);
        assert!(error <= tolerance + PRINTED, "{}: {error:e}", case.name);
        assert!(truncated <= tolerance, "{}: truncated {truncated:e}", case.name);
        assert!(imbalance <= tolerance, "{}: imbalance {imbalance:e}", case.name);
    }
}

#[test]
fn closed_form_f32() {
    holds::<F32>(None, SINGLE);
}

#[test]
fn closed_form_f64() {
    holds::<F64>(None, DOUBLE_CLOSED_FORM);
}

#[test]
fn ray_tracing_f32() {
    holds::<F32>(Some(Summation::ClosedLoops), SINGLE);
}

#[test]
fn ray_tracing_f64() {
    holds::<F64>(Some(Summation::ClosedLoops), DOUBLE_TRACED);
}

#[test]
fn ray_tracing_hit_by_hit_f32() {
    holds::<F32>(Some(Summation::Generations(Limits::SINGLE)), SINGLE);
}

#[test]
fn ray_tracing_hit_by_hit_f64() {
    holds::<F64>(Some(Summation::Generations(Limits::DOUBLE)), DOUBLE_TRACED);
}

/// Bound of rounding: the reference is printed to 14 digits, and a plasmon's resonance amplifies the rounding of 41
/// planes.
const WEAK_AMBIENT: f64 = 1e-11;

#[test]
fn light_that_arrives_through_faint_absorption_agrees_with_the_reference() {
    for case in weak_ambient() {
        assert!(case.n[0][1] > 0.0 && case.n[0][1] <= MAX_AMBIENT_K, "{}", case.name);
        for (summation, tolerance) in [
            (None, WEAK_AMBIENT),
            (Some(Summation::ClosedLoops), WEAK_AMBIENT),
            (Some(Summation::Generations(Limits::DOUBLE)), DOUBLE_TRACED),
        ] {
            let Worst { error, .. } = worst::<F64>(&case, summation);
            println!("{:24} {summation:?} error {error:.1e}", case.name);
            assert!(error <= tolerance, "{} {summation:?}: {error:e}", case.name);
        }
    }
}

/// Under an absorbing medium, the ledger lacks the power that the incident and the reflected wave exchange, and nothing
/// else.
#[test]
fn what_an_absorbing_ambient_leaves_out_is_the_exchange_of_two_waves() {
    let mut largest: f64 = 0.0;
    for case in weak_ambient() {
        let stack = Layered::from(&case);
        let mut workspace = Box::new(Workspace::<F64>::new());
        let eta = stack.eta[0];
        for &theta in &case.theta_deg {
            stack.with_prepared::<F64, _>(theta, &case.wavelength_nm, Model::Physical, |prepared| {
                let traced =
                    trace_planar(prepared, Summation::ClosedLoops, workspace.memory()).expect("the stack fits");
                let (r, missing) = (traced.response.reflection, traced.ledger.imbalance);
                let sin = theta.to_radians().sin();
                let q = (eta * eta - Complex64::from(eta.re * sin).powi(2)).sqrt();
                for (r, missing, admittance) in [(r.s, missing.s, q), (r.p, missing.p, q / (eta * eta))] {
                    for lane in 0..case.wavelength_nm.len().min(F64::WIDTH) {
                        // R + T + A = 1 + 2 Im κ Im r / Re κ.
                        let exchange = 2.0 * admittance.im / admittance.re * r.lane(lane).im;
                        let missing = Lanes::lane(missing, lane);
                        assert!((missing + exchange).abs() <= WEAK_AMBIENT, "{}: {missing:e} {exchange:e}", case.name);
                        let bound = 2.0 * eta.im / eta.re / (theta.to_radians().cos().powi(2));
                        // The bound is of first order in k/n; |r| exceeds 1 by as much.
                        let second = 1.0 + 2.0 * bound;
                        assert!(missing.abs() <= bound * second + WEAK_AMBIENT, "{}: {missing:e} {bound:e}", case.name);
                        largest = largest.max(missing.abs());
                    }
                }
            });
        }
    }
    println!("largest: {largest:.1e}");
    assert!(largest > 1e-3, "the cases show the effect: {largest:e}");
}
