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
            strength: strength(response, order),
        };
        let transmitted = |order: &Order| OrderPower {
            index: order.index,
            efficiency: response.transmitted_efficiency(order),
            strength: strength(response, order),
        };
        Self {
            reflected: response.reflected.iter().map(reflected).collect(),
            transmitted: response.transmitted.iter().map(transmitted).collect(),
        }
    }
}

/// Strength of an order: e = |E|² k_o/k_i over 4 k_i k_o/(k_i + k_o)². Where the order is evanescent, k_o is 0 and the
/// strength at most 1.
fn strength(response: &Response, order: &Order) -> [f64; 2] {
    let (k_i, k_o) = (response.incident_vertical, order.vertical.re);
    let travels = k_o > order.vertical.im.abs();
    let k_o = if travels { k_o } else { 0.0 };
    order.jones.map(|[s, p]| {
        let strength = (s.norm_sqr() + p.norm_sqr()) * ((k_i + k_o) / (2.0 * k_i)).powi(2);
        if travels { strength } else { strength.min(1.0) }
    })
}
