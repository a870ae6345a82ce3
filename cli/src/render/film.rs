//! Pixels while rays are being followed: sums of light, and how many rays each pixel still wants.

use super::framebuffer::Framebuffer;
use super::noise::{NoiseReached, around};
use crate::support::error::Result;
use crate::support::memory;

/// Rays of each half of a pixel before its noise is known for the first time.
pub(super) const FIRST_RAYS: u32 = 2;
/// Largest number of rays of each half of a pixel.
const MAX_RAYS: u32 = 2048;
/// Variance that is little, over the one that is asked for.
const LITTLE: f64 = 0.25;

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

    /// Asks for twice as many rays where there is most noise, in as many pixels as it takes to reach the target if
    /// variance falls as rays are added; false if the target is reached, or no pixel may have more.
    pub fn ask_for_more(&mut self, target: f64) -> bool {
        let variance_now: f64 = self.body().map(|pixel| f64::from(pixel.variance)).sum();
        let aim = target * target * self.body().count() as f64;
        if variance_now <= aim {
            return false;
        }
        let around = around(self.size.map(|side| side as usize), |i| self.pixels[i].variance);
        let may_have_more = |(pixel, around): &(&Pixel, &f32)| pixel.done < MAX_RAYS && **around > 0.0;
        let candidates = self.pixels.iter().zip(&around).filter(may_have_more);
        let mut noisiest: Vec<f32> =
            candidates.filter(|(pixel, _)| pixel.shows_body()).map(|(_, around)| *around).collect();
        noisiest.sort_unstable_by(|a, b| b.total_cmp(a));
        // Twice as many rays leave half of the variance.
        let mut variance = variance_now;
        let enough = noisiest.iter().position(|around| {
            variance -= 0.5 * f64::from(*around);
            variance <= aim
        });
        // While noise is far from the target, pixels that have little of it need not help.
        let little = (LITTLE * target * target) as f32;
        let Some(last) = noisiest.last() else { return false };
        let limit = enough.map_or(little.min(noisiest[0]).max(*last), |place| noisiest[place]);
        let done = self.done();
        let mut asked = 0;
        for (pixel, around) in self.pixels.iter_mut().zip(around) {
            if around >= limit && around > 0.0 && pixel.done < MAX_RAYS {
                asked += self.halves as u64 * u64::from(pixel.done);
                pixel.wanted = 2 * pixel.done;
            }
        }
        self.expected = (done + asked).max((done as f64 * (variance_now / aim).min(100.0)) as u64);
        true
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
            let covered = if is_transparent { (pixel.covered[0] + pixel.covered[1]) / count } else { 1.0 };
            [r, g, b, covered]
        };
        let shows_body = self.pixels.iter().any(Pixel::shows_body);
        Framebuffer { size: self.size, pixels: self.pixels.iter().map(of_pixel).collect(), shows_body, noise }
    }
}
