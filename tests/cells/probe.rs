use crate::height_field::{Outcome, Start};
use goniochrome::lanes::{F64, Lanes};
use goniochrome::polygons::{Departure, Field, Incident, Polygons, State, free_slot};
use goniochrome::sampling::Random;
use goniochrome::trace::{Facets, Limits, Slot, Split, Target, follow_paths};
use goniochrome_cli::bumpy::Bumpy;
use goniochrome_cli::groups::Groups;
use goniochrome_cli::scene::Scene;

pub struct Checked<'a>(pub Polygons<'a, F64>, pub f64);
impl Facets<F64> for Checked<'_> {
    type State = State<F64>;
    type Field = Field<F64>;
    type Exit = Departure<F64>;
    const PROBES: usize = usize::MAX;
    fn home(&self, s: &State<F64>) -> usize {
        Facets::home(&self.0, s)
    }
    fn same(&self, a: &State<F64>, b: &State<F64>) -> bool {
        self.0.same(a, b)
    }
    fn merge(&self, i: &State<F64>, f: Field<F64>, g: &State<F64>, m: Field<F64>) -> Field<F64> {
        self.0.merge(i, f, g, m)
    }
    fn power(&self, s: &State<F64>, f: &Field<F64>) -> F64 {
        self.0.power(s, f)
    }
    fn exit_power(&self, e: &Departure<F64>, f: &Field<F64>) -> F64 {
        self.0.exit_power(e, f)
    }
    fn strengthen(
        &self,
        t: Target<State<F64>, Departure<F64>>,
        f: &Field<F64>,
        by: f64,
    ) -> (Target<State<F64>, Departure<F64>>, Field<F64>) {
        self.0.strengthen(t, f, by)
    }
    fn split(&mut self, s: &State<F64>, f: &Field<F64>) -> Split<State<F64>, Departure<F64>, Field<F64>> {
        let before = self.power(s, f).lane(0);
        let a = |p: &Polygons<'_, F64>| {
            let a = p.absorbed();
            0.5 * (a.s.lane(0) + a.p.lane(0)) + p.lost().lane(0)
        };
        let had = a(&self.0);
        let out = self.0.split(s, f);
        let mut parts = vec![];
        for (t, g) in out.iter().flatten() {
            parts.push(match t {
                Target::State(s) => self.power(s, g).lane(0),
                Target::Exit(e) => self.exit_power(e, g).lane(0),
            });
        }
        let after: f64 = parts.iter().sum::<f64>() + a(&self.0) - had;
        let off = (after - before).abs();
        if off > 1e-9 && off > self.1 {
            self.1 = off;
            println!(
                "  off {:e}: before {before:e} parts {parts:?} absorbed {:e}\n   state {s:?}\n   field {f:?}",
                after - before,
                a(&self.0) - had
            );
        }
        out
    }
}

pub fn probe(scene: &Scene, wavelength_nm: f64, states: usize, start: &Start) {
    const LIMITS: Limits = Limits { in_flight: 0.02, generations: 200 };
    let bumpy = Bumpy::new(scene).expect("a good mesh");
    let mut buffer = bumpy.buffer();
    let cell = bumpy.cell(&mut buffer).expect("a good mesh");
    let media = bumpy.media();
    let wavelengths = [wavelength_nm];
    let mut groups = Groups::<F64>::new(media.len(), &wavelengths);
    let groups = groups.evaluate(&media, &wavelengths).expect("constant media");
    let mut slots: Vec<Slot<State<F64>, Field<F64>>> = vec![free_slot(); states];
    let eta = groups[0].0.eta()[usize::from(cell.above())];
    let mut polygons = Checked(Polygons::new(cell, groups[0].0, Incident::new(start.wi, eta), false), 0.0);
    let mut outcome = Outcome::default();
    let Some((state, field)) = polygons.0.start(start.u, start.v) else { return };
    let mut random = Random::new(start.seed, 0);
    follow_paths(&mut polygons, state, field, &mut slots, LIMITS, &mut random, &mut outcome);
}
