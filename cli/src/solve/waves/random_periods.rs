//! Scattering of cells whose periods differ at random: the interference between periods is gone, that within one stays.
//!
//! The mean over random phases of the periods is the pattern of a single period, of which the diffraction orders are
//! samples: the power of order m belongs to an interval λ/Λ of the direction cosine along the axis of the period
//! (Kinoshita, Yoshioka & Kawagoe 2002). Each order is therefore spread as a tent of half-width λ/(nΛ) around its
//! direction cosine, which interpolates the pattern between orders. Where a tent passes the horizon, its power goes to
//! the part above: the power of all bins is that of the orders.

use glam::DVec3;
use goniochrome::colour::{RgbSpace, xyz};
use goniochrome::table::{Periodicity, ScatterLayout};

use crate::support::direction::direction;
use crate::support::error::Result;
use crate::support::memory::filled;
use crate::table::metadata::Metadata;
use crate::table::orders::OrderTable;
use crate::table::scatter::{Energy, ScatterTable, check_scatter_size};
use crate::table::statistics::MeanWithError;

/// Points of a tent along each axis. They are its quantiles, so that each has the same power.
const POINTS: usize = 64;

/// The table of scattered light of a cell with these orders, with `weights` of XYZ for each wavelength, without
/// metadata. The error of a bin is the error bar of the orders that reach it.
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
    let (bins, pairs) = (layout.bins().count(), layout.count());
    let mut table = ScatterTable {
        layout,
        wavelength_nm: orders.wavelength_nm.clone(),
        brdf: filled(0.0, pairs * wavelengths, "the table")?,
        rgb: filled([0.0; 3], pairs, "the table")?,
        luminance_error: filled(0.0, pairs, "the table")?,
        energy: filled(Energy::default(), layout.incident_count(), "the table")?,
        metadata: Metadata::default(),
    };
    let solid_angle: Vec<f64> = (0..bins).map(|bin| layout.bins().projected_solid_angle(bin)).collect();
    for incident in 0..layout.incident_count() {
        let [theta, phi] = layout.incident(incident);
        let wi = direction(theta, phi);
        let Some(view) = lookup.view(wi.as_vec3()) else { continue };
        let error_of = |wavelength: usize| {
            let nodes = orders.layout.interpolation(wi.as_vec3());
            let error = |node: usize| f64::from(orders.error[wavelength * orders.layout.count() + node]);
            nodes.iter().map(|node| error(node.index)).fold(0.0, f64::max)
        };
        let mut luminance_error = vec![0.0; bins];
        let mut spectra = vec![0.0f64; bins * wavelengths];
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
                    let bin = relative_bin(&layout, incident, *wo);
                    spectra[wavelength * bins + bin] += power * share;
                    luminance_error[bin] += weights[wavelength][1].abs() * error * share;
                }
            }
        }
        for (bin, solid_angle) in solid_angle.iter().enumerate() {
            let of_bin = |wavelength: usize| spectra[wavelength * bins + bin] / solid_angle;
            for wavelength in 0..wavelengths {
                table.brdf[(incident * wavelengths + wavelength) * bins + bin] = of_bin(wavelength) as f32;
            }
            let rgb = space.from_xyz(xyz(weights, (0..wavelengths).map(of_bin)));
            table.rgb[incident * bins + bin] = rgb.map(|c| c as f32);
            table.luminance_error[incident * bins + bin] = (luminance_error[bin] / solid_angle) as f32;
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

/// Bin of a direction, numbered relative to the incident azimuth as in a table.
fn relative_bin(layout: &ScatterLayout, incident: usize, wo: DVec3) -> usize {
    let bins = layout.bins();
    let columns = bins.phi as usize;
    let bin = bins.index(wo);
    let first = layout.first_bin(incident % layout.phi().max(1) as usize);
    bin / columns * columns + (bin % columns + columns - first) % columns
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
