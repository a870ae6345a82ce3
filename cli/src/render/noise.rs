//! Noise of a picture, as one sees it: in steps of 8-bit sRGB.
//!
//! Each pixel is estimated twice, by two independent halves A and B of its rays. Their mean M is the pixel. A − M = M −
//! B has the variance of M's own error, whatever the distribution of the rays, so the squares of the encoded
//! differences A to M and M to B are estimates of the pixel's squared error.

use super::tone::{ToneMap, exposure};
use crate::plot::srgb;

/// Radius of the squares of pixels whose variances are averaged: a small one follows silhouettes, a large one is surer.
const RADII: [usize; 2] = [1, 2];

/// How linear radiance is brought to a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Exposure in stops.
    pub stops: f64,
    /// Curve of tones.
    pub tone: ToneMap,
}

/// Noise that a picture has reached, and the rays that it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseReached {
    /// Root mean square error of a component, in steps of 8-bit sRGB, over the pixels that show the body.
    pub rms: f64,
    /// Mean number of rays through these pixels.
    pub mean_rays: f64,
    /// Largest number of rays through a pixel.
    pub most_rays: u32,
}

impl Display {
    /// Components of a colour in steps of 8-bit sRGB, not rounded.
    fn shown(&self, rgb: [f32; 3]) -> [f64; 3] {
        let factor = exposure(self.stops);
        srgb(self.tone.apply(rgb.map(|c| factor * c))).map(|c| 255.0 * c)
    }

    /// Variance of a pixel whose two halves have these means: the mean over its components, in steps of 8-bit sRGB
    /// squared.
    pub(super) fn variance(&self, [a, b]: [[f32; 3]; 2]) -> f32 {
        if a == b {
            return 0.0;
        }
        let middle = self.shown(std::array::from_fn(|c| 0.5 * (a[c] + b[c])));
        let apart = |half: [f32; 3]| {
            self.shown(half).iter().zip(middle).map(|(half, middle)| (half - middle).powi(2)).sum::<f64>()
        };
        ((apart(a) + apart(b)) / 6.0) as f32
    }
}

/// The variance around each pixel, without its own: the larger of the means over two squares of pixels about it.
///
/// Whether a pixel gets more rays is decided by this. Its own rays have no say, so that pixels whose rays happen to
/// agree do not stop early, which would bias them.
pub(super) fn around([width, height]: [usize; 2], variance: impl Fn(usize) -> f32) -> Vec<f32> {
    // Sums over all pixels above and to the left; double precision keeps their differences.
    let mut sums = vec![0.0f64; (width + 1) * (height + 1)];
    for y in 0..height {
        let mut row = 0.0;
        for x in 0..width {
            row += f64::from(variance(y * width + x));
            sums[(y + 1) * (width + 1) + x + 1] = sums[y * (width + 1) + x + 1] + row;
        }
    }
    let mean = |x: usize, y: usize, radius: usize| {
        let [left, top] = [x, y].map(|i| i.saturating_sub(radius));
        let (right, below) = ((x + radius + 1).min(width), (y + radius + 1).min(height));
        let at = |x: usize, y: usize| sums[y * (width + 1) + x];
        let others = (right - left) * (below - top) - 1;
        let sum = at(right, below) - at(left, below) - at(right, top) + at(left, top);
        if others == 0 {
            return variance(y * width + x);
        }
        ((sum - f64::from(variance(y * width + x))) / others as f64).max(0.0) as f32
    };
    (0..width * height)
        .map(|i| RADII.iter().map(|&radius| mean(i % width, i / width, radius)).fold(0.0, f32::max))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_is_that_of_the_mean_of_both_halves() {
        let display = Display::default();
        // Encoded mid-grey changes by 255 · 0.4396 · dL/L^(1.4/2.4) for a small dL.
        let (a, b) = ([0.401; 3], [0.399; 3]);
        let slope = 255.0 * 1.055 / 2.4 * f64::powf(0.4, 1.0 / 2.4 - 1.0);
        let expected = (slope * 1e-3).powi(2);
        let found = f64::from(display.variance([a, b]));
        // A line through a curve, and single precision.
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        assert_eq!(display.variance([a, a]), 0.0);
        // Beyond white there is nothing to see.
        assert!(display.variance([[2.0; 3], [3.0; 3]]) < 1e-12);
        let dimmed = Display { stops: -2.0, tone: ToneMap::None };
        assert!(dimmed.variance([[2.0; 3], [3.0; 3]]) > 1.0);
    }

    #[test]
    fn neighbours_decide_and_a_pixel_itself_does_not() {
        let size = [9, 5];
        let lit = |places: &'static [usize]| around(size, move |i| if places.contains(&i) { 24.0 } else { 0.0 });
        let alone = lit(&[22]);
        assert_eq!(alone[22], 0.0);
        // One of eight neighbours is louder than one of twenty-four.
        assert!((alone[21] - 3.0).abs() < 1e-5 && (alone[20] - 1.0).abs() < 1e-5 && alone[19] == 0.0, "{alone:?}");
        // At the corner fewer neighbours share the sum.
        assert!((lit(&[1])[0] - 8.0).abs() < 1e-5);
        assert_eq!(around([1, 1], |_| 2.0), [2.0]);
    }
}
