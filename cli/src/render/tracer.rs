//! Light along a ray from the camera.
//!
//! At each contact the surface frame is turned to the viewer: both sides of a sheet carry the same structure. A mirror-like
//! table reflects the ray once, L = ρ(θ) E(mirror direction). Other tables draw directions by the table and, where the light is
//! not the same everywhere, by the environment, joined by the balance heuristic (Veach 1997).
//!
//! Reflected light that meets the body again is followed over as many reflections as asked for; from the last of them the
//! environment is seen as if the body did not stand in its way. With one, the body does not see itself at all.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::DVec3;
use goniochrome::table::{ScatterSampler, ScatterTable};
use goniochrome::trace::sobol::sobol;

use super::body::{Body, SurfaceHit};
use super::channels::Channels;
use super::environment::Environment;
use super::mesh::ShadingFrame;
use super::surface::{Prepared, narrow, reflect};

/// Share of the directions that are drawn by the cosine instead of the table: it keeps the density positive where noise in the
/// table made f(wi, wo) and f(wo, wi) differ, since the table draws by the latter.
const BY_COSINE: f64 = 0.1;

/// What all rays share.
pub(super) struct Tracer<'a> {
    pub body: &'a Body<'a>,
    pub surface: Prepared<'a>,
    pub channels: &'a Channels,
    pub environment: &'a Environment,
    pub reflections: u32,
}

/// One worker's numbers, one for each channel.
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

/// Random numbers of one sample of a pixel: a pair for each decision, well spread over the samples.
#[derive(Clone, Copy)]
pub(super) struct Stream {
    sample: u32,
    pixel: u32,
    pair: u32,
}

impl Stream {
    pub fn new(sample: u32, pixel: u32) -> Self {
        Self { sample, pixel, pair: 0 }
    }

    pub fn next(&mut self) -> [f64; 2] {
        self.pair += 1;
        // Odd multipliers (of the golden ratio and of xxHash) keep seeds apart; the sequence hashes them further.
        let seed = self.pixel.wrapping_mul(0x9e37_79b1) ^ self.pair.wrapping_mul(0x85eb_ca77);
        sobol(self.sample, seed)
    }
}

impl Tracer<'_> {
    /// Adds the light that a ray from the camera brings to the scratch's radiance; false if it misses the body.
    pub fn add(&self, eye: DVec3, direction: DVec3, stream: &mut Stream, scratch: &mut Scratch) -> bool {
        let Some(contact) = self.body.intersect(eye, direction) else { return false };
        scratch.throughput.fill(1.0);
        match self.surface {
            Prepared::Mirror { theta_deg, values } => self.mirrors(theta_deg, values, contact, direction, scratch),
            Prepared::Scatter { table, sampler } => {
                self.scatters(&table, &sampler, contact, direction, stream, scratch);
            }
        }
        true
    }

    fn mirrors(&self, theta_deg: &[f64], values: &[f32], first: SurfaceHit, direction: DVec3, scratch: &mut Scratch) {
        let (mut contact, mut wo) = (first, -direction);
        for left in (0..self.reflections).rev() {
            let frame = contact.frame.facing(wo);
            let cos = wo.dot(frame.normal).clamp(0.0, 1.0);
            // acos would lose half the digits near the normal.
            let sin = wo.cross(frame.normal).length();
            reflect(theta_deg, values, sin.atan2(cos).to_degrees(), &mut scratch.throughput);
            let wi = (2.0 * cos * frame.normal - wo).normalize();
            match (left > 0).then(|| self.next(&contact, &frame, wi)).flatten() {
                Some(next) => (contact, wo) = (next, -wi),
                None => {
                    let light = self.environment.radiance(wi);
                    return self.channels.add_light(&mut scratch.radiance, &scratch.throughput, light, 1.0);
                }
            }
        }
    }

    /// What light from `wi` would have met before.
    fn next(&self, contact: &SurfaceHit, frame: &ShadingFrame, wi: DVec3) -> Option<SurfaceHit> {
        // An interpolated normal may reflect into the triangle itself; the ray then leaves as much above it.
        let below = wi.dot(frame.face).min(0.0);
        self.body.intersect(self.body.offset_origin(contact.point, frame), wi - 2.0 * below * frame.face)
    }

    fn scatters(
        &self,
        table: &ScatterTable<'_>,
        sampler: &ScatterSampler<'_>,
        first: SurfaceHit,
        direction: DVec3,
        stream: &mut Stream,
        scratch: &mut Scratch,
    ) {
        let (mut contact, mut wo) = (first, -direction);
        for left in (0..self.reflections).rev() {
            let frame = contact.frame.facing(wo);
            let local = Local { table, sampler, wo: above(frame.to_local(wo)) };
            let last = left == 0;
            if !self.environment.is_uniform() {
                let (wi, by_light) = self.environment.sample(stream.next());
                let to_light = frame.to_local(wi);
                if to_light.z > 0.0 && by_light > 0.0 && (last || self.next(&contact, &frame, wi).is_none()) {
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
            match (!last).then(|| self.next(&contact, &frame, wi)).flatten() {
                Some(next) => {
                    local.eval(from_light, &mut scratch.brdf);
                    let scale = (from_light.z / by_table) as f32;
                    scratch.throughput.iter_mut().zip(&scratch.brdf).for_each(|(through, f)| *through *= f * scale);
                    (contact, wo) = (next, -wi);
                }
                None => {
                    let by_light = if self.environment.is_uniform() { 0.0 } else { self.environment.pdf(wi) };
                    return self.add_scattered(&local, from_light, wi, from_light.z / (by_light + by_table), scratch);
                }
            }
        }
    }

    fn add_scattered(&self, local: &Local<'_>, wi_local: DVec3, wi: DVec3, scale: f64, scratch: &mut Scratch) {
        local.eval(wi_local, &mut scratch.brdf);
        let products = scratch.throughput.iter().zip(&scratch.brdf);
        scratch.product.iter_mut().zip(products).for_each(|(product, (through, f))| *product = through * f);
        let light = self.environment.radiance(wi);
        self.channels.add_light(&mut scratch.radiance, &scratch.product, light, scale as f32);
    }
}

/// A contact with a surface that scatters, in its own frame.
struct Local<'a> {
    table: &'a ScatterTable<'a>,
    sampler: &'a ScatterSampler<'a>,
    wo: DVec3,
}

impl Local<'_> {
    fn eval(&self, wi: DVec3, brdf: &mut [f32]) {
        self.table.eval(narrow(wi), narrow(self.wo), brdf);
    }

    /// A direction towards the light, by f(wo, wi) cos θ, or now and then by the cosine.
    fn sample(&self, choice: f64, u: [f64; 2]) -> Option<DVec3> {
        if choice < BY_COSINE {
            let (sin, phi) = (u[0].sqrt(), TAU * u[1]);
            return Some(above(DVec3::new(sin * phi.cos(), sin * phi.sin(), (1.0 - u[0]).sqrt())));
        }
        let (wi, _) = self.sampler.sample(narrow(self.wo), u.map(|u| u as f32))?;
        Some(wi.as_dvec3().normalize())
    }

    fn pdf(&self, wi: DVec3) -> f64 {
        let by_table = f64::from(self.sampler.pdf(narrow(self.wo), narrow(wi)));
        BY_COSINE * wi.z * FRAC_1_PI + (1.0 - BY_COSINE) * by_table
    }
}

/// A direction that grazes the surface at most: tables end at the horizon.
fn above(local: DVec3) -> DVec3 {
    const MIN_COS: f64 = 1e-6;
    if local.z >= MIN_COS { local } else { DVec3::new(local.x, local.y, MIN_COS).normalize() }
}
