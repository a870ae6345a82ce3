//! The angles of the rows of mirror-like tables.

use super::error::TableError;
use core::f64::consts::FRAC_PI_2;

/// Angles θ of the rows of a mirror-like table: uniform from 0 to the largest, ends included, at least two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AngleAxis {
    rows: usize,
    theta_max: f64,
    rows_per_radian: f32,
}

impl AngleAxis {
    /// Axis of so many rows up to `theta_max` in radians.
    ///
    /// # Errors
    /// [`TableError::Shape`] for fewer than two rows, [`TableError::ThetaMax`] unless `theta_max` is in (0, π/2].
    pub fn new(rows: usize, theta_max: f64) -> Result<Self, TableError> {
        if rows < 2 {
            return Err(TableError::Shape);
        }
        if !(theta_max > 0.0 && theta_max <= FRAC_PI_2) {
            return Err(TableError::ThetaMax);
        }
        Ok(Self { rows, theta_max, rows_per_radian: ((rows - 1) as f64 / theta_max) as f32 })
    }

    /// Number of rows.
    pub fn rows(self) -> usize {
        self.rows
    }

    /// Angle of the last row, in radians.
    pub fn theta_max(self) -> f64 {
        self.theta_max
    }

    /// Row before θ, and the position of θ between it and the next row, in [0, 1]. θ is clamped to the axis; NaN
    /// counts as 0.
    #[inline]
    pub fn locate(self, theta: f32) -> (usize, f32) {
        let last = self.rows.saturating_sub(2);
        let row = (theta * self.rows_per_radian).max(0.0);
        // Through 32 bits, which one instruction converts; no table has more rows.
        let below = (row as u32 as usize).min(last);
        (below, (row - below as f32).clamp(0.0, 1.0))
    }
}
