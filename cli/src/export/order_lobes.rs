//! Diffraction orders of a stated width: a lobe around the exact direction of each order.

use glam::{DVec2, DVec3};
use goniochrome::colour::Quadrature;
use goniochrome::table::Periodicity;

use super::gaussian::Gaussian;
use crate::colour::{visible_weights, xyz_to_rgb};
use crate::support::error::Result;
use crate::table::mirror::neighbours;
use crate::table::orders::{LookupArrays, OrderTable};

/// Largest distance of neighbouring wavelengths of a colour, as an angle along the streak near the normal, in units of
/// σ. A sum of Gaussians half a σ apart is smooth to 1e-30.
const SPACING: f64 = 0.5;
/// Largest number of wavelengths of a colour.
const MAX_WAVELENGTHS: f64 = 2000.0;

/// A BRDF of diffraction orders, each with a lobe of one width.
#[derive(Clone, Debug)]
pub struct OrderLobes {
    arrays: LookupArrays,
    gaussian: Gaussian,
    periodicity: Periodicity,
    /// Tangential component that each order adds for each nanometre of the wavelength in the medium above.
    gratings: Vec<DVec2>,
    /// Wavelengths whose orders are added up, and what a reflectance of 1 there adds to the channels.
    samples: Vec<(usize, f32, Addition)>,
    channels: usize,
    /// Whether negative sums of colours are 0.
    clipped: bool,
}

/// What a reflectance of 1 at a wavelength adds to the channels.
#[derive(Clone, Copy, Debug)]
enum Addition {
    /// 1 to one channel.
    Channel(usize),
    /// Linear RGB.
    Colour([f64; 3]),
}

impl Addition {
    fn add(self, value: f64, channels: &mut [f64]) {
        match self {
            Self::Channel(channel) => channels[channel] += value,
            Self::Colour(rgb) => channels.iter_mut().zip(rgb).for_each(|(channel, c)| *channel += c * value),
        }
    }
}

/// Lobe of an order at a wavelength, for light from one direction.
#[derive(Clone, Copy, Debug)]
struct Lobe {
    direction: DVec3,
    /// f cos θ_o in the lobe's direction.
    peak: f64,
    efficiency: f64,
    addition: Addition,
}

/// Lobes of all orders for light from one direction.
#[derive(Clone, Debug, Default)]
pub struct LobesAt {
    wi: Option<DVec3>,
    /// Lobes of each order.
    orders: Vec<Vec<Lobe>>,
}

impl OrderLobes {
    /// The BRDF of a table, with a standard deviation in radians, in a channel for each wavelength or in RGB.
    ///
    /// # Errors
    /// RGB of a table without a visible wavelength.
    pub fn new(table: &OrderTable, spread: f64, rgb: bool) -> Result<Self> {
        let [x, y] = table.layout.period_nm().map(f64::from);
        let gratings: Vec<_> =
            table.orders.iter().map(|[m, n]| DVec2::new(f64::from(*m) / x, f64::from(*n) / y)).collect();
        let known = &table.wavelength_nm;
        let (samples, channels) = if rgb {
            let shortest = known.iter().zip(&table.index_above).map(|(nm, n)| nm / n).fold(f64::INFINITY, f64::min);
            let steepest =
                gratings.iter().map(|g| g.length()).filter(|g| g * shortest < 2.0).fold(0.0, f64::max).max(1e-9);
            let nm = fine(known, SPACING * spread / steepest);
            let matrix = xyz_to_rgb(table.metadata.space());
            let weights = visible_weights(&nm, table.metadata.illuminant(), Quadrature::Interpolated)?;
            let sample = |(nm, weight): (&f64, [f64; 3])| {
                let (below, _, t) = neighbours(known, *nm);
                (below, t as f32, Addition::Colour((matrix * DVec3::from_array(weight)).to_array()))
            };
            (nm.iter().zip(weights).map(sample).collect(), 3)
        } else {
            ((0..known.len()).map(|w| (w, 0.0, Addition::Channel(w))).collect(), known.len())
        };
        let arrays = table.arrays(vec![[0.0; 3]; known.len()]);
        arrays.table()?;
        Ok(Self {
            arrays,
            gaussian: Gaussian { spread },
            periodicity: table.layout.periodicity(),
            gratings,
            samples,
            channels,
            clipped: false,
        })
    }

    /// Makes negative components of f, of colours out of gamut, 0.
    pub(super) fn clip(&mut self) {
        self.clipped = true;
    }

    /// Standard deviation σ of a lobe, in radians.
    #[must_use]
    pub fn spread(&self) -> f64 {
        self.gaussian.spread
    }

    /// Axes along which the surface repeats.
    #[must_use]
    pub fn periodicity(&self) -> Periodicity {
        self.periodicity
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Computes the lobes for light from `wi`, unless `at` has them already.
    fn prepare(&self, wi: DVec3, at: &mut LobesAt) {
        if at.wi == Some(wi) {
            return;
        }
        at.wi = Some(wi);
        at.orders.clear();
        // The arrays were checked when they were made.
        let view = self.arrays.table().ok().and_then(|table| table.view(wi.as_vec3()));
        for order in 0..self.gratings.len() {
            let lobe = |&(wavelength, t, addition): &(usize, f32, Addition)| {
                let light = view.as_ref()?.light_between(wavelength, t, order)?;
                let direction = light.direction.as_dvec3().normalize();
                let efficiency = f64::from(light.efficiency);
                (efficiency > 0.0).then_some(Lobe {
                    direction,
                    peak: efficiency * self.gaussian.peak(direction),
                    efficiency,
                    addition,
                })
            };
            at.orders.push(self.samples.iter().filter_map(lobe).collect());
        }
    }

    /// f cos θ_o in each channel, for light from `wi` above the horizon. Below the horizon, the lobes go on.
    pub fn projected(&self, wi: DVec3, wo: DVec3, at: &mut LobesAt, out: &mut [f64]) {
        self.prepare(wi, at);
        out.fill(0.0);
        let reach = self.gaussian.reach();
        let offset = wo.truncate() + wi.truncate();
        for (grating, lobes) in self.gratings.iter().zip(&at.orders) {
            // Tangential components differ by no more than the angle.
            if offset.perp_dot(*grating).abs() > reach * grating.length() {
                continue;
            }
            for lobe in lobes {
                let share = self.gaussian.at(lobe.direction.dot(wo));
                if share > 0.0 {
                    lobe.addition.add(lobe.peak * share, out);
                }
            }
        }
        if self.clipped {
            out.iter_mut().for_each(|value| *value = value.max(0.0));
        }
    }

    /// ∫ f cos θ_o dω_o in each channel.
    pub fn albedo(&self, wi: DVec3, at: &mut LobesAt) -> Vec<f64> {
        self.prepare(wi, at);
        let mut total = vec![0.0; self.channels];
        at.orders.iter().flatten().for_each(|lobe| lobe.addition.add(lobe.efficiency, &mut total));
        total
    }
}

/// The known wavelengths, and evenly spaced ones between them at most `step_nm` apart.
fn fine(known: &[f64], step_nm: f64) -> Vec<f64> {
    let range = known.last().zip(known.first()).map_or(0.0, |(last, first)| last - first);
    let step_nm = step_nm.max(range / MAX_WAVELENGTHS);
    let between = known.windows(2).flat_map(|pair| {
        let steps = ((pair[1] - pair[0]) / step_nm).ceil().max(1.0);
        (0..steps as u32).map(move |i| pair[0] + f64::from(i) / steps * (pair[1] - pair[0]))
    });
    between.chain(known.last().copied()).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::support::direction::direction;
    use crate::table::orders::tests::sample;

    /// Error of the midpoint rule, of the planar share of a lobe above the horizon, and of its fit.
    const INTEGRAL: f64 = 2e-3;

    #[test]
    fn lobes_keep_the_energy_of_their_orders() {
        let lobes = OrderLobes::new(&sample(), 4.0_f64.to_radians(), false).unwrap();
        let (rows, columns) = (360, 720);
        for (theta, phi) in [(0.0, 0.0), (0.6, 0.4), (1.2, 2.0)] {
            let (wi, mut at) = (direction(theta, phi), LobesAt::default());
            let albedo = lobes.albedo(wi, &mut at);
            let (mut total, mut values) = ([0.0; 2], [0.0; 2]);
            for row in 0..rows {
                let theta = 0.25 * TAU * (f64::from(row) + 0.5) / f64::from(rows);
                let solid_angle = 0.25 * TAU * TAU * theta.sin() / f64::from(rows * columns);
                for column in 0..columns {
                    let wo = direction(theta, TAU * f64::from(column) / f64::from(columns));
                    lobes.projected(wi, wo, &mut at, &mut values);
                    total = [0, 1].map(|c: usize| total[c] + values[c] * solid_angle);
                }
            }
            for (found, expected) in total.into_iter().zip(&albedo) {
                assert!((found / expected - 1.0).abs() < INTEGRAL, "{theta}, {phi}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn a_colour_has_the_table_s_albedo() {
        // Near one another: between wavelengths strengths are linear, efficiencies are not.
        let mut table = sample();
        table.wavelength_nm = vec![545.0, 560.0];
        let lobes = OrderLobes::new(&table, 2.0_f64.to_radians(), true).unwrap();
        let wi = direction(0.3, 0.2);
        let rgb = lobes.albedo(wi, &mut LobesAt::default());
        let arrays = table.arrays(vec![[0.0; 3]; 2]);
        let view = arrays.table().unwrap().view(wi.as_vec3()).unwrap();
        let weights = visible_weights(&table.wavelength_nm, table.metadata.illuminant(), Quadrature::Interpolated);
        let xyz = goniochrome::colour::xyz(&weights.unwrap(), [0, 1].map(|w| f64::from(view.albedo(w))));
        let expected = (xyz_to_rgb(table.metadata.space()) * DVec3::from_array(xyz)).to_array();
        for (found, expected) in rgb.into_iter().zip(expected) {
            assert!((found - expected).abs() < 0.02, "{found} for {expected}");
        }
    }
}
