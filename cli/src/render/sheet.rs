//! Light through a sheet, such as the film of a soap bubble.
//!
//! At each hit a ray splits into its mirror image and a ray that goes straight on, L = ρ L(mirror direction) + τ
//! L(straight on). Both are followed without chance; rough facets reflect as in [`super::scattering`]. From the last
//! reflection, and where hardly any light is left, the environment is seen as if the body did not block it; so a smooth
//! sheet that absorbs nothing is invisible in white light.

use glam::DVec3;

use super::body::SurfaceHit;
use super::mesh::ShadingFrame;
use super::mirror_like::MirrorLike;
use super::tracer::{Scratch, Tracer, Way, mirrored};

/// Largest number of passages of a way: the walls that a straight line meets.
pub(super) const PASSAGES: u32 = 64;
/// Largest share of light that is not worth following: less than a step of 8-bit sRGB below radiance 10.
const FAINT: f32 = 1e-4;

impl Tracer<'_> {
    /// Follows light through a sheet from the first hit of a ray.
    pub(super) fn trace_sheet(&self, mirror: &MirrorLike, hit: SurfaceHit, direction: DVec3, scratch: &mut Scratch) {
        let throughput = scratch.throughput.clone();
        let reflections = self.reflections;
        let first = Way { hit, wo: -direction, throughput, reflections, passages: PASSAGES, is_straight: true };
        scratch.ways.push(first);
        while let Some(way) = scratch.ways.pop() {
            let frame = way.hit.frame.facing(way.wo);
            let between = mirror.at(self.body, &way.hit);
            let (theta_deg, wi) = mirrored(&frame, way.wo);

            let mut reflected = way.throughput.clone();
            mirror.reflect(between, theta_deg, &mut reflected);
            let left = way.reflections - 1;
            let next = (left > 0 && is_seen(&reflected)).then(|| self.next_hit(&way.hit, &frame, wi)).flatten();
            match next {
                Some(next) => scratch.ways.push(Way {
                    hit: next,
                    wo: -wi,
                    throughput: reflected,
                    reflections: left,
                    is_straight: false,
                    ..way
                }),
                None => {
                    let light = self.environment.radiance(wi);
                    self.channels.add_light(&mut scratch.radiance, &reflected, light, 1.0);
                }
            }

            let mut passed = way.throughput.clone();
            mirror.transmit(between, theta_deg, &mut passed);
            self.go_on(&way, &frame, passed, scratch);
        }
    }

    /// Pushes the way that goes straight on behind the end of a way with the light that passes there, or adds the light
    /// that is seen behind it.
    pub(super) fn go_on(&self, way: &Way, frame: &ShadingFrame, passed: Vec<f32>, scratch: &mut Scratch) {
        let onward = -way.wo;
        let next = (way.passages > 0 && is_seen(&passed)).then(|| self.next_hit_behind(&way.hit, frame, onward));
        match next.flatten() {
            Some(hit) => scratch.ways.push(Way { hit, throughput: passed, passages: way.passages - 1, ..*way }),
            None => {
                let behind = self.behind.filter(|_| way.is_straight);
                let light = behind.unwrap_or_else(|| self.environment.radiance(onward));
                self.channels.add_light(&mut scratch.radiance, &passed, light, 1.0);
            }
        }
    }
}

fn is_seen(throughput: &[f32]) -> bool {
    throughput.iter().any(|through| through.abs() > FAINT)
}
