//! Means and their standard errors.

/// A mean over independent batches of starting rays, and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanWithError {
    /// The mean.
    pub value: f64,
    /// Its standard error.
    pub std_error: f64,
}

impl MeanWithError {
    /// The mean of independent values, at least two, and its standard error.
    #[must_use]
    pub fn over(values: impl Iterator<Item = f64> + Clone) -> Self {
        let count = values.clone().count() as f64;
        let value = values.clone().sum::<f64>() / count;
        let variance = values.map(|x| (x - value) * (x - value)).sum::<f64>() / (count - 1.0);
        Self { value, std_error: (variance / count).sqrt() }
    }

    /// |F|² from `count` batches whose mean F̄ has the square `value`. |F|² of a batch exceeds |F̄|² by its own variance, so the
    /// mean excess over batches tells that variance; a share of it is in |F̄|² too and is taken off. The error follows
    /// from δ|F|² = 2|F| δF + δF², with δF the standard error of the mean.
    #[must_use]
    pub fn of_square(value: f64, mean_excess: f64, count: f64) -> Self {
        let variance = mean_excess.max(0.0) / (count - 1.0);
        Self { value: value - variance, std_error: 2.0 * (value * variance).sqrt() + variance }
    }
}
