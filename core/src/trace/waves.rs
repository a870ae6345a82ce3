//! Ray splitting with coherent merging.
//!
//! A ray is a plane wave; at each facet it becomes a reflected and a refracted one. Followed literally the number of paths
//! doubles at every hit. But two rays about to meet the same facet from the same side with the same wavevector are the
//! same plane wave: their amplitudes, referred to the facet's anchor, are **added and continue as one** (the paper's "rays
//! which have the same direction are coherent", applied inside the tracer). Rays are processed generation by
//! generation and merged as they are produced, so a planar stack of N planes has 2N states whatever the number of bounces.
//!
//! What a state is and where its amplitude goes is the cell's to say ([`Waves`]); where rays that leave end up is the
//! sink's ([`Sink`]). Planar cells have an accelerated sum of the same series in [`crate::trace::planar`]; rays that do not interfere
//! are followed by [`crate::trace::paths`].

use crate::simd::lanes::Lanes;

/// Where a ray goes after a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<S, X> {
    /// On to another facet.
    State(S),
    /// Out of the cell.
    Exit(X),
}

/// A cell as the tracer of waves that interfere sees it.
pub trait Waves<V: Lanes> {
    /// What tells two plane waves apart: the facet about to be met, the side, and where needed wavevector and point.
    type State: Copy;
    /// The complex amplitudes that a ray carries, referred to the facet's anchor.
    type Field: Copy;
    /// How a ray leaves: a side of the stack, or a direction.
    type Exit: Copy;

    /// A state waits at most this many slots behind its bucket; 1 where every state has a bucket of its own.
    const MAX_PROBES: usize;

    /// The first slot in which a state may wait, taken modulo the number of slots.
    fn bucket(&self, state: &Self::State) -> usize;
    /// Whether two rays are the same plane wave about to meet the same facet from the same side.
    fn is_same_wave(&self, a: &Self::State, b: &Self::State) -> bool;
    /// The field of both of two rays that are the [`Waves::is_same_wave`], in the state `into`.
    fn merge(&self, into: &Self::State, field: Self::Field, from: &Self::State, more: Self::Field) -> Self::Field;
    /// Power of a ray in units of the incident one, per lane; an upper bound where the wave is evanescent.
    fn power(&self, state: &Self::State, field: &Self::Field) -> V;
    /// Splits a ray at its facet: the reflected and the refracted ray.
    fn split(&mut self, state: &Self::State, field: &Self::Field) -> Split<Self::State, Self::Exit, Self::Field>;
}

/// Where a ray goes from a facet, and its field or light there; `None` if it is lost or fades away.
pub type Propagated<S, X, F> = Option<(Target<S, X>, F)>;

/// The reflected and the refracted ray of a hit.
pub type Split<S, X, F> = [Propagated<S, X, F>; 2];

/// Receives the rays that leave a cell. How they add is the sink's business: see [`crate::trace::ledger`].
pub trait Sink<X, F> {
    /// One ray leaves.
    fn exit(&mut self, exit: X, field: F);
}

/// A place for one state of the present or the next generation.
#[derive(Clone, Copy, Debug)]
pub struct Slot<S, F> {
    /// Generation of the ray that waits here; 0 if none does.
    pub(crate) generation: u32,
    pub(crate) state: S,
    pub(crate) field: F,
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
    /// Power in flight, relative to the incident, below which rays are dropped. It bounds no error: waves caught in a
    /// loop of gain g would still add up to √`in_flight`/|1 − g| to the amplitude that leaves.
    pub in_flight: f64,
    /// Generations after which to give up.
    pub generations: u32,
}

impl Limits {
    /// For single precision: drops amplitudes of 1e-7, which is of the order of its rounding.
    pub const SINGLE: Self = Self { in_flight: 1e-14, generations: 1_000_000 };
    /// For double precision: drops amplitudes of 3e-12.
    pub const DOUBLE: Self = Self { in_flight: 1e-23, generations: 4_000_000 };
}

/// What a trace cost and what it left undone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace<V> {
    /// Power in flight at the end plus power of rays dropped on the way, per lane. It is no error bar: see
    /// [`Limits::in_flight`]. A sum that is given up because it grows leaves more than 1.
    pub truncated: V,
    /// States visited: one for each splitting of a merged ray.
    pub visits: u64,
    /// Hits of the longest path.
    pub generations: u32,
}

/// Takes the waves for which there is no slot, and those that are not worth following. By default the former are
/// dropped and the latter are none.
pub(crate) trait OnFull<V: Lanes, W: Waves<V>, K> {
    /// Power in flight, relative to the incident, at which a sum of rays is given up. Where absorbing or evanescent
    /// waves make a loop's gain |g| > 1 although the cell is passive, the sum by generations diverges. Amplitudes of
    /// 10⁶ leave no digit of single precision and ten of double.
    const DIVERGED: f64 = 1e12;

    /// Whether a wave of this mean power over lanes is taken although there may be a slot.
    fn prefers(&self, _mean: f64) -> bool {
        false
    }

    /// Takes a wave of this power after so many hits; returns what it dropped and the hits it made.
    fn take(&mut self, _: &W::State, _: &W::Field, power: V, _visits: u64, _: &mut K) -> (V, u64) {
        (power, 0)
    }

    /// Looks at the waves that wait for `generation`, of the power `in_flight` in all: clears the lanes that are not
    /// worth following and returns their power.
    fn review(&mut self, _: &mut [Slot<W::State, W::Field>], _generation: u32, _in_flight: V) -> V {
        V::zero()
    }
}

/// Where nothing spills.
struct DropOnFull;

impl<V: Lanes, W: Waves<V>, K> OnFull<V, W, K> for DropOnFull {}

/// Follows `field` from `start` until [`Limits`] are met. `slots` is the workspace. Waves for which it has no room are dropped into
/// [`Trace::truncated`].
pub fn trace<V: Lanes, W: Waves<V>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    sink: &mut impl Sink<W::Exit, W::Field>,
) -> Trace<V> {
    generations(cell, start, field, slots, limits, &mut DropOnFull, sink)
}

pub(crate) fn generations<V: Lanes, W: Waves<V>, K: Sink<W::Exit, W::Field>, O: OnFull<V, W, K>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    overflow: &mut O,
    sink: &mut K,
) -> Trace<V> {
    for slot in slots.iter_mut() {
        slot.generation = 0;
    }
    let mut dropped = V::zero();
    let mut visits = 0;
    let mut generation = 1;
    if !insert_or_merge(cell, slots, generation, start, field) {
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
                        let stays = !overflow.prefers(power.sum() / V::WIDTH as f64);
                        if !(stays && insert_or_merge(cell, slots, generation + 1, state, field)) {
                            let (lost, hits) = overflow.take(&state, &field, power, visits, sink);
                            dropped += lost;
                            visits += hits;
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
        let cleared = overflow.review(slots, next, in_flight);
        let in_flight = in_flight - cleared;
        dropped += cleared;
        let done = !in_flight.any_above(limits.in_flight) || in_flight.any_above(O::DIVERGED);
        if done || generation >= limits.generations {
            return Trace { truncated: in_flight + dropped, visits, generations: generation };
        }
        generation = next;
    }
}

/// Merges a ray of the coming generation with its equal, or gives it a free slot; false if there is none.
fn insert_or_merge<V: Lanes, W: Waves<V>>(
    cell: &W,
    slots: &mut [Slot<W::State, W::Field>],
    generation: u32,
    state: W::State,
    field: W::Field,
) -> bool {
    if slots.is_empty() {
        return false;
    }
    let bucket = cell.bucket(&state);
    let mut vacant = None;
    let len = slots.len();
    for probe in 0..W::MAX_PROBES.min(len) {
        let place = (bucket + probe) % len;
        let Some(slot) = slots.get_mut(place) else { break };
        if slot.generation == generation && cell.is_same_wave(&slot.state, &state) {
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
