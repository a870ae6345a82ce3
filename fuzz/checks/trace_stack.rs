//! Any planar stack: the closed form and both sums of rays hold to the scalar twin, and the ledger to energy.

use arbitrary::{Arbitrary, Result, Unstructured};
use goniochrome::complex::{ComplexLanes, Polarised};
use goniochrome::interface::{Below, Model};
use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome::layers::{Summation, TraceMemory, Workspace, trace_layers};
use goniochrome::medium::{MediaLanes, Medium};
use goniochrome::stack::{Film, Optics, OpticsArrays, Stack, StackArrays};
use goniochrome::trace::Limits;
use num_complex::Complex64;

use super::scalar::{Problem, Twin};

const MOST_PLANES: usize = 40;
const MEDIA: usize = MOST_PLANES + 1;

/// Beyond this the first-order bounds of the twin say nothing.
const FIRST_ORDER: f64 = 1e-3;

#[derive(Debug)]
struct Planes {
    eta: Vec<Complex64>,
    thickness_nm: Vec<f64>,
    sin_theta: f64,
    wavelength_nm: Vec<f64>,
    slots: usize,
}

/// A round number, from which degenerate stacks are made, or any in the range.
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
        let slots = usize::from(u.arbitrary::<u8>()?) % (2 * MOST_PLANES + 1);
        let mut media = vec![eta(u, false)?];
        let mut thickness_nm = Vec::new();
        for _ in 0..u.int_in_range(0..=MOST_PLANES - 1)? {
            let code: u8 = u.arbitrary()?;
            media.push(if code.is_multiple_of(4) { media[usize::from(code / 4) % media.len()] } else { eta(u, true)? });
            let most = [1e2, 1e3, 1e4, 1e5][usize::from(code / 64)];
            thickness_nm.push(number(u, 0.0, most)?);
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
    let mut arrays = StackArrays::<MOST_PLANES>::new();
    let stack = Stack::new(0, layers, substrate, arrays.memory()).expect("fits");
    let mut memory = OpticsArrays::<V, MEDIA>::new();
    let optics = Optics::new(stack, &media, planes.sin_theta, Model::Physical, memory.memory());

    let response = optics.response();
    let closed = [optics.reflectance(response.reflection), optics.transmittance(response.transmission)];
    let mut workspace = Workspace::<V, MOST_PLANES>::new();
    let looped = trace_layers(&optics, Summation::ClosedLoops, workspace.memory()).expect("fits");
    let hit_by_hit = trace_layers(&optics, Summation::Generations(limits), workspace.memory()).expect("fits");
    let few = workspace.memory();
    let few = TraceMemory { totals: few.totals, slots: &mut few.slots[..planes.slots] };
    let cramped = trace_layers(&optics, Summation::Generations(limits), few).expect("fits");
    // The paper's model promises nothing but numbers.
    let mut memory = OpticsArrays::<V, MEDIA>::new();
    let paper = Optics::new(stack, &media, planes.sin_theta, Model::Paper, memory.memory());
    let paper_traced = trace_layers(&paper, Summation::ClosedLoops, workspace.memory()).expect("fits").ledger;

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
            for ledger in [hit_by_hit.ledger, cramped.ledger] {
                let truncated = ledger.truncated.lane(lane);
                assert!(truncated.is_finite() && truncated >= 0.0, "truncated {truncated}");
                assert!(of(ledger.reflected).is_finite() && of(ledger.transmitted).is_finite());
            }
            // Where light travels without loss in every film each loop loses power, and the sum of rays converges.
            let q_t = eta[0].re * sin_theta;
            if eta.iter().all(|eta| eta.im == 0.0 && eta.re > q_t) {
                let generations = f64::from(hit_by_hit.trace.generations);
                let [r, t] = twin.perturbed(V::UNIT_ROUNDOFF * generations.sqrt().max(1.0), media);
                let [lost_r, lost_t] = twin.truncation(hit_by_hit.ledger.truncated.lane(lane), 1.0);
                near("R hit by hit", of(hit_by_hit.ledger.reflected), twin.reflectance, r + lost_r);
                near("T hit by hit", of(hit_by_hit.ledger.transmitted), twin.transmittance, t + lost_t);
                let [lost_r, lost_t] =
                    twin.truncation(cramped.ledger.truncated.lane(lane), f64::from(cramped.trace.generations) + 1.0);
                near("R in few slots", of(cramped.ledger.reflected), twin.reflectance, r + lost_r);
                near("T in few slots", of(cramped.ledger.transmitted), twin.transmittance, t + lost_t);
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

/// Holds for any bytes from which planes can be made.
pub fn check(bytes: &[u8]) {
    let Ok(planes) = Planes::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    // Many planes get fewer generations: what is left then is bounded like any other truncation, and an input takes a millisecond.
    let generations = (1600 / planes.eta.len() as u32).clamp(20, 200);
    holds::<F64>(&planes, Limits { in_flight: 1e-20, generations });
    holds::<F32>(&planes, Limits { in_flight: 1e-12, generations });
}
