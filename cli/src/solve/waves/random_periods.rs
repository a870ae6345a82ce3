//! Scattering of cells whose periods differ at random: the interference between periods is gone, that within one stays.
//!
//! The mean over random phases of the periods is the pattern of a single period, of which the diffraction orders are
//! samples: the power of order m belongs to an interval λ/Λ of the direction cosine along the axis of the period
//! (Kinoshita, Yoshioka & Kawagoe 2002). Each order is therefore spread as a tent of half-width λ/(nΛ) around its
//! direction cosine, which interpolates the pattern between orders. Where a tent passes the horizon, its power goes to
//! the part above: the power of all bins is that of the orders.

use glam::DVec3;
use goniochrome::colour::{RgbSpace, xyz};
use goniochrome::measure::bins::DirectionGrid;
use goniochrome::table::{HalfVectorGrid, HalfVectorWarp, Periodicity, ScatterLayout};

use crate::solve::cell_table::NodeAreas;

use crate::support::direction::direction;
use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::metadata::Metadata;
use crate::table::orders::OrderTable;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size, warp_pairs};
use crate::table::statistics::MeanWithError;

/// Points of a tent along each axis. They are its quantiles, so that each has the same power.
const POINTS: usize = 64;

/// The table of scattered light of a cell with these orders, with `weights` of XYZ for each wavelength, without
/// metadata. The error of a node is the error bar of the orders that reach it.
///
/// # Errors
/// A table that is too large for memory.
pub fn scattered(
    orders: &OrderTable,
    layout: ScatterLayout,
    weights: &[[f64; 3]],
    space: RgbSpace,
) -> Result<ScatterTable> {
    let wavelengths = orders.wavelength_nm.len();
    check_scatter_size(&layout, wavelengths)?;
    let arrays = orders.arrays(weights.iter().map(|&xyz| space.from_xyz(xyz)));
    let lookup = arrays.table()?;
    let (places, count) = (layout.places(), layout.count());
    let warp = densities(orders);
    let [pairs_u, pairs_v] = warp_pairs(&warp)?;
    let half_vectors = HalfVectorWarp::from_pairs(&pairs_u, &pairs_v).map_err(Error::failed)?;
    let mut table = ScatterTable {
        layout,
        warp,
        lobes: Vec::new(),
        wavelength_nm: orders.wavelength_nm.clone(),
        values: filled(0.0, count * wavelengths, "the table")?,
        rgb: filled([0.0; 3], count, "the table")?,
        luminance_error: filled(0.0, count, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: Metadata::default(),
    };
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        let wi = direction(theta, phi);
        let Some(view) = lookup.view(wi.as_vec3()) else { continue };
        let grid = HalfVectorGrid::new(layout, half_vectors, wi, &[]);
        let error_of = |wavelength: usize| {
            let nodes = orders.layout.interpolation(wi.as_vec3());
            let error = |node: usize| f64::from(orders.error[wavelength * orders.layout.count() + node]);
            nodes.iter().map(|node| error(node.index)).fold(0.0, f64::max)
        };
        let values = &mut table.values[incident * places * wavelengths..][..places * wavelengths];
        let luminance_error = &mut table.luminance_error[incident * places..][..places];
        let (mut reflected, mut reflected_error) = (0.0, 0.0);
        for (wavelength, &nm) in orders.wavelength_nm.iter().enumerate() {
            let spread = Spread::new(orders, wavelength, nm);
            let error = error_of(wavelength);
            for order in 0..orders.orders.len() {
                let Some(light) = view.light(wavelength, order) else { continue };
                let per_point = spread.points(light.direction.as_dvec3());
                let share = 1.0 / per_point.len() as f64;
                let power = f64::from(light.efficiency);
                reflected += weights[wavelength][1] * power;
                reflected_error += weights[wavelength][1].abs() * error;
                for wo in &per_point {
                    let place = grid.index(*wo);
                    values[wavelength * places + place] += (power * share) as f32;
                    luminance_error[place] += (weights[wavelength][1].abs() * error * share) as f32;
                }
            }
        }
        let areas = NodeAreas::new(&layout, &half_vectors, incident);
        values.chunks_mut(places).chain([luminance_error]).for_each(|powers| areas.divide(powers));
        for place in 0..places {
            let spectrum = (0..wavelengths).map(|w| f64::from(values[w * places + place]));
            table.rgb[incident * places + place] = space.from_xyz(xyz(weights, spectrum)).map(|c| c as f32);
        }
        // What is not reflected is absorbed or transmitted: together the rest.
        table.energy[incident] = Energy {
            reflected: MeanWithError { value: reflected, std_error: reflected_error },
            absorbed: 1.0 - reflected,
            ..Energy::default()
        };
    }
    Ok(table)
}

/// Intervals of the densities of the warp.
const INTERVALS: usize = 32;
/// Density of half vectors along lines' grating vector over that elsewhere.
const ALONG: f32 = 8.0;

/// Densities of the warp: even over u; over v close to the azimuths of the grating vector of lines, where the half
/// vectors of all orders lie.
fn densities(orders: &OrderTable) -> [Vec<f32>; 2] {
    let quarter = INTERVALS / 4;
    let first = match orders.layout.periodicity() {
        Periodicity::X => 0,
        Periodicity::Y => quarter,
        Periodicity::Both => return [vec![1.0; 2], vec![1.0; 2]],
    };
    let along = |knot: usize| (knot + 2 * quarter - first).is_multiple_of(2 * quarter);
    [vec![1.0; 2], (0..=INTERVALS).map(|knot| if along(knot) { ALONG } else { 1.0 }).collect()]
}

/// Spread of the orders of one wavelength.
struct Spread {
    /// Half-widths of the tents along x and y, in direction cosines; 0 along an axis without periods.
    half_width: [f64; 2],
}

impl Spread {
    fn new(orders: &OrderTable, wavelength: usize, nm: f64) -> Self {
        let [x, y] = orders.layout.period_nm().map(f64::from);
        let step = |period: f64| nm / (orders.index_above[wavelength] * period);
        let half_width = match orders.layout.periodicity() {
            Periodicity::X => [step(x), 0.0],
            Periodicity::Y => [0.0, step(y)],
            Periodicity::Both => [step(x), step(y)],
        };
        Self { half_width }
    }

    /// Directions above the horizon that share the power of an order equally.
    fn points(&self, direction: DVec3) -> Vec<DVec3> {
        let offsets = |half_width: f64| -> Vec<f64> {
            if half_width == 0.0 {
                return vec![0.0];
            }
            (0..POINTS).map(|i| half_width * tent_quantile((i as f64 + 0.5) / POINTS as f64)).collect()
        };
        let across = offsets(self.half_width[1]);
        let mut points = Vec::new();
        for dx in offsets(self.half_width[0]) {
            for dy in &across {
                let (x, y) = (direction.x + dx, direction.y + dy);
                let up = 1.0 - x * x - y * y;
                if up > 0.0 {
                    points.push(DVec3::new(x, y, up.sqrt()));
                }
            }
        }
        if points.is_empty() { vec![direction] } else { points }
    }
}

/// Quantile of the tent 1 − |t| over [−1, 1].
fn tent_quantile(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}
