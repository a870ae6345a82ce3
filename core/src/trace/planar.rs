//! Tracer for planar cells, and the exact sum of their rays.
//!
//! There are two ways to add the same rays:
//!
//! - [`Summation::Generations`] follows them hit by hit ([`crate::trace::waves`]). The sum converges if light travels
//!   without loss in every film, but it takes as long as resonances ring: visits grow like layers^3.7 (measured,
//!   contrast 1.56/1.0). With absorbing or evanescent waves a passive stack may have loops of gain above 1; then the
//!   sum diverges (for one in eleven of random stacks with a third of their media absorbing).
//! - [`Summation::ClosedLoops`] uses that a ray which returns to a state is the same plane wave times the loop's gain
//!   g, and adds all its rounds at once: 1 + g + g² + … = 1/(1 − g). Loops are closed from the bottom upwards, each
//!   before the next is met, so each state is visited once: visits grow like layers.
//!
//! The second is the limit of the first, where that converges. So the error of a sum of generations is known: it is the
//! difference from the closed loops, [`Ledger::truncated`].
//!
//! Adding rays in another order than that of generations is not safe. Sweeping down and up through the layers, so that
//! an amplitude merged now is used in the same sweep, orders the rays by their number of reversals. That is the Bremmer
//! series, which diverges for strong mirrors (it overflows on a 20-layer quarter-wave mirror).

use crate::geometry::side::Side;
use crate::optics::interface::{Below, Model, flux, transmission};
use crate::optics::stack::{PreparedStack, Response};
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::trace::ledger::{Ledger, Specular};
use crate::trace::waves::{Limits, OnFull, Sink, Slot, Target, Trace, Waves, trace_generations};

/// Amplitudes of s and p. They do not mix, since all facets share the plane of incidence.
pub type PlanarField<V> = Polarised<ComplexLanes<V>>;

/// State of a ray that is about to meet `facet` from `side`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlanarState {
    facet: u32,
    side: Side,
}

/// Slot of the tracer's workspace for planar cells.
pub type PlanarSlot<V> = Slot<PlanarState, PlanarField<V>>;

/// Sums of the amplitudes that have met one facet: from above, travelling down, and from below, travelling up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals<V> {
    down: PlanarField<V>,
    up: PlanarField<V>,
}

impl<V: Lanes> Totals<V> {
    /// Empty sums.
    #[must_use]
    pub fn none() -> Self {
        let zero = Polarised::both(ComplexLanes::zero());
        Self { down: zero, up: zero }
    }
}

/// Method by which rays are added; [the module](self) compares the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Summation {
    /// Every loop is closed by its geometric series.
    ClosedLoops,
    /// Rays are added hit by hit. The sum of a lane ends if its power in flight is below the limit, if it diverges, or
    /// if its decline shows that it would take more generations than the limit; the other lanes continue.
    /// [`Ledger::truncated`] is the error of the sum.
    Generations(Limits),
}

/// Memory of the tracer for planar cells of up to `PLANES` planes.
#[derive(Clone, Debug)]
pub struct Workspace<V: Lanes, const PLANES: usize = DEFAULT_PLANES> {
    totals: [Totals<V>; PLANES],
    slots: [[PlanarSlot<V>; 2]; PLANES],
}

/// Number of planes of the default workspace: 31 layers.
pub const DEFAULT_PLANES: usize = 32;

/// Largest size in bytes of the default workspace, which is meant to live on the stack.
pub const DEFAULT_WORKSPACE_BYTES: usize = 64 * 1024;

const _: () = assert!(size_of::<Workspace<crate::simd::lanes::F32>>() <= DEFAULT_WORKSPACE_BYTES);
const _: () = assert!(size_of::<Workspace<crate::simd::lanes::F64>>() <= DEFAULT_WORKSPACE_BYTES);

impl<V: Lanes, const PLANES: usize> Workspace<V, PLANES> {
    /// Empty workspace.
    #[must_use]
    pub fn new() -> Self {
        Self { totals: [Totals::none(); PLANES], slots: [[free_slot(); 2]; PLANES] }
    }

    /// Borrows the memory for a trace.
    pub fn memory(&mut self) -> TraceMemory<'_, V> {
        TraceMemory { totals: &mut self.totals, slots: self.slots.as_flattened_mut() }
    }
}

impl<V: Lanes, const PLANES: usize> Default for Workspace<V, PLANES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Slot in which no ray waits.
#[must_use]
pub fn free_slot<V: Lanes>() -> PlanarSlot<V> {
    Slot::free(PlanarState { facet: 0, side: Side::Above }, Polarised::both(ComplexLanes::zero()))
}

/// Borrowed memory of a trace through a planar cell.
#[derive(Debug)]
pub struct TraceMemory<'m, V: Lanes> {
    /// Sums for each plane.
    pub totals: &'m mut [Totals<V>],
    /// Two slots for each plane; only [`Summation::Generations`] uses them. If there are fewer, rays are dropped, which
    /// the ledger accounts for.
    pub slots: &'m mut [PlanarSlot<V>],
}

/// Error: the workspace has room for fewer planes than the stack has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooFewPlanes {
    /// Number of planes of the stack.
    pub needed: usize,
}

impl core::fmt::Display for TooFewPlanes {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "the workspace must have room for {} planes", self.needed)
    }
}

impl core::error::Error for TooFewPlanes {}

/// Result of a trace through a planar cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Traced<V> {
    /// Amplitudes of the reflected and the transmitted wave, as those of the closed form.
    pub response: Response<V>,
    /// Power balance.
    pub ledger: Ledger<V>,
    /// Cost of the trace.
    pub trace: Trace<V>,
}

/// Traces a plane wave of unit amplitude in both polarisations through a planar cell.
///
/// # Errors
/// [`TooFewPlanes`] if `memory.totals` has fewer elements than the stack has planes.
pub fn trace_planar<V: Lanes>(
    prepared: &PreparedStack<'_, V>,
    summation: Summation,
    memory: TraceMemory<'_, V>,
) -> Result<Traced<V>, TooFewPlanes> {
    let needed = prepared.stack().planes();
    let totals = memory.totals.get_mut(..needed).ok_or(TooFewPlanes { needed })?;
    let mut tracer = PlanarTracer { prepared, totals, reversal: prepared.reversal() };
    let unit = Polarised::both(ComplexLanes::one());
    let mut sink = Specular::new();
    let closing = tracer.close_loops(unit, &mut sink);
    let closed = sink.response();
    let (response, trace, truncated) = match summation {
        Summation::ClosedLoops => (closed, closing, V::zero()),
        Summation::Generations(limits) => {
            let (response, trace) = tracer.sum_generations(unit, memory.slots, limits);
            (response, trace, largest_difference(prepared, &response, &closed))
        }
    };
    let absorbed = tracer.absorbed();
    let (reflected, transmitted) =
        (prepared.reflectance(response.reflection), prepared.transmittance(response.transmission));
    let ledger = Ledger::new(reflected, transmitted, absorbed, truncated);
    Ok(Traced { response, ledger, trace })
}

/// Largest difference of two responses in reflectance or transmittance, over both polarisations.
fn largest_difference<V: Lanes>(prepared: &PreparedStack<'_, V>, a: &Response<V>, b: &Response<V>) -> V {
    let difference = |a: Polarised<V>, b: Polarised<V>| (a.s - b.s).abs().max((a.p - b.p).abs());
    let reflected = difference(prepared.reflectance(a.reflection), prepared.reflectance(b.reflection));
    reflected.max(difference(prepared.transmittance(a.transmission), prepared.transmittance(b.transmission)))
}

/// Bound of the rounding error of R and T in each lane, for the worse polarisation ([`crate::optics::rounding`]).
///
/// `totals` are those that [`Summation::ClosedLoops`] has left in [`TraceMemory::totals`]. The bound costs a fifth of
/// the time of the trace.
#[must_use]
pub fn rounding<V: Lanes>(prepared: &PreparedStack<'_, V>, totals: &[Totals<V>]) -> V {
    let incident = prepared.admittance(prepared.stack().ambient()).map(ComplexLanes::norm_sqr);
    let (mut above, mut sum) = (incident, Polarised::both(V::zero()));
    for (met, below) in totals.iter().zip(prepared.admittances_below()) {
        let below = below.map(ComplexLanes::norm_sqr);
        // The effect of an error of r, E H/(κ₀ |1 − r²|), is about (κ₁ |down| + κ₂ |up|)(|down| + |up|)/κ₀.
        let add = |sum: V, above: V, down: V, below: V, up: V| above.mul_add(down, below * up).mul_add(down + up, sum);
        sum.s = add(sum.s, above.s, met.down.s.norm_sqr(), below.s, met.up.s.norm_sqr());
        sum.p = add(sum.p, above.p, met.down.p.norm_sqr(), below.p, met.up.p.norm_sqr());
        above = below;
    }
    // If κ₁ + κ₂ cancels, r loses digits as 1 + |r|².
    let relative = sum.zip(incident, |sum, incident| (sum / incident).sqrt());
    let relative = relative.zip(prepared.max_reflectance(), |sum, r_squared| r_squared.mul_add(sum, sum));
    prepared.rounding(relative.s.max(relative.p))
}

/// Tracer of a planar cell: the prepared stack, and the sum of each state.
struct PlanarTracer<'a, 'm, V: Lanes> {
    prepared: &'a PreparedStack<'m, V>,
    totals: &'a mut [Totals<V>],
    /// σ: reflection from below is σ times reflection from above.
    reversal: V,
}

impl<V: Lanes> PlanarTracer<'_, '_, V> {
    /// Index of the last plane.
    fn last(&self) -> usize {
        self.totals.len() - 1
    }

    /// Wave that leaves facet `j` downwards, due to all that has met the facet.
    fn outgoing_down(&self, j: usize) -> PlanarField<V> {
        let Totals { down, up } = self.totals[j];
        let r = self.prepared.reflection_at(j);
        let side = |r: ComplexLanes<V>, down, up: ComplexLanes<V>| {
            transmission(r, self.reversal) * down + r.scale(self.reversal) * up
        };
        Polarised { s: side(r.s, down.s, up.s), p: side(r.p, down.p, up.p) }
    }

    /// Wave that leaves facet `j` upwards, due to all that has met the facet.
    fn outgoing_up(&self, j: usize) -> PlanarField<V> {
        let Totals { down, up } = self.totals[j];
        let r = self.prepared.reflection_at(j);
        let side = |r: ComplexLanes<V>, down, up: ComplexLanes<V>| r * down + transmission(r, V::one()) * up;
        Polarised { s: side(r.s, down.s, up.s), p: side(r.p, down.p, up.p) }
    }

    /// Adds all rays by closing loops from the bottom upwards; leaves the sum of each state in `totals`.
    fn close_loops(&mut self, incident: PlanarField<V>, sink: &mut impl Sink<Side, PlanarField<V>>) -> Trace<V> {
        let (last, sigma, one) = (self.last(), self.reversal, ComplexLanes::one());
        // Upwards. `rho_below` is the reflection of a facet with everything below it, for a unit wave from above.
        // Meanwhile `totals` contains: in `up`, what returns to the facet of a unit wave that leaves it downwards; in
        // `down`, what leaves it downwards of a unit wave from above, after all rounds in the film below.
        let mut rho_below = self.prepared.reflection_at(last);
        for j in (0..last).rev() {
            let r = self.prepared.reflection_at(j);
            let e = self.prepared.propagator_below(j);
            let round_trip = e.square();
            let returned = rho_below.map(|rho_below| rho_below * round_trip);
            let outgoing = r.zip(returned, |r, returned| {
                let gain = r.scale(sigma) * returned;
                transmission(r, sigma).div_or_zero(one - gain)
            });
            rho_below.s = transmission(r.s, V::one()).mul_add(returned.s * outgoing.s, r.s);
            rho_below.p = transmission(r.p, V::one()).mul_add(returned.p * outgoing.p, r.p);
            self.totals[j] = Totals { down: outgoing, up: returned };
        }
        sink.exit(Side::Above, rho_below.zip(incident, |rho_below, incident| rho_below * incident));
        // Downwards: the sum of each state follows from that of the state above.
        let mut down = incident;
        for j in 0..last {
            let e = self.prepared.propagator_below(j);
            let outgoing = self.totals[j].down.zip(down, |outgoing, down| outgoing * down);
            let up = self.totals[j].up.zip(outgoing, |returned, outgoing| returned * outgoing);
            self.totals[j] = Totals { down, up };
            down = outgoing.map(|outgoing| outgoing * e);
        }
        self.totals[last] = Totals { down, up: Polarised::both(ComplexLanes::zero()) };
        sink.exit(Side::Below, self.outgoing_down(last));
        let states = 2 * last + 1;
        Trace { truncated: V::zero(), visits: states as u64, generations: 0 }
    }

    /// Adds rays hit by hit; leaves the sum of each state in `totals`.
    fn sum_generations(
        &mut self,
        incident: PlanarField<V>,
        slots: &mut [PlanarSlot<V>],
        limits: Limits,
    ) -> (Response<V>, Trace<V>) {
        self.totals.fill(Totals::none());
        let mut forecast = Forecast::new(self.totals.len(), limits);
        let (start, mut sink) = (PlanarState { facet: 0, side: Side::Above }, Specular::new());
        let trace = trace_generations(self, start, incident, slots, limits, &mut forecast, &mut sink);
        (sink.response(), trace)
    }

    /// Power absorbed in films: the flux into each film minus the flux out of it, from the fields just inside its
    /// faces.
    fn absorbed(&self) -> Polarised<V> {
        let zero = Polarised::both(V::zero());
        let stack = self.prepared.stack();
        if self.prepared.model() == Model::Paper {
            return zero; // The paper's weights are not fields; absorption appears as imbalance.
        }
        let incident = self.prepared.admittance(stack.ambient());
        (0..self.last()).fold(zero, |sum, j| {
            let admittance = self.prepared.admittance(stack.film(j).medium);
            if !admittance.s.im.any_above(0.0) {
                return sum;
            }
            let (top_down, top_up) = (self.outgoing_down(j), self.totals[j].up);
            let (bottom_down, bottom_up) = (self.totals[j + 1].down, self.outgoing_up(j + 1));
            let lost = |k, incident: ComplexLanes<V>, td, tu, bd, bu| (flux(k, td, tu) - flux(k, bd, bu)) / incident.re;
            Polarised {
                s: sum.s + lost(admittance.s, incident.s, top_down.s, top_up.s, bottom_down.s, bottom_up.s),
                p: sum.p + lost(admittance.p, incident.p, top_down.p, top_up.p, bottom_down.p, bottom_up.p),
            }
        })
    }
}

impl<V: Lanes> Waves<V> for PlanarTracer<'_, '_, V> {
    type State = PlanarState;
    type Field = PlanarField<V>;
    type Exit = Side;
    const MAX_PROBES: usize = 1;

    fn bucket(&self, state: &PlanarState) -> usize {
        2 * state.facet as usize + usize::from(state.side == Side::Below)
    }

    fn is_same_wave(&self, a: &PlanarState, b: &PlanarState) -> bool {
        a == b
    }

    fn merge(&self, _: &PlanarState, field: &mut PlanarField<V>, _: &PlanarState, &more: &PlanarField<V>) {
        *field = field.zip(more, |a, b| a + b);
    }

    fn power(&self, state: &PlanarState, field: &PlanarField<V>) -> V {
        let stack = self.prepared.stack();
        let interface = stack.interface(state.facet as usize);
        let medium = match (state.side, interface.below) {
            (Side::Above, _) => interface.above,
            (Side::Below, Below::Medium(below)) => below,
            (Side::Below, Below::Mirror) => return V::zero(),
        };
        let (here, incident) = (self.prepared.admittance(medium), self.prepared.admittance(stack.ambient()));
        let of =
            |k: ComplexLanes<V>, incident: ComplexLanes<V>, a: ComplexLanes<V>| a.norm_sqr() * k.norm() / incident.re;
        of(here.s, incident.s, field.s).max(of(here.p, incident.p, field.p))
    }

    fn split(
        &mut self,
        state: &PlanarState,
        &field: &PlanarField<V>,
        emit: &mut impl FnMut(&Self, Target<PlanarState, Side>, &PlanarField<V>),
    ) {
        let j = state.facet as usize;
        if let Some(total) = self.totals.get_mut(j) {
            let total = if state.side == Side::Above { &mut total.down } else { &mut total.up };
            *total = total.zip(field, |a, b| a + b);
        }

        let r = self.prepared.reflection_at(j);
        let (reflected, refracted) = match state.side {
            Side::Above => (field.zip(r, |a, r| a * r), field.zip(r, |a, r| a * transmission(r, self.reversal))),
            Side::Below => {
                (field.zip(r, |a, r| a * r.scale(self.reversal)), field.zip(r, |a, r| a * transmission(r, V::one())))
            }
        };
        let (up, down) = match state.side {
            Side::Above => (reflected, refracted),
            Side::Below => (refracted, reflected),
        };
        let upwards = match state.facet.checked_sub(1) {
            None => (Target::Exit(Side::Above), up),
            Some(facet) => {
                let e = self.prepared.propagator_below(j - 1);
                (Target::State(PlanarState { facet, side: Side::Below }), up.map(|a| a * e))
            }
        };
        let downwards = if j == self.last() {
            (Target::Exit(Side::Below), down)
        } else {
            let e = self.prepared.propagator_below(j);
            (Target::State(PlanarState { facet: state.facet + 1, side: Side::Above }), down.map(|a| a * e))
        };
        for (target, field) in [upwards, downwards] {
            emit(self, target, &field);
        }
    }
}

/// Test that ends lanes: those whose power in flight is below the limit, diverges, or declines too slowly to fall below
/// the limit in time.
///
/// Generations are divided into windows, each twice as long as the one before. In the long run the power in flight
/// declines like that of the mode that rings longest, so its maxima in the last two windows predict how much will be
/// left.
struct Forecast<V> {
    limits: Limits,
    /// Generation at which the present window ends.
    end: u32,
    /// Largest power in flight in the present window.
    present: V,
    /// Largest power in flight in the window before.
    before: V,
}

impl<V: Lanes> Forecast<V> {
    /// Forecast whose first window is long enough for light to cross the stack twice.
    fn new(planes: usize, limits: Limits) -> Self {
        const MIN_WINDOW: u32 = 32;
        let end = u32::try_from(planes).map_or(u32::MAX, |planes| planes.saturating_mul(4).max(MIN_WINDOW));
        Self { limits, end, present: V::zero(), before: V::splat(f64::INFINITY) }
    }

    /// 1 in lanes that are predicted to have more power than the limit in flight after the last generation, 0 in
    /// others.
    fn late(&self) -> V {
        // The last two windows begin at a half and a quarter of `end`.
        let steps = (4 * u64::from(self.limits.generations)).checked_div(self.end.into()).unwrap_or(0);
        let left = self.present * power(self.present / self.before, steps.saturating_sub(2));
        V::splat(self.limits.in_flight).select_lt(left, V::one(), V::zero())
    }
}

/// Power base^exponent by repeated squaring.
fn power<V: Lanes>(mut base: V, mut exponent: u64) -> V {
    let mut product = V::one();
    while exponent > 0 {
        if exponent % 2 == 1 {
            product = product * base;
        }
        base = base * base;
        exponent /= 2;
    }
    product
}

impl<V: Lanes, K> OnFull<V, PlanarTracer<'_, '_, V>, K> for Forecast<V> {
    fn review(&mut self, slots: &mut [PlanarSlot<V>], generation: u32, in_flight: V) -> V {
        let (zero, one) = (V::zero(), V::one());
        self.present = self.present.max(in_flight);
        // 1 in lanes that end here; lanes with no power in flight have ended before.
        let faint = V::splat(self.limits.in_flight).select_lt(in_flight, zero, zero.select_lt(in_flight, one, zero));
        let mut ends =
            V::splat(<Self as OnFull<V, PlanarTracer<'_, '_, V>, K>>::MAX_IN_FLIGHT).select_lt(in_flight, one, faint);
        if generation >= self.end {
            ends = ends.max(self.late());
            (self.before, self.present, self.end) = (self.present, zero, self.end.saturating_mul(2));
        }
        if !ends.any_above(0.0) {
            return zero;
        }
        for slot in slots.iter_mut().filter(|slot| slot.generation == generation) {
            slot.field = slot.field.map(|a| a.scale(one - ends));
        }
        zero.select_lt(ends, in_flight, zero)
    }
}
