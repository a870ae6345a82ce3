//! The closed form, rays in closed loops and rays hit by hit agree with the scalar twin, in both precisions.

use super::*;

#[test]
fn closed_form_agrees_with_the_scalar_twin() {
    let mut worst = Worst::of("closed form = scalar twin");
    each(1, |random| {
        let case = Case::random(random, false, true);
        let Power { r, t } = case.power();
        for (lane, twins) in case.twins().iter().enumerate() {
            for (pol, twin) in twins.iter().enumerate() {
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                let [dr, dt] = twin.rounding(F64::UNIT_ROUNDOFF);
                worst.see(lanes(r, lane)[pol] - twin.reflectance, dr, what);
                worst.see(lanes(t, lane)[pol] - twin.transmittance, dt, what);
            }
        }
    });
    worst.report(0.0);
}

fn traced_is_closed<V: Lanes>(seed: u64, law: &'static str, limits: Option<Limits>, most_vacuous: f64) {
    let mut worst = Worst::of(law);
    let summation = limits.map_or(Summation::ClosedLoops, Summation::Generations);
    each(seed, |random| {
        let case = Case::random(random, limits.is_some(), true);
        // Loops with absorbing or evanescent waves may gain: such rays may diverge, which is another law's business.
        let q_t = case.stack.eta[0].re * case.sin_theta();
        if limits.is_some() && case.stack.eta.iter().any(|eta| eta.re <= q_t) {
            return;
        }
        let (ledger, generations) = case.ledger::<V>(summation);
        for (lane, twins) in case.twins().iter().enumerate() {
            let truncated = ledger.truncated.lane(lane);
            assert!(truncated <= limits.map_or(0.0, |l| l.in_flight) || generations >= 1e4, "truncated {truncated}");
            for (pol, twin) in twins.iter().enumerate() {
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                let [dr, dt] = twin.rounding(V::UNIT_ROUNDOFF * generations.max(1.0).sqrt());
                let [lost_r, lost_t] = twin.truncation(truncated, 1.0);
                worst.see(lanes(ledger.reflected, lane)[pol] - twin.reflectance, dr + lost_r, what);
                worst.see(lanes(ledger.transmitted, lane)[pol] - twin.transmittance, dt + lost_t, what);
            }
        }
    });
    worst.report(most_vacuous);
}

#[test]
fn rays_in_closed_loops_agree_with_the_scalar_twin() {
    traced_is_closed::<F64>(2, "closed loops, f64", None, 0.0);
    traced_is_closed::<F32>(2, "closed loops, f32", None, 1e-3);
}

#[test]
fn rays_hit_by_hit_agree_with_the_scalar_twin() {
    let limits = Limits { in_flight: 1e-16, generations: 10_000 };
    traced_is_closed::<F64>(3, "hit by hit, f64", Some(limits), 1e-2);
}

#[test]
fn rays_that_diverge_are_accounted_for() {
    let limits = Limits { in_flight: 1e-16, generations: 2_000 };
    let (mut diverged, mut converged) = (0u32, 0u32);
    each(15, |random| {
        let case = Case::random(random, false, true);
        let (ledger, _) = case.ledger::<F64>(Summation::Generations(limits));
        for lane in 0..F64::WIDTH {
            let truncated = ledger.truncated.lane(lane);
            let mut power = lanes(ledger.reflected, lane).into_iter().chain(lanes(ledger.transmitted, lane));
            assert!(truncated.is_finite() && power.all(f64::is_finite), "{:?}", case.stack.eta);
            diverged += u32::from(truncated > 1.0);
            converged += u32::from(truncated <= limits.in_flight);
        }
    });
    println!("hit by hit: {converged} converged, {diverged} diverged");
    // Both happen, or this shows nothing.
    assert!(diverged > 0 && converged > diverged);
}

#[test]
fn single_precision_keeps_its_statistics() {
    /// The precision that single lanes are for, and how many results of arbitrary stacks may miss it: those near a critical
    /// angle of a film, and sharp resonances.
    const TARGET: f64 = 1e-5;
    const MISSES: f64 = 0.01;
    let mut worst = Worst::of("f32 closed form = f64");
    let mut errors = Vec::new();
    each(14, |random| {
        let case = Case::random(random, false, true);
        let [single, double] = [case.single(), case.power()].map(|power| power);
        for (lane, twins) in case.twins().iter().enumerate() {
            for (pol, twin) in twins.iter().enumerate() {
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                let bounds = twin.rounding(F32::UNIT_ROUNDOFF);
                for ((a, b), bound) in [(single.r, double.r), (single.t, double.t)].into_iter().zip(bounds) {
                    let error = lanes(a, lane)[pol] - lanes(b, lane)[pol];
                    worst.see(error, bound, what);
                    errors.push(error.abs());
                }
            }
        }
    });
    worst.report(1e-3);
    errors.sort_by(f64::total_cmp);
    let quantile = |q: f64| errors[((errors.len() - 1) as f64 * q) as usize];
    println!(
        "f32: median {:.1e}, 99 % {:.1e}, 99.9 % {:.1e}, worst {:.1e}",
        quantile(0.5),
        quantile(0.99),
        quantile(0.999),
        quantile(1.0)
    );
    assert!(quantile(1.0 - MISSES) <= TARGET, "{:e}", quantile(1.0 - MISSES));
}
