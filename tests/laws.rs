//! Laws of planar stacks, on many random ones: no reference but physics itself. Tolerances come from [`crate::scalar`].

#![allow(clippy::needless_range_loop, reason = "one index runs through several arrays")]

use crate::reference::Layered;
use crate::scalar::{Problem, Twin};
use goniochrome::coherence::Ledger;
use goniochrome::complex::Polarised;
use goniochrome::interface::Model;
use goniochrome::lanes::{F32, F64, Lanes};
use goniochrome::layers::{Summation, Workspace, trace_layers};
use goniochrome::trace::Limits;
use num_complex::Complex64;

const STACKS: u64 = 10_000;
const MOST_LAYERS: u64 = 12;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn dielectric(&mut self) -> Complex64 {
        self.between(1.0, 3.0).into()
    }

    /// From faint absorbers to metals.
    fn absorber(&mut self) -> Complex64 {
        let k = 10f64.powf(self.between(-4.0, 0.9));
        Complex64::new(10f64.powf(self.between(-1.3, 0.7)), k)
    }

    fn medium(&mut self, lossless: bool) -> Complex64 {
        if lossless || self.below(3) > 0 { self.dielectric() } else { self.absorber() }
    }
}

/// A stack and the light on it.
struct Case {
    stack: Layered,
    theta_deg: f64,
    wavelengths_nm: Vec<f64>,
}

/// R and T of s and p, in closed form.
#[derive(Clone, Copy)]
struct Power {
    r: Polarised<F64>,
    t: Polarised<F64>,
}

impl Case {
    fn random(random: &mut Random, lossless: bool, mirrors: bool) -> Self {
        let layers = random.below(MOST_LAYERS + 1) as usize;
        let mut eta = vec![Complex64::from(random.between(1.0, 2.0))];
        let mut thickness_nm = Vec::new();
        for layer in 0..layers {
            // Every other stack repeats a pair, as mirrors of beetles do.
            if layer >= 2 && random.0.is_multiple_of(2) {
                eta.push(eta[layer - 1]);
                thickness_nm.push(thickness_nm[layer - 2]);
            } else {
                eta.push(random.medium(lossless));
                thickness_nm.push(random.between(0.0, 1000.0));
            }
        }
        if !(mirrors && random.below(4) == 0) {
            eta.push(random.medium(lossless));
        }
        let wavelengths_nm = (0..F64::WIDTH).map(|_| random.between(300.0, 1100.0)).collect();
        Self { stack: Layered { eta, thickness_nm }, theta_deg: random.between(0.0, 89.9), wavelengths_nm }
    }

    fn sin_theta(&self) -> f64 {
        self.theta_deg.to_radians().sin()
    }

    fn power(&self) -> Power {
        self.stack.with_optics::<F64, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |optics| {
            let response = optics.response();
            Power { r: optics.reflectance(response.reflection), t: optics.transmittance(response.transmission) }
        })
    }

    fn ledger<V: Lanes>(&self, summation: Summation) -> (Ledger<V>, f64) {
        let mut workspace = Box::new(Workspace::<V, 32>::new());
        self.stack.with_optics::<V, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |optics| {
            let traced = trace_layers(optics, summation, workspace.memory()).expect("the stack fits");
            (traced.ledger, f64::from(traced.trace.generations))
        })
    }

    /// For each lane.
    fn twins(&self) -> Vec<[Twin; 2]> {
        let solve = |&wavelength_nm: &f64| {
            let Layered { eta, thickness_nm } = &self.stack;
            Problem { eta, thickness_nm, sin_theta: self.sin_theta(), wavelength_nm }.solve()
        };
        self.wavelengths_nm.iter().map(solve).collect()
    }

    fn with(&self, eta: Vec<Complex64>, thickness_nm: Vec<f64>) -> Self {
        let stack = Layered { eta, thickness_nm };
        Self { stack, theta_deg: self.theta_deg, wavelengths_nm: self.wavelengths_nm.clone() }
    }

    fn absorbs(&self) -> bool {
        self.stack.eta.iter().any(|eta| eta.im > 0.0)
    }
}

fn lanes<V: Lanes>(x: Polarised<V>, lane: usize) -> [f64; 2] {
    [x.s.lane(lane), x.p.lane(lane)]
}

/// The worst error in units of its bound, and in itself.
struct Worst {
    law: &'static str,
    relative: f64,
    absolute: f64,
    seen: u64,
    /// Where the bound says nothing, being above what R and T can differ by.
    vacuous: u64,
}

impl Worst {
    fn of(law: &'static str) -> Self {
        Self { law, relative: 0.0, absolute: 0.0, seen: 0, vacuous: 0 }
    }

    fn see(&mut self, error: f64, bound: f64, what: impl FnOnce() -> String) {
        assert!(error.is_finite(), "{}: not finite: {}", self.law, what());
        self.seen += 1;
        if bound > 1.0 {
            self.vacuous += 1;
            return;
        }
        assert!(error.abs() <= bound, "{}: {error:e} exceeds {bound:e}: {}", self.law, what());
        self.absolute = self.absolute.max(error.abs());
        self.relative = self.relative.max(error.abs() / bound);
    }

    /// A law that mostly says nothing is no law.
    fn report(self, most_vacuous: f64) {
        let Self { law, relative, absolute, seen, vacuous } = self;
        println!("{law}: worst {absolute:.1e}, {relative:.1e} of its bound; {vacuous} of {seen} unbounded");
        assert!(vacuous as f64 <= most_vacuous * seen as f64, "{law}: {vacuous} of {seen} unbounded");
    }
}

/// Two descriptions of one thing: R and T agree. `media` is how far apart, relatively, their indices may be.
fn equal(worst: &mut Worst, a: &Case, b: &Case, media: f64) {
    let (pa, pb) = (a.power(), b.power());
    for (lane, (ta, tb)) in a.twins().iter().zip(b.twins()).enumerate() {
        for pol in 0..2 {
            let bound = |of: fn([f64; 2]) -> f64| {
                of(ta[pol].perturbed(F64::UNIT_ROUNDOFF, media)) + of(tb[pol].perturbed(F64::UNIT_ROUNDOFF, media))
            };
            let difference = |x: Polarised<F64>, y: Polarised<F64>| lanes(x, lane)[pol] - lanes(y, lane)[pol];
            let what = || format!("{:?} and {:?} at {} deg", a.stack.eta, b.stack.eta, a.theta_deg);
            worst.see(difference(pa.r, pb.r), bound(|[r, _]| r), what);
            worst.see(difference(pa.t, pb.t), bound(|[_, t]| t), what);
        }
    }
}

fn each(seed: u64, mut check: impl FnMut(&mut Random)) {
    let mut random = Random(seed);
    (0..STACKS).for_each(|_| check(&mut random));
}

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
fn energy_goes_somewhere() {
    let mut worst = [Worst::of("R + T + A = 1"), Worst::of("R + T = 1"), Worst::of("0 <= R, T, A")];
    each(4, |random| {
        let case = Case::random(random, random.0.is_multiple_of(2), true);
        let (ledger, _) = case.ledger::<F64>(Summation::ClosedLoops);
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
fn light_takes_the_way_back() {
    let (mut transmitted, mut reflected) = (Worst::of("T from both sides"), Worst::of("R from both sides, lossless"));
    each(5, |random| {
        let mut case = Case::random(random, random.0.is_multiple_of(2), false);
        *case.stack.eta.last_mut().expect("a substrate") = random.dielectric();
        let (first, last) = (case.stack.eta[0].re, case.stack.eta[case.stack.eta.len() - 1].re);
        let sin = first * case.sin_theta() / last;
        if sin >= 0.9999 {
            return; // no light arrives from below at this angle
        }
        let turned = |v: &[f64]| v.iter().rev().copied().collect::<Vec<_>>();
        let mut eta = case.stack.eta.clone();
        eta.reverse();
        let mut back = case.with(eta, turned(&case.stack.thickness_nm));
        back.theta_deg = sin.asin().to_degrees();
        let (there, home) = (case.power(), back.power());
        for (lane, (a, b)) in case.twins().iter().zip(back.twins()).enumerate() {
            for pol in 0..2 {
                let [ar, at] = a[pol].rounding(F64::UNIT_ROUNDOFF);
                let [br, bt] = b[pol].rounding(F64::UNIT_ROUNDOFF);
                let what = || format!("{:?} {:?}", case.stack.eta, case.stack.thickness_nm);
                transmitted.see(lanes(there.t, lane)[pol] - lanes(home.t, lane)[pol], at + bt, what);
                if !case.absorbs() {
                    reflected.see(lanes(there.r, lane)[pol] - lanes(home.r, lane)[pol], ar + br, what);
                }
            }
        }
    });
    transmitted.report(0.0);
    reflected.report(0.0);
}

#[test]
fn only_lengths_in_wavelengths_matter() {
    let mut worst = Worst::of("scaling");
    each(6, |random| {
        let case = Case::random(random, false, true);
        let scale = 10f64.powf(random.between(-1.0, 2.0));
        let mut scaled = case.with(case.stack.eta.clone(), case.stack.thickness_nm.clone());
        scaled.stack.thickness_nm.iter_mut().for_each(|d| *d *= scale);
        scaled.wavelengths_nm.iter_mut().for_each(|nm| *nm *= scale);
        equal(&mut worst, &case, &scaled, 0.0);
    });
    worst.report(0.0);
}

#[test]
fn two_halves_are_a_whole() {
    let mut worst = Worst::of("splitting");
    each(7, |random| {
        let case = Case::random(random, false, true);
        let Layered { mut eta, mut thickness_nm } =
            case.with(case.stack.eta.clone(), case.stack.thickness_nm.clone()).stack;
        if thickness_nm.is_empty() {
            return;
        }
        let layer = random.below(thickness_nm.len() as u64) as usize;
        let part = thickness_nm[layer] * random.between(0.0, 1.0);
        thickness_nm[layer] -= part;
        thickness_nm.insert(layer, part);
        eta.insert(layer + 1, eta[layer + 1]);
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}

#[test]
fn a_layer_of_no_thickness_changes_nothing() {
    let mut worst = Worst::of("no thickness");
    each(8, |random| {
        let case = Case::random(random, false, true);
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        let layer = random.below(thickness_nm.len() as u64 + 1) as usize;
        thickness_nm.insert(layer, 0.0);
        eta.insert(layer + 1, random.medium(false));
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}

#[test]
fn a_plane_between_equal_media_changes_nothing() {
    let mut worst = Worst::of("index-matched");
    each(9, |random| {
        // More of the ambient on top, and more of the substrate below. The same medium under two numbers would be the
        // same: r = 0 comes of equal κ.
        let mut case = Case::random(random, false, false);
        let last = case.stack.eta.len() - 1;
        case.stack.eta[last] = random.dielectric();
        let (mut eta, mut thickness_nm) = (case.stack.eta.clone(), case.stack.thickness_nm.clone());
        eta.insert(0, eta[0]);
        thickness_nm.insert(0, random.between(0.0, 1000.0));
        if case.sin_theta() * case.stack.eta[0].re < case.stack.eta[last].re {
            eta.push(eta[last + 1]);
            thickness_nm.push(random.between(0.0, 1000.0));
        }
        equal(&mut worst, &case, &case.with(eta, thickness_nm), 0.0);
    });
    worst.report(0.0);
}

#[test]
fn faint_absorption_tends_to_none() {
    for k in [1e-6, 1e-9, 1e-12] {
        let mut worst = Worst::of("k to 0");
        each(10, |random| {
            let case = Case::random(random, true, true);
            let mut eta = case.stack.eta.clone();
            // An absorbing substrate would let power through that total reflection keeps out.
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
    /// Terms of second order, cos θ/|Y|, where Y of a resonance may be as small as a thousandth.
    const SECOND_ORDER: f64 = 0.1;
    let (mut most, mut departures, mut seen) = (0.0f64, 0u32, 0u32);
    each(11, |random| {
        let mut case = Case::random(random, false, false);
        let lost = COS.map(|cos| {
            case.theta_deg = 90.0 - cos.asin().to_degrees();
            case.power().r.map(|r| F64::one() - r)
        });
        // A wave that runs along the film or substrate itself is no grazing one: η must differ from the ambient's.
        for lane in 0..F64::WIDTH {
            for (far, near) in lanes(lost[0], lane).into_iter().zip(lanes(lost[1], lane)) {
                most = most.max(near);
                seen += 1;
                departures += u32::from(near > 0.01 || (near * 10.0 - far).abs() > SECOND_ORDER * far + 1e-9);
            }
        }
    });
    println!("grazing incidence: 1 - R up to {most:.1e}; {departures} of {seen} not linear in cos");
    assert!(f64::from(departures) < 1e-3 * f64::from(seen));
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
    // The square of an amplitude's rounding, not a rounding of a power.
    assert!(worst.absolute < 1e-24);
    worst.report(0.0);
}

#[test]
fn a_very_thick_absorber_is_a_half_space() {
    /// exp(−2 · 20) = 4e-18 of the amplitude returns.
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

#[test]
fn a_film_at_its_critical_angle_keeps_its_light() {
    // Light from n = 2 at 30 degrees runs along a film of n = 1; so it does in twenty of them.
    for films in [1, 2, 20] {
        let mut eta = vec![Complex64::from(2.0); 2 * films + 1];
        eta.iter_mut().skip(1).step_by(2).for_each(|eta| *eta = 1.0.into());
        let stack = Layered { eta, thickness_nm: vec![20.0; 2 * films - 1] };
        let case = Case { stack, theta_deg: 30.0, wavelengths_nm: vec![500.0; F64::WIDTH] };
        let (twins, single, double) = (case.twins(), case.single(), case.power());
        for pol in 0..2 {
            for (power, roundoff) in [(single, F32::UNIT_ROUNDOFF), (double, F64::UNIT_ROUNDOFF)] {
                // u/q_n with q_n² = 2u, a few times over, adding like random numbers from film to film.
                let bound = 4.0 * (films as f64 * roundoff).sqrt();
                let [r, t] = [power.r, power.t].map(|power| lanes(power, 0)[pol]);
                println!("{films} films: R {r} T {t}, twin {}", twins[0][pol].reflectance);
                assert!((r - twins[0][pol].reflectance).abs() <= bound && (r + t - 1.0).abs() <= bound);
            }
        }
    }
}

impl Case {
    /// [`Case::power`] in single precision, at the same wavelengths.
    fn single(&self) -> Power {
        self.stack.with_optics::<F32, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |optics| {
            let response = optics.response();
            let widen = |x: Polarised<F32>| x.map(|x| <F64 as Lanes>::from_fn(|lane| x.lane(lane)));
            Power {
                r: widen(optics.reflectance(response.reflection)),
                t: widen(optics.transmittance(response.transmission)),
            }
        })
    }
}
