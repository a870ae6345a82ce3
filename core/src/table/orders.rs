//! Diffraction orders of periodic surfaces: exact directions, tabulated efficiencies.

use super::error::{MAX_MAGNITUDE, TableError};
use super::layout::GridNode;
use super::order_layout::OrderLayout;
use super::values::Values;
use glam::Vec3;

/// Reflection of a periodic surface into diffraction orders.
///
/// Light from the unit vector `wi` leaves in order (m, n) along `wo`, of tangential components
/// wo_t = −wi_t + (λ/n) (m/Λx, n/Λy) for the index n of the medium above. Reversed, light along `wo` reaches the viewer in
/// that order from **one** direction, wi_t = −wo_t + (λ/n) (m/Λx, n/Λy), and by reciprocity with the efficiency e of
/// light that arrives from `wo` itself and leaves along `wi`. The surface element, the cosines and the solid angles
/// cancel, so that radiance is L(wo, λ) = Σ e L(wi, λ): a sum of mirror-like terms, one for each order.
///
/// The table holds strengths, not efficiencies. For orders other than (0, 0) the strength is e/(cos θ_i cos θ_o): it
/// passes smoothly through the directions in which an order begins or ends, where e itself has a kink. The strength of
/// order (0, 0) is e. Strengths are linear between the nodes of an [`OrderLayout`] and between wavelengths.
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
    /// Numbers (m, n) of each order: whole numbers.
    pub orders: &'a [[f32; 2]],
    /// Vacuum wavelengths, positive and strictly increasing.
    pub wavelength_nm: &'a [f32],
    /// Refractive index of the medium above at each wavelength, positive.
    pub index: &'a [f32],
    /// Linear RGB that a reflectance of 1 at each wavelength adds to a colour; their sum is white.
    pub rgb_weights: &'a [[f32; 3]],
    /// Strengths of unpolarised light, `[wavelength][node][order]`.
    pub strength: &'a [f32],
}

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
    /// Probability of the draw, positive: efficiency over the sum of all efficiencies.
    pub probability: f32,
}

impl<'a> OrderTable<'a> {
    /// Checks a table.
    ///
    /// # Errors
    /// [`TableError::Shape`] if there is no order or no wavelength, [`TableError::Length`] if an array does not fit the
    /// others (it states the number of strengths), and [`TableError::NotFinite`] for a strength that is NaN or beyond
    /// [`MAX_MAGNITUDE`], a wavelength or index that is not positive, wavelengths that do not increase, an order that is
    /// not whole, or a weight that is not finite; it counts within the array.
    pub fn new(layout: OrderLayout, arrays: &OrderArrays<'a>) -> Result<Self, TableError> {
        let &OrderArrays { orders, wavelength_nm, index, rgb_weights, strength } = arrays;
        Self::of(
            layout,
            Values::Numbers(orders.as_flattened()),
            Values::Numbers(wavelength_nm),
            Values::Numbers(index),
            Values::Numbers(rgb_weights.as_flattened()),
            Values::Numbers(strength),
        )
    }

    pub(super) fn of(
        layout: OrderLayout,
        orders: Values<'a>,
        wavelength_nm: Values<'a>,
        index: Values<'a>,
        rgb_weights: Values<'a>,
        strength: Values<'a>,
    ) -> Result<Self, TableError> {
        let (order_count, wavelengths) = (orders.len() / 2, wavelength_nm.len());
        if order_count == 0 || wavelengths == 0 {
            return Err(TableError::Shape);
        }
        let required = order_count.saturating_mul(wavelengths).saturating_mul(layout.count());
        let fits = orders.len() == 2 * order_count
            && index.len() == wavelengths
            && rgb_weights.len() == 3 * wavelengths
            && strength.len() == required;
        if !fits {
            return Err(TableError::Length { required });
        }
        let bounded = |x: f32| (-MAX_MAGNITUDE..=MAX_MAGNITUDE).contains(&x);
        let whole = |x: f32| x.abs() < 1e6 && libm::truncf(x) == x;
        let positive = |x: f32| x > 0.0 && bounded(x);
        let mut last = 0.0;
        let increasing = |x: f32| positive(x) && core::mem::replace(&mut last, x) < x;
        let wrong = orders
            .iter()
            .position(|x| !whole(x))
            .or_else(|| wavelength_nm.iter().map(increasing).position(|good| !good))
            .or_else(|| index.iter().position(|x| !positive(x)))
            .or_else(|| rgb_weights.iter().position(|x| !bounded(x)))
            .or_else(|| strength.iter().position(|x| !bounded(x)));
        match wrong {
            Some(index) => Err(TableError::NotFinite { index }),
            None => Ok(Self { layout, orders, wavelength_nm, index, rgb_weights, strength }),
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

    /// Numbers (m, n) of an order.
    #[must_use]
    pub fn order(&self, order: usize) -> [i32; 2] {
        [self.orders.at(2 * order) as i32, self.orders.at(2 * order + 1) as i32]
    }

    /// Number of wavelengths.
    #[must_use]
    pub fn wavelength_count(&self) -> usize {
        self.wavelength_nm.len()
    }

    /// Vacuum wavelength, in nanometres.
    #[must_use]
    pub fn wavelength_nm(&self, wavelength: usize) -> f32 {
        self.wavelength_nm.at(wavelength)
    }

    /// Linear RGB that a reflectance of 1 at this wavelength adds to a colour.
    #[must_use]
    pub fn rgb_weight(&self, wavelength: usize) -> [f32; 3] {
        core::array::from_fn(|c| self.rgb_weights.at(3 * wavelength + c))
    }

    /// The table as seen from the unit vector `wo`; `None` if it lies below the horizon.
    #[must_use]
    #[inline]
    pub fn view(&self, wo: Vec3) -> Option<OrderView<'a>> {
        let above = wo.z > 0.0;
        above.then(|| OrderView { table: *self, wo, nodes: self.layout.interpolation(wo) })
    }

    /// Strength of an order at a node.
    #[inline]
    fn strength(&self, wavelength: usize, node: usize, order: usize) -> f32 {
        self.strength.at((wavelength * self.layout.count() + node) * self.order_count() + order)
    }
}

/// An [`OrderTable`] seen from one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderView<'a> {
    table: OrderTable<'a>,
    wo: Vec3,
    nodes: [GridNode; 4],
}

impl OrderView<'_> {
    /// Light that reaches the viewer by an order at a wavelength of the table; `None` where the order is evanescent.
    #[must_use]
    #[inline]
    pub fn light(&self, wavelength: usize, order: usize) -> Option<DiffractedLight> {
        self.light_between(wavelength, 0.0, order)
    }

    /// Light that reaches the viewer by an order at the wavelength λ_w + t (λ_{w+1} − λ_w) for t in [0, 1]: its
    /// direction is exact, its strength linear between the two. `None` where the order is evanescent.
    #[must_use]
    #[inline]
    pub fn light_between(&self, wavelength: usize, t: f32, order: usize) -> Option<DiffractedLight> {
        let table = &self.table;
        let next = if t > 0.0 { (wavelength + 1).min(table.wavelength_count() - 1) } else { wavelength };
        let mix = |values: Values<'_>| {
            let first = values.at(wavelength);
            first + t * (values.at(next) - first)
        };
        let direction = self.towards(mix(table.wavelength_nm) / mix(table.index), order)?;
        let at = |wavelength: usize| -> f32 {
            self.nodes.iter().map(|node| node.weight * table.strength(wavelength, node.index, order)).sum()
        };
        let first = at(wavelength);
        let strength = if next == wavelength { first } else { first + t * (at(next) - first) };
        let cosines = if table.order(order) == [0, 0] { 1.0 } else { direction.z * self.wo.z };
        Some(DiffractedLight { direction, efficiency: strength * cosines })
    }

    /// Unit vector towards the light of an order at this wavelength in the medium above; `None` where the order is
    /// evanescent.
    #[inline]
    fn towards(&self, wavelength_in_medium_nm: f32, order: usize) -> Option<Vec3> {
        let [m, n] = [0, 1].map(|axis| self.table.orders.at(2 * order + axis));
        let [x, y] = self.table.layout.period_nm();
        let (x, y) = (m * wavelength_in_medium_nm / x - self.wo.x, n * wavelength_in_medium_nm / y - self.wo.y);
        let up_squared = 1.0 - x * x - y * y;
        (up_squared > 0.0).then(|| Vec3::new(x, y, libm::sqrtf(up_squared)))
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
        let lit = albedo > 0.0;
        if !lit {
            return None;
        }
        let (mut left, mut drawn) = (u * albedo, None);
        for order in 0..self.table.order_count() {
            let Some(DiffractedLight { direction, efficiency }) = self.light(wavelength, order) else { continue };
            if efficiency <= 0.0 {
                continue;
            }
            drawn = Some(OrderSample { order, direction, efficiency, probability: efficiency / albedo });
            left -= efficiency;
            if left < 0.0 {
                break;
            }
        }
        drawn
    }

    /// Probability with which [`OrderView::sample`] draws an order.
    #[must_use]
    pub fn probability(&self, wavelength: usize, order: usize) -> f32 {
        match (self.albedo(wavelength), self.light(wavelength, order)) {
            (albedo, Some(light)) if albedo > 0.0 => light.efficiency.max(0.0) / albedo,
            _ => 0.0,
        }
    }
}
