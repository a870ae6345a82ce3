//! Ray splitting with coherent merging.
//!
//! A ray is a plane wave; each facet splits it into a reflected and a refracted one, so the number of paths doubles at
//! every hit. But two rays about to meet the same facet from the same side with the same wavevector are the same plane
//! wave. Their amplitudes, referred to one point, are **added and continue as one** (the paper's "rays which have the
//! same direction are coherent", applied inside the tracer). Rays are processed generation by generation and merged as
//! they are produced, so a planar stack of N planes has 2N states whatever the number of bounces.
//!
//! The waiting rays lie in an open-addressing hash table in the caller's memory, an array of [`Slot`]s. The cell
//! computes the bucket of a state ([`Waves::bucket`]); linear probing over at most [`Waves::MAX_PROBES`] slots finds
//! either a ray of the same wave, with which the new one merges, or a free slot. One table contains two generations: a
//! slot belongs to the generation whose number it holds, and is freed when its ray is split.
//!
//! The cell defines states and the split of a ray ([`Waves`]); the sink receives the rays that leave ([`Sink`]). For
//! planar cells [`crate::trace::planar`] has an accelerated sum of the same series. [`crate::trace::paths`] traces rays
//! that do not interfere.

use crate::simd::lanes::Lanes;

/// Destination of a ray after a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target<S, X> {
    /// The ray arrives at another facet, in this state.
    State(S),
    /// The ray leaves the cell.
    Exit(X),
}

/// Cell in which waves interfere, as [`trace`] needs it.
pub trait Waves<V: Lanes> {
    /// Identity of a plane wave: the facet that it is about to meet, the side, and where needed wavevector and point.
    type State: Copy;
    /// Complex amplitudes of a ray at the point to which its state refers them.
    type Field: Copy;
    /// Way in which a ray leaves: a side of the stack, or a direction.
    type Exit: Copy;

    /// Number of slots, from its bucket on, in which a state may wait; 1 if every state has a bucket of its own.
    const MAX_PROBES: usize;

    /// First slot in which a state may wait. The tracer takes it modulo the number of slots.
    fn bucket(&self, state: &Self::State) -> usize;
    /// Whether two rays are one plane wave about to meet the same facet from the same side.
    fn is_same_wave(&self, a: &Self::State, b: &Self::State) -> bool;
    /// Adds to `field`, at the state `into`, the field `more` of another ray of the same plane wave
    /// ([`Waves::is_same_wave`]).
    fn merge(&self, into: &Self::State, field: &mut Self::Field, from: &Self::State, more: &Self::Field);
    /// Power of a ray in each lane, in units of the incident power; an upper bound if the wave is evanescent.
    fn power(&self, state: &Self::State, field: &Self::Field) -> V;
    /// Splits a ray at its facet into the reflected and the refracted ray, propagates both, and passes each to `emit`
    /// with its field where it arrives; one that is lost or fades away is not passed.
    fn split(
        &mut self,
        state: &Self::State,
        field: &Self::Field,
        emit: &mut impl FnMut(&Self, Target<Self::State, Self::Exit>, &Self::Field),
    );
}

/// Destination of a ray that leaves a facet, and its field or light there; `None` if it is lost or fades away.
pub type Propagated<S, X, F> = Option<(Target<S, X>, F)>;

/// Receiver of the rays that leave a cell. It decides how they add: see [`crate::trace::ledger`] and
/// [`crate::measure`].
pub trait Sink<X, F> {
    /// Receives one ray that leaves.
    fn exit(&mut self, exit: X, field: F);
}

/// Slot of the hash table for one ray of the present or the next generation.
#[derive(Clone, Copy, Debug)]
pub struct Slot<S, F> {
    /// Generation of the ray that waits here; 0 if the slot is free.
    pub(crate) generation: u32,
    pub(crate) state: S,
    pub(crate) field: F,
}

impl<S, F> Slot<S, F> {
    /// Free slot. The state and the field are never read.
    pub const fn free(state: S, field: F) -> Self {
        Self { generation: 0, state, field }
    }
}

/// Limits beyond which rays are not followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Power in flight, relative to the incident power, below which rays are dropped. It is not an error bound: waves
    /// in a loop of gain g would still add up to √`in_flight`/|1 − g| to the amplitude that leaves.
    pub in_flight: f64,
    /// Largest number of generations.
    pub generations: u32,
}

impl Limits {
    /// Limits in single precision: amplitudes below 1e-7, about its rounding error, are dropped.
    pub const SINGLE: Self = Self { in_flight: 1e-14, generations: 1_000_000 };
    /// Limits in double precision: amplitudes below 3e-12 are dropped.
    pub const DOUBLE: Self = Self { in_flight: 1e-23, generations: 4_000_000 };
}

/// Cost of a trace, and the power that it did not follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace<V> {
    /// Power in flight at the end plus power of rays dropped on the way, per lane. It is not an error bound: see
    /// [`Limits::in_flight`]. It exceeds 1 if the sum is given up because it grows.
    pub truncated: V,
    /// Number of states visited: one for each split of a merged ray.
    pub visits: u64,
    /// Number of hits of the longest path.
    pub generations: u32,
}

/// Handler of waves that find no free slot, and of waves that are not worth following. By default it drops the former,
/// and there are none of the latter.
pub(crate) trait OnFull<V: Lanes, W: Waves<V>, K> {
    /// Power in flight, relative to the incident power, at which a sum of rays is given up. Absorbing or evanescent
    /// waves can make a loop's gain |g| > 1 although the cell is passive; then the sum by generations diverges.
    /// Amplitudes of 10⁶ leave no correct digit of single precision and ten of double.
    const MAX_IN_FLIGHT: f64 = 1e12;

    /// Whether a wave of this power, averaged over lanes, is handled here even if there is a free slot.
    fn prefers(&self, _mean: f64) -> bool {
        false
    }

    /// Handles a wave of this power after `visits` hits; returns the power that is dropped and the number of further
    /// hits.
    fn handle(&mut self, _: &W::State, _: &W::Field, power: V, _visits: u64, _: &mut K) -> (V, u64) {
        (power, 0)
    }

    /// Clears the lanes that are not worth following of the waves that wait for `generation`, and returns the power of
    /// these lanes. `in_flight` is the power of all these waves.
    fn review(&mut self, _: &mut [Slot<W::State, W::Field>], _generation: u32, _in_flight: V) -> V {
        V::zero()
    }
}

/// Handler that drops waves for which there is no slot.
struct DropOnFull;

impl<V: Lanes, W: Waves<V>, K> OnFull<V, W, K> for DropOnFull {}

/// Traces a wave of amplitudes `field` from the state `start` until the [`Limits`] are reached. `slots` is the
/// workspace; waves that find no free slot are dropped and counted in [`Trace::truncated`].
pub fn trace<V: Lanes, W: Waves<V>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    sink: &mut impl Sink<W::Exit, W::Field>,
) -> Trace<V> {
    trace_generations(cell, start, field, slots, limits, &mut DropOnFull, sink)
}

/// Traces a wave generation by generation, with a handler of waves that find no free slot.
pub(crate) fn trace_generations<V: Lanes, W: Waves<V>, K: Sink<W::Exit, W::Field>, O: OnFull<V, W, K>>(
    cell: &mut W,
    start: W::State,
    field: W::Field,
    slots: &mut [Slot<W::State, W::Field>],
    limits: Limits,
    on_full: &mut O,
    sink: &mut K,
) -> Trace<V> {
    for slot in slots.iter_mut() {
        slot.generation = 0;
    }
    let mut dropped = V::zero();
    let mut visits = 0;
    let mut generation = 1;
    if !insert_or_merge(cell, slots, generation, start, &field) {
        return Trace { truncated: cell.power(&start, &field), visits, generations: 0 };
    }
    loop {
        for index in 0..slots.len() {
            let Some(slot) = slots.get_mut(index).filter(|slot| slot.generation == generation) else { continue };
            slot.generation = 0;
            let Slot { state, field, .. } = *slot;
            visits += 1;
            cell.split(&state, &field, &mut |cell, target, field| match target {
                Target::Exit(exit) => sink.exit(exit, *field),
                Target::State(state) => {
                    let power = cell.power(&state, field);
                    let may_wait = !on_full.prefers(power.sum() / V::WIDTH as f64);
                    if !(may_wait && insert_or_merge(cell, slots, generation + 1, state, field)) {
                        let (lost, hits) = on_full.handle(&state, field, power, visits, sink);
                        dropped += lost;
                        visits += hits;
                    }
                }
            });
        }
        let next = generation + 1;
        let in_flight = slots
            .iter()
            .filter(|slot| slot.generation == next)
            .fold(V::zero(), |sum, slot| sum + cell.power(&slot.state, &slot.field));
        let cleared = on_full.review(slots, next, in_flight);
        let in_flight = in_flight - cleared;
        dropped += cleared;
        let done = !in_flight.any_above(limits.in_flight) || in_flight.any_above(O::MAX_IN_FLIGHT);
        if done || generation >= limits.generations {
            return Trace { truncated: in_flight + dropped, visits, generations: generation };
        }
        generation = next;
    }
}

/// Merges a ray of the next generation with a ray of the same wave, or inserts it into a free slot; false if there is
/// none within reach of its bucket.
fn insert_or_merge<V: Lanes, W: Waves<V>>(
    cell: &W,
    slots: &mut [Slot<W::State, W::Field>],
    generation: u32,
    state: W::State,
    field: &W::Field,
) -> bool {
    if slots.is_empty() {
        return false;
    }
    let bucket = cell.bucket(&state);
    let mut vacant = None;
    let len = slots.len();
    for probe in 0..W::MAX_PROBES.min(len) {
        let index = (bucket + probe) % len;
        let Some(slot) = slots.get_mut(index) else { break };
        if slot.generation == generation && cell.is_same_wave(&slot.state, &state) {
            cell.merge(&slot.state, &mut slot.field, &state, field);
            return true;
        }
        if slot.generation == 0 && vacant.is_none() {
            vacant = Some(index);
        }
    }
    match vacant.and_then(|index| slots.get_mut(index)) {
        Some(slot) => *slot = Slot { generation, state, field: *field },
        None => return false,
    }
    true
}
