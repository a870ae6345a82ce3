//! Pixels while rays are being followed: sums of light, and how many rays each pixel still wants.

use super::framebuffer::Framebuffer;
use super::noise::{NoiseReached, around};
use crate::support::error::Result;
use crate::support::memory;

/// Rays of each half of a pixel before its noise is known for the first time.
pub(super) const FIRST_RAYS: u32 = 4;
/// Largest number of rays of each half of a pixel.
const MAX_RAYS: u32 = 2048;

/// One pixel.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pixel {
    /// Sums of linear RGB, multiplied by coverage, over the rays of each half.
    pub sums: [[f32; 3]; 2],
    /// Rays of each half that hit the body.
    pub covered: [f32; 2],
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
        self.covered[0] + self.covered[1] > 0.0
    }
}

/// All pixels, each estimated by one set of rays or by two independent ones.
pub(super) struct Film {
    size: [u32; 2],
    halves: usize,
    pixels: Vec<Pixel>,
    /// Variance around each pixel beyond which it gets more rays, over the square of the noise that is asked for.
    threshold: f64,
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
        Ok(Self { size, halves, pixels, threshold: 1.0, expected: halves as u64 * count as u64 * u64::from(rays) })
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
        for pixel in self.pixels.iter().filter(|pixel| pixel.shows_body()) {
            count += 1.0;
            variance += f64::from(pixel.variance);
            rays += self.halves as f64 * f64::from(pixel.done);
        }
        let most = self.pixels.iter().map(|pixel| pixel.done).max().unwrap_or(0);
        let mean = |sum: f64| sum / count.max(1.0);
        NoiseReached { rms: mean(variance).sqrt(), mean_rays: mean(rays), most_rays: self.halves as u32 * most }
    }

    /// Asks for twice as many rays in each pixel around which the noise is larger than the target; false if it is
    /// small everywhere, or no pixel may have more.
    ///
    /// Where noise is seldom and strong, neighbours may be quiet while the picture as a whole is not; pixels around
    /// which there is less noise then get more rays too.
    pub fn ask_for_more(&mut self, target: f64, rms: f64) -> bool {
        let size = self.size.map(|side| side as usize);
        let around = around(size, |i| self.pixels[i].variance);
        loop {
            let limit = (target * target * self.threshold) as f32;
            let mut asked = 0;
            self.expected = self.done();
            for (pixel, &around) in self.pixels.iter_mut().zip(&around) {
                if around > limit && pixel.done < MAX_RAYS {
                    pixel.wanted = 2 * pixel.done;
                    asked += 1;
                    // Variance falls at least as fast as rays are added.
                    let times = f64::from((around / limit).min((MAX_RAYS / pixel.done) as f32)).max(2.0);
                    self.expected += (self.halves as f64 * f64::from(pixel.done) * (times - 1.0)) as u64;
                }
            }
            let exhausted = || around.iter().zip(&self.pixels).all(|(&v, pixel)| v == 0.0 || pixel.done >= MAX_RAYS);
            if asked > 0 || rms <= target || exhausted() {
                return asked > 0;
            }
            self.threshold *= 0.5;
        }
    }

    /// The picture, with the noise that was reached if it is known.
    pub fn develop(self, noise: Option<NoiseReached>, is_transparent: bool) -> Framebuffer {
        let of_pixel = |pixel: &Pixel| {
            let count = self.halves as f32 * pixel.done as f32;
            let [r, g, b] = std::array::from_fn(|c| (pixel.sums[0][c] + pixel.sums[1][c]) / count);
            let covered = if is_transparent { (pixel.covered[0] + pixel.covered[1]) / count } else { 1.0 };
            [r, g, b, covered]
        };
        let shows_body = self.pixels.iter().any(Pixel::shows_body);
        Framebuffer { size: self.size, pixels: self.pixels.iter().map(of_pixel).collect(), shows_body, noise }
    }
}
