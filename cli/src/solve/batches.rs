//! Independently scrambled batches of starting rays: their spread gives the standard error of a mean.

/// The number of batches over which the standard error is taken.
pub const BATCHES: u32 = 32;

/// Starting rays of each batch, at least one, for so many rays in all.
pub(crate) fn rays_per_batch(rays: u32) -> u32 {
    (rays / BATCHES).max(1)
}

/// The scrambled Sobol sequence of a batch.
pub(crate) fn sequence(seed: u32, batch: u32) -> u32 {
    seed.wrapping_mul(BATCHES).wrapping_add(batch)
}
