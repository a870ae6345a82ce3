//! Warp of the unit square of half vectors: nodes lie close where facets have their normals.

use super::angles::{azimuth, level, polar};
use super::error::TableError;
use crate::simd::lanes::sqrtf;
use crate::values::Values;
use core::f32::consts::{FRAC_2_PI, FRAC_PI_2, PI, TAU};
use glam::Vec3;

/// Map between half vectors and the warped unit square.
///
/// The plain square is that of Dupuy & Jakob, "An adaptive parameterization for efficient material acquisition and
/// rendering" (2018): u = √(2θ_m/π) and v = (φ_m + π)/2π for the half vector m = (wi + wo)/|wi + wo|. The warped one is
/// x = X(u), y = Y(v), the integrals of two positive densities, each linear between equally spaced knots from 0 to 1.
/// It is the warp that readers of RGL's tensor files build from the product of the densities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfVectorWarp<'a> {
    axes: [Axis<'a>; 2],
}

/// Place in the warped square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Warped {
    /// x and y.
    pub place: [f32; 2],
    /// Solid angle of outgoing directions per area of the warped square: |dω_o|/(dx dy).
    pub solid_angle: f32,
}

/// Piece of u or v.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// Interval of x or y in which it lies.
    pub interval: u32,
    pub from: f32,
    pub to: f32,
}

/// Density along one axis, with its integral: pairs for each knot.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Axis<'a> {
    pairs: Values<'a>,
    intervals: usize,
}

/// Largest number of knots of a density.
const MAX_KNOTS: usize = 1025;
/// Smallest density over the mean one. With it a place is found to single precision.
const MIN_DENSITY: f32 = 1e-3;

impl<'a> HalfVectorWarp<'a> {
    /// Number of elements that [`HalfVectorWarp::new`] needs as memory for densities of these numbers of knots.
    #[must_use]
    pub const fn required_len(knots: [usize; 2]) -> usize {
        2 * (knots[0] + knots[1])
    }

    /// Prepares the warp of densities over u and over v, at 2 to 1025 knots each, in `memory`, which has
    /// [`HalfVectorWarp::required_len`] elements. The densities need not be normalised. The one over v should begin and
    /// end with the same value, since v is periodic.
    ///
    /// # Errors
    /// [`TableError::Warp`] for too few or too many knots, or a density that is not finite or below a thousandth of the
    /// mean; [`TableError::Length`] if `memory` has another length.
    pub fn new(densities: [&[f32]; 2], memory: &'a mut [f32]) -> Result<Self, TableError> {
        let knots = densities.map(<[f32]>::len);
        let required = Self::required_len(knots);
        if memory.len() != required {
            return Err(TableError::Length { required });
        }
        let Some((u, v)) = memory.split_at_mut_checked(2 * knots[0]) else {
            return Err(TableError::Length { required });
        };
        for (density, pairs) in densities.into_iter().zip([&mut *u, &mut *v]) {
            prepare(density, pairs)?;
        }
        Self::of([Values::Numbers(u), Values::Numbers(v)])
    }

    /// Borrows pairs of density and integral that [`HalfVectorWarp::new`] has written: for u twice as many elements
    /// as it has knots, and for v likewise.
    ///
    /// # Errors
    /// [`TableError::Warp`] unless the pairs are sound.
    pub fn from_pairs(u: &'a [f32], v: &'a [f32]) -> Result<Self, TableError> {
        Self::of([Values::Numbers(u), Values::Numbers(v)])
    }

    /// Checks pairs of density and integral that were prepared earlier.
    pub(super) fn of(axes: [Values<'a>; 2]) -> Result<Self, TableError> {
        let axes = axes.map(|pairs| Axis { pairs, intervals: (pairs.len() / 2).saturating_sub(1) });
        if axes.iter().all(Axis::is_sound) { Ok(Self { axes }) } else { Err(TableError::Warp) }
    }

    /// Pairs of normalised density and integral at each knot, over u and over v.
    pub(super) fn values(&self) -> [Values<'a>; 2] {
        self.axes.map(|axis| axis.pairs)
    }

    /// Numbers of knots of the densities over u and over v.
    #[must_use]
    pub fn knots(&self) -> [usize; 2] {
        self.axes.map(|axis| axis.intervals + 1)
    }

    /// Normalised density at a knot over u (`axis` 0) or v (1); 0 beyond the last.
    #[must_use]
    pub fn density(&self, axis: usize, knot: usize) -> f32 {
        self.axes.get(axis).map_or(0.0, |axis| axis.pairs.at(2 * knot))
    }

    /// Place of the half vector of two unit vectors above the surface. `origin` is the azimuth from which φ_m counts:
    /// that of [`ScatterLayout::origin`](super::ScatterLayout::origin). The place stays the same, bit for bit, if the
    /// directions are exchanged.
    #[must_use]
    #[inline]
    pub fn warped(&self, wi: Vec3, wo: Vec3, origin: f32) -> Warped {
        let sum = wi + wo;
        let u = sqrtf(polar(sum) * FRAC_2_PI).min(1.0);
        let turns = (azimuth(sum) - origin) * (1.0 / TAU) + 0.5;
        let v = turns - libm::floorf(turns);
        let [(x, density_u), (y, density_v)] = [self.axes[0].place(u), self.axes[1].place(v)];
        // |wi + wo| is 2 wi·m, so its tangential part is 2 (wi·m) sin θ_m.
        let solid_angle = plain_solid_angle(u, 0.5 * level(sum)) / (density_u * density_v);
        Warped { place: [x, y], solid_angle }
    }

    /// Half vector at a place of the warped square, and what [`Warped::solid_angle`] is there over wi·m.
    #[must_use]
    #[inline]
    pub fn half_vector(&self, place: [f32; 2], origin: f32) -> (Vec3, f32) {
        let (u, density_u) = self.axes[0].plain(place[0]);
        let (sin_phi, cos_phi, density_v) = self.azimuth_of(place[1], origin);
        let (sin, cos) = libm::sincosf(u * u * FRAC_PI_2);
        let m = Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        (m, plain_solid_angle(u, sin) / (density_u * density_v))
    }

    /// Sine and cosine of φ_m at y, and the density over v there.
    #[inline]
    pub(super) fn azimuth_of(&self, y: f32, origin: f32) -> (f32, f32, f32) {
        let (v, density) = self.axes[1].plain(y);
        let (sin, cos) = libm::sincosf(TAU * v - PI + origin);
        (sin, cos, density)
    }

    /// Pieces of u (`axis` 0) or v (1) that each lie within one of `intervals` even intervals of x or y, and between
    /// two knots; none is longer than 1/32.
    pub(super) fn pieces(&self, axis: usize, intervals: u32) -> impl Iterator<Item = Piece> {
        const MIN_PIECES: usize = 32;
        let axis = self.axes[axis.min(1)];
        let steps = axis.intervals * MIN_PIECES.div_ceil(axis.intervals.max(1));
        let end_of = move |interval: u32| {
            if interval + 1 < intervals { axis.plain((interval + 1) as f32 / intervals as f32).0 } else { 1.0 }
        };
        let (mut step, mut interval, mut from, mut end) = (0, 0, 0.0, end_of(0));
        core::iter::from_fn(move || {
            let step_end = (step + 1) as f32 / steps as f32;
            let piece = Piece { interval, from, to: end.min(step_end) };
            if step >= steps || interval >= intervals {
                return None;
            }
            step += usize::from(step_end <= piece.to);
            if end <= piece.to {
                interval += 1;
                end = end_of(interval);
            }
            from = piece.to;
            Some(piece)
        })
    }

    /// Place x of u (`axis` 0) or y of v (1), in [0, 1].
    #[must_use]
    pub fn place(&self, axis: usize, plain: f32) -> f32 {
        self.axes.get(axis).map_or(0.0, |axis| axis.place(plain).0)
    }

    /// Place u of x (`axis` 0) or v of y (1), in [0, 1]: the inverse of [`HalfVectorWarp::place`].
    #[must_use]
    pub fn plain(&self, axis: usize, place: f32) -> f32 {
        self.axes.get(axis).map_or(0.0, |axis| axis.plain(place).0)
    }
}

/// |dω_o|/(du dv) = 8π² u sin θ_m (wi·m), by dω_o = 4 (wi·m) dω_m; `rest` is the product of the last two.
#[inline]
pub(super) fn plain_solid_angle(u: f32, rest: f32) -> f32 {
    8.0 * PI * PI * u * rest
}

/// Writes pairs of normalised density and integral for each knot.
fn prepare(density: &[f32], pairs: &mut [f32]) -> Result<(), TableError> {
    let intervals = density.len().saturating_sub(1);
    if intervals == 0 {
        return Err(TableError::Warp);
    }
    let mean: f64 = density.windows(2).map(|pair| pair.iter().map(|&d| 0.5 * f64::from(d)).sum::<f64>()).sum::<f64>()
        / intervals as f64;
    let mut sum = 0.0;
    let mut last = None;
    for (&d, pair) in density.iter().zip(pairs.as_chunks_mut::<2>().0) {
        let d = f64::from(d) / mean;
        sum += last.map_or(0.0, |last: f64| 0.5 * (last + d) / intervals as f64);
        *pair = [d as f32, sum as f32];
        last = Some(d);
    }
    if let Some(end) = pairs.last_mut() {
        *end = 1.0;
    }
    Ok(())
}

impl Axis<'_> {
    /// Whether densities are positive, and integrals increase from 0 to 1 by what the densities add up to.
    fn is_sound(&self) -> bool {
        // Two integrals, the two operations of the area, and the two densities together: each is rounded by half a unit
        // of 2⁻²³ at most, since none is above 1.
        const ROUNDING: f32 = 3.0 * f32::EPSILON;
        let knots = self.intervals + 1;
        let number = |knot: usize, part: usize| self.pairs.at(2 * knot + part);
        let adds_up = |knot: usize| {
            let (from, to) = (number(knot, 1), number(knot + 1, 1));
            let area = 0.5 * (number(knot, 0) + number(knot + 1, 0)) / self.intervals as f32;
            from < to && (to - from - area).abs() <= ROUNDING
        };
        (2..=MAX_KNOTS).contains(&knots)
            && self.pairs.len() == 2 * knots
            && (0..knots).all(|knot| (MIN_DENSITY..=2.0 * MAX_KNOTS as f32).contains(&number(knot, 0)))
            && number(0, 1) == 0.0
            && number(self.intervals, 1) == 1.0
            && (0..self.intervals).all(adds_up)
    }

    /// Densities at the ends of an interval, and the integral before it.
    #[inline]
    fn interval(&self, index: usize) -> [f32; 3] {
        [self.pairs.at(2 * index), self.pairs.at(2 * index + 2), self.pairs.at(2 * index + 1)]
    }

    /// Integral up to `plain`, and the density there.
    #[inline]
    fn place(&self, plain: f32) -> (f32, f32) {
        let scaled = plain.clamp(0.0, 1.0) * self.intervals as f32;
        let index = (scaled as usize).min(self.intervals - 1);
        let [from, to, before] = self.interval(index);
        let part = scaled - index as f32;
        let density = from + part * (to - from);
        ((before + part * 0.5 * (from + density) / self.intervals as f32).min(1.0), density)
    }

    /// Place at which the integral is `place`, and the density there.
    #[inline]
    fn plain(&self, place: f32) -> (f32, f32) {
        let place = place.clamp(0.0, 1.0);
        let (mut index, mut last) = (0, self.intervals - 1);
        while index < last {
            let middle = index.midpoint(last);
            if self.pairs.at(2 * middle + 3) <= place { index = middle + 1 } else { last = middle }
        }
        let [from, to, before] = self.interval(index);
        // The root of from·t + ½ (to − from) t² = rest, without cancellation; its discriminant is the density's square.
        let rest = (place - before) * self.intervals as f32;
        let density = sqrtf((from * from + 2.0 * rest * (to - from)).max(0.0));
        let part = (2.0 * rest / (from + density)).clamp(0.0, 1.0);
        ((index as f32 + part) / self.intervals as f32, density.max(from.min(to)).min(from.max(to)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const U: [f32; 4] = [1.0, 3.0, 0.5, 0.2];
    const V: [f32; 5] = [2.0, 0.5, 1.0, 0.5, 2.0];

    #[test]
    fn the_inverse_returns_and_the_density_is_the_slope() {
        let mut memory = [0.0; 18];
        let warp = HalfVectorWarp::new([&U, &V], &mut memory).unwrap();
        for axis in [0, 1] {
            for i in 0..=1000u16 {
                let plain = f32::from(i) / 1000.0;
                let place = warp.place(axis, plain);
                // Rounding of the integral, over the smallest density, 0.16.
                assert!((warp.plain(axis, place) - plain).abs() < 1e-6, "{axis} {plain}");
                if i > 0 && i < 1000 {
                    let slope = (warp.place(axis, plain + 1e-3) - warp.place(axis, plain - 1e-3)) / 2e-3;
                    let density = warp.axes[axis].place(plain).1;
                    // At a knot the density turns by up to 10 per unit, over a step of 1e-3.
                    assert!((slope - density).abs() < 1e-2, "{axis} {plain}: {slope} {density}");
                }
            }
            assert_eq!((warp.place(axis, 0.0), warp.place(axis, 1.0)), (0.0, 1.0));
        }
    }

    #[test]
    fn directions_return_through_their_half_vector() {
        let mut memory = [0.0; 18];
        let warp = HalfVectorWarp::new([&U, &V], &mut memory).unwrap();
        let wi = Vec3::new(0.3, -0.5, 0.8).normalize();
        for i in 0..200u16 {
            let (x, y) = (f32::from(i) * 0.618 % 1.0, f32::from(i) * 0.755 % 1.0);
            let (m, area) = warp.half_vector([x, y], 0.7);
            let wo = 2.0 * wi.dot(m) * m - wi;
            if wo.z > 0.0 && m.z < 0.9999 {
                let found = warp.warped(wi, wo, 0.7);
                let turn = (found.place[1] - y).abs();
                assert!((found.place[0] - x).abs() < 1e-4 && turn.min(1.0 - turn) < 1e-4, "{x} {y}: {found:?}");
                assert!((found.solid_angle / (area * wi.dot(m)) - 1.0).abs() < 1e-3, "{x} {y}");
            }
        }
    }

    #[test]
    fn what_has_no_warp_is_refused() {
        for bad in [
            &[1.0][..],
            &[1.0, 0.0],
            &[1.0, f32::NAN],
            &[1.0, -1.0],
            &[1.0, 1e-9, 1.0],
            &[0.0, 0.0],
            &[f32::INFINITY, 1.0],
        ] {
            let mut memory = [0.0; 16];
            let required = HalfVectorWarp::required_len([bad.len(), 2]);
            assert_eq!(
                HalfVectorWarp::new([bad, &[1.0, 1.0]], &mut memory[..required]),
                Err(TableError::Warp),
                "{bad:?}"
            );
        }
        let mut memory = [0.0; 7];
        assert_eq!(
            HalfVectorWarp::new([&[1.0, 1.0], &[1.0, 1.0]], &mut memory),
            Err(TableError::Length { required: 8 })
        );
    }
}
