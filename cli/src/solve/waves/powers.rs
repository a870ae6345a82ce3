//! Powers of diffraction orders, as tables and commands take them.

use goniochrome_waves::response::{Order, Response};

/// Power of an order for light in s and in p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OrderPower {
    /// The order (m, n).
    pub index: [i32; 2],
    /// Power through a plane parallel to the surface, as a share of the power that arrives through it; 0 where the order
    /// is evanescent.
    pub efficiency: [f64; 2],
    /// Strength, as [`OrderTable`](crate::table::orders::OrderTable) defines it, continued where the order is evanescent.
    pub strength: [f64; 2],
}

/// Powers of all orders for light from one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DirectionPowers {
    pub reflected: Vec<OrderPower>,
    pub transmitted: Vec<OrderPower>,
}

impl DirectionPowers {
    /// Powers of a solver's response.
    pub fn of(response: &Response) -> Self {
        let reflected = |order: &Order| OrderPower {
            index: order.index,
            efficiency: response.reflected_efficiency(order),
            strength: reflected_strength(response, order),
        };
        let transmitted = |order: &Order| OrderPower {
            index: order.index,
            efficiency: response.transmitted_efficiency(order),
            strength: transmitted_strength(response, order),
        };
        Self {
            reflected: response.reflected.iter().map(reflected).collect(),
            transmitted: response.transmitted.iter().map(transmitted).collect(),
        }
    }
}

/// Strength of a reflected order: e/(cos θ_i cos θ_o) with e = |E|² cos θ_o/cos θ_i, or e itself of order (0, 0).
fn reflected_strength(response: &Response, order: &Order) -> [f64; 2] {
    if order.index == [0, 0] {
        return response.reflected_efficiency(order);
    }
    let cos = response.incident_vertical / response.half_spaces[0].re;
    order.jones.map(|[s, p]| (s.norm_sqr() + p.norm_sqr()) / (cos * cos))
}

/// Strength of a transmitted order: e/(cos θ_i cos θ_t) with e = |E|² n_t cos θ_t/(n_i cos θ_i).
fn transmitted_strength(response: &Response, order: &Order) -> [f64; 2] {
    let [above, below] = response.half_spaces.map(|eta| eta.re);
    let cos = response.incident_vertical / above;
    order.jones.map(|[s, p]| (s.norm_sqr() + p.norm_sqr()) * below / (above * cos * cos))
}
