//! Direction bins: where rays that leave a polygon cell are counted.
//!
//! The exits of one starting ray that fall into one bin add as amplitudes (coherence `ray`) or as powers (`none`); starting
//! rays add as powers. Amplitudes are referred to the starting ray's first hit: for equal directions that changes nothing,
//! and for directions that differ within a bin it removes a phase that only says where the origin lies.

use crate::geometry::side::Side;
use crate::optics::medium::MediaLanes;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::propagate;
use crate::simd::vector::{RealLanes, VectorLanes};
use crate::trace::coherent_mesh::{ExitWave, WaveField};
use crate::trace::incoherent_mesh::{Coherency, ExitPath};
use crate::trace::waves::Sink;
use core::f64::consts::TAU;
use glam::DVec3;

/// Bins uniform in cos θ and in φ over a hemisphere, all of equal solid angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectionBins {
    /// Number of bins in cos θ, from 0 at the horizon.
    pub cos: u32,
    /// Number of bins in φ, from 0 at the tangent.
    pub phi: u32,
}

impl DirectionBins {
    /// Number of bins.
    #[must_use]
    pub fn count(&self) -> usize {
        self.cos as usize * self.phi as usize
    }

    /// The bin of a direction; its length does not matter, nor the sign of its z. Row by row in cos θ.
    #[must_use]
    #[inline(never)] // Arctangents are long, and this is called from four places.
    pub fn index(&self, direction: DVec3) -> usize {
        let cos = libm::fabs(direction.z) / direction.length();
        let turn = libm::atan2(direction.y, direction.x) / TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let row = ((cos * f64::from(self.cos)) as u32).min(self.cos - 1);
        let column = ((turn * f64::from(self.phi)) as u32).min(self.phi - 1);
        row as usize * self.phi as usize + column as usize
    }

    /// The bin of each lane.
    fn of_lanes<V: Lanes>(&self, directions: RealLanes<V>) -> [u32; MAX_LANES] {
        let first = directions.lane(0);
        let mut bins = [self.index(first) as u32; MAX_LANES];
        for (lane, bin) in bins.iter_mut().enumerate().take(V::WIDTH).skip(1) {
            let direction = directions.lane(lane);
            if direction != first {
                *bin = self.index(direction) as u32;
            }
        }
        bins
    }

    /// Bounds of a bin: cos θ from and to, φ from and to in radians.
    #[must_use]
    pub fn bounds(&self, bin: usize) -> [f64; 4] {
        let columns = self.phi.max(1) as usize;
        let (row, column) = (bin / columns, bin % columns);
        let (cos, phi) = (f64::from(self.cos), f64::from(self.phi));
        [row as f64 / cos, (row + 1) as f64 / cos, TAU * column as f64 / phi, TAU * (column + 1) as f64 / phi]
    }

    /// ∫ cos θ dω over a bin: power divided by it is the BRDF's mean.
    #[must_use]
    pub fn projected_solid_angle(&self, bin: usize) -> f64 {
        let [from, to, phi_from, phi_to] = self.bounds(bin);
        0.5 * (to * to - from * from) * (phi_to - phi_from)
    }
}

/// Lanes of the widest type.
const MAX_LANES: usize = 16;

/// One ray that has left, waiting for the others of its starting ray.
#[derive(Clone, Copy, Debug)]
pub struct ExitRecord<V: Lanes> {
    side: Side,
    bins: [u32; MAX_LANES],
    /// Followed by itself: its power counts, its field does not.
    alone: bool,
    /// Referred to the first hit, and scaled to the power it carries.
    field: WaveField<V>,
    power: Polarised<V>,
}

impl<V: Lanes> ExitRecord<V> {
    /// Fills memory that is written before it is read.
    #[must_use]
    pub fn none() -> Self {
        let nothing = Polarised::both(VectorLanes::zero());
        Self { side: Side::Above, bins: [0; MAX_LANES], alone: true, field: nothing, power: Polarised::both(V::zero()) }
    }
}

/// The exits of one starting ray.
#[derive(Debug)]
pub struct ExitBuffer<'m, V: Lanes> {
    memory: &'m mut [ExitRecord<V>],
    count: usize,
    grid: DirectionBins,
    per_wavelength: V::Precise,
    /// The starting ray's first hit.
    origin_nm: DVec3,
    /// Power of exits for which there was no memory.
    dropped: V,
}

/// Power per lane that one starting ray sends into a bin, unpolarised.
pub trait Histogram {
    /// `power` of one lane into a bin above, or towards below.
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64);
}

impl<'m, V: Lanes> ExitBuffer<'m, V> {
    /// No exits yet. `memory` should hold as many as one starting ray may have; more are dropped and accounted for.
    pub fn new(memory: &'m mut [ExitRecord<V>], grid: DirectionBins, media: &MediaLanes<'_, V>) -> Self {
        const { assert!(V::WIDTH <= MAX_LANES) };
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let origin_nm = DVec3::ZERO;
        Self { memory, count: 0, grid, per_wavelength, origin_nm, dropped: V::zero() }
    }

    /// Begins a starting ray at its first hit.
    pub fn begin(&mut self, origin_nm: DVec3) {
        self.count = 0;
        self.dropped = V::zero();
        self.origin_nm = origin_nm;
    }

    /// Adds up the starting ray's exits and hands their unpolarised power to `histogram`. Returns the power dropped.
    pub fn flush(&mut self, histogram: &mut impl Histogram) -> V {
        let mut exits = self.memory.get_mut(..self.count).unwrap_or(&mut []);
        while let Some((into, tail)) = core::mem::take(&mut exits).split_first_mut() {
            if !into.alone {
                for other in tail.iter_mut().filter(|other| !other.alone && other.side == into.side) {
                    // Lanes are independent: those whose bins agree move over, the others stay.
                    let moves = V::from_fn(|lane| f64::from(u8::from(other.bins.get(lane) == into.bins.get(lane))));
                    let stays = V::one() - moves;
                    let scaled =
                        |e: VectorLanes<V>, by: V| VectorLanes { x: e.x.scale(by), y: e.y.scale(by), z: e.z.scale(by) };
                    into.field = into.field.zip(other.field, |a, b| a + scaled(b, moves));
                    other.field = other.field.map(|e| scaled(e, stays));
                }
                into.power = into.field.map(VectorLanes::norm_sqr);
            }
            for (lane, &bin) in into.bins.iter().enumerate().take(V::WIDTH) {
                let power = 0.5 * (into.power.s.lane(lane) + into.power.p.lane(lane));
                if power > 0.0 {
                    histogram.add(lane, into.side, bin as usize, power);
                }
            }
            exits = tail;
        }
        self.dropped
    }
}

impl<V: Lanes> ExitBuffer<'_, V> {
    /// Adds to an exit that is alike, or takes a place of its own; one without a field was followed by itself.
    fn put(&mut self, side: Side, bins: [u32; MAX_LANES], power: Polarised<V>, field: Option<WaveField<V>>) {
        let alone = field.is_none();
        let alike = |exit: &&mut ExitRecord<V>| exit.side == side && exit.alone == alone && exit.bins.iter().eq(&bins);
        if let Some(exit) = self.memory.iter_mut().take(self.count).find(alike) {
            exit.power = exit.power.zip(power, |a, b| a + b);
            if let Some(field) = field {
                exit.field = exit.field.zip(field, |a, b| a + b);
            }
        } else if let Some(exit) = self.memory.get_mut(self.count) {
            (exit.side, exit.bins, exit.alone, exit.power) = (side, bins, alone, power);
            // Otherwise it is never read, and too large to be cleared each time.
            if let Some(field) = field {
                exit.field = field;
            }
            self.count += 1;
        } else {
            self.dropped += (power.s.abs() + power.p.abs()) * V::splat(0.5);
        }
    }
}

impl<V: Lanes> Sink<ExitWave<V>, WaveField<V>> for ExitBuffer<'_, V> {
    fn exit(&mut self, departure: ExitWave<V>, field: WaveField<V>) {
        let ExitWave { side, power, wavevector, point_nm, .. } = departure;
        let to_origin = phase_of(&departure, self.origin_nm - point_nm, self.per_wavelength);
        let bins = self.grid.of_lanes(wavevector.map(|q| q.re));
        self.put(side, bins, power, Some(scaled_to_power(field, power, propagate(to_origin))));
    }
}

impl<V: Lanes> Sink<ExitPath<V>, Coherency<V>> for ExitBuffer<'_, V> {
    fn exit(&mut self, leaving: ExitPath<V>, light: Coherency<V>) {
        self.put(leaving.side, self.grid.of_lanes(leaving.direction), Polarised::both(light.power()), None);
    }
}

/// One field for each bin, above and then below: all exits that fall into a bin add as amplitudes, whatever starting ray they
/// come from (coherence `bin`, the paper's section 2.2 taken literally). Divided by the number of starting rays, its square
/// is the bin's power; power is not conserved, since directions that differ within a bin do not really interfere.
#[derive(Debug)]
pub struct BinFields<'m, V: Lanes> {
    fields: &'m mut [WaveField<V>],
    grid: DirectionBins,
    per_wavelength: V::Precise,
    incident: VectorLanes<V::Precise>,
    /// exp(i k₀ q_in·x) at the present starting ray's first hit.
    arrival: ComplexLanes<V>,
}

impl<'m, V: Lanes> BinFields<'m, V> {
    /// Memory for a grid: fields of both hemispheres.
    #[must_use]
    pub fn required_len(grid: DirectionBins) -> usize {
        2 * grid.count()
    }

    /// Adds to `fields`, which holds [`BinFields::required_len`] elements.
    pub fn new(
        fields: &'m mut [WaveField<V>],
        grid: DirectionBins,
        media: &MediaLanes<'_, V>,
        incident: VectorLanes<V::Precise>,
    ) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        Self { fields, grid, per_wavelength, incident, arrival: ComplexLanes::one() }
    }

    /// Begins a starting ray at its first hit.
    pub fn begin(&mut self, point_nm: DVec3) {
        self.arrival = propagate(self.incident.dot_real(point_nm).scale(self.per_wavelength));
    }
}

impl<V: Lanes> Sink<ExitWave<V>, WaveField<V>> for BinFields<'_, V> {
    fn exit(&mut self, departure: ExitWave<V>, field: WaveField<V>) {
        let phase = propagate::<V>(phase_of(&departure, -departure.point_nm, self.per_wavelength));
        let field = scaled_to_power(field, departure.power, phase * self.arrival);
        let bins = self.grid.of_lanes(departure.wavevector.map(|q| q.re));
        let hemisphere = if departure.side == Side::Above { 0 } else { self.grid.count() };
        for lane in 0..V::WIDTH {
            // Each bin once, for all lanes that fall into it.
            if bins[..lane].contains(&bins[lane]) {
                continue;
            }
            let mask = V::from_fn(|other| f64::from(u8::from(bins[other] == bins[lane])));
            if let Some(sum) = self.fields.get_mut(hemisphere + bins[lane] as usize) {
                *sum = sum.zip(field, |sum, e| sum + e.scale(ComplexLanes::real(mask)));
            }
        }
    }
}

/// Turns of a ray's phase over a step. Its amplitude is that of its own place: where it varies across the ray, as in an absorbing
/// substrate or behind a tilted facet of an absorbing body, a ray is as strong as its tube says, wherever its phase is referred to.
fn phase_of<V: Lanes>(departure: &ExitWave<V>, step_nm: DVec3, per_wavelength: V::Precise) -> ComplexLanes<V::Precise> {
    ComplexLanes::real(departure.wavevector.dot_real(step_nm).re * per_wavelength)
}

/// A ray's field with its phase referred elsewhere, scaled so that its square is the power it carries, in an absorbing
/// substrate too.
fn scaled_to_power<V: Lanes>(field: WaveField<V>, power: Polarised<V>, phase: ComplexLanes<V>) -> WaveField<V> {
    field.zip(power, |e, power| {
        let square = e.norm_sqr();
        let scale = V::zero().select_lt(square, (power.max(V::zero()) / square).sqrt(), V::zero());
        e.scale(phase.scale(scale))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_direction_has_the_bin_whose_bounds_hold_it() {
        let grid = DirectionBins { cos: 8, phi: 16 };
        for i in 0..1000u32 {
            let (cos, phi) = ((f64::from(i) + 0.5) / 1000.0, f64::from(i) * 0.37 % TAU);
            let sin = libm::sqrt(1.0 - cos * cos);
            let bin = grid.index(3.0 * DVec3::new(sin * libm::cos(phi), sin * libm::sin(phi), cos));
            let [from, to, phi_from, phi_to] = grid.bounds(bin);
            assert!((from..to).contains(&cos) && (phi_from..phi_to).contains(&phi), "{cos} {phi}: {bin}");
        }
    }

    #[test]
    fn projected_solid_angles_fill_the_hemisphere() {
        let grid = DirectionBins { cos: 5, phi: 7 };
        let sum: f64 = (0..grid.count()).map(|bin| grid.projected_solid_angle(bin)).sum();
        assert!((sum - core::f64::consts::PI).abs() < 1e-12);
    }
}
