//! RGB colour spaces.

/// RGB colour space with linear components. White D65 is XYZ = (0.95047, 1, 1.08883).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RgbSpace {
    /// sRGB: IEC 61966-2-1 primaries, which are those of Rec. 709; white D65.
    #[default]
    Srgb,
    /// Rec. 2020: ITU-R BT.2020 primaries, white D65.
    Rec2020,
    /// ACEScg: ACES AP1 primaries, white D60, Bradford adaptation from D65.
    AcesCg,
    /// Matrix as the paper prints it (section 3.2): SMPTE-C, with 1.0511 probably a misprint of 1.0501.
    Paper,
}

impl RgbSpace {
    /// Matrix from XYZ to linear RGB, row by row.
    #[must_use]
    pub fn matrix(self) -> [[f64; 3]; 3] {
        match self {
            Self::Srgb => [
                [3.240_454_2, -1.537_138_5, -0.498_531_4],
                [-0.969_266_0, 1.876_010_8, 0.041_556_0],
                [0.055_643_4, -0.204_025_9, 1.057_225_2],
            ],
            Self::Rec2020 => [
                [1.716_510_7, -0.355_641_7, -0.253_345_5],
                [-0.666_693_0, 1.616_502_2, 0.015_768_8],
                [0.017_643_6, -0.042_779_8, 0.942_305_1],
            ],
            Self::AcesCg => [
                [1.660_520_5, -0.315_329_8, -0.241_493_3],
                [-0.659_940_9, 1.608_420_0, 0.017_297_5],
                [0.009_009_5, -0.003_578_9, 0.913_839_2],
            ],
            Self::Paper => [[3.5064, -1.74, -0.5441], [-1.069, 1.9777, 0.0352], [0.0563, -0.197, 1.0511]],
        }
    }

    /// Linear RGB of a colour in XYZ. Components are negative for colours out of gamut.
    #[must_use]
    pub fn from_xyz(self, xyz: [f64; 3]) -> [f64; 3] {
        self.matrix().map(|row| row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2])
    }
}
