//! Tests of limits: no absorption, grazing incidence, critical angles, Brewster's angle and great depth.

use super::*;

#[test]
fn faint_absorption_tends_to_none() {
    for k in [1e-6, 1e-9, 1e-12] {
        let mut worst = Worst::of("k to 0");
        each(10, |random| {
            let case = Case::random(random, true, true);
            let mut eta = case.stack.eta.clone();
            // The substrate stays lossless: an absorbing one would take in power under total reflection.
            let films = case.stack.thickness_nm.len();
            eta[1..=films].iter_mut().for_each(|eta| eta.im = k);
            // n ≥ 1, so k is at least the relative change of every η.
            equal(&mut worst, &case, &case.with(eta, case.stack.thickness_nm.clone()), k);
        });
        worst.report(1e-2);
    }
}

#[test]
fn everything_reflects_at_grazing_incidence() {
    // 1 − R = 4κ₀ Re Y/|κ₀ + Y|² with κ₀ ∝ cos θ: ten times closer to grazing, a tenth is lost.
    const COS: [f64; 2] = [1e-4, 1e-5];
    /// Bound of terms of second order, cos θ/|Y|, where a resonance may have |Y| of a thousandth.
    const SECOND_ORDER: f64 = 0.1;
    /// Bound of rounding at 90° itself, where R = |1 − ρe²|²/|1 − ρe²|² and a resonance cancels digits.
    const ROUNDING: f64 = 1e-11;
    let (mut max, mut nonlinear, mut seen) = (0.0f64, 0u32, 0u32);
    each(11, |random| {
        let mut case = Case::random(random, false, false);
        let lost = COS.map(|cos| {
            case.theta_deg = 90.0 - cos.asin().to_degrees();
            case.power().r.map(|r| F64::one() - r)
        });
        // Media whose η is that of the ambient medium are rare exceptions: their wave runs along the film too.
        for lane in 0..F64::WIDTH {
            for (far, near) in lanes(lost[0], lane).into_iter().zip(lanes(lost[1], lane)) {
                max = max.max(near);
                seen += 1;
                nonlinear += u32::from(near > 0.01 || (near * 10.0 - far).abs() > SECOND_ORDER * far + 1e-9);
            }
        }
        // At the limit itself.
        case.theta_deg = 90.0;
        let along = case.power();
        for lane in 0..F64::WIDTH {
            let (r, t) = (lanes(along.r, lane), lanes(along.t, lane));
            assert!(
                r.iter().all(|r| (r - 1.0).abs() <= ROUNDING) && t == [0.0; 2],
                "{:?}: {r:?} {t:?}",
                case.stack.eta
            );
        }
    });
    println!("grazing incidence: 1 - R up to {max:.1e}; {nonlinear} of {seen} not linear in cos");
    assert!(f64::from(nonlinear) < 1e-3 * f64::from(seen));
}

#[test]
fn a_film_at_its_critical_angle_keeps_its_light() {
    // Light from n = 2 at 30 degrees runs along films of n = 1.
    for films in [1, 2, 20] {
        let mut eta = vec![Complex64::from(2.0); 2 * films + 1];
        eta.iter_mut().skip(1).step_by(2).for_each(|eta| *eta = 1.0.into());
        let stack = Layered { eta, thickness_nm: vec![20.0; 2 * films - 1] };
        let case = Case { stack, theta_deg: 30.0, wavelengths_nm: vec![500.0; F64::WIDTH] };
        let (twins, single, double) = (case.twins(), case.single(), case.power());
        for pol in 0..2 {
            for (power, roundoff) in [(single, F32::UNIT_ROUNDOFF), (double, F64::UNIT_ROUNDOFF)] {
                // A few u/q_n with q_n² = 2u; the errors of several films add like random numbers.
                let bound = 4.0 * (films as f64 * roundoff).sqrt();
                let [r, t] = [power.r, power.t].map(|power| lanes(power, 0)[pol]);
                println!("{films} films: R {r} T {t}, twin {}", twins[0][pol].reflectance);
                assert!((r - twins[0][pol].reflectance).abs() <= bound && (r + t - 1.0).abs() <= bound);
            }
        }
    }
}

#[test]
fn p_light_does_not_reflect_at_brewsters_angle() {
    let mut worst = Worst::of("Brewster");
    each(12, |random| {
        let eta = vec![random.dielectric(), random.dielectric()];
        let theta_deg = (eta[1].re / eta[0].re).atan().to_degrees();
        let case = Case {
            stack: Layered { eta, thickness_nm: Vec::new() },
            theta_deg,
            wavelengths_nm: vec![500.0; F64::WIDTH],
        };
        let bound = case.twins()[0][1].rounding(F64::UNIT_ROUNDOFF)[0];
        worst.see(lanes(case.power().r, 0)[1], bound, || format!("{:?}", case.stack.eta));
    });
    // The error is the square of an amplitude's rounding, not the rounding of a power.
    assert!(worst.absolute < 1e-24);
    worst.report(0.0);
}

#[test]
fn a_very_thick_absorber_is_a_half_space() {
    /// Depth of the layer in amplitudes' decay lengths: exp(−2 · 20) = 4e-18 of the amplitude returns.
    const DEPTH: f64 = 20.0;
    let mut worst = Worst::of("half space");
    each(13, |random| {
        let case = Case::random(random, false, false);
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        let thick = random.absorber();
        *eta.last_mut().expect("a substrate") = thick;
        let half_space = case.with(eta.clone(), thickness_nm.clone());
        // Im q_n ≥ k, and the longest wavelength is 1100 nm.
        thickness_nm.push(DEPTH * 1100.0 / (std::f64::consts::TAU * thick.im));
        eta.push(random.medium(false));
        let thick = case.with(eta, thickness_nm);
        let (a, b) = (half_space.power(), thick.power());
        for (lane, (ta, tb)) in half_space.twins().iter().zip(thick.twins()).enumerate() {
            for pol in 0..2 {
                let bound = ta[pol].rounding(F64::UNIT_ROUNDOFF)[0] + tb[pol].rounding(F64::UNIT_ROUNDOFF)[0];
                let what = || format!("{:?} {:?}", thick.stack.eta, thick.stack.thickness_nm);
                worst.see(lanes(a.r, lane)[pol] - lanes(b.r, lane)[pol], bound, what);
            }
        }
    });
    worst.report(0.0);
}
