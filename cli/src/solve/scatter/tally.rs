//! Sums over the starting rays of one batch, and their means and standard errors over batches.

use crate::solve::scatter::request::Scattered;
use crate::table::statistics::MeanWithError;

/// Means, or weighted sums, over the starting rays of one batch.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub reflected: f64,
    pub transmitted: f64,
    pub absorbed: f64,
    pub truncated: f64,
    pub without_interference: f64,
    pub bins: Vec<f64>,
}

impl Tally {
    /// A tally without light.
    pub(crate) fn new(bins: usize) -> Self {
        Self { bins: vec![0.0; bins], ..Self::default() }
    }

    /// Adds the numbers of a tally with equally many bins, times `weight`.
    pub(crate) fn add(&mut self, other: &Self, weight: f64) {
        let mut other = other.clone();
        self.numbers().zip(other.numbers()).for_each(|(sum, part)| *sum += weight * *part);
    }

    /// All numbers of the tally, bins last.
    fn numbers(&mut self) -> impl Iterator<Item = &mut f64> {
        let Self { reflected, transmitted, absorbed, truncated, without_interference, bins } = self;
        [reflected, transmitted, absorbed, truncated, without_interference].into_iter().chain(bins)
    }
}

/// Mean and standard error over batches.
pub(super) fn summarise<'t>(batches: impl Iterator<Item = &'t Tally> + Clone) -> Scattered {
    let over = |of: &dyn Fn(&Tally) -> f64| MeanWithError::over(batches.clone().map(of));
    let bins = batches.clone().next().map_or(0, |tally| tally.bins.len());
    Scattered {
        reflected: over(&|tally| tally.reflected),
        transmitted: over(&|tally| tally.transmitted),
        absorbed: over(&|tally| tally.absorbed),
        truncated: over(&|tally| tally.truncated),
        without_interference: over(&|tally| tally.without_interference),
        imbalance: over(&|t| 1.0 - t.reflected - t.transmitted - t.absorbed - t.truncated),
        bins: (0..bins).map(|bin| over(&|tally| tally.bins[bin])).collect(),
    }
}
