//! Sums over the starting rays of one incident direction.

use goniochrome::geometry::side::Side;
use goniochrome::measure::bins::{Histogram, MAX_LANES};
use goniochrome::simd::lanes::Lanes;

use crate::solve::scatter::Unseen;
use crate::table::scatter::Energy;
use crate::table::statistics::MeanWithError;

/// Sums of one incident direction over its starting rays, which come in pairs of neighbouring strata.
///
/// A sum over one ray of each stratum has the variance Σ σ². The squared difference of a pair of rays has at least the
/// sum of both variances as its mean, so that the sum of squared differences over all pairs is an estimate of the
/// variance that does not fall short of it (collapsed strata; Cochran, "Sampling Techniques", 1977, section 5A.12).
pub(super) struct DirectionSums {
    /// Number of half-vector angles, if each has one place whatever the azimuth.
    columns: Option<usize>,
    /// Power as `[place][wavelength]`.
    power: Vec<f64>,
    wavelengths: usize,
    /// Sums of squared differences of luminance at each place.
    squares: Vec<f64>,
    /// Differences of the present pair.
    difference: Vec<f64>,
    /// Places of the present pair.
    touched: Vec<usize>,
    totals: Totals,
    pair: Totals,
    square_reflected: f64,
    square_imbalance: f64,
    rays: u64,
}

/// Luminance of one ray or of all.
#[derive(Clone, Copy, Default)]
pub(super) struct Totals {
    pub reflected: f64,
    pub transmitted: f64,
    pub absorbed: f64,
    pub truncated: f64,
    pub without_interference: f64,
}

impl Totals {
    fn add(&mut self, other: &Self, sign: f64) {
        self.reflected += sign * other.reflected;
        self.transmitted += sign * other.transmitted;
        self.absorbed += sign * other.absorbed;
        self.truncated += sign * other.truncated;
        self.without_interference += sign * other.without_interference;
    }

    fn seen(&self) -> f64 {
        self.reflected + self.transmitted + self.absorbed + self.truncated
    }
}

impl DirectionSums {
    /// Sums without light. With `level_columns`, the light comes along the normal in a table that counts azimuths from
    /// it: so many half-vector angles then have one place each, whatever the azimuth.
    pub fn new(wavelengths: usize, places: usize, level_columns: Option<usize>) -> Self {
        Self {
            columns: level_columns,
            power: vec![0.0; wavelengths * places],
            wavelengths,
            squares: vec![0.0; places],
            difference: vec![0.0; places],
            touched: Vec::new(),
            totals: Totals::default(),
            pair: Totals::default(),
            square_reflected: 0.0,
            square_imbalance: 0.0,
            rays: 0,
        }
    }

    /// Receiver of the light of one ray at the wavelengths from `first` on, which have these weights of luminance.
    pub fn ray<'s>(&'s mut self, second: bool, first: usize, weights: &'s [[f64; 3]], nodes: usize) -> RaySums<'s> {
        let sign = if second { -1.0 } else { 1.0 };
        RaySums { sums: self, sign, first, weights, nodes, seen: Totals::default() }
    }

    /// Ends a pair of rays.
    pub fn end_pair(&mut self) {
        for place in self.touched.drain(..) {
            let difference = std::mem::take(&mut self.difference[place]);
            self.squares[place] += difference * difference;
        }
        let pair = std::mem::take(&mut self.pair);
        self.square_reflected += pair.reflected * pair.reflected;
        self.square_imbalance += pair.seen() * pair.seen();
        self.rays += 2;
    }

    /// Power at each place at one wavelength.
    pub fn powers(&self, wavelength: usize) -> impl Iterator<Item = f64> {
        self.power.iter().skip(wavelength).step_by(self.wavelengths).copied()
    }

    /// Number of starting rays.
    pub fn rays(&self) -> u64 {
        self.rays
    }

    /// Standard error of the mean of the luminance at a place.
    pub fn error(&self, place: usize) -> f64 {
        self.squares[place].sqrt() / self.rays as f64
    }

    /// The energy balance of light of this luminance.
    pub fn energy(&self, whole: f64) -> Energy {
        let per_ray = 1.0 / self.rays as f64;
        let Totals { reflected, transmitted, absorbed, truncated, without_interference } = self.totals;
        let mean = |sum: f64, square: f64| MeanWithError { value: sum * per_ray, std_error: square.sqrt() * per_ray };
        Energy {
            reflected: mean(reflected, self.square_reflected),
            transmitted: transmitted * per_ray,
            absorbed: absorbed * per_ray,
            truncated: truncated * per_ray,
            imbalance: mean(whole * self.rays as f64 - self.totals.seen(), self.square_imbalance),
            without_interference: without_interference * per_ray,
            rays: self.rays,
        }
    }
}

/// Receiver of the light of one ray at one group of wavelengths; lanes beyond the last wavelength repeat it and are not
/// counted.
pub(super) struct RaySums<'s> {
    sums: &'s mut DirectionSums,
    sign: f64,
    first: usize,
    weights: &'s [[f64; 3]],
    nodes: usize,
    seen: Totals,
}

/// Luminance of powers at wavelengths of these weights.
fn luminance(weights: &[[f64; 3]], powers: &[f64]) -> f64 {
    weights.iter().zip(powers).map(|(weight, power)| weight[1] * power).sum()
}

impl RaySums<'_> {
    fn luminance<V: Lanes>(&self, powers: V) -> f64 {
        let mut numbers = [0.0; MAX_LANES];
        powers.store(&mut numbers);
        luminance(self.weights, &numbers)
    }

    /// Adds what left otherwise than as light of the histogram, and ends the ray at this group.
    pub fn end<V: Lanes>(mut self, unseen: &Unseen<V>) {
        self.seen.absorbed = self.luminance(unseen.absorbed);
        self.seen.truncated = self.luminance(unseen.truncated);
        self.seen.without_interference = self.luminance(unseen.without_interference);
        self.sums.totals.add(&self.seen, 1.0);
        self.sums.pair.add(&self.seen, self.sign);
    }
}

impl Histogram for RaySums<'_> {
    fn add(&mut self, lane: usize, side: Side, bin: usize, power: f64) {
        self.add_lanes(lane, side, bin, &[power]);
    }

    fn add_lanes(&mut self, lane: usize, side: Side, bin: usize, powers: &[f64]) {
        let weights = self.weights.get(lane..).unwrap_or(&[]);
        if weights.is_empty() {
            return;
        }
        let luminance = luminance(weights, powers);
        if side == Side::Below {
            self.seen.transmitted += luminance;
            return;
        }
        self.seen.reflected += luminance;
        let place = match self.sums.columns {
            Some(columns) if bin < self.nodes => bin % columns,
            _ => bin,
        };
        let sums = &mut self.sums.power[place * self.sums.wavelengths + self.first + lane..][..weights.len()];
        sums.iter_mut().zip(powers).for_each(|(sum, power)| *sum += power);
        self.sums.difference[place] += self.sign * luminance;
        self.sums.touched.push(place);
    }
}
