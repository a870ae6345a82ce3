//! Colour differences ΔE2000 (CIE 142-2001).
//!
//! L*, a*, b* refer to the white of D65 reflected by a perfect mirror: reflectance 1 is L* = 100, as bright as the
//! light itself. A film on glass, which reflects some 4 % at normal incidence, has L* near 24.

use glam::DVec3;
use goniochrome::colour::RgbSpace;

use crate::colour::xyz_to_rgb;

/// X, Y and Z of D65, the white of sRGB.
const D65: [f64; 3] = [0.95047, 1.0, 1.08883];

/// A colour in CIE L*a*b*, in which differences are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lab {
    /// L*, from 0 for black to 100 for white.
    pub l: f64,
    /// a*, from green to red.
    pub a: f64,
    /// b*, from blue to yellow.
    pub b: f64,
}

/// L*a*b* of linear sRGB, unclipped.
#[must_use]
pub fn lab(rgb: [f64; 3]) -> Lab {
    let to_xyz = xyz_to_rgb(RgbSpace::Srgb).inverse();
    lab_of_xyz((to_xyz * DVec3::from_array(rgb)).to_array(), D65)
}

/// L*a*b* of a colour beside the white of its own light (CIE 15:2004, section 8.2.1).
#[must_use]
pub fn lab_of_xyz(xyz: [f64; 3], white: [f64; 3]) -> Lab {
    let response = |ratio: f64| {
        // Below, the cube root gives way to its tangent.
        if ratio > (6.0_f64 / 29.0).powi(3) { ratio.cbrt() } else { 841.0 / 108.0 * ratio + 4.0 / 29.0 }
    };
    let [x, y, z] = std::array::from_fn(|c| response(xyz[c] / white[c]));
    Lab { l: 116.0 * y - 16.0, a: 500.0 * (x - y), b: 200.0 * (y - z) }
}

/// Colour difference ΔE2000, as G. Sharma, W. Wu and E. N. Dalal write it in "The CIEDE2000 color-difference formula:
/// Implementation notes, supplementary test data, and mathematical observations", Color Research & Application 30, 21
/// (2005).
#[must_use]
pub fn delta_e(one: Lab, two: Lab) -> f64 {
    let share = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25.0_f64.powi(7))).sqrt();
    // Chroma C′ and hue h′ in degrees, of a* stretched for near-neutral colours.
    let stretch = 1.5 - 0.5 * share(0.5 * (one.a.hypot(one.b) + two.a.hypot(two.b)));
    let chroma_and_hue = |colour: Lab| {
        let a = stretch * colour.a;
        let grey = a == 0.0 && colour.b == 0.0;
        (a.hypot(colour.b), if grey { 0.0 } else { colour.b.atan2(a).to_degrees().rem_euclid(360.0) })
    };
    let ((chroma_1, hue_1), (chroma_2, hue_2)) = (chroma_and_hue(one), chroma_and_hue(two));

    // Hues differ, and have their mean, along the shorter arc; a grey has none.
    let (turn, hue) = match hue_2 - hue_1 {
        _ if chroma_1 * chroma_2 == 0.0 => (0.0, hue_1 + hue_2),
        turn if turn.abs() <= 180.0 => (turn, 0.5 * (hue_1 + hue_2)),
        turn => (turn - 360.0 * turn.signum(), (0.5 * (hue_1 + hue_2) + 180.0).rem_euclid(360.0)),
    };
    let by_hue = 2.0 * (chroma_1 * chroma_2).sqrt() * (0.5 * turn).to_radians().sin();
    let (lightness, chroma) = (0.5 * (one.l + two.l), 0.5 * (chroma_1 + chroma_2));

    let cos = |degrees: f64| degrees.to_radians().cos();
    let t = 1.0 - 0.17 * cos(hue - 30.0) + 0.24 * cos(2.0 * hue) + 0.32 * cos(3.0 * hue + 6.0)
        - 0.20 * cos(4.0 * hue - 63.0);
    let from_mid_grey = (lightness - 50.0).powi(2);
    let weight_of_lightness = 1.0 + 0.015 * from_mid_grey / (20.0 + from_mid_grey).sqrt();
    let weight_of_chroma = 1.0 + 0.045 * chroma;
    let weight_of_hue = 1.0 + 0.015 * chroma * t;
    let rotation = 30.0 * (-((hue - 275.0) / 25.0).powi(2)).exp();
    let blue = -2.0 * share(chroma) * (2.0 * rotation).to_radians().sin();

    let lightness = (two.l - one.l) / weight_of_lightness;
    let chroma = (chroma_2 - chroma_1) / weight_of_chroma;
    let hue = by_hue / weight_of_hue;
    // Rounding may leave a little less than 0 of equal colours.
    (lightness.powi(2) + chroma.powi(2) + hue.powi(2) + blue * chroma * hue).max(0.0).sqrt()
}

/// Mean, 95th percentile (nearest rank) and maximum of colour differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Mean difference.
    pub mean: f64,
    /// Difference that 95 % do not exceed.
    pub p95: f64,
    /// Largest difference.
    pub largest: f64,
}

impl Summary {
    /// Summary of at least one difference.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn of(differences: &[f64]) -> Self {
        let mut sorted = differences.to_vec();
        sorted.sort_by(f64::total_cmp);
        let rank = (sorted.len() * 95).div_ceil(100);
        Self {
            mean: sorted.iter().sum::<f64>() / sorted.len() as f64,
            p95: sorted[rank - 1],
            largest: sorted[sorted.len() - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// G. Sharma, W. Wu and E. N. Dalal, "The CIEDE2000 color-difference formula" (2005), table 1.
    const SHARMA: [([f64; 3], [f64; 3], f64); 34] = [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, 3.1571, -77.2803], [50.0, 0.0, -82.7485], 2.8615),
        ([50.0, 2.8361, -74.0200], [50.0, 0.0, -82.7485], 3.4412),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, -1.1848, -84.8006], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, -0.9009, -85.5211], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
        ([50.0, -1.0, 2.0], [50.0, 0.0, 0.0], 2.3669),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0009], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0010], 7.1792),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0011], 7.2195),
        ([50.0, 2.4900, -0.0010], [50.0, -2.4900, 0.0012], 7.2195),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0010, -2.4900], 4.8045),
        ([50.0, -0.0010, 2.4900], [50.0, 0.0011, -2.4900], 4.7461),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([50.0, 2.5, 0.0], [61.0, -5.0, 29.0], 22.8977),
        ([50.0, 2.5, 0.0], [56.0, -27.0, -3.0], 31.9030),
        ([50.0, 2.5, 0.0], [58.0, 24.0, 15.0], 19.4535),
        ([50.0, 2.5, 0.0], [50.0, 3.1736, 0.5854], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.2972, 0.0], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 1.8634, 0.5757], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 3.2592, 0.3350], 1.0),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([63.0109, -31.0961, -5.8663], [62.8187, -29.7946, -4.0864], 1.2630),
        ([61.2901, 3.7196, -5.3901], [61.4292, 2.2480, -4.9620], 1.8731),
        ([35.0831, -44.1164, 3.7933], [35.0232, -40.0716, 1.5901], 1.8645),
        ([22.7233, 20.0904, -46.6940], [23.0331, 14.9730, -42.5619], 2.0373),
        ([36.4612, 47.8580, 18.3852], [36.2715, 50.5065, 21.2231], 1.4146),
        ([90.8027, -2.0831, 1.4410], [91.1528, -1.6435, 0.0447], 1.4441),
        ([90.9257, -0.5406, -0.9208], [88.6381, -0.8985, -0.7239], 1.5381),
        ([6.7747, -0.2908, -2.4247], [5.8714, -0.0985, -2.2286], 0.6377),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ];

    #[test]
    fn the_published_pairs_come_out() {
        /// The published digits.
        const PRINTED: f64 = 0.5e-4 + 1e-9;
        for (a, b, want) in SHARMA {
            let [a, b] = [a, b].map(|[l, a, b]| Lab { l, a, b });
            for got in [delta_e(a, b), delta_e(b, a)] {
                assert!((got - want).abs() <= PRINTED, "{a:?} {b:?}: {got} for {want}");
            }
        }
    }

    #[test]
    fn a_perfect_mirror_is_white() {
        let white = lab([1.0; 3]);
        /// The matrix has seven decimals.
        const DIGITS: f64 = 1e-4;
        assert!((white.l - 100.0).abs() < DIGITS && white.a.abs() < DIGITS && white.b.abs() < DIGITS, "{white:?}");
        assert!((lab([0.04; 3]).l - (116.0 * 0.04_f64.cbrt() - 16.0)).abs() < DIGITS);
    }

    #[test]
    fn the_percentile_is_by_nearest_rank() {
        let values: Vec<f64> = (1..=40).rev().map(f64::from).collect();
        assert_eq!(Summary::of(&values), Summary { mean: 20.5, p95: 38.0, largest: 40.0 });
        assert_eq!(Summary::of(&[2.0]), Summary { mean: 2.0, p95: 2.0, largest: 2.0 });
    }
}
