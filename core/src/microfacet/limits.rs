//! Limits of finishes.

/// Smallest roughness: lobes of a tenth of a degree, below which single precision loses the half vector.
pub const MIN_ROUGHNESS: f32 = 1e-3;

/// Maximum number of rings of a [`FacetTable`](super::FacetTable).
pub const MAX_RINGS: usize = 1024;

/// Maximum number of sectors of a [`FacetTable`](super::FacetTable).
pub const MAX_SECTORS: usize = 128;

/// Number of losses of a [`Compensation`](super::Compensation): linear interpolation between them errs by at most 2e-4
/// for roughnesses from 0.05 to 1.
pub(super) const LOSSES: usize = 129;
