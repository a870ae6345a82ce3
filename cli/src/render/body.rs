//! Ray intersection with the body: a mesh by the core's bounding volume hierarchy, or the exact sphere or disc.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Hit, Node, Ray};

use super::mesh::{ShadingFrame, TriangleMesh};
use crate::support::error::{Error, Result};
use crate::support::memory::filled;

/// How far above the surface a reflected ray starts, in radii of the body: far above the rounding of a hit, far below a
/// pixel.
const OFFSET: f64 = 1e-9;

/// Inner radius of the disc, over the outer one: a compact disc has tracks from 46 to 116 mm (IEC 60908).
pub const DISC_HOLE: f64 = 46.0 / 116.0;

/// The shape of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyShape {
    /// The exact unit sphere; t points eastwards.
    Sphere,
    /// The exact ring from [`DISC_HOLE`] to 1 in the plane of x and y, with its front up; t points outwards, across
    /// circular tracks, and b along them.
    Disc,
    /// A mesh of triangles.
    Mesh(TriangleMesh),
}

/// Memory that a [`Body`] borrows for the hierarchy of its mesh.
#[derive(Debug, Default)]
pub struct BvhMemory {
    nodes: Vec<Node>,
    corners: Vec<f64>,
}

/// A shape prepared for ray intersection.
#[derive(Debug)]
pub struct Body<'a> {
    intersector: Intersector<'a>,
    /// Centre and radius of a sphere that holds the shape.
    bounds: (DVec3, f64),
    /// Lowest and highest z.
    heights: [f64; 2],
}

#[derive(Debug)]
enum Intersector<'a> {
    Sphere,
    Disc,
    Mesh(&'a TriangleMesh, Bvh<'a>),
}

/// The nearest hit of a ray on the body.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceHit {
    /// Place of the hit in the world.
    pub point: DVec3,
    /// The triangle of a mesh that is hit.
    pub triangle: u32,
    /// The frame of the surface at the hit, not yet turned to the viewer.
    pub frame: ShadingFrame,
}

impl<'a> Body<'a> {
    /// Prepares a shape: builds the hierarchy of a mesh in `memory`.
    ///
    /// # Errors
    /// A mesh without triangles, with too many of them or more than fit into memory, or one that is a single point.
    pub fn new(shape: &'a BodyShape, memory: &'a mut BvhMemory) -> Result<Self> {
        let unit = |intersector, heights| Ok(Self { intersector, bounds: (DVec3::ZERO, 1.0), heights });
        let mesh = match shape {
            BodyShape::Sphere => return unit(Intersector::Sphere, [-1.0, 1.0]),
            BodyShape::Disc => return unit(Intersector::Disc, [0.0; 2]),
            BodyShape::Mesh(mesh) => mesh,
        };
        let count = mesh.triangles.len();
        let what = format_args!("a mesh of {count} triangles");
        memory.nodes = filled(Node::EMPTY, Bvh::required_nodes(count), what)?;
        let mut order = filled(0, count, what)?;
        memory.corners = filled(0.0, Bvh::required_corners(count), what)?;
        let bvh = Bvh::build(&mesh.positions, &mesh.triangles, &mut memory.nodes, &mut order, &mut memory.corners)
            .map_err(|error| Error::failed(format_args!("the mesh cannot be shown: {error}")))?;
        let bounds = mesh.bounding_sphere();
        if bounds.1 > 0.0 {
            let heights = || mesh.positions.iter().map(|position| position.z);
            let heights = [heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max)];
            Ok(Self { intersector: Intersector::Mesh(mesh, bvh), bounds, heights })
        } else {
            Err(Error::failed("the mesh cannot be shown: it is a single point"))
        }
    }

    /// Centre and radius of a sphere that holds the body.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, f64) {
        self.bounds
    }

    /// The lowest and the highest z of the body.
    #[must_use]
    pub fn heights(&self) -> [f64; 2] {
        self.heights
    }

    /// The texture coordinates u, to the right, and v, upwards, of a point of a triangle: those of the mesh; for a disc
    /// those of a picture that lies on it; for other bodies azimuth and height over the horizon of the direction from
    /// the middle, as on a map of the earth, with −x at its edges.
    #[must_use]
    pub fn texture_place(&self, triangle: u32, point: DVec3) -> [f64; 2] {
        match &self.intersector {
            Intersector::Disc => [point.x, point.y].map(|x| 0.5 + 0.5 * x),
            Intersector::Mesh(mesh, _) if !mesh.textures.is_empty() => mesh.texture_place(triangle, point),
            Intersector::Sphere | Intersector::Mesh(..) => {
                let from_middle = point - self.bounds.0;
                let azimuth = from_middle.y.atan2(from_middle.x);
                let elevation = from_middle.z.atan2(from_middle.x.hypot(from_middle.y));
                [0.5 + azimuth / TAU, 0.5 + elevation / PI]
            }
        }
    }

    /// The nearest hits of rays from one origin along unit directions: those of [`Body::intersect`].
    #[must_use]
    pub fn intersect_each(&self, origin: DVec3, directions: &[DVec3]) -> Vec<Option<SurfaceHit>> {
        let Intersector::Mesh(mesh, bvh) = &self.intersector else {
            return directions.iter().map(|&direction| self.intersect(origin, direction)).collect();
        };
        let rays: Vec<Ray> = directions.iter().map(|&direction| ray(origin, direction)).collect();
        let mut hits = vec![None; rays.len()];
        bvh.intersect_batch(&rays, &mut hits, |_, _| true);
        hits.into_iter().zip(&rays).map(|(hit, ray)| Some(surface_hit(mesh, ray, hit?))).collect()
    }

    /// The nearest hit of the ray from `origin` along a unit `direction`.
    #[must_use]
    pub fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        match &self.intersector {
            Intersector::Sphere => intersect_sphere(origin, direction),
            Intersector::Disc => intersect_disc(origin, direction),
            Intersector::Mesh(mesh, bvh) => {
                let ray = ray(origin, direction);
                Some(surface_hit(mesh, &ray, bvh.intersect_nearest(&ray, |_| true)?))
            }
        }
    }

    /// The origin of a ray that leaves the surface at a point: a little above it, on the side to which the frame faces.
    #[must_use]
    pub fn offset_origin(&self, point: DVec3, frame: &ShadingFrame) -> DVec3 {
        point + OFFSET * self.bounds.1 * frame.face
    }
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
}

fn surface_hit(mesh: &TriangleMesh, ray: &Ray, hit: Hit) -> SurfaceHit {
    let point = ray.origin + hit.t * ray.direction;
    SurfaceHit { point, triangle: hit.triangle, frame: mesh.frame(hit.triangle, point) }
}

fn intersect_sphere(origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
    let closest = -origin.dot(direction);
    // Half the chord, by the distance between the line and the centre.
    let miss = origin + closest * direction;
    let half = (1.0 - miss.length_squared()).sqrt();
    let t = [closest - half, closest + half].into_iter().find(|&t| t >= 0.0)?;
    let normal = (origin + t * direction).normalize();
    let tangent = DVec3::new(-normal.y, normal.x, 0.0).try_normalize().unwrap_or(DVec3::X);
    Some(SurfaceHit { point: normal, triangle: 0, frame: ShadingFrame { tangent, normal, face: normal } })
}

fn intersect_disc(origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
    let t = -origin.z / direction.z;
    let reached = t > 0.0 && t.is_finite();
    let point = (origin + t * direction).with_z(0.0);
    let radius = point.length();
    (reached && (DISC_HOLE..=1.0).contains(&radius)).then(|| {
        let frame = ShadingFrame { tangent: point / radius, normal: DVec3::Z, face: DVec3::Z };
        SurfaceHit { point, triangle: 0, frame }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_sphere_and_its_mesh_agree() {
        let (exact, mesh) = (BodyShape::Sphere, BodyShape::Mesh(TriangleMesh::sphere(64)));
        let (mut none, mut memory) = (BvhMemory::default(), BvhMemory::default());
        let (exact, mesh) = (Body::new(&exact, &mut none).unwrap(), Body::new(&mesh, &mut memory).unwrap());
        let origin = DVec3::new(4.0, 0.3, 0.2);
        for target in [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.0, -0.6, 0.2], [0.0, 0.0, -0.9]] {
            let direction = (DVec3::from_array(target) - origin).normalize();
            let (a, b) = (exact.intersect(origin, direction).unwrap(), mesh.intersect(origin, direction).unwrap());
            // 256 segments around: facets lie up to 1.5e-4 below the sphere, and these rays are oblique.
            assert!(a.point.distance(b.point) < 1e-3 && a.frame.normal.distance(b.frame.normal) < 1e-3);
        }
        assert!(exact.intersect(origin, DVec3::Y).is_none() && mesh.intersect(origin, DVec3::Y).is_none());
        assert!(exact.intersect(DVec3::new(2.0, 0.0, 0.0), DVec3::X).is_none());
    }

    #[test]
    fn the_disc_is_a_ring_whose_tangents_cross_its_tracks() {
        let mut memory = BvhMemory::default();
        let body = Body::new(&BodyShape::Disc, &mut memory).unwrap();
        for [x, y, hit] in [[0.5, 0.0, 1.0], [-0.6, 0.6, 1.0], [0.3, 0.2, 0.0], [0.8, 0.8, 0.0]] {
            for side in [1.0, -1.0] {
                let origin = DVec3::new(3.0, 1.0, side);
                let found = body.intersect(origin, (DVec3::new(x, y, 0.0) - origin).normalize());
                assert_eq!(found.is_some(), hit > 0.0, "{x} {y}");
                let Some(SurfaceHit { point, frame, .. }) = found else { continue };
                assert!(point.distance(DVec3::new(x, y, 0.0)) < 1e-12 && frame.normal == DVec3::Z);
                assert!(frame.tangent.distance(point.normalize()) < 1e-12 && frame.binormal().dot(point).abs() < 1e-12);
            }
        }
        assert!(body.intersect(DVec3::new(0.5, 0.0, 1.0), DVec3::X).is_none());
        assert!(body.intersect(DVec3::new(0.5, 0.0, 1.0), DVec3::Z).is_none());
        assert!(body.intersect(DVec3::new(0.5, 0.0, 0.0), DVec3::X).is_none());
    }

    #[test]
    fn nothing_to_show_is_an_error() {
        let empty = BodyShape::Mesh(TriangleMesh::default());
        let refusal = |shape| Body::new(shape, &mut BvhMemory::default()).err().unwrap().to_string();
        assert_eq!(refusal(&empty), "the mesh cannot be shown: the mesh has no triangles");
    }
}
