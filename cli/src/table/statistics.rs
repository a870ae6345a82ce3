//! Means and their standard errors.

/// Mean over independent batches of starting rays, with its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanWithError {
    /// Mean.
    pub value: f64,
    /// Standard error of the mean.
    pub std_error: f64,
}

impl MeanWithError {
    /// Mean of independent values, at least two, with its standard error.
    #[must_use]
    pub fn over(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let value = values.clone().sum::<f64>() / count;
        let variance = values.map(|x| (x - value) * (x - value)).sum::<f64>() / (count - 1.0);
        Self { value, std_error: (variance / count).sqrt() }
    }

    /// Estimate of |F|² from `count` batches whose mean F̄ has the square `value`.
    ///
    /// The mean of |F|² − |F̄|² over batches, `mean_excess`, is the variance of a batch; divided by `count` − 1 it is
    /// the variance of F̄. |F̄|² exceeds |F|² by that variance on average, so it is subtracted. The error follows from
    /// δ|F|² = 2|F| δF + δF², with δF the standard error of the mean.
    #[must_use]
    pub fn of_square(value: f64, mean_excess: f64, count: f64) -> Self {
        let variance = mean_excess.max(0.0) / (count - 1.0);
        Self { value: value - variance, std_error: 2.0 * (value * variance).sqrt() + variance }
    }
}
