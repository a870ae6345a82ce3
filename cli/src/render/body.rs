//! What a ray meets: a mesh through the core's hierarchy, or the sphere itself.

use glam::DVec3;
use goniochrome::geometry::bvh::{Bvh, Node, Ray};

use super::mesh::{ShadingFrame, TriangleMesh};
use crate::support::error::{Error, Result};
use crate::support::memory::filled;

/// How far from a surface a reflected ray starts, in radii of the mesh: far above the rounding of a hit, far below a pixel.
const OFFSET: f64 = 1e-9;

/// What is lit.
#[derive(Clone, Debug, PartialEq)]
pub enum BodyShape {
    /// The unit sphere, exactly; t points eastwards.
    Sphere,
    /// Triangles.
    Mesh(TriangleMesh),
}

/// Memory for the hierarchy of a mesh.
#[derive(Default)]
pub struct BvhMemory {
    nodes: Vec<Node>,
    corners: Vec<f64>,
}

/// A shape made ready for rays.
pub struct Body<'a> {
    kind: Kind<'a>,
    /// Middle and radius of a sphere that holds the shape.
    bounds: (DVec3, f64),
}

enum Kind<'a> {
    Sphere,
    Mesh(&'a TriangleMesh, Bvh<'a>),
}

/// Where a ray meets the body.
pub struct SurfaceHit {
    /// In the world.
    pub point: DVec3,
    /// Not yet turned to the viewer.
    pub frame: ShadingFrame,
}

impl<'a> Body<'a> {
    /// Builds the hierarchy.
    ///
    /// # Errors
    /// If the mesh has no triangle with an area, too many, or more than fit into memory.
    pub fn new(shape: &'a BodyShape, memory: &'a mut BvhMemory) -> Result<Self> {
        let mesh = match shape {
            BodyShape::Sphere => return Ok(Self { kind: Kind::Sphere, bounds: (DVec3::ZERO, 1.0) }),
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
            Ok(Self { kind: Kind::Mesh(mesh, bvh), bounds })
        } else {
            Err(Error::failed("the mesh cannot be shown: it is a single point"))
        }
    }

    /// Middle and radius of a sphere that holds the body.
    #[must_use]
    pub fn bounds(&self) -> (DVec3, f64) {
        self.bounds
    }

    /// The first contact of the half-line from `origin` along a unit `direction`.
    #[must_use]
    pub fn intersect(&self, origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
        match &self.kind {
            Kind::Sphere => intersect_sphere(origin, direction),
            Kind::Mesh(mesh, bvh) => {
                let hit =
                    bvh.intersect_nearest(&Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY }, |_| true)?;
                let point = origin + hit.t * direction;
                Some(SurfaceHit { point, frame: mesh.frame(hit.triangle, point) })
            }
        }
    }

    /// Where a ray that leaves the surface at a contact, on the side of the turned frame, starts.
    #[must_use]
    pub fn offset_origin(&self, point: DVec3, frame: &ShadingFrame) -> DVec3 {
        point + OFFSET * self.bounds.1 * frame.face
    }
}

fn intersect_sphere(origin: DVec3, direction: DVec3) -> Option<SurfaceHit> {
    let closest = -origin.dot(direction);
    // Half the chord, from the distance between the line and the centre.
    let miss = origin + closest * direction;
    let half = (1.0 - miss.length_squared()).sqrt();
    let t = [closest - half, closest + half].into_iter().find(|&t| t >= 0.0)?;
    let normal = (origin + t * direction).normalize();
    let tangent = DVec3::new(-normal.y, normal.x, 0.0).try_normalize().unwrap_or(DVec3::X);
    Some(SurfaceHit { point: normal, frame: ShadingFrame { tangent, normal, face: normal } })
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
    fn nothing_to_show_is_an_error() {
        let empty = BodyShape::Mesh(TriangleMesh::default());
        let refusal = |shape| Body::new(shape, &mut BvhMemory::default()).err().unwrap().to_string();
        assert_eq!(refusal(&empty), "the mesh cannot be shown: the mesh has no triangles");
    }
}
