//! Laws of physics that planar stacks obey, tested on many random ones. Tolerances come from [`crate::scalar`].

#![allow(clippy::needless_range_loop, reason = "one index runs through several arrays")]

mod agreement;
mod energy;
mod invariance;
mod limits;
mod truncation;

use crate::random::Random;
use crate::reference::Layered;
use crate::scalar::{Problem, Twin};
use goniochrome::optics::interface::Model;
use goniochrome::simd::complex::Polarised;
use goniochrome::simd::lanes::{F32, F64, Lanes};
use goniochrome::trace::planar::{Summation, TraceMemory, Traced, Workspace, trace_planar};
use goniochrome::trace::waves::Limits;
use num_complex::Complex64;

const STACKS: u64 = 10_000;
const MAX_LAYERS: u64 = 12;

impl Random {
    fn dielectric(&mut self) -> Complex64 {
        self.between(1.0, 3.0).into()
    }

    /// An absorbing medium, from faint absorbers to metals.
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
        let layers = random.below(MAX_LAYERS + 1) as usize;
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
        self.stack.with_prepared::<F64, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |prepared| {
            let response = prepared.response();
            Power { r: prepared.reflectance(response.reflection), t: prepared.transmittance(response.transmission) }
        })
    }

    fn traced<V: Lanes>(&self, summation: Summation) -> Traced<V> {
        self.traced_in(2 * (self.stack.thickness_nm.len() + 1), summation)
    }

    /// [`Case::traced`] in a workspace of so many slots.
    fn traced_in<V: Lanes>(&self, slots: usize, summation: Summation) -> Traced<V> {
        let mut workspace = Box::new(Workspace::<V, 32>::new());
        self.stack.with_prepared::<V, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |prepared| {
            let memory = workspace.memory();
            let memory = TraceMemory { totals: memory.totals, slots: &mut memory.slots[..slots] };
            trace_planar(prepared, summation, memory).expect("the stack fits")
        })
    }

    /// Both polarisations by the scalar solver, for each lane.
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
    /// Number of bounds that say nothing, since they are above the largest possible difference.
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

    /// Prints the worst error. Fails if more than a share `max_vacuous` of the bounds says nothing.
    fn report(self, max_vacuous: f64) {
        let Self { law, relative, absolute, seen, vacuous } = self;
        println!("{law}: worst {absolute:.1e}, {relative:.1e} of its bound; {vacuous} of {seen} unbounded");
        assert!(vacuous as f64 <= max_vacuous * seen as f64, "{law}: {vacuous} of {seen} unbounded");
    }
}

/// Checks that R and T of two descriptions of one stack agree. `media` is the relative difference of their indices.
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

/// Calls `check` for each of the random stacks.
fn each(seed: u64, mut check: impl FnMut(&mut Random)) {
    let mut random = Random(seed);
    (0..STACKS).for_each(|_| check(&mut random));
}

impl Case {
    /// [`Case::power`] in single precision, at the same wavelengths.
    fn single(&self) -> Power {
        self.stack.with_prepared::<F32, _>(self.theta_deg, &self.wavelengths_nm, Model::Physical, |prepared| {
            let response = prepared.response();
            let widen = |x: Polarised<F32>| x.map(|x| <F64 as Lanes>::from_fn(|lane| x.lane(lane)));
            Power {
                r: widen(prepared.reflectance(response.reflection)),
                t: widen(prepared.transmittance(response.transmission)),
            }
        })
    }
}
