//! Wavefront OBJ: the part that meshes use, with the line of every face.

use std::path::{Path, PathBuf};

use super::MAX_LENGTH_NM;
use super::source::{Source, nearest, read_text};
use crate::error::Result;
use crate::text::toml_key;

/// Ten million triangles with their hierarchy, checks and file took 3.9 GB.
const MAX_TRIANGLES: usize = 10_000_000;

/// Of memory for each triangle.
const GIGABYTES: f64 = 3.9e-7;

/// Three for each triangle: every mesh whose facets share nothing fits.
const MAX_VERTICES: usize = 3 * MAX_TRIANGLES;

/// A corner may lie this fraction of the polygon's extent outside its plane: coordinates written with five digits.
const PLANAR: f64 = 1e-4;

/// Ten million triangles with their vertices take about half of this.
const MAX_BYTES: u64 = 1 << 30;

/// A triangle mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Coordinates in nanometres, z up.
    pub vertices: Vec<[f64; 3]>,
    /// At least one.
    pub triangles: Vec<Triangle>,
    /// The file, as messages name it.
    pub path: PathBuf,
}

/// A facet. Counter-clockwise vertices, seen from the side of its normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    /// Indices into the mesh's vertices.
    pub vertices: [u32; 3],
    /// Index into the scene's interfaces.
    pub interface: u16,
    /// The line of its face in the file; the triangles of one polygon share it.
    pub line: u32,
}

impl Mesh {
    /// The mesh in a file; `interfaces` are the names that `usemtl` may use.
    pub(super) fn read(path: &Path, interfaces: &[&str]) -> Result<Self> {
        let text = read_text(path, MAX_BYTES)?;
        Self::parse(&path.display().to_string(), &text, interfaces)
    }

    /// Forgets vertices that no triangle uses: they have no say in how high or wide the surface is.
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

    /// The mesh in a text that messages call `label`.
    pub(super) fn parse(label: &str, text: &str, interfaces: &[&str]) -> Result<Self> {
        parse(&Source { label, text }, Path::new(label), interfaces, MAX_TRIANGLES)
    }
}

fn parse(source: &Source<'_>, path: &Path, interfaces: &[&str], max_triangles: usize) -> Result<Mesh> {
    let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: path.to_owned() };
    let mut interface = None;
    let mut corners = Vec::new();
    for (index, text) in source.text.lines().enumerate() {
        let line = index + 1;
        let refuse = |message: String| source.refuse_line(line, message);
        let code = text.split('#').next().unwrap_or_default();
        let mut words = code.split_ascii_whitespace();
        match words.next() {
            None | Some("o" | "g" | "s" | "vn" | "vt" | "mtllib" | "l" | "p") => {}
            Some("v") => {
                if mesh.vertices.len() == MAX_VERTICES {
                    return Err(refuse(format!("more than {MAX_VERTICES} vertices")));
                }
                mesh.vertices.push(vertex(source, line, words)?);
            }
            Some("usemtl") => interface = Some(material(source, line, code, interfaces)?),
            Some("f") => {
                let interface =
                    interface.ok_or_else(|| refuse("a face before any usemtl; name its interface first".to_owned()))?;
                corners.clear();
                for word in words {
                    corners.push(corner(source, line, word, mesh.vertices.len())?);
                }
                let refused = polygon(&mesh.vertices, &corners).map_err(&refuse);
                refused?;
                if mesh.triangles.len() + corners.len() - 2 > max_triangles {
                    return Err(refuse(format!(
                        "more than {max_triangles} triangles, which take {:.1} GB; use a coarser mesh",
                        max_triangles as f64 * GIGABYTES
                    )));
                }
                // The size limit keeps lines below 2³⁰.
                let line = u32::try_from(line).unwrap_or(u32::MAX);
                let fan = corners.windows(2).skip(1);
                mesh.triangles.extend(fan.map(|pair| Triangle {
                    vertices: [corners[0], pair[0], pair[1]],
                    interface,
                    line,
                }));
            }
            Some(other) => {
                let known = "v, f, usemtl; o, g, s, l, p, vn, vt and mtllib are skipped";
                return Err(refuse(format!("unknown statement {other:?} (read are {known})")));
            }
        }
    }
    if mesh.triangles.is_empty() {
        return Err(source.refuse_line(source.text.lines().count().max(1), "the mesh has no faces"));
    }
    Ok(mesh)
}

fn vertex<'a>(source: &Source<'_>, line: usize, mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3]> {
    let mut coordinates = [0.0; 3];
    for coordinate in &mut coordinates {
        let word = words.next().ok_or_else(|| source.refuse_line(line, "a vertex needs three coordinates"))?;
        *coordinate = match word.parse::<f64>() {
            Ok(x) if x.abs() <= MAX_LENGTH_NM => x,
            Ok(x) if x.is_finite() => {
                let message = format!("coordinate {x} is more than {MAX_LENGTH_NM} nm, a metre; units are nanometres");
                return Err(source.refuse_line(line, message));
            }
            _ => return Err(source.refuse_line(line, format_args!("coordinate {word:?} is not a finite number"))),
        };
    }
    Ok(coordinates)
}

/// The index of the interface that a `usemtl` line names; the name may contain spaces.
fn material(source: &Source<'_>, line: usize, code: &str, interfaces: &[&str]) -> Result<u16> {
    let name = code.trim().strip_prefix("usemtl").unwrap_or_default().trim();
    let index = interfaces.iter().position(|&known| known == name).and_then(|index| u16::try_from(index).ok());
    index.ok_or_else(|| {
        let near = nearest(name, interfaces.iter().copied());
        let near = near.map_or_else(String::new, |near| format!("nearest is [interface.{}]; ", toml_key(near)));
        let remedy = "declare each usemtl name in the scene file";
        source.refuse_line(line, format_args!("usemtl {name:?} has no [interface]; {near}{remedy}"))
    })
}

/// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; negative numbers count back from the last vertex.
fn corner(source: &Source<'_>, line: usize, word: &str, count: usize) -> Result<u32> {
    let number = word.split('/').next().unwrap_or_default();
    let given: i64 = number
        .parse()
        .map_err(|_| source.refuse_line(line, format_args!("corner {word:?} does not start with a vertex number")))?;
    let signed_count = i64::try_from(count).unwrap_or(i64::MAX);
    let index = if given < 0 { signed_count.checked_add(given) } else { given.checked_sub(1) };
    match index {
        Some(index) if (0..signed_count).contains(&index) => Ok(u32::try_from(index).unwrap_or(u32::MAX)),
        _ => Err(source.refuse_line(line, format_args!("vertex {given} does not exist; {count} are defined above"))),
    }
}

/// Refuses what a fan of triangles from the first corner cannot represent.
fn polygon(vertices: &[[f64; 3]], corners: &[u32]) -> std::result::Result<(), String> {
    if corners.len() < 3 {
        return Err(format!("a face needs at least three corners, found {}", corners.len()));
    }
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    if sorted.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err("the face uses a vertex twice".to_owned());
    }
    if corners.len() == 3 {
        return Ok(());
    }
    let point = |corner: u32| vertices[corner as usize];
    let normals = || corners[1..].windows(2).map(|pair| normal(point(corners[0]), point(pair[0]), point(pair[1])));
    let whole = normals().fold([0.0; 3], |[x, y, z], [u, v, w]| [x + u, y + v, z + w]);
    // A slim triangle of coordinates rounded to single precision may turn over by that rounding.
    let rounding = f64::from(f32::EPSILON) * dot(whole, whole);
    if normals().any(|normal| dot(normal, whole) < -rounding) {
        return Err("the polygon is concave; split it into triangles".to_owned());
    }
    let length = dot(whole, whole).sqrt();
    let distances = || corners.iter().map(|&corner| from(point(corners[0]), point(corner)));
    let extent = distances().map(|p| dot(p, p)).fold(0.0, f64::max).sqrt();
    let off = distances().map(|p| dot(p, whole).abs()).fold(0.0, f64::max);
    if off > PLANAR * extent * length {
        let off = (1000.0 * off / length).round() / 1000.0;
        return Err(format!("the polygon is not planar: a corner lies {off} nm off; split it into triangles"));
    }
    Ok(())
}

fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}

/// The way from a to b.
fn from(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

/// Twice the area of a triangle, along its normal.
fn normal(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> [f64; 3] {
    let (u, v) = (from(a, b), from(a, c));
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Mesh> {
        parse(&Source { label: "m.obj", text }, Path::new("m.obj"), &["top", "two words"], 3)
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
        assert_eq!(sixth("f 1 2 x"), "m.obj:6: corner \"x\" does not start with a vertex number");
        assert_eq!(sixth("f 1 2"), "m.obj:6: a face needs at least three corners, found 2");
        assert_eq!(sixth("f 1 2 2"), "m.obj:6: the face uses a vertex twice");
        assert_eq!(sixth("v 0 0"), "m.obj:6: a vertex needs three coordinates");
        assert_eq!(sixth("v 0 0 nan"), "m.obj:6: coordinate \"nan\" is not a finite number");
        assert_eq!(sixth("v 0 0 1e999"), "m.obj:6: coordinate \"1e999\" is not a finite number");
        assert_eq!(
            sixth("v 0 0 1e10"),
            "m.obj:6: coordinate 10000000000 is more than 1000000000 nm, a metre; units are nanometres"
        );
        assert_eq!(
            sixth("usemtl tip"),
            "m.obj:6: usemtl \"tip\" has no [interface]; nearest is [interface.top]; declare each usemtl name in the scene file"
        );
        assert_eq!(
            sixth("f 1 2 3 4\nf 1 2 3 4"),
            "m.obj:7: more than 3 triangles, which take 0.0 GB; use a coarser mesh"
        );
        assert!(sixth("curv 0 1").starts_with("m.obj:6: unknown statement \"curv\" (read are v, f, usemtl;"));
        assert_eq!(
            sixth("v 0 1 0.1\nf 1 2 3 5"),
            "m.obj:7: the polygon is not planar: a corner lies 0.05 nm off; split it into triangles"
        );
        assert!(read(&format!("{SQUARE}v 0 1 0.00001\nf 1 2 3 5")).is_ok());
        assert_eq!(sixth("v 0.9 0.1 0\nf 1 2 3 5"), "m.obj:7: the polygon is concave; split it into triangles");
    }
}
