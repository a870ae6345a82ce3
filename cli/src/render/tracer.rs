//! Path tracing of light along a ray from the camera.
//!
//! At each hit the surface frame is turned to the viewer: both sides of a sheet carry the same structure. A mirror-like
//! table reflects the ray once, L = ρ(θ) E(mirror direction). For other tables, directions are sampled by the table
//! and, where the light is not the same everywhere, by the environment; the balance heuristic (Veach 1997) combines the
//! two. Diffraction orders come from directions of their own, which are all looked up.
//!
//! A reflected ray that hits the body again is reflected again, up to a number of reflections. From the last of them
//! the environment is seen as if the body did not block it: with one reflection, the body does not see itself at all.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;
use goniochrome::table::{ScatterSampler, ScatterTable};
use goniochrome::trace::sobol::sobol;

use super::body::{Body, SurfaceHit};
use super::channels::Channels;
use super::environment::Environment;
use super::mesh::ShadingFrame;
use super::surface::{Prepared, reflect};

/// Share of the directions that are sampled by the cosine instead of the table. It keeps the density positive where
/// noise in the table makes f(wi, wo) and f(wo, wi) differ, since the table samples by the latter.
const BY_COSINE: f64 = 0.1;

/// The scene and the settings that all rays share.
pub(super) struct Tracer<'a> {
    pub body: &'a Body<'a>,
    pub surface: Prepared<'a>,
    pub channels: &'a Channels,
    pub environment: &'a Environment,
    pub reflections: u32,
}

/// The working memory of one thread: numbers for each channel.
pub(super) struct Scratch {
    pub radiance: Vec<f32>,
    throughput: Vec<f32>,
    brdf: Vec<f32>,
    product: Vec<f32>,
}

impl Scratch {
    pub fn new(channels: usize) -> Self {
        let empty = || vec![0.0; channels];
        Self { radiance: empty(), throughput: empty(), brdf: empty(), product: empty() }
    }
}

/// Quasi-random numbers for one sample of a pixel: a pair for each decision, each well spread over the samples.
#[derive(Clone, Copy)]
pub(super) struct SampleStream {
    sample: u32,
    pixel: u32,
    pair: u32,
}

impl SampleStream {
    pub fn new(sample: u32, pixel: u32) -> Self {
        Self { sample, pixel, pair: 0 }
    }

    /// The next pair, each uniform in [0, 1).
    pub fn next(&mut self) -> [f64; 2] {
        self.pair += 1;
        // Odd multipliers (from the golden ratio and from xxHash) keep seeds apart; the sequence hashes them further.
        let seed = self.pixel.wrapping_mul(0x9e37_79b1) ^ self.pair.wrapping_mul(0x85eb_ca77);
        sobol(self.sample, seed)
    }
}

impl Tracer<'_> {
    /// Traces a ray from the camera and adds its light to the scratch's radiance; false if the ray misses the body.
    pub fn trace(&self, eye: DVec3, direction: DVec3, stream: &mut SampleStream, scratch: &mut Scratch) -> bool {
        let Some(hit) = self.body.intersect(eye, direction) else { return false };
        scratch.throughput.fill(1.0);
        match &self.surface {
            Prepared::Mirror { theta_deg, values } => self.trace_mirror(theta_deg, values, hit, direction, scratch),
            Prepared::Scatter { table, sampler } => {
                self.trace_scatter(table, sampler, hit, direction, stream, scratch);
            }
            Prepared::Orders(orders) => {
                let frame = hit.frame.facing(-direction);
                let rgb = orders.radiance(&frame, above(frame.to_local(-direction)), self.environment);
                scratch.radiance.iter_mut().zip(rgb).for_each(|(sum, c)| *sum += c);
            }
        }
        true
    }

    /// Follows mirror reflections from the first hit of a ray.
    fn trace_mirror(
        &self,
        theta_deg: &[f64],
        values: &[f32],
        first: SurfaceHit,
        direction: DVec3,
        scratch: &mut Scratch,
    ) {
        let (mut hit, mut wo) = (first, -direction);
        for left in (0..self.reflections).rev() {
            let frame = hit.frame.facing(wo);
            let cos = wo.dot(frame.normal).clamp(0.0, 1.0);
            // acos would lose half the digits near the normal.
            let sin = wo.cross(frame.normal).length();
            reflect(theta_deg, values, sin.atan2(cos).to_degrees(), &mut scratch.throughput);
            let wi = (2.0 * cos * frame.normal - wo).normalize();
            match (left > 0).then(|| self.next_hit(&hit, &frame, wi)).flatten() {
                Some(next) => (hit, wo) = (next, -wi),
                None => {
                    let light = self.environment.radiance(wi);
                    return self.channels.add_light(&mut scratch.radiance, &scratch.throughput, light, 1.0);
                }
            }
        }
    }

    /// The nearest hit of the ray that leaves a hit in the direction `wi`.
    fn next_hit(&self, hit: &SurfaceHit, frame: &ShadingFrame, wi: DVec3) -> Option<SurfaceHit> {
        // An interpolated normal may reflect into the triangle itself; the ray is then mirrored at the triangle's
        // plane.
        let below = wi.dot(frame.face).min(0.0);
        self.body.intersect(self.body.offset_origin(hit.point, frame), wi - 2.0 * below * frame.face)
    }

    /// Follows scattering reflections from the first hit of a ray.
    fn trace_scatter(
        &self,
        table: &ScatterTable<'_>,
        sampler: &ScatterSampler<'_>,
        first: SurfaceHit,
        direction: DVec3,
        stream: &mut SampleStream,
        scratch: &mut Scratch,
    ) {
        let (mut hit, mut wo) = (first, -direction);
        for left in (0..self.reflections).rev() {
            let frame = hit.frame.facing(wo);
            let local = LocalHit { table, sampler, wo: above(frame.to_local(wo)) };
            let last = left == 0;
            if !self.environment.is_uniform() {
                let (wi, by_light) = self.environment.sample(stream.next());
                let to_light = frame.to_local(wi);
                if to_light.z > 0.0 && by_light > 0.0 && (last || self.next_hit(&hit, &frame, wi).is_none()) {
                    let scale = to_light.z / (by_light + local.pdf(to_light));
                    self.add_scattered(&local, to_light, wi, scale, scratch);
                }
            }
            let [choice, drawn] = [stream.next(), stream.next()];
            let Some(from_light) = local.sample(choice[0], drawn) else { return };
            let by_table = local.pdf(from_light);
            if by_table <= 0.0 {
                return;
            }
            let wi = frame.to_world(from_light);
            match (!last).then(|| self.next_hit(&hit, &frame, wi)).flatten() {
                Some(next) => {
                    local.eval(from_light, &mut scratch.brdf);
                    let scale = (from_light.z / by_table) as f32;
                    scratch.throughput.iter_mut().zip(&scratch.brdf).for_each(|(through, f)| *through *= f * scale);
                    (hit, wo) = (next, -wi);
                }
                None => {
                    let by_light = if self.environment.is_uniform() { 0.0 } else { self.environment.pdf(wi) };
                    return self.add_scattered(&local, from_light, wi, from_light.z / (by_light + by_table), scratch);
                }
            }
        }
    }

    /// Adds light from the environment in the direction `wi`, reflected once at a hit, times `scale`.
    fn add_scattered(&self, local: &LocalHit<'_>, wi_local: DVec3, wi: DVec3, scale: f64, scratch: &mut Scratch) {
        local.eval(wi_local, &mut scratch.brdf);
        let products = scratch.throughput.iter().zip(&scratch.brdf);
        scratch.product.iter_mut().zip(products).for_each(|(product, (through, f))| *product = through * f);
        let light = self.environment.radiance(wi);
        self.channels.add_light(&mut scratch.radiance, &scratch.product, light, scale as f32);
    }
}

/// A hit on a surface that scatters, in the frame of the surface.
struct LocalHit<'a> {
    table: &'a ScatterTable<'a>,
    sampler: &'a ScatterSampler<'a>,
    wo: DVec3,
}

impl LocalHit<'_> {
    /// f(wi, wo) in each channel.
    fn eval(&self, wi: DVec3, brdf: &mut [f32]) {
        self.table.eval(wi.as_vec3(), self.wo.as_vec3(), brdf);
    }

    /// Samples a direction towards the light, by f(wo, wi) cos θ or, with probability [`BY_COSINE`], by the cosine.
    fn sample(&self, choice: f64, u: [f64; 2]) -> Option<DVec3> {
        if choice < BY_COSINE {
            let (sin, phi) = (u[0].sqrt(), TAU * u[1]);
            return Some(above(DVec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - u[0]).sqrt())));
        }
        let (wi, _) = self.sampler.sample(self.wo.as_vec3(), u.map(|u| u as f32))?;
        Some(wi.as_dvec3().normalize())
    }

    /// The probability density per solid angle of [`LocalHit::sample`].
    fn pdf(&self, wi: DVec3) -> f64 {
        let by_table = f64::from(self.sampler.pdf(self.wo.as_vec3(), wi.as_vec3()));
        BY_COSINE * wi.z * FRAC_1_PI + (1.0 - BY_COSINE) * by_table
    }
}

/// The direction, lifted above the horizon, where tables end, if it lies below.
fn above(local: DVec3) -> DVec3 {
    const MIN_COS: f64 = 1e-6;
    if local.z >= MIN_COS { local } else { DVec3::new(local.x, local.y, MIN_COS).normalize() }
}
