//! A hand-made compact disc, whose efficiencies are known in closed form.

use std::f64::consts::PI;

use goniochrome::simd::complex::Polarised;
use goniochrome::table::{OrderLayout, Periodicity};
use goniochrome_cli::table::orders::OrderTable;

/// Distance of the tracks.
pub const PITCH_NM: f64 = 1600.0;
/// Share of the pitch that pits take, their depth, and the reflectance of the metal.
const PIT: f64 = 0.35;
const DEPTH_NM: f64 = 130.0;
const METAL: f64 = 0.85;

/// Strength of an order by scalar theory for rectangular grooves, whatever the direction.
pub fn strength(order: i32, nm: f64) -> f64 {
    let phase = 4.0 * PI * DEPTH_NM / nm;
    let step = 2.0 - 2.0 * phase.cos();
    if order == 0 {
        return METAL * (1.0 - PIT * (1.0 - PIT) * step);
    }
    let m = PI * f64::from(order);
    METAL * step * ((m * PIT).sin() / m).powi(2)
}

/// The table of a strength that depends on the order and the wavelength.
pub fn table(wavelength_nm: Vec<f64>, last: i32, of: impl Fn(i32, f64) -> f64) -> OrderTable {
    let layout = OrderLayout::new([5, 3], Periodicity::X, [PITCH_NM as f32; 2]).unwrap();
    let orders: Vec<[i32; 2]> = (-last..=last).map(|m| [m, 0]).collect();
    let strengths: Vec<f32> = wavelength_nm
        .iter()
        .flat_map(|&nm| (0..layout.count()).map(move |_| nm))
        .flat_map(|nm| orders.iter().map(move |order| (order[0], nm)))
        .map(|(order, nm)| of(order, nm) as f32)
        .collect();
    let count = wavelength_nm.len();
    OrderTable {
        layout,
        orders,
        index_above: vec![1.0; count],
        index_below: vec![0.0; count],
        transmitted: Polarised { s: vec![0.0; strengths.len()], p: vec![0.0; strengths.len()] },
        reflected: Polarised { s: strengths.clone(), p: strengths },
        error: vec![0.0; count * layout.count()],
        metadata: Default::default(),
        wavelength_nm,
    }
}

/// A compact disc from 380 to 780 nm in steps of 10 nm.
pub fn compact_disc() -> OrderTable {
    table((0..=40).map(|i| 380.0 + 10.0 * f64::from(i)).collect(), 4, strength)
}
