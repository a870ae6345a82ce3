//! Path tracing of light along a ray from the camera.
//!
//! At each hit the surface frame is turned to the viewer: both sides of a sheet carry the same structure. A mirror-like
//! table reflects the ray once, L = ρ(θ) E(mirror direction); what a sheet lets through is followed in
//! [`super::sheet`]. Diffraction orders come from directions of their own, which are all looked up. Tables of scattered
//! light and rough surfaces are followed in [`super::scattering`].
//!
//! A reflected ray that hits the body again is reflected again, up to a number of reflections. From the last of them
//! the environment is seen as if the body did not block it: with one reflection, the body does not see itself at all.

use glam::DVec3;
use goniochrome::trace::sobol::sobol;

use super::body::{Body, SurfaceHit};
use super::channels::Channels;
use super::environment::Environment;
use super::glossy::Viewed;
use super::mesh::ShadingFrame;
use super::mirror_like::MirrorLike;
use super::pyramid::Pyramid;
use super::surface::Prepared;

/// Rays through each pixel of a preview.
pub(super) const PREVIEW_RAYS: u32 = 4;

/// Place of a ray of a preview in its pixel: a square that is turned, so that edges along rows, columns and diagonals
/// have four different coverages.
pub(super) fn preview_place(ray: u32) -> [f64; 2] {
    [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]][(ray % PREVIEW_RAYS) as usize]
}

/// The scene and the settings that all rays share.
pub(super) struct Tracer<'a> {
    pub body: &'a Body<'a>,
    pub surface: Prepared<'a>,
    pub channels: &'a Channels,
    pub environment: &'a Environment,
    /// The light as diffraction orders and facet lobes see it.
    pub widened: &'a Environment,
    /// The light of a preview.
    pub pyramid: Option<Pyramid<'a>>,
    pub reflections: u32,
    /// The colour that is seen straight through a sheet, instead of the environment.
    pub behind: Option<[f32; 3]>,
}

/// A way of light that is still to be followed from a hit.
pub(super) struct Way {
    pub hit: SurfaceHit,
    pub wo: DVec3,
    pub throughput: Vec<f32>,
    /// Reflections that may still follow.
    pub reflections: u32,
    /// Passages that may still follow.
    pub passages: u32,
    /// Whether the way leads straight on from the camera.
    pub is_straight: bool,
}

/// The working memory of one thread: numbers for each channel.
pub(super) struct Scratch {
    pub radiance: Vec<f32>,
    pub(super) throughput: Vec<f32>,
    pub(super) reflectance: Vec<f32>,
    pub(super) product: Vec<f32>,
    pub(super) onward: Vec<f32>,
    pub(super) viewed: Viewed,
    /// Ways through a sheet that are still to be followed.
    pub(super) ways: Vec<Way>,
}

impl Scratch {
    pub fn new(channels: usize) -> Self {
        let empty = || vec![0.0; channels];
        Self {
            radiance: empty(),
            throughput: empty(),
            reflectance: empty(),
            product: empty(),
            onward: empty(),
            viewed: Viewed::default(),
            ways: Vec::new(),
        }
    }

    /// Sets the product of throughput and reflectance.
    pub fn multiply(&mut self) {
        let factors = self.throughput.iter().zip(&self.reflectance);
        self.product.iter_mut().zip(factors).for_each(|(product, (through, f))| *product = through * f);
    }
}

/// Quasi-random numbers for one ray through a pixel: points of the unit square for each decision.
///
/// The points of a decision come from a two-dimensional Sobol sequence over the rays of its pixel, with an Owen
/// scrambling and an order of its own for each pixel, half and decision. So they are evenly spread over the rays, and
/// independent of those of other decisions, halves and pixels.
#[derive(Clone, Copy)]
pub(super) struct SampleStream {
    ray: u32,
    seed: u32,
    decision: u32,
}

impl SampleStream {
    pub fn new(ray: u32, pixel: u32, half: u32) -> Self {
        // Odd multipliers (from the golden ratio and from xxHash) keep seeds apart; the sequence hashes them further.
        Self { ray, seed: pixel.wrapping_mul(0x9e37_79b1) ^ half.wrapping_mul(0xc2b2_ae3d), decision: 0 }
    }

    /// The number of the ray.
    pub fn ray(&self) -> u32 {
        self.ray
    }

    /// The point of the next decision, each number uniform in [0, 1).
    pub fn next(&mut self) -> [f64; 2] {
        self.several(1).next().unwrap_or_default()
    }

    /// So many points of the next decision.
    pub fn several(&mut self, count: u32) -> impl Iterator<Item = [f64; 2]> + use<> {
        self.decision += 1;
        let seed = self.seed ^ self.decision.wrapping_mul(0x85eb_ca77);
        let first = self.ray.wrapping_mul(count);
        (0..count).map(move |i| sobol(first.wrapping_add(i), seed))
    }
}

impl Tracer<'_> {
    /// Adds the light along a ray from the camera, whose first hit is given, to the scratch's radiance.
    pub fn trace(&self, hit: SurfaceHit, direction: DVec3, stream: &mut SampleStream, scratch: &mut Scratch) {
        scratch.throughput.fill(1.0);
        match &self.surface {
            Prepared::Mirror(mirror) if mirror.is_sheet() => self.trace_sheet(mirror, hit, direction, scratch),
            Prepared::Mirror(mirror) => self.trace_mirror(mirror, hit, direction, scratch),
            Prepared::Glossy(glossy) => self.trace_scattered(glossy, hit, -direction, stream, scratch),
            Prepared::Orders(orders) => {
                let frame = hit.frame.facing(-direction);
                let rgb = orders.radiance(&frame, above(frame.to_local(-direction)), self.widened);
                scratch.radiance.iter_mut().zip(rgb).for_each(|(sum, c)| *sum += c);
            }
        }
    }

    /// Follows mirror reflections from the first hit of a ray.
    fn trace_mirror(&self, mirror: &MirrorLike, first: SurfaceHit, direction: DVec3, scratch: &mut Scratch) {
        let (mut hit, mut wo) = (first, -direction);
        for left in (0..self.reflections).rev() {
            let frame = hit.frame.facing(wo);
            let (theta_deg, wi) = mirrored(&frame, wo);
            mirror.reflect(mirror.at(self.body, &hit), theta_deg, &mut scratch.throughput);
            match (left > 0).then(|| self.next_hit(&hit, &frame, wi)).flatten() {
                Some(next) => (hit, wo) = (next, -wi),
                None => {
                    let light = self.environment.radiance(wi);
                    return self.channels.add_light(&mut scratch.radiance, &scratch.throughput, light, 1.0);
                }
            }
        }
    }

    /// The nearest hit of the ray that goes on behind a hit.
    pub(super) fn next_hit_behind(&self, hit: &SurfaceHit, frame: &ShadingFrame, onward: DVec3) -> Option<SurfaceHit> {
        let behind = ShadingFrame { face: -frame.face, ..*frame };
        self.body.intersect(self.body.offset_origin(hit.point, &behind), onward)
    }

    /// The nearest hit of the ray that leaves a hit in the direction `wi`.
    pub(super) fn next_hit(&self, hit: &SurfaceHit, frame: &ShadingFrame, wi: DVec3) -> Option<SurfaceHit> {
        // An interpolated normal may reflect into the triangle itself; the ray is then mirrored at the triangle's
        // plane.
        let below = wi.dot(frame.face).min(0.0);
        self.body.intersect(self.body.offset_origin(hit.point, frame), wi - 2.0 * below * frame.face)
    }
}

/// The angle of incidence in degrees at a frame that faces `wo`, and the mirrored direction.
pub(super) fn mirrored(frame: &ShadingFrame, wo: DVec3) -> (f64, DVec3) {
    let cos = wo.dot(frame.normal).clamp(0.0, 1.0);
    // acos would lose half the digits near the normal.
    let sin = wo.cross(frame.normal).length();
    (sin.atan2(cos).to_degrees(), (2.0 * cos * frame.normal - wo).normalize())
}

/// The direction, lifted above the horizon, where tables end, if it lies below.
pub(super) fn above(local: DVec3) -> DVec3 {
    const MIN_COS: f64 = 1e-6;
    if local.z >= MIN_COS { local } else { DVec3::new(local.x, local.y, MIN_COS).normalize() }
}
