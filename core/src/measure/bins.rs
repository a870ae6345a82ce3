//! Direction bins, which count the rays that leave a polygon mesh.
//!
//! The exits of one starting ray in one bin add as amplitudes (coherence `ray`) or as powers (coherence `none`);
//! starting rays add as powers. Amplitudes are referred to the starting ray's first hit. For equal directions this
//! changes nothing; for directions that differ within a bin it removes a phase that depends on the choice of the origin
//! only.

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

/// Division of a hemisphere into cells, in which exits are counted.
pub trait DirectionGrid {
    /// Number of cells.
    fn count(&self) -> usize;

    /// Cell of a direction of any positive length, less than [`DirectionGrid::count`]. The sign of the direction's z
    /// does not matter: one grid divides the hemispheres above and below.
    fn index(&self, direction: DVec3) -> usize;
}

impl<G: DirectionGrid> DirectionGrid for &G {
    fn count(&self) -> usize {
        G::count(self)
    }

    fn index(&self, direction: DVec3) -> usize {
        G::index(self, direction)
    }
}

/// Cell of the direction in each lane.
fn cells_of_lanes<V: Lanes>(grid: &impl DirectionGrid, directions: RealLanes<V>) -> [u32; MAX_LANES] {
    let first = directions.lane(0);
    let mut cells = [grid.index(first) as u32; MAX_LANES];
    for (lane, cell) in cells.iter_mut().enumerate().take(V::WIDTH).skip(1) {
        let direction = directions.lane(lane);
        if direction != first {
            *cell = grid.index(direction) as u32;
        }
    }
    cells
}

/// Grid of bins over a hemisphere, uniform in cos θ and in φ, so that all have equal solid angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DirectionBins {
    /// Number of bins in cos θ, counted from the horizon.
    pub cos: u32,
    /// Number of bins in φ, counted from the tangent.
    pub phi: u32,
}

impl DirectionBins {
    /// Number of bins.
    #[must_use]
    pub fn count(&self) -> usize {
        self.cos as usize * self.phi as usize
    }

    /// Bin of a direction, row by row in cos θ. The length of the direction and the sign of its z do not matter.
    #[must_use]
    #[inline(never)] // The arc tangent is long code, and there are four callers.
    pub fn index(&self, direction: DVec3) -> usize {
        let cos = libm::fabs(direction.z) / direction.length();
        let fraction = libm::atan2(direction.y, direction.x) / TAU;
        let fraction = if fraction < 0.0 { fraction + 1.0 } else { fraction };
        let row = ((cos * f64::from(self.cos)) as u32).min(self.cos - 1);
        let column = ((fraction * f64::from(self.phi)) as u32).min(self.phi - 1);
        row as usize * self.phi as usize + column as usize
    }

    /// Bounds of a bin: lower and upper cos θ, lower and upper φ in radians.
    #[must_use]
    pub fn bounds(&self, bin: usize) -> [f64; 4] {
        let columns = self.phi.max(1) as usize;
        let (row, column) = (bin / columns, bin % columns);
        let (cos, phi) = (f64::from(self.cos), f64::from(self.phi));
        [row as f64 / cos, (row + 1) as f64 / cos, TAU * column as f64 / phi, TAU * (column + 1) as f64 / phi]
    }

    /// Integral of cos θ dω over a bin. A bin's power divided by it is the mean of the BRDF.
    #[must_use]
    pub fn projected_solid_angle(&self, bin: usize) -> f64 {
        let [from, to, phi_from, phi_to] = self.bounds(bin);
        0.5 * (to * to - from * from) * (phi_to - phi_from)
    }
}

impl DirectionGrid for DirectionBins {
    fn count(&self) -> usize {
        Self::count(self)
    }

    fn index(&self, direction: DVec3) -> usize {
        Self::index(self, direction)
    }
}

/// Number of lanes of the widest type.
const MAX_LANES: usize = 16;

/// Exits of one starting ray in the same bins, until the starting ray is complete.
#[derive(Clone, Copy, Debug)]
pub struct ExitRecord<V: Lanes> {
    side: Side,
    bins: [u32; MAX_LANES],
    /// Whether the exits are paths: they add as powers, and have no field.
    incoherent: bool,
    /// Field, referred to the first hit and scaled to the power that it carries.
    field: WaveField<V>,
    power: Polarised<V>,
}

impl<V: Lanes> ExitRecord<V> {
    /// Empty record, to initialise memory.
    #[must_use]
    pub fn none() -> Self {
        let zero = Polarised::both(VectorLanes::zero());
        Self {
            side: Side::Above,
            bins: [0; MAX_LANES],
            incoherent: true,
            field: zero,
            power: Polarised::both(V::zero()),
        }
    }
}

/// Buffer for the exits of one starting ray.
#[derive(Debug)]
pub struct ExitBuffer<'m, V: Lanes, G> {
    memory: &'m mut [ExitRecord<V>],
    count: usize,
    grid: G,
    per_wavelength: V::Precise,
    /// First hit of the starting ray.
    origin_nm: DVec3,
    /// Power of exits for which there was no record.
    dropped: V,
}

/// Receiver of the unpolarised power that starting rays send into bins.
pub trait Histogram {
    /// Adds the power of one lane to a bin of the hemisphere on `side`.
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64);
}

impl<'m, V: Lanes, G: DirectionGrid> ExitBuffer<'m, V, G> {
    /// Empty buffer. `memory` should have as many records as one starting ray may need; further exits are dropped, and
    /// [`ExitBuffer::flush`] returns their power.
    pub fn new(memory: &'m mut [ExitRecord<V>], grid: G, media: &MediaLanes<'_, V>) -> Self {
        const { assert!(V::WIDTH <= MAX_LANES) };
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let origin_nm = DVec3::ZERO;
        Self { memory, count: 0, grid, per_wavelength, origin_nm, dropped: V::zero() }
    }

    /// Clears the buffer for a starting ray whose first hit is `origin_nm`.
    pub fn begin(&mut self, origin_nm: DVec3) {
        self.count = 0;
        self.dropped = V::zero();
        self.origin_nm = origin_nm;
    }

    /// Adds the starting ray's exits in each bin and passes their unpolarised power to `histogram`. Returns the power
    /// of exits that were dropped.
    pub fn flush(&mut self, histogram: &mut impl Histogram) -> V {
        let mut exits = self.memory.get_mut(..self.count).unwrap_or(&mut []);
        while let Some((into, tail)) = core::mem::take(&mut exits).split_first_mut() {
            if !into.incoherent {
                for other in tail.iter_mut().filter(|other| !other.incoherent && other.side == into.side) {
                    // Lanes are independent: fields of lanes whose bins agree move to `into`, the others stay.
                    let moves = V::from_fn(|lane| f64::from(u8::from(other.bins.get(lane) == into.bins.get(lane))));
                    let stays = V::one() - moves;
                    let scaled = |e: VectorLanes<V>, factor: V| VectorLanes {
                        x: e.x.scale(factor),
                        y: e.y.scale(factor),
                        z: e.z.scale(factor),
                    };
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

impl<V: Lanes, G: DirectionGrid> ExitBuffer<'_, V, G> {
    /// Adds an exit to the record of its side, bins and coherence, or to a new record. A path has no field.
    fn record(&mut self, side: Side, bins: [u32; MAX_LANES], power: Polarised<V>, field: Option<WaveField<V>>) {
        let incoherent = field.is_none();
        let matches = |exit: &&mut ExitRecord<V>| {
            exit.side == side && exit.incoherent == incoherent && exit.bins.iter().eq(&bins)
        };
        if let Some(exit) = self.memory.iter_mut().take(self.count).find(matches) {
            exit.power = exit.power.zip(power, |a, b| a + b);
            if let Some(field) = field {
                exit.field = exit.field.zip(field, |a, b| a + b);
            }
        } else if let Some(exit) = self.memory.get_mut(self.count) {
            (exit.side, exit.bins, exit.incoherent, exit.power) = (side, bins, incoherent, power);
            // The field of a path is never read, and is too large to be cleared each time.
            if let Some(field) = field {
                exit.field = field;
            }
            self.count += 1;
        } else {
            self.dropped += (power.s.abs() + power.p.abs()) * V::splat(0.5);
        }
    }
}

impl<V: Lanes, G: DirectionGrid> Sink<ExitWave<V>, WaveField<V>> for ExitBuffer<'_, V, G> {
    fn exit(&mut self, wave: ExitWave<V>, field: WaveField<V>) {
        let ExitWave { side, power, wavevector, point_nm, .. } = wave;
        let to_origin = phase_of(&wave, self.origin_nm - point_nm, self.per_wavelength);
        let bins = cells_of_lanes(&self.grid, wavevector.map(|q| q.re));
        self.record(side, bins, power, Some(scaled_to_power(field, power, propagate(to_origin))));
    }
}

impl<V: Lanes, G: DirectionGrid> Sink<ExitPath<V>, Coherency<V>> for ExitBuffer<'_, V, G> {
    fn exit(&mut self, path: ExitPath<V>, light: Coherency<V>) {
        self.record(path.side, cells_of_lanes(&self.grid, path.direction), Polarised::both(light.power()), None);
    }
}

/// Sink with one field for each bin: all exits in a bin add as amplitudes, whatever starting ray they come from
/// (coherence `bin`, section 2.2 of the paper taken literally).
///
/// The squared sum, divided by the squared number of starting rays, is the bin's power. Power is not conserved, since
/// directions that differ within a bin do not really interfere.
#[derive(Debug)]
pub struct BinFields<'m, V: Lanes, G> {
    /// Fields of the bins above, then of those below.
    fields: &'m mut [WaveField<V>],
    grid: G,
    per_wavelength: V::Precise,
    incident: VectorLanes<V::Precise>,
    /// Phase factor exp(i k₀ q_in·x) at the first hit of the present starting ray.
    arrival: ComplexLanes<V>,
}

impl<'m, V: Lanes, G: DirectionGrid> BinFields<'m, V, G> {
    /// Number of fields that a grid needs, for both hemispheres.
    #[must_use]
    pub fn required_len(grid: &G) -> usize {
        2 * grid.count()
    }

    /// Sink that adds to `fields`, which has [`BinFields::required_len`] elements.
    pub fn new(
        fields: &'m mut [WaveField<V>],
        grid: G,
        media: &MediaLanes<'_, V>,
        incident: VectorLanes<V::Precise>,
    ) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        Self { fields, grid, per_wavelength, incident, arrival: ComplexLanes::one() }
    }

    /// Begins a starting ray whose first hit is `point_nm`.
    pub fn begin(&mut self, point_nm: DVec3) {
        self.arrival = propagate(self.incident.dot_real(point_nm).scale(self.per_wavelength));
    }
}

impl<V: Lanes, G: DirectionGrid> Sink<ExitWave<V>, WaveField<V>> for BinFields<'_, V, G> {
    fn exit(&mut self, wave: ExitWave<V>, field: WaveField<V>) {
        let phase = propagate::<V>(phase_of(&wave, -wave.point_nm, self.per_wavelength));
        let field = scaled_to_power(field, wave.power, phase * self.arrival);
        let bins = cells_of_lanes(&self.grid, wave.wavevector.map(|q| q.re));
        let hemisphere = if wave.side == Side::Above { 0 } else { self.grid.count() };
        for lane in 0..V::WIDTH {
            // Each bin is treated once, for all lanes in it.
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

/// Phase of a ray over a step, in turns. The amplitude is not changed: where it varies across the ray, as in an
/// absorbing substrate or behind a tilted facet of an absorbing body, the power of the ray's tube counts, wherever the
/// phase is referred to.
fn phase_of<V: Lanes>(wave: &ExitWave<V>, step_nm: DVec3, per_wavelength: V::Precise) -> ComplexLanes<V::Precise> {
    ComplexLanes::real(wave.wavevector.dot_real(step_nm).re * per_wavelength)
}

/// Field times a phase factor, scaled so that its square is the power of the ray, in an absorbing substrate too.
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
    fn every_direction_lies_within_the_bounds_of_its_bin() {
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
