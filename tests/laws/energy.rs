//! Tests of energy conservation and of reciprocity.

use super::*;

#[test]
fn energy_is_conserved() {
    let mut worst = [Worst::of("R + T + A = 1"), Worst::of("R + T = 1"), Worst::of("0 <= R, T, A")];
    each(4, |random| {
        let case = Case::random(random, random.0.is_multiple_of(2), true);
        let ledger = case.traced::<F64>(Summation::ClosedLoops).ledger;
        let Power { r, t } = case.power();
        for (lane, twins) in case.twins().iter().enumerate() {
            for (pol, twin) in twins.iter().enumerate() {
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                let bound = twin.imbalance(F64::UNIT_ROUNDOFF);
                worst[0].see(lanes(ledger.imbalance, lane)[pol], bound, what);
                if !case.absorbs() {
                    let [dr, dt] = twin.rounding(F64::UNIT_ROUNDOFF);
                    worst[1].see(lanes(r, lane)[pol] + lanes(t, lane)[pol] - 1.0, dr + dt, what);
                }
                for part in [ledger.reflected, ledger.transmitted, ledger.absorbed] {
                    worst[2].see(lanes(part, lane)[pol].min(0.0), bound, what);
                }
            }
        }
    });
    worst.into_iter().for_each(|worst| worst.report(0.0));
}

#[test]
fn stacks_are_reciprocal() {
    let (mut transmitted, mut reflected) = (Worst::of("T from both sides"), Worst::of("R from both sides, lossless"));
    each(5, |random| {
        let mut case = Case::random(random, random.0.is_multiple_of(2), false);
        *case.stack.eta.last_mut().expect("a substrate") = random.dielectric();
        let (first, last) = (case.stack.eta[0].re, case.stack.eta[case.stack.eta.len() - 1].re);
        let sin = first * case.sin_theta() / last;
        if sin >= 0.9999 {
            return; // no light arrives from below at this angle
        }
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        eta.reverse();
        thickness_nm.reverse();
        let mut reversed = case.with(eta, thickness_nm);
        reversed.theta_deg = sin.asin().to_degrees();
        let (down, up) = (case.power(), reversed.power());
        for (lane, (a, b)) in case.twins().iter().zip(reversed.twins()).enumerate() {
            for pol in 0..2 {
                let [ar, at] = a[pol].rounding(F64::UNIT_ROUNDOFF);
                let [br, bt] = b[pol].rounding(F64::UNIT_ROUNDOFF);
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                transmitted.see(lanes(down.t, lane)[pol] - lanes(up.t, lane)[pol], at + bt, what);
                if !case.absorbs() {
                    reflected.see(lanes(down.r, lane)[pol] - lanes(up.r, lane)[pol], ar + br, what);
                }
            }
        }
    });
    transmitted.report(0.0);
    reflected.report(0.0);
}
