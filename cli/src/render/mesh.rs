//! Triangle meshes to show a surface on, with a frame (t, n, b) at each vertex, as in the paper's section 3.3. z is up.
//!
//! Lengths have no unit: the camera fits itself to the mesh.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

pub use crate::obj::Axes;

/// Segments along each edge of a patch of the teapot: at 1024 pixels, no silhouette is off by a tenth of a pixel.
pub const DEFAULT_LEVEL: u32 = 32;

/// Triangles with a frame at each vertex.
///
/// Vertices at one place have bitwise equal positions even where their normals differ, so neighbouring triangles leave
/// no gap. Corners are counter-clockwise seen from the front, and normals point to the front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// Position of each vertex.
    pub positions: Vec<DVec3>,
    /// Normal n of each vertex, of unit length.
    pub normals: Vec<DVec3>,
    /// Tangent t of each vertex, of unit length and perpendicular to n; the binormal is b = n × t.
    pub tangents: Vec<DVec3>,
    /// Texture coordinates u and v of each vertex, or empty: the mesh has none.
    pub textures: Vec<[f64; 2]>,
    /// Indices of the three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// The unit sphere in `4 level` segments around z and `2 level` from pole to pole; t points eastwards.
    #[must_use]
    pub fn sphere(level: u32) -> Self {
        let (around, down) = (4 * level, 2 * level);
        let mut mesh = Self::default();
        for row in 0..=down {
            let (sin, cos) = (PI * f64::from(row) / f64::from(down)).sin_cos();
            let sin = if row == down { 0.0 } else { sin };
            for column in 0..=around {
                // The last column lies exactly on the first.
                let phi = TAU * f64::from(column % around) / f64::from(around);
                let normal = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos).normalize();
                mesh.push(normal, normal, DVec3::new(-phi.sin(), phi.cos(), 0.0));
            }
        }
        mesh.grid(0, around, down, false);
        mesh
    }

    /// The square from −1 to 1 in x and y, with its front up; t along x.
    #[must_use]
    pub fn plane() -> Self {
        let mut mesh = Self::default();
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            mesh.push(DVec3::new(x, y, 0.0), DVec3::Z, DVec3::X);
            mesh.textures.push([0.5 + 0.5 * x, 0.5 + 0.5 * y]);
        }
        mesh.grid(0, 1, 1, true);
        mesh
    }

    /// Adds a vertex, with the tangent nearest to `tangent` that is perpendicular to the normal.
    pub(crate) fn push(&mut self, position: DVec3, normal: DVec3, tangent: DVec3) {
        self.positions.push(position);
        self.normals.push(normal);
        self.tangents.push(tangent_across(normal, tangent));
    }

    /// Adds two triangles for each quad of a grid of vertices, row by row from the vertex `first`, except triangles
    /// without area.
    ///
    /// `counter_clockwise` says that a step along a row and then one along a column turn left, seen from the front.
    pub(crate) fn grid(&mut self, first: u32, columns: u32, rows: u32, counter_clockwise: bool) {
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * (columns + 1) + column;
                let (b, c, d) = (a + 1, a + columns + 1, a + columns + 2);
                for [i, j, k] in [[a, b, d], [a, d, c]] {
                    let corners = if counter_clockwise { [i, j, k] } else { [i, k, j] };
                    let [p, q, r] = corners.map(|corner| self.positions[corner as usize]);
                    if p != q && q != r && r != p {
                        self.triangles.push(corners);
                    }
                }
            }
        }
    }

    /// A sphere that holds the mesh: the middle of its bounding box, and the distance from there to the farthest
    /// vertex.
    #[must_use]
    pub fn bounding_sphere(&self) -> (DVec3, f64) {
        let min = self.positions.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = self.positions.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (min + max);
        (centre, self.positions.iter().map(|p| p.distance(centre)).fold(0.0, f64::max))
    }

    /// The shading frame at a point of a triangle: normal and tangent interpolated linearly between its vertices.
    #[must_use]
    pub fn frame(&self, triangle: u32, point: DVec3) -> ShadingFrame {
        let Barycentric { corners, shares, across } = self.barycentric(triangle, point);
        let mean = |of: &[DVec3]| corners.iter().zip(shares).map(|(&corner, w)| w * of[corner]).sum::<DVec3>();
        let face = across.normalize();
        // Normals of three corners may cancel on a badly modelled mesh.
        let normal = mean(&self.normals).try_normalize().unwrap_or(face);
        ShadingFrame { tangent: tangent_across(normal, mean(&self.tangents)), normal, face }
    }

    /// Texture coordinates at a point of a triangle.
    ///
    /// # Panics
    /// A mesh without texture coordinates.
    #[must_use]
    pub fn texture_place(&self, triangle: u32, point: DVec3) -> [f64; 2] {
        let Barycentric { corners, shares, .. } = self.barycentric(triangle, point);
        [0, 1].map(|axis| corners.iter().zip(shares).map(|(&corner, w)| w * self.textures[corner][axis]).sum())
    }

    fn barycentric(&self, triangle: u32, point: DVec3) -> Barycentric {
        let corners = self.triangles[triangle as usize].map(|corner| corner as usize);
        let [a, b, c] = corners.map(|corner| self.positions[corner]);
        let across = (b - a).cross(c - a);
        let share = |p: DVec3, q: DVec3| ((p - point).cross(q - point).dot(across) / across.length_squared()).max(0.0);
        Barycentric { corners, shares: [share(b, c), share(c, a), share(a, b)], across }
    }
}

/// A point of a triangle.
struct Barycentric {
    /// Vertices of the triangle.
    corners: [usize; 3],
    /// Barycentric coordinates: the areas opposite to the vertices.
    shares: [f64; 3],
    /// Normal of the triangle, of twice its area in length.
    across: DVec3,
}

/// The frame of a surface at a point: its tangent, its normal and that of the flat triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingFrame {
    /// Tangent t.
    pub tangent: DVec3,
    /// Normal n of the smooth surface.
    pub normal: DVec3,
    /// Normal of the flat triangle.
    pub face: DVec3,
}

impl ShadingFrame {
    /// The frame that a viewer in the direction `wo` sees.
    ///
    /// Both sides of a surface carry the same structure, so n and b point the other way for a viewer behind it. At a
    /// silhouette, interpolated normals may point away from the viewer by a little; n is then made perpendicular to
    /// `wo`.
    #[must_use]
    pub fn facing(self, wo: DVec3) -> Self {
        let side = if wo.dot(self.face) < 0.0 { -1.0 } else { 1.0 };
        let (face, mut normal) = (side * self.face, side * self.normal);
        let cos = normal.dot(wo);
        if cos < 0.0 {
            normal = (normal - cos * wo).try_normalize().unwrap_or(face);
        }
        Self { tangent: tangent_across(normal, self.tangent), normal, face }
    }

    /// Binormal b = n × t.
    #[must_use]
    pub fn binormal(&self) -> DVec3 {
        self.normal.cross(self.tangent)
    }

    /// Takes a direction of the world into the surface frame: x along t, y along b, z along n.
    #[must_use]
    pub fn to_local(&self, world: DVec3) -> DVec3 {
        DVec3::new(world.dot(self.tangent), world.dot(self.binormal()), world.dot(self.normal))
    }

    /// Takes a direction of the surface frame into the world.
    #[must_use]
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        local.x * self.tangent + local.y * self.binormal() + local.z * self.normal
    }
}

/// The unit vector perpendicular to the normal that is nearest to `wanted`; a horizontal one where `wanted` is along
/// the normal.
#[must_use]
pub fn tangent_across(normal: DVec3, wanted: DVec3) -> DVec3 {
    let across = |v: DVec3| (v - v.dot(normal) * normal).try_normalize();
    across(wanted)
        .or_else(|| across(DVec3::Z.cross(normal)))
        .or_else(|| across(DVec3::X))
        .unwrap_or_else(|| normal.any_orthonormal_vector())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Asserts that vertices have orthonormal frames, and that every normal lies on the front side of its triangles.
    pub(in super::super) fn check(mesh: &TriangleMesh) {
        for (normal, tangent) in mesh.normals.iter().zip(&mesh.tangents) {
            assert!((normal.length() - 1.0).abs() < 1e-12 && (tangent.length() - 1.0).abs() < 1e-12);
            assert!(normal.dot(*tangent).abs() < 1e-12);
        }
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            let across = (b - a).cross(c - a);
            assert!(across.length() > 0.0, "{triangle:?}");
            for corner in triangle {
                assert!(across.dot(mesh.normals[*corner as usize]) > 0.0, "{triangle:?} at {a}");
            }
        }
    }

    /// The number of edges, told apart by the bits of their ends, that are not crossed once in each direction.
    pub(in super::super) fn open_edges(mesh: &TriangleMesh) -> usize {
        let mut edges = std::collections::HashMap::new();
        let bits = |corner: u32| mesh.positions[corner as usize].to_array().map(|x| (x + 0.0).to_bits());
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((bits(*from), bits(*to))).or_insert(0i32) += 1;
                *edges.entry((bits(*to), bits(*from))).or_insert(0i32) -= 1;
            }
        }
        edges.values().filter(|&&balance| balance != 0).count() / 2
    }

    #[test]
    fn the_sphere_is_closed_and_round() {
        let sphere = TriangleMesh::sphere(8);
        check(&sphere);
        assert_eq!(open_edges(&sphere), 0);
        let (centre, radius) = sphere.bounding_sphere();
        assert!(centre.length() < 1e-12 && (radius - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_plane_faces_up() {
        check(&TriangleMesh::plane());
        let frame = TriangleMesh::plane().frame(0, DVec3::new(0.3, 0.1, 0.0));
        assert_eq!((frame.normal, frame.tangent, frame.binormal()), (DVec3::Z, DVec3::X, DVec3::Y));
    }

    #[test]
    fn frames_are_those_of_the_vertices_and_turn_to_the_viewer() {
        let sphere = TriangleMesh::sphere(4);
        let corner = sphere.triangles[40][0] as usize;
        let frame = sphere.frame(40, sphere.positions[corner]);
        assert!(frame.normal.distance(sphere.normals[corner]) < 1e-12);
        assert!(frame.tangent.distance(sphere.tangents[corner]) < 1e-12);
        let behind = frame.facing(-frame.normal);
        assert!(behind.normal.distance(-frame.normal) < 1e-12 && behind.tangent.distance(frame.tangent) < 1e-12);
        // A viewer in the plane of the triangle sees the smooth surface just grazingly, never from behind.
        let wo = (frame.face.any_orthonormal_vector() + 1e-3 * frame.face).normalize();
        for wo in [wo, DVec3::new(-wo.x, -wo.y, wo.z)] {
            assert!(frame.facing(wo).normal.dot(wo) > -1e-12);
        }
        let local = DVec3::new(0.1, -0.7, 0.3);
        assert!(frame.to_local(frame.to_world(local)).distance(local) < 1e-12);
    }
}
