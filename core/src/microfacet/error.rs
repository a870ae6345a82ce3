//! Errors of finishes.

use super::limits::{LOSSES, MAX_RINGS, MAX_SECTORS, MIN_ROUGHNESS};

/// An error for which a finish or a table of facets is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FinishError {
    /// A roughness is not from [`MIN_ROUGHNESS`](MIN_ROUGHNESS) to 1.
    Roughness,
    /// A table of facets has too few or too many rings or sectors, or memory or densities of another length.
    Size,
    /// A density of normals is negative or not finite, or none is positive.
    Density,
    /// Facets have a mean slope.
    Tilt,
    /// Losses of a compensation are not from 0 to 1, or memory for them has another length.
    Losses,
}

impl core::fmt::Display for FinishError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Roughness => write!(f, "a roughness must be from {MIN_ROUGHNESS} to 1"),
            Self::Size => write!(
                f,
                "a table of facets has 1 to {MAX_RINGS} rings, 1 or 4 to {MAX_SECTORS} sectors, and a number for each node"
            ),
            Self::Density => write!(f, "densities of normals must be finite, not negative, and positive somewhere"),
            Self::Tilt => write!(f, "the facets have a mean slope; level them"),
            Self::Losses => write!(f, "energy compensation has {LOSSES} losses, each from 0 to 1"),
        }
    }
}

impl core::error::Error for FinishError {}
