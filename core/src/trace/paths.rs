//! Tracing of paths, one by one, that do not interfere and add as powers.
//!
//! Without interference rays need not be merged: each path is followed to its end, and Russian roulette chooses one
//! branch of a weak path. Waves that find no free slot can continue as such paths ([`trace_with_fallback`]).

use crate::simd::lanes::Lanes;
use crate::trace::random::Random;
use crate::trace::waves::{Limits, OnFull, Propagated, Sink, Slot, Target, Trace, Waves, trace_generations};

/// Cell in which paths do not interfere, as [`follow_paths`] needs it.
pub trait Paths<V: Lanes> {
    /// State of a path: the facet that it is about to meet, the side, and where needed its point and direction.
    type State: Copy;
    /// Continuation of a path from a facet.
    type Branch: Copy;
    /// Light of a path.
    type Light: Copy;
    /// Way in which a path leaves.
    type Exit: Copy;

    /// Power of light in each lane, in units of the incident power.
    fn power(light: &Self::Light) -> V;
    /// Light with its power multiplied by `factor`.
    fn scale_power(light: &Self::Light, factor: f64) -> Self::Light;
    /// Splits a path at its facet into the reflected and the refracted branch.
    fn split(&mut self, state: &Self::State, light: &Self::Light) -> [Option<(Self::Branch, Self::Light)>; 2];
    /// Propagates a branch to the next facet, or out of the cell; `None` if it is lost.
    fn propagate(
        &mut self,
        from: &Self::State,
        branch: &Self::Branch,
        light: &Self::Light,
    ) -> Propagated<Self::State, Self::Exit, Self::Light>;
}

/// Paths that continue waves whose interference is given up.
pub trait AsPath<V: Lanes, W: Waves<V>>: Paths<V> {
    /// Path that continues a waiting wave; `None` if the wave is evanescent, and so carries no power of its own.
    fn path(&self, state: &W::State, field: &W::Field) -> Option<(Self::State, Self::Light)>;
}

/// Power below which a path is given up. Roulette keeps the power of a path, so only absorption reduces it so far.
const MIN_POWER: f64 = 1e-9;

/// Follows every path of `light`, depth first and weaker branch first, so that few paths wait at a time.
///
/// A path below the power `limits.in_flight` is no longer split: Russian roulette chooses one of its branches, with a
/// probability proportional to the branch's power, and the branch continues with the power of both. So the number of
/// paths stays bounded however often they meet facets, no power is lost, and each direction gets its expected power.
///
/// Paths of more than `limits.generations` hits, and paths that find no free slot, are dropped and counted in
/// [`Trace::truncated`]. After `limits.generations` hits of all paths together none is split any more: a strong path
/// that is trapped in the cell would produce a weak one at each hit, which would be trapped in turn. So there are at
/// most `limits.generations` × (1 + number of slots) hits.
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
    // The path that is being followed; others wait in the slots.
    let mut present = Slot { generation: 1, state: start, field: light };
    let mut waiting = 0;
    loop {
        let Slot { generation, state, field: light } = present;
        trace.visits += 1;
        trace.generations = trace.generations.max(generation);
        let many_hits = trace.visits > u64::from(limits.generations);
        let weak = many_hits || !P::power(&light).any_above(limits.in_flight);
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
            if generation >= limits.generations || !power.any_above(MIN_POWER) {
                trace.truncated += power;
                continue;
            }
            let mut slot = Slot { generation: generation + 1, state, field: light };
            // The stronger branch waits for the weaker, which ends sooner.
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

/// Russian roulette: keeps one of two branches, with the power of both in the sum over lanes.
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
        // Neither has power, or a power is NaN. One continues nevertheless: two would multiply without end.
        branches[1] = None;
    }
}

/// Number of hits of a starting ray, relative to [`Limits::generations`], beyond which waves that find no slot are
/// dropped: light that stays so long is trapped, and counts as truncated.
const MAX_RELATIVE_VISITS: u64 = 16;

/// Fall-back for waves that find no free slot: they continue as paths, without interference ([`trace_with_fallback`]).
///
/// Waves weaker than `limits.in_flight` are sampled systematically with a random offset: one sample for each
/// `limits.in_flight` of their cumulative power. This is unbiased, and keeps the power to within one sample.
#[derive(Debug)]
pub struct IncoherentFallback<'s, V: Lanes, P: Paths<V>> {
    paths: &'s mut P,
    slots: &'s mut [Slot<P::State, P::Light>],
    limits: Limits,
    random: &'s mut Random,
    /// Power of weak waves since the last sample.
    waiting: f64,
    /// Whether a wave has found no free slot.
    is_full: bool,
}

impl<'s, V: Lanes, P: Paths<V>> IncoherentFallback<'s, V, P> {
    /// Fall-back that follows `paths`, the cell without interference, in the memory `slots` and within `limits` of
    /// [`follow_paths`].
    pub fn new(
        paths: &'s mut P,
        slots: &'s mut [Slot<P::State, P::Light>],
        limits: Limits,
        random: &'s mut Random,
    ) -> Self {
        let waiting = random.next() * limits.in_flight;
        Self { paths, slots, limits, random, waiting, is_full: false }
    }

    /// Factor by which to multiply the power of a wave that is followed; `None` if the wave is not sampled.
    fn sample(&mut self, power: f64) -> Option<f64> {
        let step = self.limits.in_flight;
        if power >= step {
            return Some(1.0);
        }
        self.waiting += power;
        if self.waiting < step {
            return None;
        }
        self.waiting -= step;
        Some(step / power)
    }
}

/// Traces a wave like [`crate::trace::waves::trace`], but waves that find no free slot continue without interference,
/// as paths, through `fallback`.
///
/// From the first such wave on, all waves weaker than the fall-back's `in_flight` go there too and are sampled. Where
/// waves outnumber the slots, as light trapped in a curved film does, they hardly ever coincide again, and tracing each
/// as a wave costs a hundred times as much.
pub fn trace_with_fallback<V: Lanes, W: Waves<V>, P: AsPath<V, W>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    mut fallback: IncoherentFallback<'_, V, P>,
    sink: &mut (impl Sink<W::Exit, W::Field> + Sink<P::Exit, P::Light>),
) -> Trace<V> {
    trace_generations(cell, start, field, slots, limits, &mut fallback, sink)
}

impl<V, W, P, K> OnFull<V, W, K> for IncoherentFallback<'_, V, P>
where
    V: Lanes,
    W: Waves<V>,
    P: AsPath<V, W>,
    K: Sink<P::Exit, P::Light>,
{
    /// Paths are followed to their end, so the power in flight must be one that a passive cell can contain. Merging on
    /// curved facets may double it for a moment.
    const MAX_IN_FLIGHT: f64 = 4.0;

    fn prefers(&self, mean: f64) -> bool {
        self.is_full && mean < self.limits.in_flight
    }

    fn handle(&mut self, state: &W::State, field: &W::Field, power: V, visits: u64, sink: &mut K) -> (V, u64) {
        self.is_full = true;
        if visits > MAX_RELATIVE_VISITS * u64::from(self.limits.generations) {
            return (power, 0);
        }
        let Some((state, light)) = self.paths.path(state, field) else { return (power, 0) };
        let Some(factor) = self.sample(power.sum() / V::WIDTH as f64) else { return (V::zero(), 0) };
        let light = P::scale_power(&light, factor);
        let trace = follow_paths(self.paths, state, light, self.slots, self.limits, self.random, sink);
        (trace.truncated, trace.visits)
    }
}
