//! Tests of 500 stacks against results computed with 80 digits, among them narrow filters, critical angles and grazing
//! incidence. Every precision is as exact as it says.

use crate::random::Random;
use crate::reference::Layered;
use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::Model;
use goniochrome::simd::double_double::DoubleDouble;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, TraceMemory, Workspace, rounding, trace_planar};
use num_complex::Complex64;

/// A case of `data/precise.txt`, which says how it was made.
struct Case {
    name: &'static str,
    degrees: f64,
    nm: f64,
    stack: Layered,
    /// R_s, R_p, T_s, T_p.
    power: [f64; 4],
}

impl Case {
    fn parse(line: &'static str) -> Option<Self> {
        let numbers = |text: &str| text.split_whitespace().map(|x| x.parse().ok()).collect::<Option<Vec<f64>>>();
        let index = |text: &str| match text.split_once('+') {
            Some((n, k)) => Some(Complex64::new(n.parse().ok()?, k.strip_suffix('i')?.parse().ok()?)),
            None => Some(Complex64::from(text.parse::<f64>().ok()?)),
        };
        let mut fields = line.split(';').map(str::trim);
        let mut next = || fields.next();
        Some(Self {
            name: next()?,
            degrees: next()?.parse().ok()?,
            nm: next()?.parse().ok()?,
            stack: Layered {
                eta: next()?.split(' ').map(index).collect::<Option<_>>()?,
                thickness_nm: numbers(next()?)?,
            },
            power: numbers(next()?).and_then(|power| power.try_into().ok())?,
        })
    }
}

fn cases() -> impl Iterator<Item = Case> {
    let lines = include_str!("data/precise.txt").lines().filter(|line| !line.starts_with('#'));
    lines.map(|line| Case::parse(line).unwrap_or_else(|| panic!("{line}")))
}

/// A method that solves a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    ClosedForm,
    Trace,
}

/// R_s, R_p, T_s, T_p of a case, and the estimate of their rounding.
fn solve<V: Lanes>(case: &Case, by: By) -> ([f64; 4], f64) {
    let (powers, estimated) = case.stack.with_prepared_at::<V, _>(
        Incidence::from_degrees(case.degrees),
        &[case.nm],
        Model::Physical,
        |prepared| match by {
            By::ClosedForm => {
                let (response, estimated) = prepared.response_and_rounding();
                ([prepared.reflectance(response.reflection), prepared.transmittance(response.transmission)], estimated)
            }
            By::Trace => {
                let mut workspace = Box::new(Workspace::<V, 64>::new());
                let TraceMemory { totals, slots } = workspace.memory();
                let memory = TraceMemory { totals: &mut *totals, slots };
                let ledger = trace_planar(prepared, Summation::ClosedLoops, memory).expect("the stack fits").ledger;
                ([ledger.reflected, ledger.transmitted], rounding(prepared, totals))
            }
        },
    );
    let [r, t] = powers;
    ([r.s, r.p, t.s, t.p].map(|power| power.lane(0)), estimated.lane(0))
}

/// The largest error of R and T, and its estimate.
fn error<V: Lanes>(case: &Case, by: By) -> (f64, f64) {
    let (got, estimated) = solve::<V>(case, by);
    // At 90 degrees no light arrives, and T is 0/0.
    let defined = if case.degrees == 90.0 { 2 } else { 4 };
    let errors = got.iter().zip(case.power).take(defined).map(|(got, want)| (got - want).abs());
    (errors.fold(0.0, |worst, error| if error <= worst { worst } else { error }), estimated)
}

/// Error of R and T that single precision promises.
const SINGLE: f64 = 1e-5;
/// Error of R and T that double precision promises.
const DOUBLE: f64 = 1e-11;

/// Share of the promised error up to which an estimate is trusted, as on the command line.
const TRUSTED: f64 = 0.5;

const WAYS: [By; 2] = [By::ClosedForm, By::Trace];

/// Rounding of the reference to a double.
const LAST_DIGIT: f64 = f64::EPSILON;

#[test]
fn twice_the_digits_of_a_double_hold_in_every_stack() {
    for case in cases() {
        for by in WAYS {
            let (error, _) = error::<DoubleDouble>(&case, by);
            assert!(error <= LAST_DIGIT, "{} at {} degrees, {by:?}: {error:e}", case.name, case.degrees);
        }
    }
}

/// The cases, each as it is and at other angles and wavelengths, where `DoubleDouble` gives the result. Some changes
/// are small, so that light comes close to narrow resonances and critical angles.
fn detuned() -> Vec<Case> {
    const COPIES: usize = 4;
    let mut random = Random(20);
    let mut all: Vec<Case> = cases().collect();
    for _ in 0..COPIES {
        for mut case in cases() {
            match random.below(4) {
                0 => case.nm *= 1.0 + 1e-3 * random.between(-0.5, 0.5) * random.between(0.0, 1.0).powi(4),
                1 => case.degrees += random.between(-0.2, 0.2) * random.between(0.0, 1.0).powi(6),
                2 => case.nm = random.between(300.0, 1100.0),
                _ => case.degrees = random.between(0.0, 89.9),
            }
            case.degrees = case.degrees.clamp(0.0, 90.0 - 1e-9);
            case.power = solve::<DoubleDouble>(&case, By::ClosedForm).0;
            all.push(case);
        }
    }
    all
}

/// Checks that results whose estimate is trusted are as exact as promised. Returns the share of ordinary stacks that is
/// trusted, and the share of all stacks that is not trusted although it is exact enough.
fn holds<V: Lanes>(cases: &[Case], by: By, promised: f64) -> [f64; 2] {
    let (mut ordinary, mut trusted, mut wasted) = (0, 0, 0);
    let mut worst: f64 = 0.0;
    for case in cases {
        let (error, estimated) = error::<V>(case, by);
        let trust = estimated <= TRUSTED * promised;
        if trust {
            worst = worst.max(error);
        }
        assert!(
            !trust || error <= promised,
            "{} at {} degrees, {} nm, {by:?}: {error:e}, estimated {estimated:e}",
            case.name,
            case.degrees,
            case.nm
        );
        if case.name == "ordinary" {
            ordinary += 1;
            trusted += u32::from(trust);
        }
        wasted += u32::from(!trust && error <= promised);
    }
    let shares = [f64::from(trusted) / f64::from(ordinary), f64::from(wasted) / cases.len() as f64];
    println!(
        "{by:?}, {promised:e}: {worst:.1e} where trusted; trusted of ordinary stacks, wasted of all: {shares:.3?}"
    );
    shares
}

/// Least share of ordinary stacks that is trusted: an estimate that trusts nothing would be useless.
const TRUSTED_OF_ORDINARY: f64 = 0.8;
/// Largest share that is not trusted although it is exact enough. Two thirds of the cases are made to be hard, and half
/// of those are.
const WASTED: f64 = 0.4;

#[test]
fn an_estimate_of_rounding_knows_the_stacks_that_a_precision_cannot_hold() {
    let cases = detuned();
    for by in WAYS {
        for [trusted, wasted] in [holds::<F32>(&cases, by, SINGLE), holds::<F64>(&cases, by, DOUBLE)] {
            assert!(trusted >= TRUSTED_OF_ORDINARY && wasted <= WASTED, "{by:?}: {trusted} {wasted}");
        }
    }
}

#[test]
fn a_filters_inputs_in_double_precision_do_not_fix_eleven_digits_of_it() {
    // The other wavelength is the next double, so the change of R and T comes from the input, not from the computation.
    let moved = |name: &str| {
        cases().filter(|case| case.name == name).fold(0.0, |max: f64, mut case| {
            case.nm = case.nm.next_up();
            max.max(error::<DoubleDouble>(&case, By::ClosedForm).0)
        })
    };
    let (ordinary, filter) = (moved("ordinary"), moved("narrow_filter"));
    println!("the next wavelength moves ordinary stacks by {ordinary:.1e}, filters by {filter:.1e}");
    assert!(ordinary < DOUBLE && filter > DOUBLE);
}
