//! Limits of finishes.

/// Smallest roughness: lobes of a tenth of a degree, below which single precision loses the half vector.
pub const MIN_ROUGHNESS: f32 = 1e-3;

/// Maximum number of rings of a [`FacetTable`](super::FacetTable).
pub const MAX_RINGS: usize = 1024;

/// Maximum number of sectors of a [`FacetTable`](super::FacetTable).
pub const MAX_SECTORS: usize = 128;
