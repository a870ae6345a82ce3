//! Exposure and tone mapping: from scene-linear radiance to the range of a screen.

use crate::colour::LUMINANCE_F32;

/// A curve that brings bright light into the range of a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ToneMap {
    /// No curve: colours out of range are desaturated, then scaled, as in every picture of this program.
    #[default]
    None,
    /// Reinhard's curve on luminance, L (1 + L/16)/(1 + L): radiance 4 becomes white.
    Reinhard,
    /// A film-like curve for each of R, G and B (Narkowicz's fit of ACES): highlights bleach.
    Filmic,
}

impl ToneMap {
    /// The tone-mapped colour, for the screen's transfer function to encode.
    #[must_use]
    pub fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::None => rgb,
            Self::Reinhard => {
                let [r, g, b] = std::array::from_fn(|c| LUMINANCE_F32[c] * rgb[c]);
                let luminance = (r + g + b).max(0.0);
                let scale = (1.0 + luminance / 16.0) / (1.0 + luminance);
                rgb.map(|c| c * scale)
            }
            Self::Filmic => rgb.map(|c| {
                let x = c.max(0.0);
                (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)).min(1.0)
            }),
        }
    }
}

/// The factor of an exposure in stops.
#[must_use]
pub fn exposure(stops: f64) -> f32 {
    stops.exp2() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_from_black_to_white() {
        for map in [ToneMap::None, ToneMap::Reinhard, ToneMap::Filmic] {
            let shown: Vec<f32> = (0..=400).map(|i| map.apply([0.01 * i as f32; 3])[1]).collect();
            assert!(shown[0].abs() < 1e-6 && shown.is_sorted(), "{map:?}");
        }
        assert!((ToneMap::Reinhard.apply([4.0; 3])[0] - 1.0).abs() < 1e-6);
        assert!(ToneMap::Filmic.apply([1e6; 3])[0] <= 1.0);
        assert!((exposure(-1.0) - 0.5).abs() < 1e-9);
    }
}
