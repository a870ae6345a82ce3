//! Powers of diffraction orders, as tables and commands take them.

use goniochrome_waves::Complex64;
use goniochrome_waves::response::{Order, Response};

/// Power of an order for light in s and in p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OrderPower {
    /// The order (m, n).
    pub index: [i32; 2],
    /// Power through a plane parallel to the surface, as a share of the power that arrives through it; 0 where the
    /// order is evanescent.
    pub efficiency: [f64; 2],
    /// Strength, as [`OrderTable`](crate::table::orders::OrderTable) defines it, continued where the order is
    /// evanescent.
    pub strength: [f64; 2],
}

/// Powers of all orders for light from one direction.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DirectionPowers {
    pub reflected: Vec<OrderPower>,
    pub transmitted: Vec<OrderPower>,
}

impl DirectionPowers {
    /// Largest change of an efficiency between two truncations. An order that the coarser lacks counts wholly.
    pub fn largest_change(coarse: &[Self], fine: &[Self]) -> f64 {
        let of = |coarse: &[OrderPower], fine: &[OrderPower]| {
            let mut largest = 0.0_f64;
            for order in fine {
                let known = coarse.iter().find(|known| known.index == order.index);
                let before = known.map_or([0.0; 2], |known| known.efficiency);
                for (now, before) in order.efficiency.iter().zip(before) {
                    largest = largest.max((now - before).abs());
                }
            }
            largest
        };
        let changes = coarse.iter().zip(fine).map(|(coarse, fine)| {
            of(&coarse.reflected, &fine.reflected).max(of(&coarse.transmitted, &fine.transmitted))
        });
        changes.fold(0.0, f64::max)
    }

    /// Powers of a solver's response; none below where that half-space is opaque.
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
            transmitted: if is_opaque(response.half_spaces[1]) {
                Vec::new()
            } else {
                response.transmitted.iter().map(transmitted).collect()
            },
        }
    }
}

/// Least k of a half-space below, relative to n, with which it counts as opaque: no light leaves in orders.
const OPAQUE: f64 = 1e-3;

/// Whether a half-space absorbs what enters it.
pub(super) fn is_opaque(eta: Complex64) -> bool {
    eta.im > OPAQUE * eta.re
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
