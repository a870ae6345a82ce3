//! Random numbers of a generated surface.

use goniochrome::trace::random::Random;

use crate::scene::toml_value::TomlTable;
use crate::support::error::Result;

/// Sequence of random numbers of a surface; every seed, 0 too, gives a good one.
pub(super) struct RandomSequence(Random);

impl RandomSequence {
    /// The sequence of a surface's optional key `seed`, 0 where it is left out.
    pub fn read(table: &TomlTable<'_>) -> Result<Self> {
        let seed = table.get("seed").map_or(Ok(0), |item| item.count(u32::MAX))?;
        Ok(Self(Random::new(0, seed)))
    }

    /// The next number, uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.next()
    }

    /// The next number, uniform in [min, max).
    pub fn between(&mut self, min: f64, max: f64) -> f64 {
        min + (max - min) * self.unit()
    }

    /// The next number, normally distributed, of mean 0 and variance 1 (Box and Muller, 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }
}
