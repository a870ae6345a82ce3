//! Generator of uniform random numbers.

/// Generator of uniform random numbers: SplitMix64 (Steele, Lea & Flood, OOPSLA 2014).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Random(u64);

impl Random {
    /// Generator for a starting ray. Equal arguments give equal sequences.
    #[must_use]
    pub fn new(ray: u32, seed: u32) -> Self {
        Self(u64::from(ray) << 32 | u64::from(seed))
    }

    /// Next number, in [0, 1).
    #[allow(clippy::should_implement_trait, reason = "the sequence never ends")]
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}
