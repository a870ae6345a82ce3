//! 500 stacks against results of 80 digits: every precision is as exact as it says, narrow filters, critical angles and
//! grazing incidence included.

use crate::laws::Random;
use crate::reference::Layered;
use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::Model;
use goniochrome::simd::double_double::DoubleDouble;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, TraceMemory, Workspace, rounding, trace_planar};
use num_complex::Complex64;

/// A line of `data/precise.txt`, which says how it was made.
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

/// How a stack is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
enum By {
    ClosedForm,
    Trace,
}

/// R_s, R_p, T_s, T_p of a case, and how far rounding may have moved them.
fn solve<V: Lanes>(case: &Case, by: By) -> ([f64; 4], f64) {
    let (powers, estimated) = case.stack.with_optics_at::<V, _>(
        Incidence::from_degrees(case.degrees),
        &[case.nm],
        Model::Physical,
        |optics| match by {
            By::ClosedForm => {
                let (response, estimated) = optics.response_and_rounding();
                ([optics.reflectance(response.reflection), optics.transmittance(response.transmission)], estimated)
            }
            By::Trace => {
                let mut workspace = Box::new(Workspace::<V, 64>::new());
                let TraceMemory { totals, slots } = workspace.memory();
                let memory = TraceMemory { totals: &mut *totals, slots };
                let ledger = trace_planar(optics, Summation::ClosedLoops, memory).expect("the stack fits").ledger;
                ([ledger.reflected, ledger.transmitted], rounding(optics, totals))
            }
        },
    );
    let [r, t] = powers;
    ([r.s, r.p, t.s, t.p].map(|power| power.lane(0)), estimated.lane(0))
}

/// The largest error of R and T, and what was estimated.
fn error<V: Lanes>(case: &Case, by: By) -> (f64, f64) {
    let (got, estimated) = solve::<V>(case, by);
    // At 90 degrees nothing arrives, and T is 0/0.
    let defined = if case.degrees == 90.0 { 2 } else { 4 };
    let errors = got.iter().zip(case.power).take(defined).map(|(got, want)| (got - want).abs());
    (errors.fold(0.0, |worst, error| if error <= worst { worst } else { error }), estimated)
}

/// What is promised of R and T.
const SINGLE: f64 = 1e-5;
const DOUBLE: f64 = 1e-11;

/// The share of what is promised up to which an estimated error is trusted, as on the command line.
const TRUSTED: f64 = 0.5;

const WAYS: [By; 2] = [By::ClosedForm, By::Trace];

/// Rounds of the reference to a double.
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

/// The cases, each as it is and at other angles and wavelengths with results in twice the digits: tuned finely, so that
/// narrow resonances and critical angles are met from near and far.
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

/// Where the estimate is trusted the result is as exact as promised; returns of ordinary stacks the share that is
/// trusted, and of all the share that is not although it could be.
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

/// Ordinary stacks of up to 12 layers are mostly as exact as they can be: an estimate that trusts nothing would be of
/// no use.
const TRUSTED_OF_ORDINARY: f64 = 0.8;
/// Two thirds of the cases are made to be hard, and half of those are hard.
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
    // The other wavelength is the next double: what R and T change is of the inputs, not of the computation.
    let moved = |name: &str| {
        cases().filter(|case| case.name == name).fold(0.0, |most: f64, mut case| {
            case.nm = case.nm.next_up();
            most.max(error::<DoubleDouble>(&case, By::ClosedForm).0)
        })
    };
    let (ordinary, filter) = (moved("ordinary"), moved("narrow_filter"));
    println!("the next wavelength moves ordinary stacks by {ordinary:.1e}, filters by {filter:.1e}");
    assert!(ordinary < DOUBLE && filter > DOUBLE);
}
