//! Exits of a polygon mesh, counted by direction in the cells of a grid.
//!
//! Starting rays add as powers. The exits of one starting ray on one side add as amplitudes (coherence `ray`) or as
//! powers (coherence `none`). Waves of equal direction become one wave; waves of different directions a and b within
//! 40° of each other keep their cells, and share their cross term 2 Re(E_a·E_b*) in proportion to their powers. So what
//! a starting ray reflects does not depend on the grid. A pair alone never takes more from a cell than its wave brings
//! there: p_a − 2√(p_a p_b) p_a/(p_a + p_b) ≥ 0.
//!
//! Where all wavelengths have one amplitude, every wave keeps its own record, and the phase of a cross term is that of
//! the difference of the optical paths.
//!
//! The phase of a cross term is that of both waves at the middle M of the points A and B where they leave:
//! φ_a + q_a·(M − A) − φ_b − q_b·(M − B) = φ_a − φ_b + ½(q_a + q_b)·(B − A). For equal directions every point gives
//! the same phase. Waves that leave through neighbouring facets agree at the facets' common edge, which M is near;
//! there the interference of both sides balances best.

use crate::geometry::side::Side;
use crate::optics::medium::MediaLanes;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::{propagate, propagate_real};
use crate::simd::ray_lanes::RayLanes;
use crate::simd::vector::{RealLanes, VectorLanes};
use crate::trace::coherent_mesh::{ExitWave, MAX_WAVEVECTOR_DIFFERENCE, WaveField, hero};
use crate::trace::incoherent_mesh::{Coherency, ExitPath};
use crate::trace::waves::Sink;
use core::f64::consts::TAU;
use glam::DVec3;
use num_complex::Complex64;

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

/// Cell of the direction in each lane. Lanes may have any precision.
fn cells_of_lanes<V: Lanes>(grid: &impl DirectionGrid, directions: RealLanes<V>) -> [u32; MAX_DIRECTIONS] {
    let first = directions.lane(0);
    let mut cells = [grid.index(first) as u32; MAX_DIRECTIONS];
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

/// Largest number of lanes of directions.
const MAX_DIRECTIONS: usize = 16;
/// Largest number of lanes whose exits are counted.
pub const MAX_LANES: usize = 64;

/// Cosine of 40°, the largest angle in the hero lane between exits of one starting ray that interfere.
///
/// The faces of a film turn by some angle δ from facet to facet, and light that crosses the film of index n leaves up
/// to 2nδ beside the light that the upper face reflects. 40° covers turns of 8° for n = 2.4, of 15° for n = 1.33. Pairs
/// of unrelated waves have random phases: a larger angle adds their noise, and a bias where facets are as narrow as a
/// wavelength. Measured on films of 420 and 900 nm, n = 1.33 to 2.4, rms slopes 0.2 and 0.3, on meshes of 32 × 32
/// squares, as |R − R of the local film|/(0.1 R + 0.002): at most 0.5 for 40°, 0.8 for 30°, 1.5 for 20°.
const MIN_INTERFERING_COSINE: f64 = 0.766_044_443_118_978;

/// Smallest product of the powers of two exits that interfere. The cross term of others is at most twice its root, 6e-9
/// of the incident power. A film at 85° sends out some hundred pairs just below this, which makes 1e-6.
const MIN_PRODUCT: f64 = 1e-17;

/// Exits of one starting ray in one direction, until the starting ray is complete.
#[derive(Clone, Copy, Debug)]
pub struct ExitRecord<V: RayLanes> {
    side: Side,
    cells: [u32; MAX_DIRECTIONS],
    /// Whether this is a path, which adds as power: it has no point, wavevector or field.
    is_path: bool,
    /// Unit direction in the hero lane.
    direction: DVec3,
    /// Point to which the field is referred.
    point_nm: DVec3,
    /// Real part of the wavevector in units of k₀.
    wavevector: RealLanes<V::Wavevector>,
    /// Field, scaled to the power that it carries.
    field: WaveField<V::Light>,
    /// Optical path, where the field does not have its phase.
    path_nm: Complex64,
    /// Unpolarised power of the exit alone.
    power: V,
    /// Unpolarised power that interference with other directions adds, and exits for which there is no record.
    added: V,
}

impl<V: RayLanes> ExitRecord<V> {
    /// Empty record, to initialise memory.
    #[must_use]
    pub fn none() -> Self {
        Self {
            side: Side::Above,
            cells: [0; MAX_DIRECTIONS],
            is_path: true,
            direction: DVec3::ZERO,
            point_nm: DVec3::ZERO,
            wavevector: RealLanes::<V::Wavevector>::splat(DVec3::ZERO),
            field: Polarised::both(VectorLanes::zero()),
            path_nm: Complex64::ZERO,
            power: V::zero(),
            added: V::zero(),
        }
    }

    /// Whether this is a wave that leaves on `side` in `direction`.
    fn is_same_wave(&self, side: Side, direction: DVec3) -> bool {
        const MAX_SQUARE: f64 = MAX_WAVEVECTOR_DIFFERENCE * MAX_WAVEVECTOR_DIFFERENCE;
        !self.is_path && self.side == side && self.direction.distance_squared(direction) < MAX_SQUARE
    }

    /// Whether two exits are waves that leave on one side in directions within 40° of each other.
    fn interferes_with(&self, other: &Self) -> bool {
        !other.is_path && other.side == self.side && self.direction.dot(other.direction) >= MIN_INTERFERING_COSINE
    }

    /// Adds the cross term of two waves to both, in proportion to their powers.
    fn interfere(&mut self, other: &mut Self, per_wavelength: V::Precise) {
        let half_step = RealLanes::<V::Wavevector>::splat(0.5 * (other.point_nm - self.point_nm));
        let mut path = ComplexLanes::real((self.wavevector + other.wavevector).dot(half_step));
        if V::IS_ALIKE {
            path += ComplexLanes::from_fn(|_| self.path_nm - other.path_nm.conj());
        }
        let phase = phase_factor::<V>(path, per_wavelength);
        // Unpolarised light is half s and half p: half of 2 Re(E_a·E_b*) for each.
        let Polarised { s, p } = self.field.zip(other.field, |a, b| {
            let [x, y, z] = [a.x * b.x.conj(), a.y * b.y.conj(), a.z * b.z.conj()];
            x + y + z
        });
        let cross = ((s + p).map(V::each) * phase).re;
        let share = self.power / (self.power + other.power).max(V::splat(f64::from(f32::MIN_POSITIVE)));
        let here = cross * share;
        self.added += here;
        other.added += cross - here;
    }
}

/// Buffer for the exits of one starting ray.
#[derive(Debug)]
pub struct ExitBuffer<'m, V: RayLanes, G> {
    memory: &'m mut [ExitRecord<V>],
    count: usize,
    grid: G,
    per_wavelength: V::Precise,
    /// Power of exits for which there was no record.
    dropped: V,
}

/// Receiver of the unpolarised power that starting rays send into bins.
pub trait Histogram {
    /// Adds the power of one lane to a bin of the hemisphere on `side`. The power of one exit may be negative, where
    /// several weaken it by interference: clamp sums over all starting rays, never single powers.
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64);

    /// Adds the powers of the lanes from `first` on, which leave in one bin.
    fn add_lanes(&mut self, first: usize, side: Side, bin: usize, powers: &[f64]) {
        for (lane, &power) in (first..).zip(powers) {
            if power.abs() > 0.0 {
                self.add(lane, side, bin, power);
            }
        }
    }
}

impl<'m, V: RayLanes, G: DirectionGrid> ExitBuffer<'m, V, G> {
    /// Empty buffer. `memory` should have as many records as one starting ray may need; further exits add their power
    /// to the nearest direction. If no exit on their side has a record, they are dropped, and [`ExitBuffer::flush`]
    /// returns their power.
    pub fn new(memory: &'m mut [ExitRecord<V>], grid: G, media: &MediaLanes<'_, V>) -> Self {
        const { assert!(V::Wavevector::WIDTH <= MAX_DIRECTIONS && V::WIDTH <= MAX_LANES) };
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        Self { memory, count: 0, grid, per_wavelength, dropped: V::zero() }
    }

    /// Clears the buffer for a starting ray.
    pub fn begin(&mut self) {
        self.count = 0;
        self.dropped = V::zero();
    }

    /// Lets the starting ray's waves interfere and passes the unpolarised power of each exit to `histogram`. Returns
    /// the power of exits that were dropped.
    pub fn flush(&mut self, histogram: &mut impl Histogram) -> V {
        self.flush_lanes(V::one(), histogram)
    }

    /// [`ExitBuffer::flush`] of the lanes in which `kept` is above 0; the others are dark.
    pub fn flush_lanes(&mut self, kept: V, histogram: &mut impl Histogram) -> V {
        let mut exits = self.memory.get_mut(..self.count).unwrap_or(&mut []);
        for wave in exits.iter_mut().filter(|exit| !exit.is_path) {
            let Polarised { s, p } = wave.field.map(VectorLanes::norm_sqr);
            wave.power = V::each((s + p) * V::Light::splat(0.5));
            if wave.path_nm.im > 0.0 {
                let decay = V::Wavevector::splat(wave.path_nm.im);
                let path = ComplexLanes { re: V::Wavevector::zero(), im: decay + decay };
                wave.power = wave.power * phase_factor::<V>(path, self.per_wavelength).re;
            }
        }
        while let Some((exit, tail)) = core::mem::take(&mut exits).split_first_mut() {
            if !exit.is_path {
                for other in tail.iter_mut() {
                    if exit.interferes_with(other) && (exit.power * other.power).any_above(MIN_PRODUCT) {
                        exit.interfere(other, self.per_wavelength);
                    }
                }
            }
            let powers = V::zero().select_lt(kept, exit.power + exit.added, V::zero());
            if powers.abs().any_above(0.0) {
                let mut numbers = [0.0; MAX_LANES];
                powers.store(&mut numbers);
                match exit.cells.get(..V::Wavevector::WIDTH).unwrap_or(&[]) {
                    &[cell] => {
                        let powers = numbers.get(..V::WIDTH).unwrap_or(&[]);
                        histogram.add_lanes(0, exit.side, cell as usize, powers);
                    }
                    cells => {
                        for (lane, (&cell, &power)) in cells.iter().zip(&numbers).enumerate() {
                            if power.abs() > 0.0 {
                                histogram.add(lane, exit.side, cell as usize, power);
                            }
                        }
                    }
                }
            }
            exits = tail;
        }
        V::zero().select_lt(kept, self.dropped, V::zero())
    }
}

impl<V: RayLanes, G: DirectionGrid> ExitBuffer<'_, V, G> {
    /// Next unused record. If there is none, the exit adds its power to the record of the nearest direction on its
    /// side, so that power is kept whatever the grid.
    fn push(&mut self, side: Side, direction: DVec3, power: V) -> Option<&mut ExitRecord<V>> {
        if self.count < self.memory.len() {
            let exit = self.memory.get_mut(self.count)?;
            self.count += 1;
            (exit.side, exit.direction, exit.power, exit.added) = (side, direction, power, V::zero());
            return Some(exit);
        }
        let on_side = self.memory.iter_mut().filter(|exit| exit.side == side);
        match on_side.max_by(|a, b| a.direction.dot(direction).total_cmp(&b.direction.dot(direction))) {
            Some(nearest) => nearest.added += power,
            None => self.dropped += power.abs(),
        }
        None
    }
}

impl<V: RayLanes, G: DirectionGrid> Sink<ExitWave<V>, WaveField<V::Light>> for ExitBuffer<'_, V, G> {
    fn exit(&mut self, wave: ExitWave<V>, field: WaveField<V::Light>) {
        let ExitWave { side, power, point_nm, path_nm, .. } = wave;
        let direction = wave.wavevector.direction(hero::<V::Wavevector>()).normalize_or_zero();
        let same = |exit: &&mut ExitRecord<V>| !V::IS_ALIKE && exit.is_same_wave(side, direction);
        if let Some(exit) = self.memory.iter_mut().take(self.count).find(same) {
            let path = ComplexLanes::real(wave.wavevector.dot_real(exit.point_nm - point_nm).re);
            let phase = phase_factor::<V>(path, self.per_wavelength).map(V::light);
            let more = scaled_to_power::<V>(field, power).map(|e| e.times(phase));
            exit.field = exit.field.zip(more, |a, b| a + b);
            return;
        }
        let wavevector = wave.wavevector.map(|q| q.re);
        let cells = cells_of_lanes(&self.grid, wavevector);
        if let Some(exit) = self.push(side, direction, V::each((power.s + power.p) * V::Light::splat(0.5))) {
            (exit.is_path, exit.cells, exit.point_nm, exit.wavevector) = (false, cells, point_nm, wavevector);
            (exit.field, exit.path_nm) = (scaled_to_power::<V>(field, power), path_nm);
        }
    }
}

impl<V: RayLanes, G: DirectionGrid> Sink<ExitPath<V>, Coherency<V::Light>> for ExitBuffer<'_, V, G> {
    fn exit(&mut self, path: ExitPath<V>, light: Coherency<V::Light>) {
        let cells = cells_of_lanes(&self.grid, path.direction);
        if let Some(exit) = self.push(path.side, path.direction.lane(hero::<V::Direction>()), V::each(light.power())) {
            (exit.is_path, exit.cells) = (true, cells);
        }
    }
}

/// Sink with one field for each bin: all exits in a bin add as amplitudes, whatever starting ray they come from
/// (coherence `bin`, section 2.2 of the paper taken literally).
///
/// The squared sum, divided by the squared number of starting rays, is the bin's power. Power is not conserved, since
/// directions that differ within a bin do not really interfere.
#[derive(Debug)]
pub struct BinFields<'m, V: RayLanes, G> {
    /// Fields of the bins above, then of those below.
    fields: &'m mut [WaveField<V>],
    grid: G,
    per_wavelength: V::Precise,
    incident: VectorLanes<V::Wavevector>,
    /// Phase factor exp(i k₀ q_in·x) at the first hit of the present starting ray.
    arrival: ComplexLanes<V>,
}

impl<'m, V: RayLanes, G: DirectionGrid> BinFields<'m, V, G> {
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
        incident: VectorLanes<V::Wavevector>,
    ) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        Self { fields, grid, per_wavelength, incident, arrival: ComplexLanes::one() }
    }

    /// Begins a starting ray whose first hit is `point_nm`.
    pub fn begin(&mut self, point_nm: DVec3) {
        self.arrival = propagate(self.incident.dot_real(point_nm).map(V::precise).scale(self.per_wavelength));
    }
}

impl<V: RayLanes, G: DirectionGrid> Sink<ExitWave<V>, WaveField<V::Light>> for BinFields<'_, V, G> {
    fn exit(&mut self, wave: ExitWave<V>, field: WaveField<V::Light>) {
        let mut path = ComplexLanes::real(wave.wavevector.dot_real(-wave.point_nm).re);
        if V::IS_ALIKE {
            path += ComplexLanes::from_fn(|_| wave.path_nm);
        }
        let phase = phase_factor::<V>(path, self.per_wavelength) * self.arrival;
        let field = scaled_to_power::<V>(field, wave.power);
        let field = field.map(|e| e.map(|c| c.map(V::each) * phase));
        let bins = cells_of_lanes(&self.grid, wave.wavevector.map(|q| q.re));
        let hemisphere = if wave.side == Side::Above { 0 } else { self.grid.count() };
        let last = V::Wavevector::WIDTH - 1;
        for lane in 0..=last {
            // Each bin is treated once, for all lanes in it.
            if bins[..lane].contains(&bins[lane]) {
                continue;
            }
            let mask = V::from_fn(|other| f64::from(u8::from(bins[other.min(last)] == bins[lane])));
            if let Some(sum) = self.fields.get_mut(hemisphere + bins[lane] as usize) {
                *sum = sum.zip(field, |sum, e| sum + e.scale(ComplexLanes::real(mask)));
            }
        }
    }
}

/// Phase factor of an optical path, at each wavelength.
///
/// Exits take the real part of their wavevectors alone: where the amplitude varies across a ray, as in an absorbing
/// substrate or behind a tilted facet of an absorbing body, the power of the ray's tube counts, wherever the phase is
/// referred to.
fn phase_factor<V: RayLanes>(path: ComplexLanes<V::Wavevector>, per_wavelength: V::Precise) -> ComplexLanes<V> {
    let turns = path.map(V::precise).scale(per_wavelength);
    if path.im.any_above(0.0) { propagate(turns) } else { propagate_real(turns.re) }
}

/// Field scaled so that its square is the power of the ray, in an absorbing substrate too.
fn scaled_to_power<V: RayLanes>(field: WaveField<V::Light>, power: Polarised<V::Light>) -> WaveField<V::Light> {
    let zero = V::Light::zero();
    field.zip(power, |e, power| {
        let square = e.norm_sqr();
        let scale = zero.select_lt(square, (power.max(zero) / square).sqrt(), zero);
        e.scale(ComplexLanes::real(scale))
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
