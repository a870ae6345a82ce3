//! CIE illuminants: relative power by wavelength.

/// Spectrum of the light that falls on the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Illuminant {
    /// CIE standard illuminant D65: daylight of 6504 K.
    #[default]
    D65,
    /// CIE illuminant E: equal energy at every wavelength. The paper uses it.
    E,
}

impl Illuminant {
    /// Relative power at a whole wavelength in [`VISIBLE_NM`](super::VISIBLE_NM), in nanometres.
    pub(super) fn power(self, nm: u16) -> f64 {
        match self {
            Self::E => 1.0,
            Self::D65 => {
                let from_first = usize::from(nm) - D65_FIRST_NM;
                let (i, remainder) = (from_first / D65_STEP_NM, from_first % D65_STEP_NM);
                let at = |i: usize| D65.get(i.min(D65.len() - 1)).copied().unwrap_or(0.0);
                at(i) + (at(i + 1) - at(i)) * remainder as f64 / D65_STEP_NM as f64
            }
        }
    }
}

/// First wavelength of [`D65`], in nanometres.
const D65_FIRST_NM: usize = 300;
/// Step between wavelengths of [`D65`], in nanometres.
const D65_STEP_NM: usize = 5;

/// Relative spectral power of CIE standard illuminant D65 (CIE 015:2018).
#[rustfmt::skip]
const D65: [f64; 107] = [
    0.0341, 1.6643, 3.2945, 11.7652, 20.236, 28.6447, 37.0535, 38.5011,
    39.9488, 42.4302, 44.9117, 45.775, 46.6383, 49.3637, 52.0891, 51.0323,
    49.9755, 52.3118, 54.6482, 68.7015, 82.7549, 87.1204, 91.486, 92.4589,
    93.4318, 90.057, 86.6823, 95.7736, 104.865, 110.936, 117.008, 117.41,
    117.812, 116.336, 114.861, 115.392, 115.923, 112.367, 108.811, 109.082,
    109.354, 108.578, 107.802, 106.296, 104.79, 106.239, 107.689, 106.047,
    104.405, 104.225, 104.046, 102.023, 100.0, 98.1671, 96.3342, 96.0611,
    95.788, 92.2368, 88.6856, 89.3459, 90.0062, 89.8026, 89.5991, 88.6489,
    87.6987, 85.4936, 83.2886, 83.4939, 83.6992, 81.863, 80.0268, 80.1207,
    80.2146, 81.2462, 82.2778, 80.281, 78.2842, 74.0027, 69.7213, 70.6652,
    71.6091, 72.979, 74.349, 67.9765, 61.604, 65.7448, 69.8856, 72.4863,
    75.087, 69.3398, 63.5927, 55.0054, 46.4182, 56.6118, 66.8054, 65.0941,
    63.3828, 63.3828, 63.3828, 63.3828, 63.3828, 63.3828, 63.3828, 63.3828,
    63.3828, 63.3828, 63.3828,
];
