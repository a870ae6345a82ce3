//! Diffraction orders of waves for light from one direction.

use glam::DVec3;
use goniochrome::measure::bins::DirectionBins;
use goniochrome::simd::complex::Polarised;

use crate::solve::scatter::Scattered;
use crate::solve::waves::cell::{Accuracy, WaveCell};
use crate::solve::waves::powers::{DirectionPowers, OrderPower};
use crate::support::error::Result;
use crate::support::parallel;
use crate::table::statistics::MeanWithError;

/// Travelling order at one wavelength, on one side of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveOrder {
    /// The order (m, n).
    pub index: [i32; 2],
    /// Unit vector in which the order leaves; downwards if it is transmitted.
    pub direction: DVec3,
    /// Efficiency for light in s and in p.
    pub efficiency: Polarised<f64>,
}

/// Travelling orders of one wavelength.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveDiffraction {
    /// Vacuum wavelength.
    pub wavelength_nm: f64,
    /// Reflected orders, sorted by index.
    pub reflected: Vec<WaveOrder>,
    /// Transmitted orders, sorted by index; none into an opaque medium.
    pub transmitted: Vec<WaveOrder>,
    /// Error bar of every efficiency by the truncation of the waves.
    pub error: f64,
    /// Largest |m| that the solver took along.
    pub max_order: usize,
    /// Whether the error bar meets the target.
    pub met: bool,
}

impl WaveDiffraction {
    /// Reflected orders in bins of directions, unpolarised. What neither goes up nor down is absorbed; in a medium
    /// below that absorbs, all that is not reflected is. The error bar counts as truncated light.
    #[must_use]
    pub fn in_bins(&self, bins: DirectionBins) -> Scattered {
        let exact = |value: f64| MeanWithError { value, std_error: 0.0 };
        let mut of_bin = vec![MeanWithError::default(); bins.count()];
        let mean = |order: &WaveOrder| 0.5 * (order.efficiency.s + order.efficiency.p);
        for order in &self.reflected {
            of_bin[bins.index(order.direction)].value += mean(order);
        }
        let [reflected, transmitted] =
            [&self.reflected, &self.transmitted].map(|orders| orders.iter().map(mean).sum::<f64>());
        Scattered {
            reflected: exact(reflected),
            transmitted: exact(transmitted),
            absorbed: exact(1.0 - reflected - transmitted),
            truncated: exact(self.error),
            imbalance: exact(0.0),
            without_interference: exact(0.0),
            bins: of_bin,
        }
    }
}

/// Orders of waves for light from the unit vector `wi` at each wavelength. `progress` is called after each wavelength.
///
/// # Errors
/// A medium without data at a wavelength, bodies that overlap, a period that needs more orders than `accuracy` allows,
/// equations without a finite solution.
pub fn wave_orders(
    cell: &WaveCell<'_>,
    wi: DVec3,
    wavelength_nm: &[f64],
    accuracy: Accuracy,
    threads: usize,
    progress: &(dyn Fn() + Sync),
) -> Result<Vec<WaveDiffraction>> {
    let mut found: Vec<Option<Result<WaveDiffraction>>> = wavelength_nm.iter().map(|_| None).collect();
    parallel::for_each(
        threads,
        found.iter_mut().zip(wavelength_nm),
        || (),
        |(), (place, &nm)| {
            *place = Some(of_wavelength(cell, wi, nm, accuracy));
            progress();
        },
    );
    found.into_iter().flatten().collect()
}

fn of_wavelength(cell: &WaveCell<'_>, wi: DVec3, wavelength_nm: f64, accuracy: Accuracy) -> Result<WaveDiffraction> {
    let index = [cell.index_above(wavelength_nm)?, cell.index_below(wavelength_nm)?];
    let [first, second] = cell.wavevector(wi, index[0]);
    let mut found = cell.orders(wavelength_nm, first, &[second], accuracy)?;
    let DirectionPowers { reflected, transmitted } = found.directions.remove(0);
    let travelling = |orders: &[OrderPower], place: usize, up: f64| {
        let mut listed = Vec::new();
        for order in orders {
            let [x, y] = cell.order_tangential(wi, index[0], order.index, wavelength_nm);
            let up_squared = index[place].powi(2) - x * x - y * y;
            if up_squared > 0.0 {
                let direction = DVec3::new(x, y, up * up_squared.sqrt()) / index[place];
                let [s, p] = order.efficiency;
                listed.push(WaveOrder { index: order.index, direction, efficiency: Polarised { s, p } });
            }
        }
        listed.sort_by_key(|order| order.index);
        listed
    };
    Ok(WaveDiffraction {
        wavelength_nm,
        reflected: travelling(&reflected, 0, 1.0),
        transmitted: travelling(&transmitted, 1, -1.0),
        error: found.error,
        max_order: found.max_order,
        met: found.met,
    })
}
