//! ρ(θ) of mirror-like surfaces: one outgoing direction for each incident one.

use super::angle_axis::AngleAxis;
use super::error::{MAX_MAGNITUDE, TableError};
use crate::values::Values;

/// Reflectance ρ(θ) of a mirror-like surface. Rows are uniform in θ from 0 to `theta_max`, ends included; values are
/// linear between rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorTable<'a> {
    values: Values<'a>,
    channels: usize,
    axis: AngleAxis,
}

impl<'a> MirrorTable<'a> {
    /// Checks a table of `values[row * channels + channel]`; `theta_max` is in radians.
    ///
    /// # Errors
    /// [`TableError::Shape`] for fewer than two rows, no channels or a last row that is not whole,
    /// [`TableError::ThetaMax`] unless `theta_max` is in (0, π/2], and [`TableError::NotFinite`] for a value that is
    /// NaN or beyond [`MAX_MAGNITUDE`].
    pub fn new(values: &'a [f32], channels: usize, theta_max: f64) -> Result<Self, TableError> {
        Self::of(Values::Numbers(values), channels, theta_max)
    }

    pub(super) fn of(values: Values<'a>, channels: usize, theta_max: f64) -> Result<Self, TableError> {
        let rows = values.len().checked_div(channels).unwrap_or(0);
        if rows * channels != values.len() {
            return Err(TableError::Shape);
        }
        let axis = AngleAxis::new(rows, theta_max)?;
        match values.first_beyond(MAX_MAGNITUDE) {
            Some(index) => Err(TableError::NotFinite { index }),
            None => Ok(Self { values, channels, axis }),
        }
    }

    /// Number of rows, each at one angle.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.axis.rows()
    }

    /// Angle of the last row, in radians.
    #[must_use]
    pub fn theta_max(&self) -> f64 {
        self.axis.theta_max()
    }

    /// Number of channels of each row.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Value of one channel at θ in radians, which is clamped to the table.
    ///
    /// # Panics
    /// Panics if the table has no such channel.
    #[must_use]
    pub fn channel(&self, theta: f32, channel: usize) -> f32 {
        assert!(channel < self.channels, "the table has {} channels", self.channels);
        let (row, w) = self.axis.locate(theta);
        self.interpolate(row, w, channel)
    }

    /// Value of a channel between `row` and the next, at the weight `w` of the latter.
    #[inline]
    fn interpolate(&self, row: usize, w: f32, channel: usize) -> f32 {
        let at = |row: usize| self.values.at(row * self.channels + channel);
        at(row) + w * (at(row + 1) - at(row))
    }

    pub(super) fn values(&self) -> Values<'a> {
        self.values
    }

    pub(super) fn axis(&self) -> AngleAxis {
        self.axis
    }

    /// First three channels at θ in radians, which is clamped to the table. A table with fewer channels repeats its
    /// last.
    #[must_use]
    #[inline]
    pub fn rgb(&self, theta: f32) -> [f32; 3] {
        let (row, w) = self.axis.locate(theta);
        if let (Values::Numbers(values), 3) = (self.values, self.channels)
            && let Some([low, high]) = values.get(3 * row..).and_then(two_rows)
        {
            return core::array::from_fn(|c| low[c] + w * (high[c] - low[c]));
        }
        let last = self.channels - 1;
        core::array::from_fn(|c| self.interpolate(row, w, c.min(last)))
    }
}

/// First two rows of an RGB table, with one check of the length.
#[inline]
fn two_rows(values: &[f32]) -> Option<[[f32; 3]; 2]> {
    let &[a, b, c, d, e, f] = values.first_chunk()?;
    Some([[a, b, c], [d, e, f]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_and_the_middle_is_their_mean() {
        let values = [0.1, 0.2, 0.3, 0.5, 0.6, 0.7];
        let table = MirrorTable::new(&values, 3, 1.0).unwrap();
        assert_eq!(table.rgb(0.0), [0.1, 0.2, 0.3]);
        let middle = table.rgb(0.5);
        for (c, got) in middle.into_iter().enumerate() {
            assert!((got - 0.5 * (values[c] + values[c + 3])).abs() < f32::EPSILON);
        }
        assert_eq!(table.rgb(1.0), [0.5, 0.6, 0.7]);
        // The fast path for RGB in memory agrees with the channels one by one.
        for theta in [-1.0, 0.0, 0.3, 0.999, 1.0, 2.0, f32::NAN] {
            let [r, g, b] = [0, 1, 2].map(|c| table.channel(theta, c));
            assert_eq!(table.rgb(theta), [r, g, b]);
        }
        assert!((table.channel(1.0, 1) - 0.6).abs() < f32::EPSILON);
    }

    #[test]
    fn angles_beyond_the_table_are_held_at_its_ends() {
        let table = MirrorTable::new(&[0.25, 0.75], 1, 0.5).unwrap();
        assert_eq!(table.rgb(-1.0), [0.25; 3]);
        assert_eq!(table.rgb(9.0), [0.75; 3]);
        assert_eq!(table.rgb(f32::NAN), [0.25; 3]);
    }

    #[test]
    fn bad_tables_are_refused() {
        assert_eq!(MirrorTable::new(&[0.5; 4], 3, 1.0), Err(TableError::Shape));
        assert_eq!(MirrorTable::new(&[0.5; 3], 3, 1.0), Err(TableError::Shape));
        assert_eq!(MirrorTable::new(&[0.5; 4], 2, 2.0), Err(TableError::ThetaMax));
        assert_eq!(MirrorTable::new(&[0.5, f32::NAN], 1, 1.0), Err(TableError::NotFinite { index: 1 }));
        assert_eq!(MirrorTable::new(&[-2.0 * MAX_MAGNITUDE, 0.5], 1, 1.0), Err(TableError::NotFinite { index: 0 }));
    }
}
