//! Pixels while rays are being followed: sums of light, and how many rays each pixel still wants.

use super::framebuffer::Framebuffer;
use super::noise::{NoiseReached, around};
use crate::support::error::Result;
use crate::support::memory;

/// Rays of each half of a pixel before its noise is known for the first time.
pub(super) const FIRST_RAYS: u32 = 2;
/// Largest number of rays of each half of a pixel.
const MAX_RAYS: u32 = 2048;

/// One pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pixel {
    /// Sums of linear RGB, multiplied by coverage, over the rays of each half.
    pub sums: [[f32; 3]; 2],
    /// Rays of both halves that hit the body.
    pub covered: u32,
    /// Rays of each half that were followed.
    pub done: u32,
    /// Rays of each half that are to be followed.
    pub wanted: u32,
    /// Variance of the mean of both halves, in steps of 8-bit sRGB squared.
    pub variance: f32,
}

impl Pixel {
    /// Mean colour of each half.
    pub fn means(&self) -> [[f32; 3]; 2] {
        self.sums.map(|sum| sum.map(|c| c / self.done as f32))
    }

    fn shows_body(&self) -> bool {
        self.covered > 0
    }
}

/// All pixels, each estimated by one set of rays or by two independent ones.
pub(super) struct Film {
    size: [u32; 2],
    halves: usize,
    pixels: Vec<Pixel>,
    /// Rays that are expected in all.
    expected: u64,
}

impl Film {
    /// A film whose pixels want so many rays in each of one or two halves.
    ///
    /// # Errors
    /// Too little memory.
    pub fn new(size: [u32; 2], halves: usize, rays: u32) -> Result<Self> {
        let [width, height] = size;
        let count = width as usize * height as usize;
        let blank = Pixel { wanted: rays, ..Pixel::default() };
        let pixels = memory::filled(blank, count, format_args!("a picture of {width} × {height} pixels"))?;
        Ok(Self { size, halves, pixels, expected: halves as u64 * count as u64 * u64::from(rays) })
    }

    pub fn halves(&self) -> usize {
        self.halves
    }

    /// Pixels, row by row.
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut [Pixel]> + Send {
        self.pixels.chunks_mut(self.size[0] as usize)
    }

    /// Rays that were followed.
    pub fn done(&self) -> u64 {
        self.halves as u64 * self.pixels.iter().map(|pixel| u64::from(pixel.done)).sum::<u64>()
    }

    /// Rays that are expected in all.
    pub fn expected(&self) -> u64 {
        self.expected
    }

    /// Noise of the picture as it is.
    pub fn noise(&self) -> NoiseReached {
        let (mut count, mut variance, mut rays) = (0.0f64, 0.0, 0.0);
        for pixel in self.body() {
            count += 1.0;
            variance += f64::from(pixel.variance);
            rays += self.halves as f64 * f64::from(pixel.done);
        }
        let most = self.pixels.iter().map(|pixel| pixel.done).max().unwrap_or(0);
        let mean = |sum: f64| sum / count.max(1.0);
        NoiseReached { rms: mean(variance).sqrt(), mean_rays: mean(rays), most_rays: self.halves as u32 * most }
    }

    /// Asks for more rays, up to twice as many, where they help most; false if the target is reached, or no pixel may
    /// have more.
    ///
    /// If the variance v of a pixel falls as its rays n are added, so that a = v n stays, the fewest rays in all that
    /// leave a sum V of variances are n = √a Σ√a / V.
    pub fn ask_for_more(&mut self, target: f64) -> bool {
        let variance: f64 = self.body().map(|pixel| f64::from(pixel.variance)).sum();
        let aim = target * target * self.body().count() as f64;
        if variance <= aim {
            return false;
        }
        let around = around(self.size.map(|side| side as usize), |i| self.pixels[i].variance);
        let root = |pixel: &Pixel, around: f32| (f64::from(around) * f64::from(pixel.done)).sqrt();
        let (mut roots, mut variance_around) = (0.0, 0.0);
        for (pixel, &around) in self.pixels.iter().zip(&around).filter(|(pixel, _)| pixel.shows_body()) {
            roots += root(pixel, around);
            variance_around += f64::from(around);
        }
        let by_root = roots / (aim / variance * variance_around);
        let done = self.done();
        let (mut asked, mut expected) = (0, 0.0);
        // Steps of 3/2 and 4/3, or both at once; in the end also where a step is a little too far.
        for too_far in [1.2, 1.0] {
            for (pixel, &around) in self.pixels.iter_mut().zip(&around) {
                let best = by_root * root(pixel, around);
                let step = if pixel.done.is_power_of_two() { pixel.done / 2 } else { pixel.done / 3 };
                if best > too_far * f64::from(pixel.done) && pixel.done < MAX_RAYS {
                    let is_far = best > 1.5 * f64::from(pixel.done);
                    pixel.wanted = if is_far { 2 * pixel.done } else { pixel.done + step }.min(MAX_RAYS);
                    asked += u64::from(pixel.wanted - pixel.done);
                    expected += best - f64::from(pixel.done);
                }
            }
            if asked > 0 {
                break;
            }
        }
        self.expected = done + self.halves as u64 * (expected as u64).max(asked);
        asked > 0
    }

    /// Pixels that show the body.
    fn body(&self) -> impl Iterator<Item = &Pixel> {
        self.pixels.iter().filter(|pixel| pixel.shows_body())
    }

    /// The picture, with the noise that was reached if it is known.
    pub fn develop(self, noise: Option<NoiseReached>, is_transparent: bool) -> Framebuffer {
        let of_pixel = |pixel: &Pixel| {
            let count = self.halves as f32 * pixel.done as f32;
            let [r, g, b] = std::array::from_fn(|c| (pixel.sums[0][c] + pixel.sums[1][c]) / count);
            let covered = if is_transparent { pixel.covered as f32 / count } else { 1.0 };
            [r, g, b, covered]
        };
        let shows_body = self.pixels.iter().any(Pixel::shows_body);
        Framebuffer { size: self.size, pixels: self.pixels.iter().map(of_pixel).collect(), shows_body, noise }
    }
}
