//! Diffraction orders of periodic surfaces: exact directions, tabulated efficiencies.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::GridNode;
use super::order_layout::{OrderLayout, Periodicity};
use crate::simd::lanes::sqrtf;
use crate::values::Values;
use glam::Vec3;

/// Efficiency over strength of an order: 4 cos θ_i cos θ_o/(cos θ_i + cos θ_o)², for the cosines of the light and of
/// the order, both positive. It is the transmittance of a step between two impedances, at most 1, and 1 for order (0,
/// 0).
#[must_use]
#[inline]
pub fn match_factor(cos_i: f32, cos_o: f32) -> f32 {
    let sum = cos_i + cos_o;
    4.0 * cos_i * cos_o / (sum * sum)
}

/// Reflection of a periodic surface into diffraction orders.
///
/// Light from the unit vector `wi` leaves in order (m, n) along `wo`, of tangential components wo_t = −wi_t + (λ/n)
/// (m/Λx, n/Λy) for the index n of the medium above. Reversed, light along `wo` reaches the viewer in that order from
/// **one** direction, wi_t = −wo_t + (λ/n) (m/Λx, n/Λy), and by reciprocity with the efficiency e of light that arrives
/// from `wo` itself and leaves along `wi`. The surface element, the cosines and the solid angles cancel, so that
/// radiance is L(wo, λ) = Σ e L(wi, λ): a sum of mirror-like terms, one for each order.
///
/// The table holds strengths, not efficiencies: e over [`match_factor`], the power that passes between waves of these
/// directions at best. It passes smoothly through the directions in which an order begins or ends, where e itself has a
/// kink. The strength of order (0, 0) is e. Strengths are linear between the nodes of an [`OrderLayout`] and between
/// wavelengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderTable<'a> {
    layout: OrderLayout,
    orders: Values<'a>,
    wavelength_nm: Values<'a>,
    index: Values<'a>,
    rgb_weights: Values<'a>,
    strength: Values<'a>,
}

/// Arrays of an [`OrderTable`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderArrays<'a> {
    /// Numbers (m, n) of each order: whole numbers, 0 along an axis along which the surface does not vary.
    pub orders: &'a [[f32; 2]],
    /// Vacuum wavelengths, positive and strictly increasing.
    pub wavelength_nm: &'a [f32],
    /// Refractive index of the medium above at each wavelength, positive.
    pub index: &'a [f32],
    /// Linear RGB that a reflectance of 1 at each wavelength adds to a colour; their sum is white.
    pub rgb_weights: &'a [[f32; 3]],
    /// Strengths of unpolarised light, not negative, `[wavelength][node][order]`.
    pub strength: &'a [f32],
}

/// Largest number of orders. With it, sums over orders stay within single precision.
const MAX_ORDERS: usize = 1 << 20;
/// Largest number m or n of an order.
const MAX_NUMBER: f32 = 1e6;

/// Light that reaches a viewer by one diffraction order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffractedLight {
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Share of that light's radiance which the viewer receives, unpolarised.
    pub efficiency: f32,
}

/// A draw of [`OrderView::sample`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderSample {
    /// Index of the order in the table.
    pub order: usize,
    /// Unit vector towards the light.
    pub direction: Vec3,
    /// Share of that light's radiance which the viewer receives, unpolarised.
    pub efficiency: f32,
    /// Probability of the draw, positive: efficiency over the sum of the efficiencies of all orders.
    pub probability: f32,
}

impl<'a> OrderTable<'a> {
    /// Checks a table.
    ///
    /// # Errors
    /// [`TableError::Shape`] if there is no wavelength or no order, or more than 2²⁰ orders. [`TableError::Length`] if
    /// an array does not fit the others; it states the number of strengths. [`TableError::Orders`] for numbers of an
    /// order, wavelengths, indices or weights that are not as [`OrderArrays`] says, or beyond [`MAX_MAGNITUDE`].
    /// [`TableError::Strength`] for a strength that is NaN, negative or beyond [`MAX_MAGNITUDE`].
    pub fn new(layout: OrderLayout, arrays: &OrderArrays<'a>) -> Result<Self, TableError> {
        let &OrderArrays { orders, wavelength_nm, index, rgb_weights, strength } = arrays;
        Self::checked(Self {
            layout,
            orders: Values::Numbers(orders.as_flattened()),
            wavelength_nm: Values::Numbers(wavelength_nm),
            index: Values::Numbers(index),
            rgb_weights: Values::Numbers(rgb_weights.as_flattened()),
            strength: Values::Numbers(strength),
        })
    }

    /// Checks a table whose arrays may lie in a blob. `axes` holds what [`OrderTable::axes`] gives, one after the
    /// other.
    pub(super) fn from_parts(
        layout: OrderLayout,
        strength: Values<'a>,
        axes: Values<'a>,
        orders: usize,
        wavelengths: usize,
    ) -> Result<Self, TableError> {
        let part = |from: usize, count: usize| axes.part(from, count);
        let (orders, wavelength_nm) = (part(0, 2 * orders), part(2 * orders, wavelengths));
        let from = orders.len() + wavelengths;
        let (index, rgb_weights) = (part(from, wavelengths), part(from + wavelengths, 3 * wavelengths));
        Self::checked(Self { layout, orders, wavelength_nm, index, rgb_weights, strength })
    }

    fn checked(table: Self) -> Result<Self, TableError> {
        let Self { layout, orders, wavelength_nm, index, rgb_weights, strength } = table;
        let (order_count, wavelengths) = (table.order_count(), table.wavelength_count());
        if !(1..=MAX_ORDERS).contains(&order_count) || wavelengths == 0 {
            return Err(TableError::Shape);
        }
        let required = order_count.saturating_mul(wavelengths).saturating_mul(layout.count());
        let fits = orders.len() == 2 * order_count
            && index.len() == wavelengths
            && rgb_weights.len() == wavelengths.saturating_mul(3)
            && strength.len() == required;
        if !fits {
            return Err(TableError::Length { required });
        }
        let positive = |x: f32| x > 0.0 && x <= MAX_MAGNITUDE;
        let [mut varies, mut other] = [Periodicity::Y, Periodicity::X].map(|across| layout.periodicity() != across);
        let mut last = 0.0;
        // Numbers m and n take turns.
        let mut whole = |x: f32| {
            let max = if varies { MAX_NUMBER } else { 0.0 };
            core::mem::swap(&mut varies, &mut other);
            x.abs() <= max && libm::truncf(x) == x
        };
        let mut increasing = |x: f32| positive(x) && core::mem::replace(&mut last, x) < x;
        let sound = first_wrong(orders, &mut whole).is_none()
            && first_wrong(wavelength_nm, &mut increasing).is_none()
            && first_wrong(index, &mut |x| positive(x)).is_none()
            && first_wrong(rgb_weights, &mut |x| x.abs() <= MAX_MAGNITUDE).is_none();
        if !sound {
            return Err(TableError::Orders);
        }
        match first_wrong(strength, &mut |x| (0.0..=MAX_MAGNITUDE).contains(&x)) {
            Some(index) => Err(TableError::Strength { index }),
            None => Ok(table),
        }
    }

    /// Grid of directions.
    #[must_use]
    pub fn layout(&self) -> OrderLayout {
        self.layout
    }

    /// Number of orders.
    #[must_use]
    pub fn order_count(&self) -> usize {
        self.orders.len() / 2
    }

    /// Numbers (m, n) of an order; (0, 0) beyond the last.
    #[must_use]
    pub fn order(&self, order: usize) -> [i32; 2] {
        self.numbers(order).map_or([0; 2], |numbers| numbers.map(|x| x as i32))
    }

    /// Numbers (m, n) of an order as the table stores them; `None` beyond the last.
    #[inline]
    fn numbers(&self, order: usize) -> Option<[f32; 2]> {
        (order < self.order_count()).then(|| [self.orders.at(2 * order), self.orders.at(2 * order + 1)])
    }

    /// Number of wavelengths.
    #[must_use]
    pub fn wavelength_count(&self) -> usize {
        self.wavelength_nm.len()
    }

    /// Vacuum wavelength, in nanometres; 0 beyond the last.
    #[must_use]
    pub fn wavelength_nm(&self, wavelength: usize) -> f32 {
        self.wavelength_nm.at(wavelength)
    }

    /// Refractive index of the medium above at this wavelength; 0 beyond the last.
    #[must_use]
    pub fn index(&self, wavelength: usize) -> f32 {
        self.index.at(wavelength)
    }

    /// Linear RGB that a reflectance of 1 at this wavelength adds to a colour; 0 beyond the last wavelength.
    #[must_use]
    pub fn rgb_weight(&self, wavelength: usize) -> [f32; 3] {
        let first = wavelength.saturating_mul(3);
        [0, 1, 2].map(|c| self.rgb_weights.at(first.saturating_add(c)))
    }

    /// The table as seen from the unit vector `wo`; `None` if it lies below the horizon.
    #[must_use]
    #[inline]
    pub fn view(&self, wo: Vec3) -> Option<OrderView<'a>> {
        let above = wo.z > 0.0;
        above.then(|| {
            let orders = self.order_count();
            let first = |node: GridNode| GridNode { index: node.index * orders, ..node };
            let (nodes, stride) = (self.layout.interpolation(wo).map(first), self.layout.count() * orders);
            OrderView { table: *self, wo, nodes, stride }
        })
    }

    /// Arrays in the order of a blob's last section: orders, wavelengths, indices, weights.
    pub(super) fn axes(&self) -> [Values<'a>; 4] {
        [self.orders, self.wavelength_nm, self.index, self.rgb_weights]
    }

    pub(super) fn strengths(&self) -> Values<'a> {
        self.strength
    }
}

/// Index of the first value that fails a test. One loop serves every array of every precision, which keeps programs
/// small.
#[inline(never)]
fn first_wrong(values: Values<'_>, test: &mut dyn FnMut(f32) -> bool) -> Option<usize> {
    values.iter().position(|x| !test(x))
}

/// An [`OrderTable`] seen from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderView<'a> {
    table: OrderTable<'a>,
    wo: Vec3,
    /// Places of the first order of each node at the first wavelength.
    nodes: [GridNode; 4],
    /// Number of strengths of one wavelength.
    stride: usize,
}

impl<'a> OrderView<'a> {
    /// The table.
    #[must_use]
    pub fn table(&self) -> &OrderTable<'a> {
        &self.table
    }

    /// Light that reaches the viewer by an order at a wavelength of the table. `None` where the order is evanescent, or
    /// if the table has no such order or wavelength.
    #[must_use]
    #[inline]
    pub fn light(&self, wavelength: usize, order: usize) -> Option<DiffractedLight> {
        self.light_between(wavelength, 0.0, order)
    }

    /// Light that reaches the viewer by an order at the wavelength λ_w + t (λ_{w+1} − λ_w). Its direction is exact, its
    /// strength linear between the two, and so is the refractive index. `t` is clamped to [0, 1]; NaN counts as 0.
    /// Beyond the last wavelength nothing changes. `None` as for [`OrderView::light`].
    #[must_use]
    pub fn light_between(&self, wavelength: usize, t: f32, order: usize) -> Option<DiffractedLight> {
        let last = self.table.wavelength_count() - 1;
        if wavelength > last {
            return None;
        }
        let between = Between { first: wavelength, next: (wavelength + 1).min(last), t: t.clamp(0.0, 1.0) };
        let [nm, index] = [self.table.wavelength_nm, self.table.index].map(|values| between.mix(|w| values.at(w)));
        let direction = self.towards(order, nm / index)?;
        let strength = between.mix(|wavelength| self.strength(wavelength, order));
        Some(DiffractedLight { direction, efficiency: strength * match_factor(direction.z, self.wo.z) })
    }

    /// Unit vector towards the light of an order, for any wavelength in the medium above. `None` where the order is
    /// evanescent, or if the table has no such order.
    #[must_use]
    #[inline]
    pub fn towards(&self, order: usize, wavelength_in_medium_nm: f32) -> Option<Vec3> {
        let [m, n] = self.table.numbers(order)?;
        let [x, y] = self.table.layout.period_nm();
        let (x, y) = (m * wavelength_in_medium_nm / x - self.wo.x, n * wavelength_in_medium_nm / y - self.wo.y);
        let up_squared = 1.0 - x * x - y * y;
        // NaN travels nowhere.
        let travels = up_squared > 0.0;
        travels.then(|| Vec3::new(x, y, sqrtf(up_squared)))
    }

    /// Strength of an order for light from the viewer's direction, evanescent or not; 0 if the table has no such order
    /// or wavelength.
    #[must_use]
    #[inline]
    pub fn strength(&self, wavelength: usize, order: usize) -> f32 {
        if wavelength >= self.table.wavelength_count() || order >= self.table.order_count() {
            return 0.0;
        }
        let first = wavelength * self.stride + order;
        self.nodes.iter().map(|node| node.weight * self.table.strength.at(first + node.index)).sum()
    }

    /// Sum of the efficiencies of all orders at a wavelength: the directional albedo.
    #[must_use]
    pub fn albedo(&self, wavelength: usize) -> f32 {
        let orders = 0..self.table.order_count();
        orders.filter_map(|order| self.light(wavelength, order)).map(|light| light.efficiency).sum()
    }

    /// Draws an order at a wavelength, in proportion to its efficiency, by `u` uniform in [0, 1). `None` if no light
    /// reaches the viewer.
    ///
    /// Orders are discrete: there is no density per solid angle, and other techniques of a path tracer cannot find
    /// them. A sample's estimate of the radiance is L · efficiency/probability.
    #[must_use]
    pub fn sample(&self, wavelength: usize, u: f32) -> Option<OrderSample> {
        let albedo = self.albedo(wavelength);
        let (mut left, mut drawn) = (u * albedo, None);
        for order in 0..self.table.order_count() {
            let Some(DiffractedLight { direction, efficiency }) = self.light(wavelength, order) else { continue };
            let probability = efficiency / albedo;
            // Not so for an albedo of 0, nor for efficiencies too small for single precision.
            if probability > 0.0 {
                drawn = Some(OrderSample { order, direction, efficiency, probability });
                left -= efficiency;
                if left < 0.0 {
                    break;
                }
            }
        }
        drawn
    }

    /// Probability with which [`OrderView::sample`] draws an order.
    #[must_use]
    pub fn probability(&self, wavelength: usize, order: usize) -> f32 {
        match self.light(wavelength, order) {
            Some(light) if light.efficiency > 0.0 => light.efficiency / self.albedo(wavelength),
            _ => 0.0,
        }
    }
}

/// Place between two wavelengths of a table, at the share `t` of the way; at the first unless `t` is positive.
#[derive(Clone, Copy)]
struct Between {
    first: usize,
    next: usize,
    t: f32,
}

impl Between {
    /// Linear interpolation of a quantity.
    #[inline]
    fn mix(self, at: impl Fn(usize) -> f32) -> f32 {
        let first = at(self.first);
        if self.t > 0.0 { first + self.t * (at(self.next) - first) } else { first }
    }
}

#[cfg(test)]
#[path = "orders_tests.rs"]
mod tests;
