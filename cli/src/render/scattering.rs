//! Light that reaches the viewer from a surface that reflects into many directions.
//!
//! Directions are sampled by the surface's own density and, where the light is not the same everywhere, by the
//! environment; the balance heuristic (Veach 1997) combines the two. Facet lobes come from directions of their own,
//! which are all looked up.
//!
//! Of the ways to other parts of the body, only one is followed, chosen in proportion to what it reflects. What a sheet
//! lets through is followed too, as in [`super::sheet`].

use glam::{DVec3, Vec3};
use goniochrome::trace::sobol::sobol;

use super::body::SurfaceHit;
use super::glossy::{Glossy, Towards};
use super::mesh::ShadingFrame;
use super::pyramid::Pyramid;
use super::sheet::PASSAGES;
use super::tracer::{PREVIEW_RAYS, SampleStream, Scratch, Tracer, Way, above};

/// Directions that each ray samples by the table. The ray has one place on the body, at which the table is interpolated
/// once.
const BY_TABLE: u32 = 16;
/// Directions that each ray samples by the light: they find small lamps, and are worth less elsewhere.
const BY_LIGHT: u32 = 4;
/// Facets of a sheet that each ray passes through: over them, transmittance varies little.
const PASSED: u32 = 4;

/// Directions that a pixel of a preview samples, shared out among its rays.
const PREVIEW_SAMPLES: u32 = 64;
/// Scrambling of these directions.
const PREVIEW_SEED: u32 = 1;

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
    /// Follows scattering reflections, and what a sheet lets through, from the first hit of a ray that leaves it along
    /// `wo`.
    pub(super) fn trace_scattered(
        &self,
        surface: &Glossy<'_>,
        first: SurfaceHit,
        wo: DVec3,
        stream: &mut SampleStream,
        scratch: &mut Scratch,
    ) {
        let (throughput, reflections) = (scratch.throughput.clone(), self.reflections);
        scratch.ways.push(Way { hit: first, wo, throughput, reflections, passages: PASSAGES, is_straight: true });
        while let Some(way) = scratch.ways.pop() {
            scratch.throughput.copy_from_slice(&way.throughput);
            let frame = way.hit.frame.facing(way.wo);
            let viewer = above(frame.to_local(way.wo)).as_vec3();
            surface.look(self.body, &way.hit, viewer, &mut scratch.viewed);
            self.pass(surface, &way, &frame, stream, scratch);
            match &self.pyramid {
                Some(pyramid) => self.preview_scattered(surface, pyramid, &frame, viewer, stream.ray(), scratch),
                None => self.scatter(surface, way, &frame, viewer, stream, scratch),
            }
        }
    }

    /// Follows what a sheet lets through.
    fn pass(
        &self,
        surface: &Glossy<'_>,
        way: &Way,
        frame: &ShadingFrame,
        stream: &mut SampleStream,
        scratch: &mut Scratch,
    ) {
        if !surface.is_sheet() {
            return;
        }
        let mut points = [[0.0; 2]; PASSED as usize];
        if self.pyramid.is_some() {
            points.iter_mut().zip(stream.ray() * PASSED..).for_each(|(u, i)| *u = sobol(i, PREVIEW_SEED));
        } else {
            points.iter_mut().zip(stream.several(PASSED)).for_each(|(u, point)| *u = point);
        }
        let points = points.map(|u| u.map(|u| u as f32));
        let mut passed = vec![0.0; way.throughput.len()];
        surface.transmit(&scratch.viewed, &points, &mut scratch.reflectance, &mut passed);
        passed.iter_mut().zip(&way.throughput).for_each(|(passed, through)| *passed *= through);
        self.go_on(way, frame, passed, scratch);
    }

    /// Adds the light that is reflected at the end of a way, and pushes the way on to another part of the body.
    fn scatter(
        &self,
        surface: &Glossy<'_>,
        way: Way,
        frame: &ShadingFrame,
        viewer: Vec3,
        stream: &mut SampleStream,
        scratch: &mut Scratch,
    ) {
        let is_even = self.environment.is_uniform();
        let by_light = if is_even { 0 } else { BY_LIGHT };
        // The balance heuristic: one over the number of directions that both ways draw per solid angle.
        let scale = |towards: &Towards, pdf_of_light: f64| {
            1.0 / (f64::from(BY_TABLE) * towards.pdf() + f64::from(by_light) * pdf_of_light)
        };
        let left = way.reflections - 1;
        let last = left == 0;
        let next_hit = |wi: DVec3| if last { None } else { self.next_hit(&way.hit, frame, wi) };
        let mut onward = Onward::new(if last { 0.0 } else { stream.next()[0] });
        for lobe in 0..surface.lobes() {
            let Some(wi) = reflect_lobe(surface, lobe, frame, viewer, scratch) else { continue };
            match next_hit(wi) {
                Some(next) => onward.offer(next, wi, 1.0, scratch),
                None => self.add_light(self.widened.radiance(wi), 1.0, scratch),
            }
        }
        for u in stream.several(by_light) {
            let (wi, pdf) = self.environment.sample(u);
            let direction = frame.to_local(wi).as_vec3();
            if direction.z > 0.0 && pdf > 0.0 && next_hit(wi).is_none() {
                let Some(towards) = surface.towards(&scratch.viewed, direction) else { continue };
                reflect(surface, &towards, scratch);
                self.add_light(self.environment.radiance(wi), scale(&towards, pdf), scratch);
            }
        }
        for u in stream.several(BY_TABLE) {
            let Some(towards) = surface.sample(&scratch.viewed, u.map(|u| u as f32)) else { continue };
            let wi = frame.to_world(towards.direction()).normalize();
            reflect(surface, &towards, scratch);
            match next_hit(wi) {
                Some(next) => onward.offer(next, wi, scale(&towards, 0.0), scratch),
                None => {
                    let pdf = if is_even { 0.0 } else { self.environment.pdf(wi) };
                    self.add_light(self.environment.radiance(wi), scale(&towards, pdf), scratch);
                }
            }
        }
        if let Some((next, wi)) = onward.take(scratch) {
            let throughput = scratch.throughput.clone();
            scratch.ways.push(Way { hit: next, wo: -wi, throughput, reflections: left, is_straight: false, ..way });
        }
    }

    /// Adds what a hit of a ray of a preview reflects to the viewer.
    fn preview_scattered(
        &self,
        surface: &Glossy<'_>,
        pyramid: &Pyramid<'_>,
        frame: &ShadingFrame,
        viewer: Vec3,
        ray: u32,
        scratch: &mut Scratch,
    ) {
        for lobe in 0..surface.lobes() {
            if let Some(wi) = reflect_lobe(surface, lobe, frame, viewer, scratch) {
                self.add_light(self.widened.radiance(wi), 1.0, scratch);
            }
        }
        // The rays of a pixel share its samples; those of each are evenly spread too.
        const OF_RAY: u32 = PREVIEW_SAMPLES / PREVIEW_RAYS;
        for sample in ray * OF_RAY..(ray + 1) * OF_RAY {
            let u = sobol(sample, PREVIEW_SEED).map(|u| u as f32);
            let Some(towards) = surface.sample(&scratch.viewed, u) else { continue };
            reflect(surface, &towards, scratch);
            let (wi, pdf) = (frame.to_world(towards.direction()).normalize(), towards.pdf());
            let light = pyramid.radiance(wi, 1.0 / (f64::from(PREVIEW_SAMPLES) * pdf));
            self.add_light(light, 1.0 / (f64::from(OF_RAY) * pdf), scratch);
        }
    }

    /// Adds light, times the scratch's product and `scale`, to what reaches the viewer.
    fn add_light(&self, rgb: [f32; 3], scale: f64, scratch: &mut Scratch) {
        self.channels.add_light(&mut scratch.radiance, &scratch.product, rgb, scale as f32);
    }
}

/// Sets the product of throughput and f cos θ for light from a direction.
fn reflect(surface: &Glossy<'_>, towards: &Towards, scratch: &mut Scratch) {
    surface.reflect(&scratch.viewed, towards, &mut scratch.reflectance);
    scratch.multiply();
}

/// Direction of a facet lobe in the world, if its light is seen; sets the product of throughput and its reflectance.
fn reflect_lobe(
    surface: &Glossy<'_>,
    lobe: usize,
    frame: &ShadingFrame,
    viewer: Vec3,
    scratch: &mut Scratch,
) -> Option<DVec3> {
    let direction = surface.reflected(viewer, lobe, &mut scratch.reflectance)?;
    scratch.multiply();
    Some(frame.to_world(direction.as_dvec3()).normalize())
}

#[cfg(test)]
mod tests {
    use super::super::body::{Body, BodyShape, BvhMemory};
    use super::*;

    #[test]
    fn the_way_that_is_taken_stands_for_all_that_were_offered() {
        // Rounding of sums of single precision.
        const ROUNDING: f32 = 1e-5;
        let mut memory = BvhMemory::default();
        let body = Body::new(&BodyShape::Sphere, &mut memory).unwrap();
        let hit = body.intersect(DVec3::new(3.0, 0.0, 0.0), DVec3::NEG_X).unwrap();
        let ways = [([0.3, 0.1], 2.0), ([0.0, 0.0], 1.0), ([0.0, 0.5], 0.5), ([0.2, 0.2], 1.0)];
        let mut scratch = Scratch::new(2);
        let (mut sum, mut taken, count) = ([0.0; 2], [0i32; 4], 10_000);
        for i in 0..count {
            let mut onward = Onward::new((f64::from(i) + 0.5) / f64::from(count));
            for (way, (product, scale)) in ways.iter().enumerate() {
                scratch.product.copy_from_slice(product);
                onward.offer(hit, DVec3::new(way as f64, 0.0, 1.0), *scale, &mut scratch);
            }
            let (_, wi) = onward.take(&mut scratch).unwrap();
            taken[wi.x as usize] += 1;
            (0..2).for_each(|c| sum[c] += scratch.throughput[c] / count as f32);
        }
        // All of 0.8, 0.25 and 0.4 go on: the choices are as frequent as they weigh, but for one of the numbers.
        assert!(taken[1] == 0 && (taken[0] - 5517).abs() <= 2 && (taken[2] - 1724).abs() <= 2, "{taken:?}");
        let expected = [0.6 + 0.2, 0.2 + 0.25 + 0.2];
        let steps = 2.0 / count as f32;
        assert!((0..2).all(|c| (sum[c] - expected[c]).abs() <= steps + ROUNDING), "{sum:?}");
        assert!(Onward::new(0.3).take(&mut scratch).is_none());
    }
}
