//! Fuzzing of the planar solvers with any stack. The closed form and both sums of rays agree with the scalar solver,
//! the sum hit by hit within the truncation that it states, and the ledger adds up to 1.

use arbitrary::{Arbitrary, Result, Unstructured};
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::{ComplexLanes, Polarised};
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, TraceMemory, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;
use num_complex::Complex64;

use super::scalar::{Problem, Twin};

const MAX_PLANES: usize = 40;
const MEDIA: usize = MAX_PLANES + 1;

/// Bound above which the scalar solver's first-order bounds say nothing.
const FIRST_ORDER: f64 = 1e-3;

/// Rounding of a difference of powers, in unit roundoffs of their sum.
const DIFFERENCE: f64 = 4.0;

#[derive(Debug)]
struct Planes {
    eta: Vec<Complex64>,
    thickness_nm: Vec<f64>,
    sin_theta: f64,
    wavelength_nm: Vec<f64>,
    slots: usize,
}

/// A number in the range: a round one, which makes degenerate stacks, or any.
fn number(u: &mut Unstructured<'_>, low: f64, high: f64) -> Result<f64> {
    let code: u8 = u.arbitrary()?;
    let steps = f64::from(code >> 1);
    let fraction = if code & 1 == 0 { steps / 100.0 } else { f64::from(u.arbitrary::<u32>()?) / f64::from(u32::MAX) };
    Ok(low + (high - low) * fraction.min(1.0))
}

impl<'a> Arbitrary<'a> for Planes {
    fn arbitrary(u: &mut Unstructured<'a>) -> Result<Self> {
        let eta = |u: &mut Unstructured<'_>, absorbs: bool| {
            let n = number(u, 0.0, 5.0)?.max(0.05);
            let k = if absorbs && u.ratio(1, 3)? { number(u, 0.0, 8.0)? } else { 0.0 };
            Ok(Complex64::new(n, k))
        };
        let sin_theta = number(u, 0.0, 1.0)?.min(0.9999);
        let wavelength_nm = (0..3).map(|_| number(u, 100.0, 3000.0)).collect::<Result<_>>()?;
        let slots = usize::from(u.arbitrary::<u8>()?) % (2 * MAX_PLANES + 1);
        let mut media = vec![eta(u, false)?];
        let mut thickness_nm = Vec::new();
        for _ in 0..u.int_in_range(0..=MAX_PLANES - 1)? {
            let code: u8 = u.arbitrary()?;
            media.push(if code.is_multiple_of(4) { media[usize::from(code / 4) % media.len()] } else { eta(u, true)? });
            let max = [1e2, 1e3, 1e4, 1e5][usize::from(code / 64)];
            thickness_nm.push(number(u, 0.0, max)?);
        }
        if !u.ratio(1, 4)? {
            media.push(eta(u, true)?);
        }
        Ok(Self { eta: media, thickness_nm, sin_theta, wavelength_nm, slots })
    }
}

fn near(what: &str, got: f64, want: f64, bound: f64) {
    assert!(got.is_finite(), "{what}: {got}");
    assert!(bound > FIRST_ORDER || (got - want).abs() <= bound, "{what}: {got:e}, expected {want:e} within {bound:e}");
}

fn holds<V: Lanes>(planes: &Planes, limits: Limits) {
    let media: Vec<_> = planes.eta.iter().map(|&eta| Medium::constant(eta).expect("passive")).collect();
    let mut eta = [ComplexLanes::zero(); MEDIA];
    let media =
        MediaLanes::<V>::evaluate(&media, &planes.wavelength_nm, &mut eta[..planes.eta.len()]).expect("constant");
    let index = |j: usize| u16::try_from(j).expect("few");
    let layers =
        planes.thickness_nm.iter().enumerate().map(|(j, &thickness_nm)| Film { medium: index(j + 1), thickness_nm });
    let count = planes.thickness_nm.len() + 1;
    let substrate = if planes.eta.len() > count { Below::Medium(index(count)) } else { Below::Mirror };
    let mut arrays = StackArrays::<MAX_PLANES>::new();
    let stack = Stack::new(0, layers, substrate, arrays.memory()).expect("fits");
    let mut memory = PreparedStackArrays::<V, MEDIA>::new();
    let prepared = PreparedStack::new(stack, &media, planes.sin_theta, Model::Physical, memory.memory());

    let response = prepared.response();
    let closed = [prepared.reflectance(response.reflection), prepared.transmittance(response.transmission)];
    let mut workspace = Workspace::<V, MAX_PLANES>::new();
    let looped = trace_planar(&prepared, Summation::ClosedLoops, workspace.memory()).expect("fits");
    let hit_by_hit = trace_planar(&prepared, Summation::Generations(limits), workspace.memory()).expect("fits");
    let few = workspace.memory();
    let few = TraceMemory { totals: few.totals, slots: &mut few.slots[..planes.slots] };
    let cramped = trace_planar(&prepared, Summation::Generations(limits), few).expect("fits");
    // The paper's model promises only finite numbers.
    let mut memory = PreparedStackArrays::<V, MEDIA>::new();
    let paper = PreparedStack::new(stack, &media, planes.sin_theta, Model::Paper, memory.memory());
    let paper_traced = trace_planar(&paper, Summation::ClosedLoops, workspace.memory()).expect("fits").ledger;

    for (lane, &wavelength_nm) in planes.wavelength_nm.iter().enumerate() {
        let Planes { eta, thickness_nm, sin_theta, .. } = planes;
        let problem = Problem { eta, thickness_nm, sin_theta: *sin_theta, wavelength_nm };
        let (twins, media) = (problem.solve(), problem.kept_off(V::UNIT_ROUNDOFF));
        for (pol, twin) in twins.iter().enumerate() {
            let of = |x: Polarised<V>| if pol == 0 { x.s.lane(lane) } else { x.p.lane(lane) };
            compare(
                twin,
                twin.perturbed(V::UNIT_ROUNDOFF, media),
                closed.map(of),
                [looped.ledger.reflected, looped.ledger.transmitted].map(of),
            );
            near("imbalance", of(looped.ledger.imbalance), 0.0, twin.imbalance(V::UNIT_ROUNDOFF));
            assert!(of(looped.ledger.absorbed) >= -twin.imbalance(V::UNIT_ROUNDOFF));
            for (name, ledger) in [("hit by hit", hit_by_hit.ledger), ("in few slots", cramped.ledger)] {
                let truncated = ledger.truncated.lane(lane);
                assert!(truncated.is_finite() && truncated >= 0.0, "truncated {truncated}");
                let bounds = twin.perturbed(V::UNIT_ROUNDOFF, media);
                let parts = [(ledger.reflected, twin.reflectance), (ledger.transmitted, twin.transmittance)];
                for ((got, want), bound) in parts.map(|(got, want)| (of(got), want)).into_iter().zip(bounds) {
                    // Sums that diverge are large, and so is their rounding.
                    let rounding = DIFFERENCE * V::UNIT_ROUNDOFF * (got + want);
                    assert!(got.is_finite(), "{name}: {got}");
                    assert!(
                        bound > FIRST_ORDER || (got - want).abs() <= truncated + bound + rounding,
                        "{name}: {got:e}, expected {want:e} within {truncated:e} truncated and {bound:e} rounded"
                    );
                }
            }
            assert!(
                of(paper_traced.reflected).is_finite() && of(paper_traced.transmitted).is_finite(),
                "paper's model"
            );
        }
    }
}

fn compare(twin: &Twin, bounds: [f64; 2], closed: [f64; 2], looped: [f64; 2]) {
    let want = [twin.reflectance, twin.transmittance];
    for (i, name) in ["R", "T"].into_iter().enumerate() {
        for (got, sum) in [(closed[i], "closed form"), (looped[i], "closed loops")] {
            near(&format!("{name}, {sum}"), got, want[i], bounds[i]);
            assert!(got >= 0.0);
            assert!(bounds[i] > FIRST_ORDER || got <= 1.0 + bounds[i], "{name} = {got}");
        }
    }
}

/// Checks any bytes from which planes can be made.
pub fn check(bytes: &[u8]) {
    let Ok(planes) = Planes::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    // Many planes get fewer generations, so that an input takes a millisecond. The bound of truncation covers the rest.
    let generations = (1600 / planes.eta.len() as u32).clamp(20, 200);
    holds::<F64>(&planes, Limits { in_flight: 1e-20, generations });
    holds::<F32>(&planes, Limits { in_flight: 1e-12, generations });
}
