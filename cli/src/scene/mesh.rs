//! Mesh of a cell, from Wavefront OBJ, with the line of every face.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::diagnostics::nearest;
use super::mesh_frame::MeshFrame;
use super::parts::MAX_LENGTH_NM;
use crate::obj::polygon::Triangulator;
use crate::obj::{Detail, MAX_TRIANGLES, Reader, Statement, read_file};
use crate::support::error::Result;
use crate::support::memory;
use crate::support::text::toml_key;

/// Bytes of memory that a triangle takes: hierarchy, checks and file.
const BYTES: usize = 390;

/// Fraction of a polygon's extent by which a corner may lie off its plane: coordinates written with five digits.
const PLANAR: f64 = 1e-4;

/// Triangle mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices in nanometres, z up.
    pub vertices: Vec<[f64; 3]>,
    /// Triangles, at least one.
    pub triangles: Vec<Triangle>,
    /// File, as messages name it.
    pub path: PathBuf,
}

/// Facet of a mesh, its vertices counter-clockwise seen from the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into the mesh's vertices.
    pub vertices: [u32; 3],
    /// Index into the scene's interfaces.
    pub interface: u16,
    /// Line of its face in the file; the triangles of one polygon share it.
    pub line: u32,
}

impl Mesh {
    /// Reads the mesh in a file; `interfaces` are the names that `usemtl` may use. Without them all names are ignored.
    pub(super) fn read(path: &Path, interfaces: Option<&[&str]>, frame: MeshFrame) -> Result<Self> {
        let text = read_file(path, "")?;
        let mesh = parse(&path.display().to_string(), &text, interfaces, frame, MAX_TRIANGLES)?;
        drop(text);
        memory::expect(BYTES * mesh.triangles.len(), format_args!("the mesh {}", path.display()))?;
        Ok(mesh)
    }

    /// Drops vertices that no triangle uses: they do not count for the bounds of the surface.
    pub(super) fn drop_unused(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut numbers = vec![UNUSED; self.vertices.len()];
        let mut used = Vec::with_capacity(self.vertices.len());
        for vertex in self.triangles.iter_mut().flat_map(|triangle| &mut triangle.vertices) {
            let number = &mut numbers[*vertex as usize];
            if *number == UNUSED {
                *number = used.len() as u32; // at most MAX_VERTICES
                used.push(self.vertices[*vertex as usize]);
            }
            *vertex = *number;
        }
        self.vertices = used;
    }

    /// Reads the mesh in a text that messages call `label`.
    pub(super) fn parse(label: &str, text: &str, interfaces: &[&str]) -> Result<Self> {
        parse(label, text, Some(interfaces), MeshFrame::default(), MAX_TRIANGLES)
    }
}

fn parse(label: &str, text: &str, interfaces: Option<&[&str]>, frame: MeshFrame, max_triangles: usize) -> Result<Mesh> {
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: PathBuf::from(label) };
    let mut interface = interfaces.is_none().then_some(0);
    let mut face = Face::default();
    let mut reader = Reader::new(label, text, Detail::Places);
    while let Some(statement) = reader.next()? {
        match statement {
            Statement::Vertex(place) => {
                let place = frame.place(place);
                if let Some(x) = place.iter().find(|x| x.abs() > MAX_LENGTH_NM) {
                    return Err(reader.refuse(frame.too_long(*x)));
                }
                memory::push(&mut mesh.vertices, place, "the vertices of a mesh")?;
            }
            Statement::Material(name) => {
                let Some(interfaces) = interfaces else { continue };
                let found = interfaces.iter().position(|known| *known == name);
                let found = found.and_then(|index| u16::try_from(index).ok());
                let name = name.into_owned();
                interface = Some(found.ok_or_else(|| reader.refuse(unknown_interface(&name, interfaces)))?);
            }
            Statement::Face(corners) => {
                face.set(&mesh.vertices, corners.iter().map(|corner| corner.vertex));
                let refuse = |message: String| reader.refuse(message);
                let interface =
                    interface.ok_or_else(|| refuse("a face before any usemtl; name its interface first".to_owned()))?;
                face.cut().map_err(refuse)?;
                if mesh.triangles.len() + face.triangulator.triangles.len() > max_triangles {
                    let gigabytes = 1e-9 * (max_triangles * BYTES) as f64;
                    let message = format!("more than {max_triangles} triangles, which take {gigabytes:.1} GB");
                    return Err(refuse(format!("{message}; use a coarser mesh")));
                }
                // The size limit keeps lines below 2³⁰.
                let line = u32::try_from(reader.line()).unwrap_or(u32::MAX);
                for triangle in &face.triangulator.triangles {
                    let vertices = triangle.map(|corner| face.vertices[corner]);
                    let triangle = Triangle { vertices, interface, line };
                    memory::push(&mut mesh.triangles, triangle, "the triangles of a mesh")?;
                }
            }
            Statement::Normal(_) | Statement::Texture(_) => {}
        }
    }
    if mesh.triangles.is_empty() {
        return Err(reader.refuse("the mesh has no faces"));
    }
    Ok(mesh)
}

fn unknown_interface(name: &str, interfaces: &[&str]) -> String {
    let near = nearest(name, interfaces.iter().copied());
    let near = near.map_or_else(String::new, |near| format!("nearest is [interface.{}]; ", toml_key(near)));
    format!("usemtl {name:?} has no [interface]; {near}declare each usemtl name in the scene file")
}

/// Face, with memory to triangulate it.
#[derive(Default)]
struct Face {
    vertices: Vec<u32>,
    places: Vec<DVec3>,
    triangulator: Triangulator,
}

impl Face {
    fn set(&mut self, places: &[[f64; 3]], vertices: impl Iterator<Item = u32>) {
        self.vertices.clear();
        self.vertices.extend(vertices);
        self.places.clear();
        self.places.extend(self.vertices.iter().map(|&vertex| DVec3::from(places[vertex as usize])));
    }

    /// Cuts the face into triangles; the error says why a cell cannot have it.
    fn cut(&mut self) -> std::result::Result<(), String> {
        let count = self.vertices.len();
        if count < 3 {
            return Err(format!("a face needs at least three different corners, found {count}"));
        }
        let mut sorted = self.vertices.clone();
        sorted.sort_unstable();
        if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err("the face uses a vertex twice; split it into triangles".to_owned());
        }
        self.triangulator.triangulate(&self.places).map_err(|error| error.message())?;
        let off = self.triangulator.off_plane;
        if off > PLANAR * self.triangulator.extent {
            let off = (1000.0 * off).round() / 1000.0;
            return Err(format!("the polygon is not planar: a corner lies {off} nm off; split it into triangles"));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Mesh> {
        parse("m.obj", text, Some(&["top", "two words"]), MeshFrame::default(), 3)
    }

    fn refusal(text: &str) -> String {
        read(text).unwrap_err().to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl top\n";

    #[test]
    fn every_form_of_a_face_is_read() {
        for face in ["1 2 3", "1/7 2/8 3/9", "1//7 2//8 3//9", "1/1/1 2/2/2 3/3/3", "-4 -3 -2", "1 2/1 -2//5"] {
            for newline in ["\n", "\r\n"] {
                let text = format!("# c\no x\ng y\ns 1\nvn 0 0 1\nvt 0 0\nmtllib m.mtl\n{SQUARE}f {face} # end");
                let mesh = read(&text.replace('\n', newline)).unwrap();
                assert_eq!(mesh.triangles, [Triangle { vertices: [0, 1, 2], interface: 0, line: 13 }], "{face}");
                assert_eq!(mesh.vertices[2].map(f64::to_bits), [1.0, 1.0, 0.0f64].map(f64::to_bits));
            }
        }
    }

    #[test]
    fn polygons_become_fans_that_share_a_line() {
        let mesh = read(&format!("{SQUARE}usemtl two words\nf 1 2 3 4\nf 2 3 4")).unwrap();
        let triangle = |vertices, line| Triangle { vertices, interface: 1, line };
        assert_eq!(mesh.triangles, [triangle([0, 1, 2], 7), triangle([0, 2, 3], 7), triangle([1, 2, 3], 8)]);
    }

    #[test]
    fn faults_are_named_by_their_line() {
        let sixth = |line: &str| refusal(&format!("{SQUARE}{line}\nf 1 2 3\n"));
        assert_eq!(refusal(""), "m.obj:1: the mesh has no faces");
        assert_eq!(refusal(SQUARE), "m.obj:5: the mesh has no faces");
        assert_eq!(refusal("v 0 0 0\nf 1 1 1\n"), "m.obj:2: a face before any usemtl; name its interface first");
        assert_eq!(sixth("f 1 2 5"), "m.obj:6: vertex 5 does not exist; 4 are defined above");
        assert_eq!(sixth("f 1 2 0"), "m.obj:6: vertex 0 does not exist; 4 are defined above");
        assert_eq!(sixth("f 1 2 -5"), "m.obj:6: vertex -5 does not exist; 4 are defined above");
        assert_eq!(sixth("f 1 2 x"), "m.obj:6: corner \"x\": \"x\" is no vertex number");
        assert_eq!(sixth("f 1 2"), "m.obj:6: a face needs at least three corners, found 2");
        assert_eq!(sixth("f 1 2 2"), "m.obj:6: a face needs at least three different corners, found 2");
        assert_eq!(sixth("f 1 2 3 1 4"), "m.obj:6: the face uses a vertex twice; split it into triangles");
        assert_eq!(sixth("v 0 0"), "m.obj:6: a vertex needs three coordinates");
        assert_eq!(sixth("v 0 0 nan"), "m.obj:6: coordinate \"nan\" is not a finite number");
        assert_eq!(sixth("v 0 0 1e999"), "m.obj:6: coordinate \"1e999\" is not a finite number");
        assert_eq!(
            sixth("v 0 0 1e10"),
            "m.obj:6: coordinate 10000000000 nm is more than 1000000000 nm, a metre; units are nanometres unless [cell] has unit_nm"
        );
        assert_eq!(
            sixth("usemtl tip"),
            "m.obj:6: usemtl \"tip\" has no [interface]; nearest is [interface.top]; declare each usemtl name in the scene file"
        );
        assert_eq!(
            sixth("f 1 2 3 4\nf 1 2 3 4"),
            "m.obj:7: more than 3 triangles, which take 0.0 GB; use a coarser mesh"
        );
        assert!(sixth("vertex 0 1").starts_with("m.obj:6: unknown statement \"vertex\"; an OBJ consists of"));
        assert_eq!(
            sixth("v 0 1 0.1\nf 1 2 3 5"),
            "m.obj:7: the polygon is not planar: a corner lies 0.05 nm off; split it into triangles"
        );
        assert!(read(&format!("{SQUARE}v 0 1 0.00001\nf 1 2 3 5")).is_ok());
        assert_eq!(sixth("f 1 3 2 4"), "m.obj:6: the polygon crosses or touches itself; split it into triangles");
        assert_eq!(sixth("v 2 0 0\nv 3 0 0\nf 1 2 5 6"), "m.obj:8: the polygon has no area; remove it");
    }

    #[test]
    fn concave_and_closed_polygons_are_cut_and_every_side_is_kept() {
        for face in ["1 2 3 5", "2 3 5 1", "3 5 1 2", "5 1 2 3", "1 2 3 5 1", "1 \\\n2 3 5"] {
            let mesh = read(&format!("{SQUARE}v 0.9 0.2 0\nf {face}")).unwrap();
            let area = |t: &Triangle| {
                let [a, b, c] = t.vertices.map(|v| DVec3::from(mesh.vertices[v as usize]));
                0.5 * (b - a).cross(c - a).z
            };
            assert!(mesh.triangles.iter().all(|t| area(t) > 0.0), "{face}");
            // The triangle of 1, 2 and 3 without that of 1, 5 and 3.
            let whole: f64 = mesh.triangles.iter().map(area).sum();
            assert!((whole - 0.15).abs() < 1e-12, "{face}: {whole}");
        }
    }
}
