//! Table of diffraction orders in memory.

use glam::DVec3;
use goniochrome::simd::complex::Polarised;
use goniochrome::table::{OrderArrays, OrderLayout, OrderTable as Lookup, Periodicity};

use crate::support::error::{Error, Result};
use crate::table::metadata::Metadata;
use crate::table::mirror::check_wavelengths;
use crate::table::scatter::MAX_VALUES;

/// Efficiencies of the diffraction orders of a periodic surface, for light from each node of a grid of directions, as
/// strengths.
///
/// An order's efficiency e is its power through a plane parallel to the surface, as a share of the power that arrives
/// through that plane. Its strength is e over 4 k_i k_o/(k_i + k_o)², for the vertical wavevectors k_i = n_i cos θ_i
/// of the light and k_o = n_o cos θ_o of the order in its own half-space: the factor of the library's
/// [`match_factor`](goniochrome::table::match_factor), 1 for the reflected order (0, 0). Where an order is evanescent,
/// the strength continues the formula with k_o = 0, up to 1. Light has no such order, but neighbouring nodes are
/// interpolated through it.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderTable {
    /// Grid of directions towards the light.
    pub layout: OrderLayout,
    /// Numbers (m, n) of the orders, ascending. Order (0, 0) is among them.
    pub orders: Vec<[i32; 2]>,
    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    pub wavelength_nm: Vec<f64>,
    /// Refractive index of the medium above at each wavelength.
    pub index_above: Vec<f64>,
    /// Refractive index of the medium below at each wavelength; 0 where it is opaque and nothing is transmitted.
    pub index_below: Vec<f64>,
    /// Strengths of reflected orders for light in s and in p, `[wavelength][node][order]`, not negative.
    pub reflected: Polarised<Vec<f32>>,
    /// Strengths of transmitted orders, likewise; 0 where there is no such order.
    pub transmitted: Polarised<Vec<f32>>,
    /// Error bar of every efficiency by the truncation of the waves, `[wavelength][node]`.
    pub error: Vec<f32>,
    /// Provenance of the table: scene, method, colour space.
    pub metadata: Metadata,
}

impl OrderTable {
    /// Index of the first order of a wavelength and node in the arrays of strengths.
    #[must_use]
    pub fn first(&self, wavelength: usize, node: usize) -> usize {
        (wavelength * self.layout.count() + node) * self.orders.len()
    }

    /// Strengths of reflected orders for unpolarised light, `[wavelength][node][order]`.
    #[must_use]
    pub fn unpolarised(&self) -> Vec<f32> {
        self.reflected.s.iter().zip(&self.reflected.p).map(|(s, p)| 0.5 * (s + p)).collect()
    }

    /// The table in the form that the library looks up, unpolarised. `rgb_weights` are the linear RGB that a
    /// reflectance of 1 at each wavelength adds to a colour.
    #[must_use]
    pub fn arrays(&self, rgb_weights: impl IntoIterator<Item = [f64; 3]>) -> LookupArrays {
        let narrow = |numbers: &[f64]| numbers.iter().map(|x| *x as f32).collect();
        LookupArrays {
            layout: self.layout,
            orders: self.orders.iter().map(|order| order.map(|m| m as f32)).collect(),
            wavelength_nm: narrow(&self.wavelength_nm),
            index: narrow(&self.index_above),
            rgb_weights: rgb_weights.into_iter().map(|rgb| rgb.map(|c| c as f32)).collect(),
            strength: self.unpolarised(),
        }
    }

    /// Largest sum of the reflected efficiencies for light from the middles between directions of the grid, where
    /// strengths are interpolated. More than 1 says that the grid is too coarse.
    ///
    /// # Errors
    /// A table that the library refuses.
    pub fn worst_albedo(&self) -> Result<f64> {
        let arrays = self.arrays(self.wavelength_nm.iter().map(|_| [0.0; 3]));
        let lookup = arrays.table()?;
        let [width, height] = self.layout.nodes().map(|n| n as usize);
        let corners = |node: usize| [node, node + 1, node + width, node + width + 1];
        let inner = (0..(height - 1) * width).filter(|node| node % width + 1 < width);
        let middles = inner.map(|node| corners(node).map(|n| self.layout.direction(n)).into_iter().sum::<DVec3>());
        let albedo = |middle: DVec3| {
            let view = lookup.view(middle.normalize().as_vec3());
            view.map_or(0.0, |view| (0..self.wavelength_nm.len()).map(|w| view.albedo(w)).fold(0.0, f32::max))
        };
        Ok(f64::from(middles.map(albedo).fold(0.0, f32::max)))
    }

    /// Largest error bar of an efficiency.
    #[must_use]
    pub fn worst_error(&self) -> f64 {
        f64::from(self.error.iter().copied().fold(0.0, f32::max))
    }

    /// Checks sizes and values.
    ///
    /// # Errors
    /// An empty or too large table, arrays whose lengths do not fit the layout, orders that do not ascend, lack (0, 0)
    /// or count along an axis along which the surface does not repeat, wavelengths that are not positive or do not
    /// increase, an index that is not positive above or negative below, a strength or error that is negative or not
    /// finite.
    pub fn check(&self) -> Result<()> {
        check_wavelengths(&self.wavelength_nm)?;
        check_order_size(&self.layout, self.orders.len(), self.wavelength_nm.len())?;
        let wavelengths = self.wavelength_nm.len();
        let strengths = wavelengths * self.layout.count() * self.orders.len();
        for (name, found, expected) in [
            ("indices above", self.index_above.len(), wavelengths),
            ("indices below", self.index_below.len(), wavelengths),
            ("reflected strengths in s", self.reflected.s.len(), strengths),
            ("reflected strengths in p", self.reflected.p.len(), strengths),
            ("transmitted strengths in s", self.transmitted.s.len(), strengths),
            ("transmitted strengths in p", self.transmitted.p.len(), strengths),
            ("errors", self.error.len(), wavelengths * self.layout.count()),
        ] {
            if found != expected {
                return Err(Error::failed(format_args!("the table has {found} {name} where {expected} belong")));
            }
        }
        if !self.orders.is_sorted_by(|a, b| a < b) || !self.orders.contains(&[0, 0]) {
            return Err(Error::failed("the orders of the table do not ascend, or (0, 0) is missing"));
        }
        let varies = [self.layout.periodicity() != Periodicity::Y, self.layout.periodicity() != Periodicity::X];
        if let Some([m, n]) = self.orders.iter().find(|order| (0..2).any(|axis| order[axis] != 0 && !varies[axis])) {
            return Err(Error::failed(format_args!(
                "the table has an order ({m}, {n}), but the surface repeats along one axis alone"
            )));
        }
        let good = |n: f64, least: f64| n >= least && n.is_finite();
        if !self.index_above.iter().all(|&n| good(n, f64::MIN_POSITIVE))
            || !self.index_below.iter().all(|&n| good(n, 0.0))
        {
            return Err(Error::failed("a refractive index of the table is not a positive number"));
        }
        let numbers = [&self.reflected.s, &self.reflected.p, &self.transmitted.s, &self.transmitted.p, &self.error];
        if let Some(value) = numbers.into_iter().flatten().find(|x| !(0.0..f32::INFINITY).contains(*x)) {
            return Err(Error::failed(format_args!("a strength or error of the table is {value}")));
        }
        Ok(())
    }
}

/// Arrays of a table of orders in single precision, which the library's table borrows.
#[derive(Debug, Clone, PartialEq)]
pub struct LookupArrays {
    layout: OrderLayout,
    orders: Vec<[f32; 2]>,
    wavelength_nm: Vec<f32>,
    index: Vec<f32>,
    rgb_weights: Vec<[f32; 3]>,
    strength: Vec<f32>,
}

impl LookupArrays {
    /// The library's table.
    ///
    /// # Errors
    /// Wavelengths that are equal in single precision, or weights that do not fit them.
    pub fn table(&self) -> Result<Lookup<'_>> {
        let arrays = OrderArrays {
            orders: &self.orders,
            wavelength_nm: &self.wavelength_nm,
            index: &self.index,
            rgb_weights: &self.rgb_weights,
            strength: &self.strength,
        };
        Lookup::new(self.layout, &arrays).map_err(Error::failed)
    }
}

/// Refuses sizes that only a damaged file or a mistyped option asks for.
///
/// # Errors
/// No order, no wavelength, or more than [`MAX_VALUES`] strengths.
pub fn check_order_size(layout: &OrderLayout, orders: usize, wavelengths: usize) -> Result<()> {
    let values = layout.count().saturating_mul(orders).saturating_mul(wavelengths);
    if values == 0 {
        return Err(Error::failed("a table needs at least one order and one wavelength"));
    }
    if values > MAX_VALUES {
        return Err(Error::failed(format_args!(
            "{} directions × {orders} orders × {wavelengths} wavelengths are more than the {MAX_VALUES} values of a table; \
             name fewer directions or wavelengths",
            layout.count()
        )));
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Lines of period 700 nm along y: three orders, two wavelengths, 3 × 2 directions.
    pub fn sample() -> OrderTable {
        let layout = OrderLayout::new([3, 2], Periodicity::X, [700.0, 700.0]).unwrap();
        let strengths = |offset: f32| (0..36).map(|i| offset + i as f32 / 100.0).collect::<Vec<f32>>();
        OrderTable {
            layout,
            orders: vec![[-1, 0], [0, 0], [1, 0]],
            wavelength_nm: vec![450.0, 600.0],
            index_above: vec![1.0, 1.0],
            index_below: vec![1.5, 0.0],
            reflected: Polarised { s: strengths(0.0), p: strengths(0.1) },
            transmitted: Polarised { s: strengths(0.2), p: strengths(0.3) },
            error: (0..12).map(|i| i as f32 * 1e-4).collect(),
            metadata: Metadata::default(),
        }
    }

    #[test]
    fn tables_that_do_not_fit_are_refused() {
        sample().check().unwrap();
        let refusal = |change: fn(&mut OrderTable)| {
            let mut table = sample();
            change(&mut table);
            table.check().unwrap_err().to_string()
        };
        assert!(refusal(|t| t.error.truncate(3)).contains("3 errors where 12 belong"));
        assert!(refusal(|t| t.orders[1] = [2, 0]).contains("do not ascend"));
        assert!(refusal(|t| t.orders = vec![[-1, 0], [1, 0], [2, 0]]).contains("(0, 0) is missing"));
        assert!(refusal(|t| t.orders[2] = [1, 1]).contains("an order (1, 1), but"));
        assert!(refusal(|t| t.index_above[1] = 0.0).contains("refractive index"));
        assert!(refusal(|t| t.reflected.p[7] = f32::NAN).contains("is NaN"));
        assert!(refusal(|t| t.transmitted.s[7] = -1.0).contains("is -1"));
        assert!(refusal(|t| t.wavelength_nm[1] = 450.0).contains("wavelength"));
    }
}
