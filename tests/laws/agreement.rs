//! Tests that the closed form and rays in closed loops agree with the scalar solver, in both precisions. Rays hit by
//! hit are tested in [`super::truncation`].

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

fn traced_is_closed<V: Lanes>(law: &'static str, max_vacuous: f64) {
    let mut worst = Worst::of(law);
    each(2, |random| {
        let case = Case::random(random, false, true);
        let ledger = case.traced::<V>(Summation::ClosedLoops).ledger;
        for (lane, twins) in case.twins().iter().enumerate() {
            let truncated = ledger.truncated.lane(lane);
            assert!(truncated == 0.0, "truncated {truncated}");
            for (pol, twin) in twins.iter().enumerate() {
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                let [dr, dt] = twin.rounding(V::UNIT_ROUNDOFF);
                worst.see(lanes(ledger.reflected, lane)[pol] - twin.reflectance, dr, what);
                worst.see(lanes(ledger.transmitted, lane)[pol] - twin.transmittance, dt, what);
            }
        }
    });
    worst.report(max_vacuous);
}

#[test]
fn rays_in_closed_loops_agree_with_the_scalar_twin() {
    traced_is_closed::<F64>("closed loops, f64", 0.0);
    traced_is_closed::<F32>("closed loops, f32", 1e-3);
}

#[test]
fn single_precision_keeps_its_statistics() {
    /// The error that single precision is meant for.
    const TARGET: f64 = 1e-5;
    /// Share of results of random stacks that may miss it: those near a film's critical angle, and sharp resonances.
    const MISSES: f64 = 0.01;
    let mut worst = Worst::of("f32 closed form = f64");
    let mut errors = Vec::new();
    each(14, |random| {
        let case = Case::random(random, false, true);
        let (single, double) = (case.single(), case.power());
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
