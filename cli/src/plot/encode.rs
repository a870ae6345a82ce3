//! Encoding of linear RGB as 8-bit sRGB, and the gamut policy of all pictures.
//!
//! Structural colours may be more saturated than sRGB and brighter than white. Pictures bring them into the gamut by
//! one policy:
//!
//! 1. A colour with a negative component is mixed with the grey of its own luminance until that component is 0: hue and
//!    luminance stay, saturation gives way.
//! 2. A colour with a component above 1 is then scaled until its largest component is 1: hue and saturation stay,
//!    brightness gives way. Clipping instead would turn a bright orange yellow.
//!
//! Luminance has the Rec. 709 weights. Colours without positive luminance are black. Tables and CSV files keep the
//! values as they are.

use crate::colour::luminance;

/// 8-bit sRGB of a colour, under the gamut policy of this module.
#[must_use]
pub fn srgb8(linear: [f32; 3]) -> [u8; 3] {
    srgb(linear).map(|c| (255.0 * c).round() as u8)
}

/// Encoded sRGB of a colour, from 0 to 1, under the gamut policy of this module.
#[must_use]
pub fn srgb(linear: [f32; 3]) -> [f64; 3] {
    in_gamut(linear).map(transfer)
}

/// The code `#rrggbb` of a colour, under the gamut policy of this module.
#[must_use]
pub fn hex(linear: [f32; 3]) -> String {
    let [r, g, b] = srgb8(linear);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Neutral linear RGB of a reflectance.
#[must_use]
pub fn grey(reflectance: f64) -> [f32; 3] {
    [reflectance as f32; 3]
}

/// A colour that suggests a wavelength and is dark enough for a curve on white. It is not colorimetric: monochromatic
/// light lies outside sRGB.
#[must_use]
pub fn wavelength_colour(wavelength_nm: f64) -> String {
    const STOPS: [(f64, [f64; 3]); 8] = [
        (400.0, [0.36, 0.10, 0.60]),
        (436.0, [0.26, 0.18, 0.80]),
        (475.0, [0.05, 0.40, 0.85]),
        (505.0, [0.00, 0.55, 0.50]),
        (546.0, [0.10, 0.58, 0.20]),
        (585.0, [0.80, 0.60, 0.00]),
        (620.0, [0.87, 0.30, 0.06]),
        (700.0, [0.72, 0.07, 0.10]),
    ];
    let above = STOPS.partition_point(|stop| stop.0 < wavelength_nm);
    let (low, high) = (STOPS[above.saturating_sub(1)], STOPS[above.min(STOPS.len() - 1)]);
    let weight = if high.0 > low.0 { (wavelength_nm - low.0) / (high.0 - low.0) } else { 0.0 };
    let byte = |i: usize| (255.0 * (low.1[i] + weight * (high.1[i] - low.1[i]))).round() as u8;
    format!("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2))
}

/// Linear RGB brought into [0, 1] by the policy of this module.
#[must_use]
pub fn in_gamut(linear: [f32; 3]) -> [f64; 3] {
    let rgb = linear.map(f64::from);
    let luminance = luminance(rgb);
    if !(luminance > 0.0 && luminance.is_finite()) {
        return [0.0; 3];
    }
    let smallest = rgb.into_iter().fold(f64::INFINITY, f64::min);
    let saturation = if smallest < 0.0 { luminance / (luminance - smallest) } else { 1.0 };
    let rgb = rgb.map(|c| (luminance + saturation * (c - luminance)).max(0.0));
    let largest = rgb.into_iter().fold(1.0, f64::max);
    rgb.map(|c| c / largest)
}

/// The sRGB transfer function, IEC 61966-2-1.
fn transfer(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_inside_the_gamut_are_only_encoded() {
        assert_eq!(srgb8([0.0, 1.0, 0.5]), [0, 255, 188]);
        assert_eq!(srgb8([0.002, 0.214_041_14, 0.018]), [7, 128, 36]);
        assert_eq!(hex([1.0, 0.5, 0.0]), "#ffbc00");
    }

    #[test]
    fn encoding_rises_with_the_colour() {
        let bytes: Vec<u8> = (0..=1000).map(|i| srgb8(grey(f64::from(i) / 1000.0))[1]).collect();
        assert!(bytes.is_sorted());
        assert_eq!((bytes[0], bytes[1000]), (0, 255));
    }

    #[test]
    fn negative_components_cost_saturation_but_neither_hue_nor_luminance() {
        let from = [0.5, 0.3, -0.2_f32];
        let to = in_gamut(from);
        assert!(to[2].abs() < 1e-12, "{to:?}");
        assert!((luminance(to) - luminance(from.map(f64::from))).abs() < 1e-7);
        // Equal ratios of differences are an equal hue.
        assert!(((to[0] - to[1]) / (to[1] - to[2]) - 0.4).abs() < 1e-6, "{to:?}");
    }

    #[test]
    fn bright_colours_are_scaled_and_keep_their_ratios() {
        let to = in_gamut([1.6, 0.8, 0.4]);
        assert!(to.iter().zip([1.0, 0.5, 0.25]).all(|(a, b)| (a - b).abs() < 1e-7), "{to:?}");
    }

    #[test]
    fn no_light_and_no_number_are_black() {
        for rgb in [[0.0; 3], [-0.1, -0.2, 0.3], [f32::NAN, 1.0, 1.0], [f32::INFINITY, 0.0, 0.0]] {
            assert_eq!(srgb8(rgb), [0; 3], "{rgb:?}");
        }
    }

    #[test]
    fn wavelengths_are_blue_green_and_red_in_their_places() {
        let rgb = |nm| {
            let text = wavelength_colour(nm);
            [1, 3, 5].map(|i| u8::from_str_radix(&text[i..i + 2], 16).unwrap())
        };
        for (nm, largest) in [(436.0, 2), (546.0, 1), (700.0, 0), (300.0, 2), (900.0, 0)] {
            let rgb = rgb(nm);
            assert_eq!((0..3).max_by_key(|&i| rgb[i]), Some(largest), "{nm} nm: {rgb:?}");
        }
    }
}
