//! Triangle meshes from OBJ files: polygons are cut into triangles, and missing normals are computed.

use std::collections::HashMap;

use glam::DVec3;

use super::mesh::TriangleMesh;
use crate::obj::polygon::{TriangulationError, Triangulator};
use crate::obj::{self, Axes, Detail, MAX_TRIANGLES, Reader, Statement};
use crate::support::error::{Error, Result};
use crate::support::memory;

/// Facets whose normals differ by more than this angle keep a visible edge between them where a file has no normals.
pub(crate) const CREASE_DEG: f64 = 45.0;

/// Distance of unit normals below which facets lie in one plane: single precision does not tell them apart.
const SAME_NORMAL: f64 = 1e-6;

/// Largest coordinate of a vertex: fourth powers and their sums are far from the largest number.
const MAX_COORDINATE: f64 = 1e30;

/// Memory for each triangle: the file's corners, the mesh, its hierarchy and, at worst, computed normals.
const BYTES: usize = 1600;

/// Twice the smallest area of a triangle: its square is far from the smallest number.
const MIN_DOUBLE_AREA: f64 = 1e-150;

/// Repairs of a mesh before its use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshRepairs {
    /// Number of triangles of the mesh.
    pub triangles: usize,
    /// Triangles with a corner that had no normal, or a normal that is not a direction. These normals were computed,
    /// all others kept.
    pub without_normals: usize,
    /// Number of triangles without area, which were left out; a polygon without area counts as one.
    pub without_area: usize,
}

impl MeshRepairs {
    /// Messages for the user, one line for each kind of repair; empty if there are none.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let Self { triangles, without_normals, without_area } = self;
        if *without_normals > 0 {
            notes.push(format!(
                "{without_normals} of {triangles} triangles have corners without normals; they were computed, smooth across edges of up to {CREASE_DEG} degrees"
            ));
        }
        if *without_area > 0 {
            notes.push(format!("{without_area} triangles have no area; they were left out"));
        }
        notes
    }
}

impl TriangleMesh {
    /// The mesh in the text of an OBJ file, turned so that z is up, with what had to be repaired in it. `label` names
    /// the file in messages.
    ///
    /// t follows the first texture coordinate where there is one, and is horizontal elsewhere. The mesh has texture
    /// coordinates if all of its corners have two.
    ///
    /// # Errors
    /// Text that is not OBJ, polygons that cross themselves, coordinates above 10³⁰, too many triangles, no triangle
    /// with an area, or too little memory. The message is one line that names the file and, where it is known, the
    /// line in it.
    pub fn from_obj(label: &str, text: &str, axes: Axes) -> Result<(Self, MeshRepairs)> {
        read(label, text, axes)
    }
}

/// A corner of a polygon or a triangle, with the normal and the texture coordinates that the file gives it.
#[derive(Clone, Copy)]
struct MeshCorner {
    position: DVec3,
    normal: Option<DVec3>,
    texture: Option<[f64; 2]>,
}

fn read(label: &str, text: &str, axes: Axes) -> Result<(TriangleMesh, MeshRepairs)> {
    let mut repairs = MeshRepairs::default();
    let facets = facets(label, text, axes, &mut repairs)?;
    if facets.is_empty() {
        let what =
            if repairs.without_area > 0 { "no triangle of the mesh has an area" } else { "the mesh has no faces" };
        return Err(Error::failed(format_args!("{label}: {what}; there is nothing to show")));
    }
    memory::expect(BYTES * facets.len(), format_args!("the mesh {label}"))?;
    repairs.triangles = facets.len();
    repairs.without_normals = facets.iter().filter(|facet| facet.iter().any(|corner| corner.normal.is_none())).count();
    let smooth = (repairs.without_normals > 0).then(|| SmoothNormals::new(&facets));

    let mut mesh = TriangleMesh::default();
    for facet in &facets {
        let face = area_normal(facet).normalize();
        let along = texture_direction(facet);
        let first = mesh.positions.len() as u32; // at most three for each triangle
        for corner in facet {
            let computed = || smooth.as_ref().map_or(face, |smooth| smooth.at(corner.position, face));
            let normal = corner.normal.unwrap_or_else(computed);
            mesh.push(corner.position, normal, along.unwrap_or(DVec3::Z.cross(normal)));
            mesh.textures.extend(corner.texture.filter(|uv| uv[1].is_finite()));
        }
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    if mesh.textures.len() < mesh.positions.len() {
        mesh.textures.clear();
    }
    Ok((mesh, repairs))
}

/// The triangles of the file that have an area. Polygons, planar or not, are cut as they are seen along their mean
/// normal.
fn facets(label: &str, text: &str, axes: Axes, repairs: &mut MeshRepairs) -> Result<Vec<[MeshCorner; 3]>> {
    let (mut positions, mut normals, mut textures) = (Vec::new(), Vec::new(), Vec::new());
    let mut facets = Vec::new();
    let (mut corners, mut places, mut triangulator) = (Vec::new(), Vec::new(), Triangulator::default());
    let mut reader = Reader::new(label, text, Detail::Full);
    while let Some(statement) = reader.next()? {
        match statement {
            Statement::Vertex(place) => {
                if let Some(x) = place.iter().find(|x| x.abs() > MAX_COORDINATE) {
                    return Err(reader.refuse(format_args!("coordinate {x:e} is larger than {MAX_COORDINATE:e}")));
                }
                memory::push(&mut positions, DVec3::from(axes.turned(place)), "the vertices of a mesh")?;
            }
            Statement::Normal(normal) => {
                let normal = direction(DVec3::from(axes.turned(normal)));
                memory::push(&mut normals, normal, "the normals of a mesh")?;
            }
            Statement::Texture(texture) => memory::push(&mut textures, texture, "the texture coordinates of a mesh")?,
            Statement::Face(face) => {
                let corner = |corner: &obj::FaceCorner| MeshCorner {
                    position: positions[corner.vertex as usize],
                    normal: corner.normal.and_then(|normal| normals[normal as usize]),
                    texture: corner
                        .texture
                        .map(|texture| textures[texture as usize])
                        .filter(|uv: &[f64; 2]| uv[0].is_finite()),
                };
                corners.clear();
                corners.extend(face.iter().map(corner));
                places.clear();
                places.extend(corners.iter().map(|corner: &MeshCorner| corner.position));
                match if corners.len() < 3 {
                    Err(TriangulationError::NoArea)
                } else {
                    triangulator.triangulate(&places)
                } {
                    Ok(()) => {}
                    Err(TriangulationError::NoArea) => {
                        repairs.without_area += 1;
                        continue;
                    }
                    Err(error) => return Err(reader.refuse(error.message())),
                }
                for triangle in &triangulator.triangles {
                    let facet = triangle.map(|i| corners[i]);
                    if double_area(&facet) > MIN_DOUBLE_AREA {
                        memory::push(&mut facets, facet, "the triangles of a mesh")?;
                    } else {
                        repairs.without_area += 1;
                    }
                }
                if facets.len() > MAX_TRIANGLES {
                    return Err(reader.refuse(format_args!("more than {MAX_TRIANGLES} triangles; use a coarser mesh")));
                }
            }
            Statement::Material(_) => {}
        }
    }
    Ok(facets)
}

/// The unit vector along a vector of any length; `None` if the vector is 0 or not finite.
fn direction(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    (vector.is_finite() && largest > 0.0).then(|| (vector / largest).normalize())
}

/// The normal of a facet, of twice its area in length.
fn area_normal(facet: &[MeshCorner; 3]) -> DVec3 {
    let [a, b, c] = facet.map(|corner| corner.position);
    (b - a).cross(c - a)
}

/// Twice the area of a facet.
fn double_area(facet: &[MeshCorner; 3]) -> f64 {
    area_normal(facet).length()
}

/// The direction in a facet along which the first texture coordinate rises; `None` without texture coordinates.
fn texture_direction(facet: &[MeshCorner; 3]) -> Option<DVec3> {
    let [a, b, c] = facet.map(|corner| corner.position);
    let [ua, ub, uc] = facet.map(|corner| corner.texture.map(|[u, _]| u));
    // The gradient of the linear function of these values over the facet.
    let (ub, uc) = (ub? - ua?, uc? - ua?);
    area_normal(facet).cross((b - a) * uc - (c - a) * ub).try_normalize()
}

/// Computed vertex normals: the mean over the facets at a vertex that make no crease with the facet at hand, each
/// weighted by its angle at the vertex.
struct SmoothNormals(HashMap<[u64; 3], VertexFacets>);

/// The facets at a vertex.
#[derive(Default)]
struct VertexFacets {
    /// The normal of each facet, and its angle at the vertex; neighbours in a plane count as one.
    facets: Vec<(DVec3, f64)>,
    /// The sum over all facets if no two of them make a crease, and the result is therefore the same for each.
    whole: Option<DVec3>,
}

impl SmoothNormals {
    fn new(facets: &[[MeshCorner; 3]]) -> Self {
        let mut at: HashMap<_, VertexFacets> = HashMap::new();
        for facet in facets {
            let face = area_normal(facet).normalize();
            for i in 0..3 {
                let [p, q, r] = [0, 1, 2].map(|k| facet[(i + k) % 3].position);
                let angle = (q - p).angle_between(r - p);
                let around = &mut at.entry(bits(p)).or_default().facets;
                match around.last_mut() {
                    Some((last, sum)) if last.distance_squared(face) <= SAME_NORMAL * SAME_NORMAL => *sum += angle,
                    _ => around.push((face, angle)),
                }
            }
        }
        // Two directions within half the angle of a third are within the angle of each other.
        let near = (0.5 * CREASE_DEG).to_radians().cos();
        for VertexFacets { facets, whole } in at.values_mut() {
            let middle = facets.iter().map(|(face, _)| face).sum::<DVec3>().normalize_or_zero();
            if facets.iter().all(|(face, _)| face.dot(middle) >= near) {
                *whole = Some(facets.iter().map(|&(face, angle)| angle * face).sum());
            }
        }
        Self(at)
    }

    /// The normal at a vertex for a facet of the normal `face`.
    fn at(&self, position: DVec3, face: DVec3) -> DVec3 {
        let Some(VertexFacets { facets, whole }) = self.0.get(&bits(position)) else { return face };
        let min_cos = CREASE_DEG.to_radians().cos();
        let sum =
            || facets.iter().filter(|(other, _)| other.dot(face) >= min_cos).map(|&(other, angle)| angle * other).sum();
        whole.unwrap_or_else(sum).try_normalize().unwrap_or(face)
    }
}

/// The bits of a place, which tell vertices apart; 0 and −0 are one place.
fn bits(position: DVec3) -> [u64; 3] {
    position.to_array().map(|x| (x + 0.0).to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE_CORNER: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

    fn read(text: &str) -> Result<(TriangleMesh, MeshRepairs)> {
        super::read("m.obj", text, Axes::ZUp)
    }

    /// The total area of a mesh.
    fn area_of(mesh: &TriangleMesh) -> f64 {
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        };
        mesh.triangles.iter().map(area).sum()
    }

    #[test]
    fn given_normals_and_texture_directions_are_kept() {
        let text = format!("{CUBE_CORNER}vt 0 0\nvt 0 1\nvt 1 0\nvn 0 3 4\nf 1/1/1 2/2/1 3/3/1\n");
        let (mesh, repairs) = read(&text).unwrap();
        assert_eq!(repairs, MeshRepairs { triangles: 1, ..MeshRepairs::default() });
        assert!(mesh.normals.iter().all(|n| n.distance(DVec3::new(0.0, 0.6, 0.8)) < 1e-12));
        // The first texture coordinate rises along y; across the given normal that is (0, 0.8, −0.6).
        assert!(mesh.tangents.iter().all(|t| t.distance(DVec3::new(0.0, 0.8, -0.6)) < 1e-12));
    }

    #[test]
    fn computed_normals_keep_right_angles_and_smooth_gentle_ones() {
        let (mesh, repairs) = read(&format!("{CUBE_CORNER}f 1 2 3\nf 1 4 2\n")).unwrap();
        assert_eq!((repairs.without_normals, repairs.without_area), (2, 0));
        assert!(mesh.normals[..3].iter().all(|n| n.distance(DVec3::Z) < 1e-12), "{:?}", mesh.normals);
        let (mesh, _) = read("v 0 0 0\nv 1 0 0\nv 0 1 0.2\nv 0 -1 0.2\nf 1 2 3\nf 1 4 2\n").unwrap();
        assert!(mesh.normals[0].distance(DVec3::Z) < 1e-12 && mesh.normals[2].y < 0.0);
    }

    #[test]
    fn a_normal_among_many_facets_is_found_at_once() {
        // A flat cone of 30000 facets: each against each would be 10⁹ comparisons.
        let count = 30_000;
        let mut text = "v 0 0 0.1\n".to_owned();
        for i in 0..count {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(count)).sin_cos();
            text += &format!("v {cos} {sin} 0\n");
        }
        (0..count).for_each(|i| text += &format!("f 1 {} {}\n", 2 + i, 2 + (i + 1) % count));
        let smooth = SmoothNormals::new(&facets("m.obj", &text, Axes::ZUp, &mut MeshRepairs::default()).unwrap());
        assert!(smooth.0[&bits(DVec3::new(0.0, 0.0, 0.1))].whole.is_some());
        assert!(smooth.at(DVec3::new(0.0, 0.0, 0.1), DVec3::X).distance(DVec3::Z) < 1e-9);
    }

    #[test]
    fn normals_are_computed_at_the_corners_that_have_none_and_kept_at_all_others() {
        let given = DVec3::new(0.0, 0.6, 0.8);
        let normals = "vn 0 3 4\nvn 0 0 0\nvn nan -nan(ind) 0\n";
        // Of eight corners that name normals, one names no direction, and one something that is not a number.
        let text = format!("{CUBE_CORNER}{normals}f 1//1 2//1 3//1\nf 1 4 2\nf 1//1 2//2 4//1\nf 1//3 3//1 4//1\n");
        let (mesh, repairs) = read(&text).unwrap();
        assert_eq!((repairs.triangles, repairs.without_normals), (4, 3));
        let kept: Vec<bool> = mesh.normals.iter().map(|n| n.distance(given) < 1e-12).collect();
        let (y, n) = (true, false);
        assert_eq!(kept, [y, y, y, n, n, n, y, n, y, n, y, y]);
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-12));
        assert_eq!(
            repairs.notes(),
            [
                "3 of 4 triangles have corners without normals; they were computed, smooth across edges of up to 45 degrees"
            ]
        );
        assert!(MeshRepairs::default().notes().is_empty());
    }

    #[test]
    fn concave_polygons_cover_what_they_enclose() {
        let l = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
        for face in ["1 2 3 4 5 6", "2 3 4 5 6 1", "6 5 4 3 2 1", "2 3 4 \\\n5 6 1 2"] {
            let (mesh, _) = read(&format!("\u{feff}{l}f {face}\n")).unwrap();
            assert_eq!(mesh.triangles.len(), 4);
            assert!((area_of(&mesh) - 3.0).abs() < 1e-12, "{face}: {}", area_of(&mesh));
        }
        let crossing = read(&format!("{l}f 1 2 5 3 4 6\n")).unwrap_err().to_string();
        assert_eq!(crossing, "m.obj:7: the polygon crosses or touches itself; split it into triangles");
        // A warped quad is cut, not refused.
        assert_eq!(read("v 0 0 0\nv 1 0 0.3\nv 1 1 0\nv 0 1 0.3\nf 1 2 3 4\n").unwrap().0.triangles.len(), 2);
    }

    #[test]
    fn y_up_becomes_z_up() {
        let text = "v 0 0 0\nv 0 0 1\nv 1 0 0\nvn 0 1 0\nf 1//1 2//1 3//1\n";
        let (mesh, _) = super::read("m.obj", text, Axes::YUp).unwrap();
        assert!(mesh.normals.iter().all(|n| *n == DVec3::Z), "{:?}", mesh.normals);
        assert_eq!(mesh.positions[1], DVec3::NEG_Y);
    }

    #[test]
    fn huge_and_tiny_meshes_are_shown_and_what_has_no_area_is_counted() {
        for size in ["1e29", "1e-20"] {
            let (mesh, repairs) = read(&format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n")).unwrap();
            assert!(repairs.without_area == 0 && mesh.normals[0].distance(DVec3::Z) < 1e-12, "{size}");
        }
        assert!(read("v 1e31 0 0\n").unwrap_err().to_string().starts_with("m.obj:1: coordinate 1e31 is larger"));
        let flat = format!("{CUBE_CORNER}v 2 0 0\nv 3 0 0\nf 1 2 3\nf 1 2 2\nf 1 2 5 6\nf 1 2 5\n");
        let (_, repairs) = read(&flat).unwrap();
        assert_eq!((repairs.triangles, repairs.without_area), (1, 3));
    }
}
