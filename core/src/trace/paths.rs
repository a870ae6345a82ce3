//! Rays that are followed one by one and add as powers.
//!
//! Without interference a ray needs no equals to wait for: each path is followed to its end, and of the branches of weak ones one
//! is drawn. Waves for which their tracer has no slot go on like this too ([`trace_with_fallback`]).

use crate::simd::lanes::Lanes;
use crate::trace::random::Random;
use crate::trace::waves::{Limits, OnFull, Propagated, Sink, Slot, Target, Trace, Waves, generations};

/// A cell as the tracer of paths sees it.
pub trait Paths<V: Lanes> {
    /// Where a path is: the facet about to be met, the side, and where needed its point and direction.
    type State: Copy;
    /// Which way a path goes on from a facet.
    type Branch: Copy;
    /// The light that it carries.
    type Light: Copy;
    /// How it leaves.
    type Exit: Copy;

    /// Power in units of the incident one, per lane.
    fn power(light: &Self::Light) -> V;
    /// Light `by` times as powerful.
    fn scale_power(light: &Self::Light, by: f64) -> Self::Light;
    /// Splits a path at its facet: the reflected and the refracted branch.
    fn split(&mut self, state: &Self::State, light: &Self::Light) -> [Option<(Self::Branch, Self::Light)>; 2];
    /// Sends a branch on its way; nothing if it is lost.
    fn propagate(
        &mut self,
        from: &Self::State,
        branch: &Self::Branch,
        light: &Self::Light,
    ) -> Propagated<Self::State, Self::Exit, Self::Light>;
}

/// Paths that go on where a wave gives up its interference.
pub trait AsPath<V: Lanes, W: Waves<V>>: Paths<V> {
    /// A waiting wave as a path; nothing if it is evanescent, and has no power of its own.
    fn path(&self, state: &W::State, field: &W::Field) -> Option<(Self::State, Self::Light)>;
}

/// Power below which a path is given up. Drawing keeps power whole, so only absorption leads here.
const FADED: f64 = 1e-9;

/// Follows every path of `light`, depth first and weaker branch first, so that few wait at a time.
///
/// A path below the power `limits.in_flight` is no longer split: one of its branches is drawn with a probability in
/// proportion to its power and goes on with the power of both. So the number of paths stays bounded however often they
/// meet facets, no power is lost, and each direction gets its share on average. Paths beyond `limits.generations` hits, or
/// without a slot, are dropped into [`Trace::truncated`]. After `limits.generations` hits of all paths together none is split
/// any more: a strong path that a cell traps would send a weak one at each of its hits, all of them trapped in their turn. So there
/// are at most `limits.generations` × (1 + number of slots) hits.
pub fn follow_paths<V: Lanes, P: Paths<V>>(
    cell: &mut P,
    start: P::State,
    light: P::Light,
    slots: &mut [Slot<P::State, P::Light>],
    limits: Limits,
    random: &mut Random,
    sink: &mut impl Sink<P::Exit, P::Light>,
) -> Trace<V> {
    let mut trace = Trace { truncated: V::zero(), visits: 0, generations: 0 };
    // The path at hand; others wait in the slots.
    let mut present = Slot { generation: 1, state: start, field: light };
    let mut waiting = 0;
    loop {
        let Slot { generation, state, field: light } = present;
        trace.visits += 1;
        trace.generations = trace.generations.max(generation);
        let enough = trace.visits > u64::from(limits.generations);
        let weak = enough || !P::power(&light).any_above(limits.in_flight);
        let mut branches = cell.split(&state, &light);
        if weak {
            roulette::<V, P>(&mut branches, random);
        }
        let mut next: Option<Slot<P::State, P::Light>> = None;
        for (branch, light) in branches.iter().flatten() {
            let (state, light) = match cell.propagate(&state, branch, light) {
                Some((Target::State(state), light)) => (state, light),
                Some((Target::Exit(exit), light)) => {
                    sink.exit(exit, light);
                    continue;
                }
                None => continue,
            };
            let power = P::power(&light);
            if generation >= limits.generations || !power.any_above(FADED) {
                trace.truncated += power;
                continue;
            }
            let mut slot = Slot { generation: generation + 1, state, field: light };
            // The stronger waits for the weaker, which is soon done with.
            if let Some(first) = &mut next {
                if (P::power(&first.field) - power).any_above(0.0) {
                    core::mem::swap(first, &mut slot);
                }
                match slots.get_mut(waiting) {
                    Some(vacant) => {
                        *vacant = slot;
                        waiting += 1;
                    }
                    None => trace.truncated += P::power(&slot.field),
                }
            } else {
                next = Some(slot);
            }
        }
        present = match next {
            Some(next) => next,
            None => {
                let Some(&last) = waiting.checked_sub(1).and_then(|last| slots.get(last)) else { return trace };
                waiting -= 1;
                last
            }
        };
    }
}

/// Leaves one of two branches, with the power of both in the sum over lanes.
fn roulette<V: Lanes, P: Paths<V>>(branches: &mut [Option<(P::Branch, P::Light)>; 2], random: &mut Random) {
    let [Some((_, first)), Some((_, second))] = branches else { return };
    let (a, b) = (P::power(first).sum(), P::power(second).sum());
    let both = a + b;
    if random.next() * both < a {
        *first = P::scale_power(first, both / a);
        branches[1] = None;
    } else if b > 0.0 {
        *second = P::scale_power(second, both / b);
        branches[0] = None;
    } else {
        // Neither has power, or it is no number: one goes on all the same, for two would become ever more.
        branches[1] = None;
    }
}

/// Hits of a starting ray, in units of those of the longest path, after which nothing spills any more: light that stays so long is
/// trapped, and counts as truncated.
const TRAPPED: u64 = 16;

/// Where rays go for which there is no slot among the waves: see [`trace_with_fallback`]. Those weaker than `limits.in_flight` are sampled
/// systematically, one for each `limits.in_flight` of their power, from a random start: each counts as often as its power says, and
/// all power is kept but for one sample's.
#[derive(Debug)]
pub struct IncoherentFallback<'s, V: Lanes, P: Paths<V>> {
    paths: &'s mut P,
    slots: &'s mut [Slot<P::State, P::Light>],
    limits: Limits,
    random: &'s mut Random,
    /// Power since the last sample.
    waiting: f64,
    /// Whether a ray has found no room.
    crowded: bool,
}

impl<'s, V: Lanes, P: Paths<V>> IncoherentFallback<'s, V, P> {
    /// The same cell for paths, memory and limits for [`follow_paths`], and what draws among branches.
    pub fn new(
        paths: &'s mut P,
        slots: &'s mut [Slot<P::State, P::Light>],
        limits: Limits,
        random: &'s mut Random,
    ) -> Self {
        let waiting = random.next() * limits.in_flight;
        Self { paths, slots, limits, random, waiting, crowded: false }
    }

    /// By how much to strengthen a ray of this power, if it is to be followed.
    fn sample(&mut self, power: f64) -> Option<f64> {
        let each = self.limits.in_flight;
        if power >= each {
            return Some(1.0);
        }
        self.waiting += power;
        if self.waiting < each {
            return None;
        }
        self.waiting -= each;
        Some(each / power)
    }
}

/// [`crate::trace::waves::trace`], but waves for which the workspace has no room lose their interference and go on by themselves through `spill`. From
/// the first such wave on, weak ones are sampled there too: where waves outnumber the workspace they hardly ever meet their equals
/// again, as light trapped in a curved film does not, and following each as a wave costs a hundred times as much.
pub fn trace_with_fallback<V: Lanes, W: Waves<V>, P: AsPath<V, W>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    mut spill: IncoherentFallback<'_, V, P>,
    sink: &mut (impl Sink<W::Exit, W::Field> + Sink<P::Exit, P::Light>),
) -> Trace<V> {
    generations(cell, start, field, slots, limits, &mut spill, sink)
}

impl<V, W, P, K> OnFull<V, W, K> for IncoherentFallback<'_, V, P>
where
    V: Lanes,
    W: Waves<V>,
    P: AsPath<V, W>,
    K: Sink<P::Exit, P::Light>,
{
    /// What spills is followed to its end, so it must be power that a passive cell can hold. Merging on curved facets may double
    /// the power in flight for a moment.
    const DIVERGED: f64 = 4.0;

    fn prefers(&self, mean: f64) -> bool {
        self.crowded && mean < self.limits.in_flight
    }

    fn take(&mut self, state: &W::State, field: &W::Field, power: V, visits: u64, sink: &mut K) -> (V, u64) {
        self.crowded = true;
        if visits > TRAPPED * u64::from(self.limits.generations) {
            return (power, 0);
        }
        let Some((state, light)) = self.paths.path(state, field) else { return (power, 0) };
        let Some(by) = self.sample(power.sum() / V::WIDTH as f64) else { return (V::zero(), 0) };
        let light = P::scale_power(&light, by);
        let alone = follow_paths(self.paths, state, light, self.slots, self.limits, self.random, sink);
        (alone.truncated, alone.visits)
    }
}
