//! Ray splitting with coherent merging.
//!
//! A ray is a plane wave; at each facet it becomes a reflected and a refracted one. Followed literally the number of paths
//! doubles at every hit. But two rays about to meet the same facet from the same side with the same wavevector are the
//! same plane wave: their amplitudes, referred to the facet's anchor, are **added and continue as one** (the paper's "rays
//! which have the same direction are coherent", applied inside the tracer). Rays are processed generation by
//! generation and merged as they are produced, so a planar stack of N planes has 2N states whatever the number of bounces.
//!
//! What a state is and where its amplitude goes is the cell's to say ([`Facets`]); where rays that leave end up is the
//! sink's ([`Sink`]). Planar cells have an accelerated sum of the same series in [`crate::layers`].

use crate::lanes::Lanes;
use crate::sampling::Random;

/// Where a ray goes after a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<S, X> {
    /// On to another facet.
    State(S),
    /// Out of the cell.
    Exit(X),
}

/// A cell as the tracer sees it.
pub trait Facets<V: Lanes> {
    /// What tells two plane waves apart: the facet about to be met, the side, and where needed wavevector and tile.
    type State: Copy;
    /// The complex amplitudes that a ray carries, referred to the facet's anchor.
    type Field: Copy;
    /// How a ray leaves: a side of the stack, or a direction.
    type Exit: Copy;

    /// A state waits at most this many slots behind its home; 1 where every state has a home of its own.
    const PROBES: usize;

    /// The first slot in which a state may wait, taken modulo the number of slots.
    fn home(&self, state: &Self::State) -> usize;
    /// Whether two rays are the same plane wave about to meet the same facet from the same side.
    fn same(&self, a: &Self::State, b: &Self::State) -> bool;
    /// The field of both of two rays that are the [`Facets::same`], in the state `into`.
    fn merge(&self, into: &Self::State, field: Self::Field, from: &Self::State, more: Self::Field) -> Self::Field;
    /// Power of a ray in units of the incident one, per lane; an upper bound where the wave is evanescent.
    fn power(&self, state: &Self::State, field: &Self::Field) -> V;
    /// Power of a ray that leaves, as [`Facets::power`].
    fn exit_power(&self, exit: &Self::Exit, field: &Self::Field) -> V;
    /// A ray, waiting or leaving, `by` times as powerful.
    fn strengthen(
        &self,
        target: Target<Self::State, Self::Exit>,
        field: &Self::Field,
        by: f64,
    ) -> (Target<Self::State, Self::Exit>, Self::Field);
    /// From here on rays are followed one by one (`true`), or as waves that interfere: where a cell's fields keep power only
    /// together, it keeps that of each ray then.
    fn apart(&mut self, _: bool) {}
    /// Splits a ray at its facet: the reflected and the refracted ray.
    fn split(&mut self, state: &Self::State, field: &Self::Field) -> Split<Self::State, Self::Exit, Self::Field>;
}

/// The rays that come of a hit, each with where it goes: reflected, refracted.
pub type Split<S, X, F> = [Option<(Target<S, X>, F)>; 2];

/// Receives the rays that leave a cell. How they add is the sink's business: see [`crate::coherence`].
pub trait Sink<X, F> {
    /// One ray leaves.
    fn exit(&mut self, exit: X, field: F);

    /// One ray leaves that was followed by itself: its power counts, its phase does not.
    fn exit_alone(&mut self, exit: X, field: F) {
        self.exit(exit, field);
    }
}

/// A place for one state of the present or the next generation.
#[derive(Clone, Copy, Debug)]
pub struct Slot<S, F> {
    /// Generation of the ray that waits here; 0 if none does.
    generation: u32,
    state: S,
    field: F,
}

impl<S, F> Slot<S, F> {
    /// A free slot; the values are never read.
    pub const fn free(state: S, field: F) -> Self {
        Self { generation: 0, state, field }
    }
}

/// When to stop following rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Power in flight, relative to the incident, below which the sum is complete. What is left enters the amplitude that
    /// leaves, so reflectance is in error by up to 2√(R·in flight).
    pub in_flight: f64,
    /// Generations after which to give up.
    pub generations: u32,
}

impl Limits {
    /// For single precision: 2√1e-14 = 2e-7 is of the order of its rounding.
    pub const SINGLE: Self = Self { in_flight: 1e-14, generations: 1_000_000 };
    /// For double precision: 2√1e-22 = 2e-11.
    pub const DOUBLE: Self = Self { in_flight: 1e-22, generations: 4_000_000 };
}

/// Power in flight, relative to the incident, at which a sum of rays is given up. Where absorbing or evanescent waves make a
/// loop's gain |g| > 1 although the stack is passive, the sum by generations diverges. Amplitudes of
/// 10⁶ leave no digit of single precision and ten of double.
const DIVERGED: f64 = 1e12;

/// The same where rays spill: what spills is followed to its end, so it must be power that a passive cell can hold. Merging on
/// curved facets may double the power in flight for a moment.
const AMPLIFIED: f64 = 4.0;

/// Hits of a starting ray, in units of those of the longest path, after which nothing spills any more: light that stays so long is
/// trapped, and counts as truncated.
const TRAPPED: u64 = 16;

/// What a trace cost and what it left undone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace<V> {
    /// Power in flight at the end plus power of rays dropped for want of a slot, per lane. Above 1 the sum diverged.
    pub truncated: V,
    /// States visited: one for each splitting of a merged ray.
    pub visits: u64,
    /// Hits of the longest path.
    pub generations: u32,
}

/// Where rays go for which [`trace`] has no slot: they are followed by themselves. Those weaker than `limits.in_flight` are sampled
/// systematically, one for each `limits.in_flight` of their power, from a random start: each counts as often as its power says, and
/// all power is kept but for one sample's.
#[derive(Debug)]
pub struct Spill<'s, S, F> {
    slots: &'s mut [Slot<S, F>],
    limits: Limits,
    random: &'s mut Random,
    /// Power since the last sample.
    waiting: f64,
    /// Whether a ray has found no room: see [`trace`].
    crowded: bool,
}

impl<'s, S, F> Spill<'s, S, F> {
    /// Memory and limits for [`follow_paths`], and what draws among branches.
    pub fn new(slots: &'s mut [Slot<S, F>], limits: Limits, random: &'s mut Random) -> Self {
        let waiting = random.next() * limits.in_flight;
        Self { slots, limits, random, waiting, crowded: false }
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

/// Follows `field` from `start` until [`Limits`] are met. `slots` is the workspace. Rays for which it has no room lose their
/// interference and go on by themselves through `spill`; without that they are dropped into [`Trace::truncated`]. From the first
/// such ray on, weak ones are sampled there too: where waves outnumber the workspace they hardly ever meet their equals
/// again, as light trapped in a curved film does not, and following each as a wave costs a hundred times as much.
pub fn trace<V: Lanes, C: Facets<V>>(
    cell: &mut C,
    start: C::State,
    field: C::Field,
    slots: &mut [Slot<C::State, C::Field>],
    limits: Limits,
    mut spill: Option<Spill<'_, C::State, C::Field>>,
    sink: &mut impl Sink<C::Exit, C::Field>,
) -> Trace<V> {
    for slot in slots.iter_mut() {
        slot.generation = 0;
    }
    let mut dropped = V::zero();
    let mut visits = 0;
    let mut generation = 1;
    if !offer(cell, slots, generation, start, field) {
        return Trace { truncated: cell.power(&start, &field), visits, generations: 0 };
    }
    loop {
        for place in 0..slots.len() {
            let Some(slot) = slots.get_mut(place).filter(|slot| slot.generation == generation) else { continue };
            slot.generation = 0;
            let Slot { state, field, .. } = *slot;
            visits += 1;
            for (target, field) in cell.split(&state, &field).into_iter().flatten() {
                match target {
                    Target::Exit(exit) => sink.exit(exit, field),
                    Target::State(state) => {
                        let power = cell.power(&state, &field);
                        let mean = sum_of_lanes(power) / V::WIDTH as f64;
                        let keep = !spill.as_ref().is_some_and(|spill| spill.crowded && mean < spill.limits.in_flight);
                        if keep && offer(cell, slots, generation + 1, state, field) {
                            continue;
                        }
                        let Some(spill) = &mut spill else {
                            dropped += power;
                            continue;
                        };
                        spill.crowded = true;
                        if visits > TRAPPED * u64::from(spill.limits.generations) {
                            dropped += power;
                        } else if let Some(by) = spill.sample(mean) {
                            let (_, field) = cell.strengthen(Target::State(state), &field, by);
                            let Spill { slots, limits, random, .. } = spill;
                            cell.apart(true);
                            let alone = follow_paths(cell, state, field, slots, *limits, random, sink);
                            cell.apart(false);
                            visits += alone.visits;
                            dropped += alone.truncated;
                        }
                    }
                }
            }
        }
        let next = generation + 1;
        let in_flight = slots
            .iter()
            .filter(|slot| slot.generation == next)
            .fold(V::zero(), |sum, slot| sum + cell.power(&slot.state, &slot.field));
        let most = if spill.is_some() { AMPLIFIED } else { DIVERGED };
        let done = !in_flight.any_above(limits.in_flight) || in_flight.any_above(most);
        if done || generation >= limits.generations {
            return Trace { truncated: in_flight + dropped, visits, generations: generation };
        }
        generation = next;
    }
}

/// Power below which a path that is followed by itself is given up. Drawing keeps power whole, so only absorption leads here.
const FADED: f64 = 1e-9;

/// Follows every path of `field` by itself, depth first and weaker branch first, so that few rays wait at a time.
///
/// A ray below the power `limits.in_flight` is no longer split: one of its branches is drawn with a probability in
/// proportion to its power and goes on with the power of both. So the number of paths stays bounded however often they
/// meet facets, no power is lost, and each direction gets its share on average. Rays beyond `limits.generations` hits, or
/// without a slot, are dropped into [`Trace::truncated`]. After `limits.generations` hits of all paths together none is split
/// any more: a strong path that a cell traps would send a weak one at each of its hits, all of them trapped in their turn. So there
/// are at most `limits.generations` × (1 + number of slots) hits.
pub fn follow_paths<V: Lanes, C: Facets<V>>(
    cell: &mut C,
    start: C::State,
    field: C::Field,
    slots: &mut [Slot<C::State, C::Field>],
    limits: Limits,
    random: &mut Random,
    sink: &mut impl Sink<C::Exit, C::Field>,
) -> Trace<V> {
    let mut trace = Trace { truncated: V::zero(), visits: 0, generations: 0 };
    let mut waiting = 0;
    let wait = |slots: &mut [Slot<C::State, C::Field>], waiting: &mut usize, slot| match slots.get_mut(*waiting) {
        Some(vacant) => {
            *vacant = slot;
            *waiting += 1;
            true
        }
        None => false,
    };
    if !wait(slots, &mut waiting, Slot { generation: 1, state: start, field }) {
        trace.truncated = cell.power(&start, &field);
    }
    while let Some(next) = waiting.checked_sub(1) {
        waiting = next;
        let Some(&Slot { generation, state, field }) = slots.get(waiting) else { break };
        trace.visits += 1;
        trace.generations = trace.generations.max(generation);
        let enough = trace.visits > u64::from(limits.generations);
        let weak = enough || !cell.power(&state, &field).any_above(limits.in_flight);
        let mut branches = cell.split(&state, &field);
        if weak {
            draw(cell, &mut branches, random);
        }
        let mut on = [None, None];
        for ((target, field), on) in branches.into_iter().flatten().zip(&mut on) {
            let state = match target {
                Target::Exit(exit) => {
                    sink.exit_alone(exit, field);
                    continue;
                }
                Target::State(state) => state,
            };
            let power = cell.power(&state, &field);
            if generation >= limits.generations || !power.any_above(FADED) {
                trace.truncated += power;
            } else {
                *on = Some((power, Slot { generation: generation + 1, state, field }));
            }
        }
        // The stronger waits below the weaker, which is soon done with.
        if let [Some((first, _)), Some((second, _))] = &on
            && (*second - *first).any_above(0.0)
        {
            on.swap(0, 1);
        }
        for (power, slot) in on.into_iter().flatten() {
            if !wait(slots, &mut waiting, slot) {
                trace.truncated += power;
            }
        }
    }
    trace
}

/// Leaves one of two branches, with the power of both in the sum over lanes.
fn draw<V: Lanes, C: Facets<V>>(cell: &C, branches: &mut Split<C::State, C::Exit, C::Field>, random: &mut Random) {
    let [Some(first), Some(second)] = branches else { return };
    let power = |(target, field): &(Target<C::State, C::Exit>, C::Field)| {
        let power = match target {
            Target::Exit(exit) => cell.exit_power(exit, field),
            Target::State(state) => cell.power(state, field),
        };
        sum_of_lanes(power)
    };
    let (a, b) = (power(first), power(second));
    let both = a + b;
    if random.next() * both < a {
        let (target, field) = *first;
        *branches = [Some(cell.strengthen(target, &field, both / a)), None];
    } else if b > 0.0 {
        let (target, field) = *second;
        *branches = [None, Some(cell.strengthen(target, &field, both / b))];
    } else {
        // Neither has power, or it is no number: one goes on all the same, for two would become ever more.
        *branches = [Some(*first), None];
    }
}

fn sum_of_lanes<V: Lanes>(power: V) -> f64 {
    (0..V::WIDTH).map(|lane| power.lane(lane)).sum()
}

/// Merges a ray of the coming generation with its equal, or gives it a free slot; false if there is none.
fn offer<V: Lanes, C: Facets<V>>(
    cell: &C,
    slots: &mut [Slot<C::State, C::Field>],
    generation: u32,
    state: C::State,
    field: C::Field,
) -> bool {
    if slots.is_empty() {
        return false;
    }
    let home = cell.home(&state);
    let mut vacant = None;
    let len = slots.len();
    for probe in 0..C::PROBES.min(len) {
        let place = (home + probe) % len;
        let Some(slot) = slots.get_mut(place) else { break };
        if slot.generation == generation && cell.same(&slot.state, &state) {
            slot.field = cell.merge(&slot.state, slot.field, &state, field);
            return true;
        }
        if slot.generation == 0 && vacant.is_none() {
            vacant = Some(place);
        }
    }
    match vacant.and_then(|place| slots.get_mut(place)) {
        Some(slot) => *slot = Slot { generation, state, field },
        None => return false,
    }
    true
}
