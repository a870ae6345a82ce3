//! Tests that the error of sums of rays hit by hit stays within the truncation that they state, whether they converge,
//! diverge, ring for too long or drop rays.

use super::*;
use goniochrome::trace::ledger::Ledger;

const SOME_STACKS: u32 = 2_000;
/// Error of closed loops in double precision and of the scalar solver, also at a critical angle. R changes by up to 4
/// q_n there, and the square of q_n is rounded to some 2e-15 |η|².
const CLOSED_LOOPS: f64 = 4e-7;
/// Number of generations, few enough that many sums end early.
const FEW_GENERATIONS: u32 = 2_000;

/// A random passive stack: dielectrics, absorbers, metals, frustrated and total reflection. Where the light comes from
/// a denser medium, it comes exactly at the critical angle in a third of the cases.
fn any(random: &mut Random) -> Case {
    let dielectric = |random: &mut Random| Complex64::from(random.between(1.0, 4.0));
    let layers = random.below(7) as usize;
    let ambient = dielectric(random);
    let mut eta = vec![ambient];
    for _ in 0..=layers {
        let mut medium = dielectric(random);
        if random.below(3) == 0 {
            medium.im = random.between(0.0, 5.0);
        }
        eta.push(medium);
    }
    let rarer = eta.iter().find(|eta| eta.im == 0.0 && eta.re < ambient.re).map(|eta| eta.re);
    let critical_deg = rarer.filter(|_| random.below(3) == 0).map(|n| (n / ambient.re).asin().to_degrees());
    let theta_deg = critical_deg.unwrap_or_else(|| random.between(0.0, 89.9));
    let thickness_nm = (0..layers).map(|_| random.between(1.0, 1000.0)).collect();
    let wavelengths_nm = (0..F64::WIDTH).map(|_| random.between(300.0, 1100.0)).collect();
    Case { stack: Layered { eta, thickness_nm }, theta_deg, wavelengths_nm }
}

impl Case {
    /// This case with the wavelength of one lane in all lanes.
    fn at(&self, lane: usize) -> Self {
        let one = self.with(self.stack.eta.clone(), self.stack.thickness_nm.clone());
        Self { wavelengths_nm: vec![self.wavelengths_nm[lane]; F64::WIDTH], ..one }
    }
}

/// Numbers of lanes by the error that their sums state.
#[derive(Debug, Default)]
struct Ends {
    /// Sums that state less than 1e-5.
    good: u32,
    /// Sums that state up to 1.
    poor: u32,
    /// Sums that state more than any passive stack reflects.
    absurd: u32,
}

impl Ends {
    fn count(&mut self, truncated: f64) {
        let class = if truncated < 1e-5 {
            &mut self.good
        } else if truncated <= 1.0 {
            &mut self.poor
        } else {
            &mut self.absurd
        };
        *class += 1;
    }
}

/// Checks the error of each lane against the truncation that it states.
fn check<V: Lanes>(worst: &mut Worst, case: &Case, ledger: &Ledger<V>) {
    let Layered { eta, thickness_nm } = &case.stack;
    for (lane, twins) in case.twins().iter().enumerate() {
        let truncated = ledger.truncated.lane(lane);
        assert!(truncated.is_finite() && truncated >= 0.0, "truncated {truncated}");
        let wavelength_nm = case.wavelengths_nm[lane];
        let problem = Problem { eta, thickness_nm, sin_theta: case.sin_theta(), wavelength_nm };
        let media = problem.kept_off(V::UNIT_ROUNDOFF);
        for (pol, twin) in twins.iter().enumerate() {
            let [dr, dt] = twin.perturbed(V::UNIT_ROUNDOFF, media);
            for (got, want, bound) in [
                (lanes(ledger.reflected, lane)[pol], twin.reflectance, dr),
                (lanes(ledger.transmitted, lane)[pol], twin.transmittance, dt),
            ] {
                // A difference of powers is rounded like the larger power.
                let rounding = 4.0 * V::UNIT_ROUNDOFF * (got + want);
                let error = (got - want).abs();
                assert!(got.is_finite(), "{eta:?}");
                // At a film's critical angle, where first-order bounds say nothing, double precision keeps its bound.
                let anywhere = if V::UNIT_ROUNDOFF < 1e-10 { CLOSED_LOOPS } else { f64::INFINITY };
                assert!(
                    error <= truncated + rounding + anywhere,
                    "{error:e} of {truncated:e}: {eta:?} {thickness_nm:?}"
                );
                worst.see((error - truncated).max(0.0), bound + rounding, || {
                    format!("truncated {truncated:e}: {eta:?} {thickness_nm:?} at {} deg", case.theta_deg)
                });
            }
        }
    }
}

fn no_further_off_than_they_say<V: Lanes>(law: &'static str, limits: Limits) {
    let (mut worst, mut ends, mut random) = (Worst::of(law), Ends::default(), Random(41));
    for _ in 0..SOME_STACKS {
        let case = any(&mut random);
        let ledger = case.traced::<V>(Summation::Generations(limits)).ledger;
        check(&mut worst, &case, &ledger);
        (0..F64::WIDTH).for_each(|lane| ends.count(ledger.truncated.lane(lane)));
    }
    println!("{law}: {ends:?}");
    // The test shows little unless all three happen.
    assert!(ends.good > ends.poor && ends.poor > 0 && ends.absurd > 0, "{ends:?}");
    // A fifth of the cases are at a critical angle.
    worst.report(0.25);
}

#[test]
fn sums_of_hits_are_no_further_off_than_they_say() {
    let (single, double) = (Limits::SINGLE, Limits::DOUBLE);
    no_further_off_than_they_say::<F64>("hits, f64", Limits { generations: FEW_GENERATIONS, ..double });
    no_further_off_than_they_say::<F32>("hits, f32", Limits { generations: FEW_GENERATIONS, ..single });
}

#[test]
fn sums_of_hits_converge_where_light_travels_without_loss() {
    let limits = Limits { in_flight: 1e-16, generations: 10_000 };
    let (mut converged, mut late, mut early) = (0u32, 0u32, 0u32);
    let mut random = Random(3);
    for _ in 0..SOME_STACKS / 5 {
        let case = Case::random(&mut random, true, true);
        let q_t = case.stack.eta[0].re * case.sin_theta();
        if case.stack.eta.iter().any(|eta| eta.re <= q_t) {
            continue;
        }
        let Traced { ledger, trace, .. } = case.traced::<F64>(Summation::Generations(limits));
        for lane in 0..F64::WIDTH {
            if Lanes::lane(trace.truncated, lane) <= limits.in_flight {
                converged += 1;
                // Amplitudes in flight of 1e-8, times resonances of up to 1e3 in such stacks.
                let truncated = Lanes::lane(ledger.truncated, lane);
                assert!(truncated <= 1e-5, "{truncated:e}: {:?}", case.stack.eta);
            } else {
                late += 1;
                // Giving up was right if the lane alone, with more generations, needs more.
                let patient = Limits { generations: 10 * limits.generations, ..limits };
                let alone = case.at(lane).traced::<F64>(Summation::Generations(patient)).trace;
                early +=
                    u32::from(alone.generations <= limits.generations && !alone.truncated.any_above(limits.in_flight));
            }
        }
    }
    println!("{converged} lanes converged, {late} were given up, {early} of them too early");
    assert!(late > 0 && f64::from(late) < 0.05 * f64::from(converged) && f64::from(early) < 0.1 * f64::from(late));
}

#[test]
fn sums_that_cannot_converge_are_given_up_early() {
    // Thin metal films, at whose plasmons a loop gains, and a film at its critical angle, which holds light for 1e8
    // hits.
    let metal = Complex64::new(0.2, 3.4);
    let sandwich =
        Layered { eta: vec![1.0.into(), metal, 1.5.into(), metal, 1.5.into()], thickness_nm: vec![3.0, 10.0, 3.0] };
    let critical = Layered { eta: vec![2.0.into(), 1.0.into(), 2.0.into()], thickness_nm: vec![100.0] };
    for (stack, theta_deg, nm) in [(sandwich, 0.0, 550.0), (critical, 30.0, 633.0)] {
        let case = Case { stack, theta_deg, wavelengths_nm: vec![nm; F64::WIDTH] };
        let Traced { ledger, trace, .. } = case.traced::<F64>(Summation::Generations(Limits::DOUBLE));
        println!("{trace:?} {:?}", ledger.truncated);
        assert!(trace.generations < 1_000, "{}", trace.generations);
        assert!(Lanes::lane(ledger.truncated, 0) > 0.1);
        check(&mut Worst::of("given up"), &case, &ledger);
    }
}

#[test]
fn a_lane_does_not_depend_on_its_neighbours() {
    let limits = Limits { generations: FEW_GENERATIONS, ..Limits::DOUBLE };
    let mut random = Random(17);
    for _ in 0..200 {
        let case = any(&mut random);
        let together = case.traced::<F64>(Summation::Generations(limits)).ledger;
        for lane in 0..F64::WIDTH {
            let alone = case.at(lane).traced::<F64>(Summation::Generations(limits)).ledger;
            for (a, b) in [(together.reflected, alone.reflected), (together.transmitted, alone.transmitted)] {
                assert_eq!(lanes(a, lane), lanes(b, 0), "{:?}", case.stack.eta);
            }
        }
    }
}

#[test]
fn a_larger_workspace_converges_to_the_sum_of_all_rays() {
    let limits = Limits { in_flight: 1e-16, generations: FEW_GENERATIONS };
    let mut worst = Worst::of("few slots, within what they truncate");
    let (mut full, mut cramped, mut random) = (0u32, 0u32, Random(16));
    for _ in 0..SOME_STACKS {
        let case = Case::random(&mut random, false, true);
        let states = 2 * (case.stack.thickness_nm.len() + 1);
        // Half of the states, all, and more than there are.
        for slots in [states / 2, states, states + 8] {
            let Traced { ledger, trace, .. } = case.traced_in::<F64>(slots, Summation::Generations(limits));
            check(&mut worst, &case, &ledger);
            if slots >= states {
                full += 1;
            } else {
                cramped += u32::from(trace.truncated.any_above(limits.in_flight));
            }
        }
    }
    println!("{full} sums in full, {cramped} with rays dropped");
    assert!(full > 0 && cramped > 0);
    worst.report(0.01);
}
