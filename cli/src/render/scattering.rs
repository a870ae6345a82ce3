//! Light that a table of scattered light reflects to the viewer.
//!
//! The table's incident direction is the viewer, in evaluation and in sampling: f is reciprocal. Directions are sampled
//! by the table and, where the light is not the same everywhere, by the environment; the balance heuristic (Veach 1997)
//! combines the two. Facet lobes come from directions of their own, which are all looked up.
//!
//! Where a ray leaves to another part of the body, only one of the ways to go on is followed, chosen in proportion to
//! what it reflects.

use glam::{DVec3, Vec3};
use goniochrome::trace::sobol::sobol;

use super::body::SurfaceHit;
use super::mesh::ShadingFrame;
use super::pyramid::Pyramid;
use super::surface::Scattering;
use super::tracer::{PREVIEW_RAYS, SampleStream, Scratch, Tracer, above};

/// Directions that a pixel of a preview samples, shared out among its rays.
const PREVIEW_SAMPLES: u32 = 64;
/// Scrambling of these directions.
const PREVIEW_SEED: u32 = 1;

// STUB until the core has facet lobes.
trait Lobes {
    fn lobe_count(&self) -> usize {
        0
    }
    fn lobe(&self, _: Vec3, _: usize) -> Option<Vec3> {
        None
    }
    fn lobe_power(&self, _: Vec3, _: usize, _: &mut [f32]) {}
}
impl Lobes for goniochrome::table::ScatterTable<'_> {}

/// A hit on a surface that scatters.
struct ScatterHit<'a> {
    scattering: &'a Scattering<'a>,
    frame: ShadingFrame,
    /// Direction to the viewer in the frame.
    viewer: Vec3,
}

impl<'a> ScatterHit<'a> {
    fn new(scattering: &'a Scattering<'a>, hit: &SurfaceHit, wo: DVec3) -> Self {
        let frame = hit.frame.facing(wo);
        Self { scattering, frame, viewer: above(frame.to_local(wo)).as_vec3() }
    }

    /// Sets the product of throughput and f for light from a direction of the frame.
    fn reflect(&self, to_light: Vec3, scratch: &mut Scratch) {
        self.scattering.table.eval(self.viewer, to_light, &mut scratch.reflectance);
        scratch.multiply();
    }

    /// Density per solid angle with which the table samples a direction of the frame.
    fn pdf(&self, to_light: Vec3) -> f64 {
        f64::from(self.scattering.sampler.pdf(self.viewer, to_light))
    }

    /// A direction of the frame drawn by the table, and its density per solid angle.
    fn sample(&self, u: [f64; 2]) -> Option<(Vec3, f64)> {
        let (to_light, pdf) = self.scattering.sampler.sample(self.viewer, u.map(|u| u as f32))?;
        (pdf > 0.0 && to_light.z > 0.0).then(|| (to_light.normalize(), f64::from(pdf)))
    }

    /// Direction of a facet lobe in the world, if its light is seen; sets the product of throughput and its power.
    fn lobe(&self, lobe: usize, scratch: &mut Scratch) -> Option<DVec3> {
        let to_light = self.scattering.table.lobe(self.viewer, lobe)?;
        self.scattering.table.lobe_power(self.viewer, lobe, &mut scratch.reflectance);
        scratch.multiply();
        Some(self.to_world(to_light))
    }

    fn to_world(&self, to_light: Vec3) -> DVec3 {
        self.frame.to_world(to_light.as_dvec3()).normalize()
    }
}

/// Chooses one among several ways to go on.
struct Onward {
    /// Uniform in [0, 1), made so again by each choice.
    choice: f64,
    /// Sum of the weights of the ways that were offered, and the weight of the one that is taken.
    weights: [f64; 2],
    taken: Option<(SurfaceHit, DVec3)>,
}

impl Onward {
    fn new(choice: f64) -> Self {
        Self { choice, weights: [0.0; 2], taken: None }
    }

    /// Offers a way to the next hit in the direction `wi`, along which light is multiplied by the scratch's product
    /// times `scale`.
    fn offer(&mut self, next: SurfaceHit, wi: DVec3, scale: f64, scratch: &mut Scratch) {
        let scale = scale as f32;
        scratch.product.iter_mut().for_each(|product| *product *= scale);
        let weight: f64 = scratch.product.iter().map(|product| f64::from(product.abs())).sum();
        if weight <= 0.0 {
            return;
        }
        self.weights[0] += weight;
        let share = weight / self.weights[0];
        if self.choice < share {
            self.choice /= share;
            self.weights[1] = weight;
            self.taken = Some((next, wi));
            std::mem::swap(&mut scratch.onward, &mut scratch.product);
        } else {
            self.choice = (self.choice - share) / (1.0 - share);
        }
    }

    /// The way that is taken; sets the throughput along it, over the probability of taking it.
    fn take(self, scratch: &mut Scratch) -> Option<(SurfaceHit, DVec3)> {
        let taken = self.taken?;
        let over_probability = (self.weights[0] / self.weights[1]) as f32;
        for (through, onward) in scratch.throughput.iter_mut().zip(&scratch.onward) {
            *through = onward * over_probability;
        }
        Some(taken)
    }
}

impl Tracer<'_> {
    /// Follows scattering reflections from the first hit of a ray that leaves it along `wo`.
    pub(super) fn trace_scattered(
        &self,
        scattering: &Scattering<'_>,
        first: SurfaceHit,
        wo: DVec3,
        stream: &mut SampleStream,
        scratch: &mut Scratch,
    ) {
        let (mut hit, mut wo) = (first, wo);
        for left in (0..self.reflections).rev() {
            let here = ScatterHit::new(scattering, &hit, wo);
            let last = left == 0;
            let next_hit = |wi: DVec3| if last { None } else { self.next_hit(&hit, &here.frame, wi) };
            let mut onward = Onward::new(if last { 0.0 } else { stream.next()[0] });
            for lobe in 0..scattering.table.lobe_count() {
                let Some(wi) = here.lobe(lobe, scratch) else { continue };
                match next_hit(wi) {
                    Some(next) => onward.offer(next, wi, 1.0, scratch),
                    None => self.add_light(self.widened.radiance(wi), 1.0, scratch),
                }
            }
            if !self.environment.is_uniform() {
                let (wi, by_light) = self.environment.sample(stream.next());
                let to_light = here.frame.to_local(wi).as_vec3();
                if to_light.z > 0.0 && by_light > 0.0 && next_hit(wi).is_none() {
                    let scale = f64::from(to_light.z) / (by_light + here.pdf(to_light));
                    here.reflect(to_light, scratch);
                    self.add_light(self.environment.radiance(wi), scale, scratch);
                }
            }
            if let Some((to_light, by_table)) = here.sample(stream.next()) {
                let wi = here.to_world(to_light);
                here.reflect(to_light, scratch);
                let cos = f64::from(to_light.z);
                match next_hit(wi) {
                    Some(next) => onward.offer(next, wi, cos / by_table, scratch),
                    None => {
                        let by_light = if self.environment.is_uniform() { 0.0 } else { self.environment.pdf(wi) };
                        self.add_light(self.environment.radiance(wi), cos / (by_light + by_table), scratch);
                    }
                }
            }
            let Some((next, wi)) = onward.take(scratch) else { return };
            (hit, wo) = (next, -wi);
        }
    }

    /// Adds what the first hit of a ray of a preview reflects along `wo`.
    pub(super) fn preview_scattered(
        &self,
        scattering: &Scattering<'_>,
        pyramid: &Pyramid<'_>,
        hit: &SurfaceHit,
        wo: DVec3,
        ray: u32,
        scratch: &mut Scratch,
    ) {
        let here = ScatterHit::new(scattering, hit, wo);
        for lobe in 0..scattering.table.lobe_count() {
            if let Some(wi) = here.lobe(lobe, scratch) {
                self.add_light(self.widened.radiance(wi), 1.0, scratch);
            }
        }
        // The rays of a pixel share its samples; those of each are evenly spread too.
        const OF_RAY: u32 = PREVIEW_SAMPLES / PREVIEW_RAYS;
        for sample in ray * OF_RAY..(ray + 1) * OF_RAY {
            let Some((to_light, pdf)) = here.sample(sobol(sample, PREVIEW_SEED)) else { continue };
            here.reflect(to_light, scratch);
            let light = pyramid.radiance(here.to_world(to_light), 1.0 / (f64::from(PREVIEW_SAMPLES) * pdf));
            self.add_light(light, f64::from(to_light.z) / (f64::from(OF_RAY) * pdf), scratch);
        }
    }

    /// Adds light, times the scratch's product and `scale`, to what reaches the viewer.
    fn add_light(&self, rgb: [f32; 3], scale: f64, scratch: &mut Scratch) {
        self.channels.add_light(&mut scratch.radiance, &scratch.product, rgb, scale as f32);
    }
}
