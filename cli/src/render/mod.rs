//! Pictures of a surface on a lit body, for `goniochrome render` and `goniochrome view`.
//!
//! A [`body`] has a shape, often a [`mesh`]. A [`surface`] says how it reflects, an [`environment`] how it is lit and a
//! [`camera`] from where it is seen. [`render()`] makes a [`framebuffer`], which [`tone`] mapping brings to a screen.
//! Nothing here reads or writes files.
//!
//! The world is right-handed with z up. Directions are unit vectors; `wo` points to the viewer and `wi` to the light.

pub mod tone;
pub mod channels;
pub mod mesh;
pub mod obj;
pub mod teapot;
pub mod body;
mod primaries;
mod picture;
mod openexr;
mod radiance;
pub mod latlong;
pub mod decode;
pub mod studio;
pub mod lamp;
mod distribution;
pub mod environment;
pub mod spread;
mod pyramid;
mod orders;
pub mod thickness;
mod mirror_like;
mod viewed;
mod glossy;
pub mod surface;
pub mod camera;
pub mod noise;
pub mod framebuffer;
mod tracer;
mod sheet;
mod scattering;
mod film;

use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;

use body::{Body, SurfaceHit};
use camera::Camera;
use environment::Environment;
use film::{Film, Pixel};
use framebuffer::Framebuffer;
use noise::Display;
use pyramid::Pyramid;
use surface::Surface;
use tracer::{PREVIEW_RAYS, SampleStream, Scratch, Tracer};

use crate::support::error::Result;
use crate::support::parallel;

/// The background of a picture, seen past the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The environment.
    #[default]
    Environment,
    /// Nothing; coverage is 0.
    Transparent,
    /// One linear RGB colour.
    Colour([f32; 3]),
}

/// How many rays go through a pixel, and what they do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// So many rays through each pixel: one through its centre, or several spread evenly over its square.
    Fixed(u32),
    /// Rays until the noise is small enough: the root mean square, over the pixels that show the body, of the error of
    /// a component of 8-bit sRGB. More rays go where there is more noise.
    ToNoise(f64),
    /// A few rays and fixed directions, equal for all pixels, each of which sees the light blurred: no noise, a little
    /// blur.
    Preview,
}

/// The quality of a picture, and the threads that draw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Rays through each pixel.
    pub sampling: Sampling,
    /// Largest number of reflections by the body on a light path, at least 1; a preview has 1. Passages through a sheet
    /// do not count.
    pub reflections: u32,
    /// How the picture is shown, in which its noise is measured.
    pub display: Display,
    /// Number of threads; the picture does not depend on it.
    pub threads: usize,
}

/// How far a picture has come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Rays that have been followed.
    pub done: u64,
    /// Rays that are expected in all.
    pub expected: u64,
    /// Noise so far, in steps of 8-bit sRGB, once it is known.
    pub noise: Option<f64>,
}

/// A body in its light, seen by a camera.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// The body.
    pub body: &'a Body<'a>,
    /// The reflection of the body's surface.
    pub surface: &'a Surface,
    /// The light on the body, which is also seen past it.
    pub environment: &'a Environment,
    /// The light as diffraction orders and facet lobes see it, which may be spread.
    pub widened: &'a Environment,
    /// The camera.
    pub camera: &'a Camera,
    /// The background.
    pub background: Background,
}

/// Renders the picture of a stage; `report` is called after each row of pixels.
///
/// # Errors
/// A table that cannot be sampled, or too little memory for the picture.
pub fn render(stage: &Stage<'_>, quality: &Quality, report: &(dyn Fn(Progress) + Sync)) -> Result<Framebuffer> {
    let is_preview = quality.sampling == Sampling::Preview;
    let tracer = Tracer {
        body: stage.body,
        surface: stage.surface.prepare()?,
        channels: stage.surface.channels(),
        environment: stage.environment,
        widened: stage.widened,
        pyramid: is_preview.then(|| Pyramid::new(stage.environment)).transpose()?,
        reflections: quality.reflections.max(1),
        behind: if let Background::Colour(rgb) = stage.background { Some(rgb) } else { None },
    };
    let size = stage.camera.size;
    let is_transparent = stage.background == Background::Transparent;
    let painter = Painter { stage, tracer: &tracer, quality, report };
    match quality.sampling {
        Sampling::Fixed(_) | Sampling::Preview => {
            let rays = if let Sampling::Fixed(rays) = quality.sampling { rays.max(1) } else { PREVIEW_RAYS };
            let mut film = Film::new(size, 1, rays)?;
            painter.paint(&mut film, None);
            Ok(film.develop(None, is_transparent))
        }
        Sampling::ToNoise(target) => {
            let mut film = Film::new(size, 2, film::FIRST_RAYS)?;
            let mut noise = None;
            loop {
                painter.paint(&mut film, noise);
                let reached = film.noise();
                noise = Some(reached.rms);
                if !film.ask_for_more(target) {
                    return Ok(film.develop(Some(reached), is_transparent));
                }
            }
        }
    }
}

/// Number of rays from the camera whose first hits are found together, unless those of the last pixel are more.
const TOGETHER: usize = 512;

/// A ray from the camera, with its first hit on the body.
struct First {
    stream: SampleStream,
    direction: DVec3,
    hit: Option<SurfaceHit>,
}

/// What all pixels share while they are painted.
struct Painter<'a> {
    stage: &'a Stage<'a>,
    tracer: &'a Tracer<'a>,
    quality: &'a Quality,
    report: &'a (dyn Fn(Progress) + Sync),
}

impl Painter<'_> {
    /// Follows the rays that pixels ask for.
    fn paint(&self, film: &mut Film, noise: Option<f64>) {
        let expected = film.expected();
        let done = AtomicU64::new(film.done());
        let halves = film.halves();
        let rows = film.rows_mut().zip(0..);
        let scratch = || Scratch::new(self.tracer.channels.count());
        parallel::for_each(self.quality.threads, rows, scratch, |scratch, (row, y)| {
            let (mut rays, mut rest, mut x) = (0, row, 0);
            while !rest.is_empty() {
                let (count, firsts) = self.first_hits(rest, [x, y], halves);
                rays += firsts.len() as u64;
                let mut firsts = firsts.into_iter();
                let (pixels, others) = rest.split_at_mut(count);
                for pixel in pixels.iter_mut().filter(|pixel| pixel.done < pixel.wanted) {
                    (0..halves).for_each(|half| self.shade(pixel, half, &mut firsts, scratch));
                    pixel.done = pixel.wanted;
                    if halves == 2 {
                        pixel.variance = self.quality.display.variance(pixel.means());
                    }
                }
                (rest, x) = (others, x + count as u32);
            }
            let done = done.fetch_add(rays, Ordering::Relaxed) + rays;
            (self.report)(Progress { done, expected, noise });
        });
    }

    /// The rays that the next pixels of a row still want, by pixel and half, with their first hits; and how many pixels
    /// these are. [x, y] is the place of the first.
    fn first_hits(&self, pixels: &[Pixel], [x, y]: [u32; 2], halves: usize) -> (usize, Vec<First>) {
        let camera = self.stage.camera;
        let (mut count, mut firsts) = (0, Vec::new());
        for (pixel, x) in pixels.iter().zip(x..) {
            if firsts.len() >= TOGETHER {
                break;
            }
            count += 1;
            for (half, ray) in (0..halves).flat_map(|half| (pixel.done..pixel.wanted).map(move |ray| (half, ray))) {
                let mut stream = SampleStream::new(ray, y * camera.size[0] + x, half as u32);
                let [right, down] = match self.quality.sampling {
                    Sampling::Fixed(1) => [0.5; 2],
                    Sampling::Preview => tracer::preview_place(ray),
                    _ => stream.next(),
                };
                let direction = camera.direction(f64::from(x) + right, f64::from(y) + down);
                firsts.push(First { stream, direction, hit: None });
            }
        }
        let directions: Vec<DVec3> = firsts.iter().map(|first| first.direction).collect();
        let hits = self.tracer.body.intersect_each(camera.eye, &directions);
        firsts.iter_mut().zip(hits).for_each(|(first, hit)| first.hit = hit);
        (count, firsts)
    }

    /// Adds the rays that a pixel still wants to one of its halves; they come next of `firsts`.
    fn shade(&self, pixel: &mut Pixel, half: usize, firsts: &mut impl Iterator<Item = First>, scratch: &mut Scratch) {
        let (mut behind, mut covered) = ([0.0; 3], 0);
        scratch.radiance.fill(0.0);
        for First { mut stream, direction, hit } in firsts.take((pixel.wanted - pixel.done) as usize) {
            if let Some(hit) = hit {
                self.tracer.trace(hit, direction, &mut stream, scratch);
                covered += 1;
                continue;
            }
            let rgb = match self.stage.background {
                Background::Environment => self.stage.environment.radiance(direction),
                Background::Transparent => continue,
                Background::Colour(rgb) => rgb,
            };
            (0..3).for_each(|c| behind[c] += rgb[c]);
        }
        let rgb = self.tracer.channels.colour(&scratch.radiance);
        (0..3).for_each(|c| pixel.sums[half][c] += rgb[c] + behind[c]);
        pixel.covered += covered;
    }
}
