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
mod orders;
pub mod surface;
pub mod camera;
pub mod framebuffer;
mod tracer;

use std::sync::atomic::{AtomicBool, Ordering};

use body::Body;
use camera::Camera;
use environment::Environment;
use framebuffer::Framebuffer;
use surface::Surface;
use tracer::{SampleStream, Scratch, Tracer};

use crate::support::error::Result;
use crate::support::{memory, parallel};

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

/// The quality of a picture, and the threads that draw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quality {
    /// Rays through each pixel: one through its centre, or several spread evenly over its square.
    pub samples: u32,
    /// Largest number of reflections by the body on a light path, at least 1.
    pub reflections: u32,
    /// Number of threads; the picture does not depend on it.
    pub threads: usize,
}

/// A body in its light, seen by a camera.
#[derive(Clone, Copy, Debug)]
pub struct Stage<'a> {
    /// The body.
    pub body: &'a Body<'a>,
    /// The reflection of the body's surface.
    pub surface: &'a Surface,
    /// The light on the body.
    pub environment: &'a Environment,
    /// The light that is seen past the body.
    pub backdrop: &'a Environment,
    /// The camera.
    pub camera: &'a Camera,
    /// The background.
    pub background: Background,
}

/// Renders the picture of a stage; `tick` is called after each row of pixels.
///
/// # Errors
/// A table that cannot be sampled, or too little memory for the picture.
pub fn render(stage: &Stage<'_>, quality: &Quality, tick: &(dyn Fn() + Sync)) -> Result<Framebuffer> {
    let mut memory = Vec::new();
    let tracer = Tracer {
        body: stage.body,
        surface: stage.surface.prepare(&mut memory)?,
        channels: stage.surface.channels(),
        environment: stage.environment,
        reflections: quality.reflections.max(1),
    };
    let [width, height] = stage.camera.size;
    let what = format_args!("a picture of {width} × {height} pixels");
    let mut pixels = memory::filled([0.0; 4], width as usize * height as usize, what)?;
    let rows = pixels.chunks_mut(width as usize).zip(0..height);
    let shows_body = AtomicBool::new(false);
    let scratch = || Scratch::new(tracer.channels.count());
    parallel::for_each(quality.threads, rows, scratch, |scratch, (row, y)| {
        for (pixel, x) in row.iter_mut().zip(0..width) {
            let (mean, covered) = shade(stage, &tracer, quality.samples.max(1), [x, y], scratch);
            *pixel = mean;
            if covered {
                shows_body.store(true, Ordering::Relaxed);
            }
        }
        tick();
    });
    Ok(Framebuffer { size: stage.camera.size, pixels, shows_body: shows_body.into_inner() })
}

/// The mean over the samples of a pixel, and whether any of them hit the body.
fn shade(
    stage: &Stage<'_>,
    tracer: &Tracer<'_>,
    samples: u32,
    [x, y]: [u32; 2],
    scratch: &mut Scratch,
) -> ([f32; 4], bool) {
    let camera = stage.camera;
    let (mut behind, mut covered) = ([0.0; 3], 0);
    scratch.radiance.fill(0.0);
    for sample in 0..samples {
        let mut stream = SampleStream::new(sample, y * camera.size[0] + x);
        let [right, down] = if samples == 1 { [0.5; 2] } else { stream.next() };
        let direction = camera.direction(f64::from(x) + right, f64::from(y) + down);
        if tracer.trace(camera.eye, direction, &mut stream, scratch) {
            covered += 1;
            continue;
        }
        let rgb = match stage.background {
            Background::Environment => stage.backdrop.radiance(direction),
            Background::Transparent => continue,
            Background::Colour(rgb) => rgb,
        };
        (0..3).for_each(|c| behind[c] += rgb[c]);
    }
    let count = samples as f32;
    let [r, g, b] = tracer.channels.colour(&scratch.radiance);
    let coverage = if stage.background == Background::Transparent { covered as f32 / count } else { 1.0 };
    ([(r + behind[0]) / count, (g + behind[1]) / count, (b + behind[2]) / count, coverage], covered > 0)
}
