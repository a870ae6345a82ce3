//! Any OBJ as a mesh to show a surface on.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::Mesh;
use crate::error::{Error, Result};

/// Facets that meet at a wider angle keep an edge between them where a file has no normals.
const CREASE_DEG: f64 = 45.0;

/// What had to be mended in a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Triangles whose normals were missing or no directions, and were computed.
    pub without_normals: usize,
    /// Triangles without area, which were left out.
    pub without_area: usize,
}

/// A corner of a triangle in the file.
#[derive(Clone, Copy)]
struct Corner {
    position: DVec3,
    normal: Option<DVec3>,
    texture: Option<f64>,
}

pub(super) fn read(label: &str, text: &str) -> Result<(Mesh, Repairs)> {
    let corners = corners(label, text)?;
    let mut repairs = Repairs::default();
    let facets: Vec<[Corner; 3]> = corners
        .into_iter()
        .filter(|facet| {
            let area = area(facet) > 0.0;
            repairs.without_area += usize::from(!area);
            area
        })
        .collect();
    if facets.is_empty() {
        let what =
            if repairs.without_area > 0 { "no triangle of the mesh has an area" } else { "the mesh has no faces" };
        return Err(Error::failed(format_args!("{label}: {what}; there is nothing to show")));
    }
    repairs.without_normals = facets.iter().filter(|facet| facet.iter().any(|corner| corner.normal.is_none())).count();
    let smooth = (repairs.without_normals > 0).then(|| Smooth::new(&facets));

    let mut mesh = Mesh::default();
    for facet in &facets {
        let face = across(facet).normalize();
        let along = texture_direction(facet);
        let first = mesh.positions.len() as u32;
        let whole = facet.iter().all(|corner| corner.normal.is_some());
        for corner in facet {
            let given = if whole { corner.normal } else { None };
            let computed = || smooth.as_ref().map_or(face, |smooth| smooth.at(corner.position, face));
            let normal = given.unwrap_or_else(computed);
            mesh.push(corner.position, normal, along.unwrap_or(DVec3::Z.cross(normal)));
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Ok((mesh, repairs))
}

/// The triangles of the file, with polygons cut into fans.
fn corners(label: &str, text: &str) -> Result<Vec<[Corner; 3]>> {
    // With separate indices the crate makes up normals that a face does not name; with single ones it leaves them out.
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let mut rest = text.as_bytes();
    // Colours are the table's: what materials say does not matter.
    let loaded = tobj::load_obj_buf(&mut rest, &options, |_| Ok(Default::default()));
    let (models, _) = loaded.map_err(|error| {
        let line = text.as_bytes()[..text.len() - rest.len()].iter().filter(|&&byte| byte == b'\n').count();
        Error::failed(format_args!("{label}: {error}, at or before line {line}; export the mesh anew"))
    })?;
    let mut facets = Vec::new();
    for tobj::Model { mesh, .. } in &models {
        let point = |list: &[f64], i: u32| {
            let from = 3 * i as usize;
            list.get(from..from + 3).map(DVec3::from_slice)
        };
        // Shorter lists leave out the vertices that name none, and fit nothing.
        let vertices = mesh.positions.len() / 3;
        let (has_normals, has_textures) = (mesh.normals.len() == 3 * vertices, mesh.texcoords.len() == 2 * vertices);
        let corner = |i: usize| {
            let index = mesh.indices[i];
            let position = point(&mesh.positions, index).filter(|p| p.is_finite()).ok_or_else(|| {
                Error::failed(format_args!(
                    "{label}: a vertex has a coordinate that is not finite; export the mesh anew"
                ))
            })?;
            let normal = if has_normals { point(&mesh.normals, index) } else { None };
            let texture = if has_textures { mesh.texcoords.get(2 * index as usize).copied() } else { None };
            Ok(Corner { position, normal: normal.and_then(DVec3::try_normalize), texture })
        };
        for i in (0..mesh.indices.len()).step_by(3) {
            facets.push([corner(i)?, corner(i + 1)?, corner(i + 2)?]);
        }
    }
    Ok(facets)
}

fn across(facet: &[Corner; 3]) -> DVec3 {
    let [a, b, c] = facet.map(|corner| corner.position);
    (b - a).cross(c - a)
}

fn area(facet: &[Corner; 3]) -> f64 {
    across(facet).length()
}

/// The direction in a facet in which the first texture coordinate rises.
fn texture_direction(facet: &[Corner; 3]) -> Option<DVec3> {
    let [a, b, c] = facet.map(|corner| corner.position);
    let [ua, ub, uc] = facet.map(|corner| corner.texture);
    // The gradient of the linear function of these values over the facet.
    let (ub, uc) = (ub? - ua?, uc? - ua?);
    across(facet).cross((b - a) * uc - (c - a) * ub).try_normalize()
}

/// Normals of a mesh that has none: of the facets at a vertex, those that make no crease with the facet at hand, by the
/// angle that each fills there.
struct Smooth(HashMap<[u64; 3], Vec<(DVec3, f64)>>);

impl Smooth {
    fn new(facets: &[[Corner; 3]]) -> Self {
        let mut at: HashMap<_, Vec<_>> = HashMap::new();
        for facet in facets {
            let face = across(facet).normalize();
            for i in 0..3 {
                let [p, q, r] = [0, 1, 2].map(|k| facet[(i + k) % 3].position);
                at.entry(bits(p)).or_default().push((face, (q - p).angle_between(r - p)));
            }
        }
        Self(at)
    }

    fn at(&self, position: DVec3, face: DVec3) -> DVec3 {
        let least = CREASE_DEG.to_radians().cos();
        let around = self.0.get(&bits(position)).into_iter().flatten();
        let sum: DVec3 =
            around.filter(|(other, _)| other.dot(face) >= least).map(|&(other, angle)| angle * other).sum();
        sum.try_normalize().unwrap_or(face)
    }
}

/// What two vertices at one place share; 0 and −0 are one.
fn bits(position: DVec3) -> [u64; 3] {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE_CORNER: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

    #[test]
    fn given_normals_and_texture_directions_are_kept() {
        let text = format!("{CUBE_CORNER}vt 0 0\nvt 0 1\nvt 1 0\nvn 0 3 4\nf 1/1/1 2/2/1 3/3/1\n");
        let (mesh, repairs) = read("m.obj", &text).unwrap();
        assert_eq!(repairs, Repairs::default());
        assert!(mesh.normals.iter().all(|n| n.distance(DVec3::new(0.0, 0.6, 0.8)) < 1e-12));
        // The first texture coordinate rises along y; across the given normal that is (0, 0.8, −0.6).
        assert!(mesh.tangents.iter().all(|t| t.distance(DVec3::new(0.0, 0.8, -0.6)) < 1e-12));
    }

    #[test]
    fn computed_normals_keep_right_angles_and_smooth_gentle_ones() {
        let (mesh, repairs) = read("m.obj", &format!("{CUBE_CORNER}f 1 2 3\nf 1 4 2\n")).unwrap();
        assert_eq!((repairs.without_normals, repairs.without_area), (2, 0));
        assert!(mesh.normals[..3].iter().all(|n| n.distance(DVec3::Z) < 1e-12), "{:?}", mesh.normals);
        let (mesh, _) = read("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0.2\nv 0 -1 0.2\nf 1 2 3\nf 1 4 2\n").unwrap();
        assert!(mesh.normals[0].distance(DVec3::Z) < 1e-12 && mesh.normals[2].y < 0.0);
    }

    #[test]
    fn a_face_that_names_no_normal_gets_one_by_computation() {
        let (_, repairs) = read("m.obj", &format!("{CUBE_CORNER}vn 0 0 1\nf 1//1 2//1 3//1\nf 1 2 4\n")).unwrap();
        assert!(repairs.without_normals > 0);
    }
}
