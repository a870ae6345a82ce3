//! Light of diffraction orders: looks into the environment along exact directions, and no random numbers.
//!
//! Radiance is the integral over the wavelength of Σ e_m(λ) E(direction of order m at λ), weighted by the observer and
//! the illuminant. Strengths are linear between wavelengths of the table, as everywhere. The direction of an order
//! turns meanwhile, so each interval between two wavelengths is divided into as many steps as the environment has
//! detail along that turn. The weights of all rules, of 1, 2, 4 … steps, stem from one fine grid: those of its
//! wavelengths are shared out linearly between the ends of the step that they lie in. Whatever the steps, weights of an
//! interval have the same sum, and even light gives the same colour.

use glam::{DVec3, Mat3, Vec3};
use goniochrome::colour::Quadrature;
use goniochrome::table::{OrderTable as Lookup, OrderView, match_factor};

use super::channels::Channels;
use super::environment::Environment;
use super::mesh::ShadingFrame;
use crate::colour::visible_weights;
use crate::support::error::Result;
use crate::table::orders::{LookupArrays, OrderTable};

/// Binary logarithm of the largest number of steps between two wavelengths: 0.04 nm where those are 10 nm apart.
const MAX_LEVEL: usize = 8;
const MAX_STEPS: usize = 1 << MAX_LEVEL;

/// Weight below which an interval of wavelengths is not seen: a thousandth of an 8-bit step, over 400 intervals.
const UNSEEN: f32 = 1e-8;

/// A table of diffraction orders with its quadrature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OrderSurface {
    arrays: LookupArrays,
    /// Indices of the orders that reflect something.
    lit: Vec<usize>,
    /// Index of the order (0, 0), which leaves in one direction at all wavelengths.
    zeroth: usize,
    /// From an even environment's RGB to the RGB of a reflectance of 1 at each wavelength.
    even: Vec<Mat3>,
    /// Rules of quadrature between wavelengths, by the binary logarithm of the number of steps of an interval.
    rules: Vec<Rule>,
}

/// Weights of the places from one wavelength to the next, `[interval][place]`.
type Rule = Vec<Mat3>;

/// An [`OrderSurface`] that is looked up.
#[derive(Debug)]
pub(super) struct OrderShading<'a> {
    surface: &'a OrderSurface,
    table: Lookup<'a>,
}

impl OrderSurface {
    /// Orders under light whose RGB is multiplied by that of each wavelength or, with `spectral`, becomes a smooth
    /// spectrum.
    ///
    /// # Errors
    /// Wavelengths that are invisible or, with `spectral`, too few to tell colours apart.
    pub fn new(table: &OrderTable, spectral: bool) -> Result<Self> {
        let (illuminant, space) = (table.metadata.illuminant(), table.metadata.screen_space());
        let matrices = |wavelength_nm: &[f64]| -> Result<Vec<Mat3>> {
            if spectral {
                return Ok(Channels::spectral(wavelength_nm, illuminant, space)?.matrices().collect());
            }
            let weights = visible_weights(wavelength_nm, illuminant, Quadrature::Interpolated)?;
            let rgb = |xyz| Vec3::from(space.from_xyz(xyz).map(|c| c as f32));
            Ok(weights.into_iter().map(|xyz| Mat3::from_diagonal(rgb(xyz))).collect())
        };
        let even = matrices(&table.wavelength_nm)?;
        let fine = matrices(&refined(&table.wavelength_nm))?;
        let reflects = |order: usize| {
            let strengths = |of: &[f32]| of.iter().skip(order).step_by(table.orders.len()).any(|&x| x > 0.0);
            strengths(&table.reflected.s) || strengths(&table.reflected.p)
        };
        Ok(Self {
            arrays: table.arrays(std::iter::repeat_n([0.0; 3], table.wavelength_nm.len())),
            lit: (0..table.orders.len()).filter(|&order| reflects(order)).collect(),
            zeroth: table.orders.iter().position(|order| *order == [0, 0]).unwrap_or(usize::MAX),
            even,
            rules: (0..=MAX_LEVEL).map(|level| rule(&fine, 1 << level)).collect(),
        })
    }

    /// Whether no order reflects anything.
    pub fn is_black(&self) -> bool {
        self.lit.is_empty()
    }

    /// The surface, ready to be looked up.
    pub fn shading(&self) -> Result<OrderShading<'_>> {
        Ok(OrderShading { surface: self, table: self.arrays.table()? })
    }
}

/// Wavelengths with [`MAX_STEPS`] equal steps from each to the next.
fn refined(wavelength_nm: &[f64]) -> Vec<f64> {
    let steps = |pair: &[f64]| {
        let (from, step) = (pair[0], (pair[1] - pair[0]) / MAX_STEPS as f64);
        (0..MAX_STEPS).map(move |i| from + step * i as f64)
    };
    wavelength_nm.windows(2).flat_map(steps).chain(wavelength_nm.last().copied()).collect()
}

/// The rule of so many steps in each interval, from the weights of refined wavelengths. One wavelength alone counts as
/// the start of an interval.
fn rule(fine: &[Mat3], steps: usize) -> Rule {
    let intervals = ((fine.len() - 1) / MAX_STEPS).max(1);
    let mut rule = vec![Mat3::ZERO; intervals * (steps + 1)];
    for (i, weight) in fine.iter().enumerate() {
        let interval = (i / MAX_STEPS).min(intervals - 1);
        let place = (i - interval * MAX_STEPS) * steps;
        let (below, share) = (place / MAX_STEPS, (place % MAX_STEPS) as f32 / MAX_STEPS as f32);
        let at = interval * (steps + 1) + below;
        rule[at] += *weight * (1.0 - share);
        if share > 0.0 {
            rule[at + 1] += *weight * share;
        }
    }
    for weights in rule.chunks_mut(steps + 1) {
        let largest = weights.iter().flat_map(|matrix| matrix.to_cols_array()).fold(0.0, |a: f32, b| a.max(b.abs()));
        if largest < UNSEEN {
            weights.fill(Mat3::ZERO);
        }
    }
    rule
}

impl OrderShading<'_> {
    /// Linear RGB that leaves along the unit vector `wo` of the frame, above its horizon.
    pub fn radiance(&self, frame: &ShadingFrame, wo: DVec3, environment: &Environment) -> [f32; 3] {
        let Some(view) = self.table.view(wo.as_vec3()) else { return [0.0; 3] };
        if environment.is_uniform() {
            let mut sum = Mat3::ZERO;
            for (wavelength, weight) in self.surface.even.iter().enumerate() {
                sum += *weight * view.albedo(wavelength);
            }
            return (sum * Vec3::from(environment.radiance(frame.normal))).to_array();
        }
        let seen = Seen { shading: self, view, cos: wo.z as f32, frame, environment };
        let orders = self
            .surface
            .lit
            .iter()
            .map(|&order| if order == self.surface.zeroth { seen.mirrored(order) } else { seen.diffracted(order) });
        orders.sum::<Vec3>().to_array()
    }
}

/// A surface seen from one direction, in its light.
struct Seen<'a> {
    shading: &'a OrderShading<'a>,
    view: OrderView<'a>,
    cos: f32,
    frame: &'a ShadingFrame,
    environment: &'a Environment,
}

/// Light of an order at a wavelength: its direction, unless it is evanescent, and its strength.
type Place = (Option<Vec3>, f32);

impl Seen<'_> {
    /// Light of the order (0, 0).
    fn mirrored(&self, order: usize) -> Vec3 {
        let even = self.shading.surface.even.iter().enumerate();
        let sum =
            even.fold(Mat3::ZERO, |sum, (wavelength, weight)| sum + *weight * self.view.strength(wavelength, order));
        let direction = self.view.towards(order, 0.0);
        direction.map_or(Vec3::ZERO, |direction| sum * self.look(direction))
    }

    /// Light of any other order.
    fn diffracted(&self, order: usize) -> Vec3 {
        let table = &self.shading.table;
        let in_medium = |wavelength: usize| table.wavelength_nm(wavelength) / table.index(wavelength);
        let at = |wavelength: usize| -> Place {
            (self.view.towards(order, in_medium(wavelength)), self.view.strength(wavelength, order))
        };
        let mut sum = Vec3::ZERO;
        let mut here = at(0);
        // Weight of the end of the last interval, where the next one begins.
        let mut carried = Mat3::ZERO;
        for interval in 0..table.wavelength_count().max(2) - 1 {
            let next = (interval + 1 < table.wavelength_count()).then(|| at(interval + 1));
            let level = next.map_or(0, |next| self.level(here, next));
            let steps = 1 << level;
            let weights = &self.shading.surface.rules[level][interval * (steps + 1)..][..=steps];
            sum += self.weighted(carried + weights[0], here);
            if let Some(next) = next {
                let (from, to) = (in_medium(interval), in_medium(interval + 1));
                for (step, weight) in weights[..steps].iter().enumerate().skip(1) {
                    let t = step as f32 / steps as f32;
                    let direction = self.view.towards(order, from + t * (to - from));
                    sum += self.weighted(*weight, (direction, here.1 + t * (next.1 - here.1)));
                }
                here = next;
            }
            carried = weights[steps];
        }
        sum + self.weighted(carried, here)
    }

    /// Binary logarithm of the number of steps between two wavelengths.
    fn level(&self, here: Place, next: Place) -> usize {
        if here.1 <= 0.0 && next.1 <= 0.0 {
            return 0;
        }
        let (from, turn) = match (here.0, next.0) {
            (Some(here), Some(next)) => (here, here.distance(next)),
            // The order passes the horizon between the two.
            (Some(last), None) | (None, Some(last)) => (last, last.z.asin()),
            (None, None) => return 0,
        };
        // A chord is shorter than its arc, by π/2 at most.
        if self.environment.is_even_around(self.frame.to_world(from.as_dvec3()), 1.6 * f64::from(turn)) {
            return 0;
        }
        let steps = f64::from(turn) / self.environment.detail();
        (0..MAX_LEVEL).find(|level| steps <= f64::from(1u32 << level)).unwrap_or(MAX_LEVEL)
    }

    /// Light from a place, weighted.
    fn weighted(&self, weight: Mat3, (direction, strength): Place) -> Vec3 {
        match direction {
            Some(direction) if strength > 0.0 && weight != Mat3::ZERO => {
                weight * self.look(direction) * (strength * match_factor(direction.z, self.cos))
            }
            _ => Vec3::ZERO,
        }
    }

    /// RGB of the environment in a direction of the frame.
    fn look(&self, direction: Vec3) -> Vec3 {
        Vec3::from(self.environment.radiance(self.frame.to_world(direction.as_dvec3())))
    }
}
