//! Random profiles and directions, from fixed seeds.

use goniochrome_waves::Complex64;
use goniochrome_waves::profile::{Profile, Slice};

/// Generator of pseudo-random numbers (SplitMix64: Steele, Lea, Flood 2014).
pub struct Random(pub u64);

impl Random {
    /// Uniform number in [from, to).
    pub fn within(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        from + (to - from) * (z >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        self.within(0.0, count as f64) as usize
    }

    /// Tangential wavevector in air of a direction at most `most_deg` from the normal.
    pub fn tangential(&mut self, most_deg: f64) -> [f64; 2] {
        let (sin_phi, cos_phi) = self.within(0.0, std::f64::consts::TAU).sin_cos();
        let sin_theta = self.within(0.0, most_deg).to_radians().sin();
        [sin_theta * cos_phi, sin_theta * sin_phi]
    }
}

/// Kind of media of a random profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Media {
    /// Real indices from 1.3 to 2.5.
    Lossless,
    /// Indices from 1.3 to 4 with k from 0.001 to 0.5.
    Absorbing,
    /// Metals: n from 0.05 to 1.5, k from 2 to 7.
    Metal,
}

impl Media {
    /// Index of a medium of this kind.
    pub fn index(self, random: &mut Random) -> Complex64 {
        match self {
            Self::Lossless => Complex64::from(random.within(1.3, 2.5)),
            Self::Absorbing => Complex64::new(random.within(1.3, 4.0), random.within(0.001, 0.5)),
            Self::Metal => Complex64::new(random.within(0.05, 1.5), random.within(2.0, 7.0)),
        }
    }
}

/// Bodies of one or two media in air, in one to three slices on a substrate of the first.
pub fn profile(random: &mut Random, media: Media) -> Profile {
    let period_nm = random.within(200.0, 1500.0);
    let below = media.index(random);
    let body = [below, media.index(random)];
    let slices = (0..=random.below(3)).map(|_| {
        let bars = 1 + random.below(2);
        let mut edges_nm: Vec<f64> = (0..2 * bars).map(|_| random.within(0.0, period_nm)).collect();
        edges_nm.sort_by(f64::total_cmp);
        let eta = (0..2 * bars).map(|i| if i % 2 == 0 { body[random.below(2)] } else { Complex64::ONE }).collect();
        Slice { thickness_nm: random.within(20.0, 200.0), edges_nm, eta }
    });
    let slices = slices.collect();
    Profile { period_nm, above: 1.0, below, slices }
}
