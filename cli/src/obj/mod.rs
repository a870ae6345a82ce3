//! Reader of Wavefront OBJ, statement by statement, for the meshes of cells and of pictures.
//!
//! The reader takes `v`, `vn`, `vt`, `usemtl` and `f`. Statements that group, shade or name other files are skipped,
//! and so are points and lines. A backslash at the end of a line continues it, `#` starts a comment, numbers below zero
//! count back from the last vertex, a vertex may carry a colour, and a corner that repeats the one before it, or the
//! first at the end, counts once.

pub(crate) mod polygon;

use std::borrow::Cow;
use std::fmt::Display;
use std::path::Path;

use crate::support::error::{Error, Result};
use crate::support::input::read_bytes;

/// Maximum length of a file: ten million triangles with their vertices take about half of this.
const MAX_BYTES: u64 = 1 << 30;

/// Maximum number of triangles of a mesh. As a cell, ten million with their hierarchy, checks and file took 3.9 GB.
pub(crate) const MAX_TRIANGLES: usize = 10_000_000;

/// Maximum number of vertices of a mesh, three for each triangle: every mesh whose facets share nothing fits.
const MAX_VERTICES: usize = 3 * MAX_TRIANGLES;

/// Maximum number of characters of a word that messages show.
const SHOWN: usize = 40;

/// Statements that say nothing about where a surface is.
const SKIPPED: [&str; 17] = [
    "o",
    "g",
    "s",
    "mg",
    "l",
    "p",
    "mtllib",
    "usemap",
    "maplib",
    "lod",
    "bevel",
    "c_interp",
    "d_interp",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
];

/// Statements of curves and curved surfaces, which are refused.
const CURVED: [&str; 17] = [
    "vp", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con",
    "bzp", "bsp",
];

/// Reads the text of an OBJ file. Bytes that are not UTF-8, as old programs write them into names and comments, become
/// U+FFFD.
///
/// # Errors
/// One line that names the file: it cannot be read, is longer than a gibibyte, or is UTF-16.
pub(crate) fn read_file(path: &Path, remedy: &str) -> Result<String> {
    let label = path.display();
    let failed = |error: std::io::Error| Error::failed(format_args!("cannot read {label}: {error}{remedy}"));
    let bytes = read_bytes(path, MAX_BYTES, "a mesh", failed)?;
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        return Err(Error::failed(format_args!("{label}: is UTF-16 text; save the file as UTF-8")));
    }
    Ok(String::from_utf8(bytes).unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned()))
}

/// Corner of a face, with indices from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FaceCorner {
    /// Index of the vertex.
    pub vertex: u32,
    /// Index of the texture coordinates; `None` where the face names none, and in [`Detail::Places`].
    pub texture: Option<u32>,
    /// Index of the normal; `None` where the face names none, and in [`Detail::Places`].
    pub normal: Option<u32>,
}

/// Axis that points up in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// z, as everywhere in this program
    #[default]
    ZUp,
    /// y, as modelling programs export unless told otherwise: x, y, z become x, −z, y
    YUp,
}

impl Axes {
    /// Rotates a vector of the file so that z is up.
    pub(crate) fn turned(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::ZUp => [x, y, z],
            Self::YUp => [x, -z, y],
        }
    }
}

/// Statements that a reader returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Detail {
    /// Vertices and faces.
    Places,
    /// Vertices, faces, texture coordinates and normals.
    Full,
}

/// Statement of a line.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Statement<'r> {
    /// Vertex, with finite coordinates.
    Vertex([f64; 3]),
    /// Normal as written; NaN for what is not a number.
    Normal([f64; 3]),
    /// First texture coordinate; NaN for what is not a number.
    Texture([f64; 2]),
    /// Name in `usemtl`, which may contain spaces.
    Material(Cow<'r, str>),
    /// Corners of a polygon, at least one. Neighbours differ in their vertices.
    Face(&'r [FaceCorner]),
}

/// Reader of the statements of a text.
pub(crate) struct Reader<'a> {
    label: &'a str,
    lines: std::str::Lines<'a>,
    detail: Detail,
    /// Number of lines taken from `lines`.
    count: usize,
    /// Line on which the last statement starts, from 1.
    line: usize,
    vertices: usize,
    textures: usize,
    normals: usize,
    corners: Vec<FaceCorner>,
}

impl<'a> Reader<'a> {
    /// Reader of a text that messages call `label`.
    pub fn new(label: &'a str, text: &'a str, detail: Detail) -> Self {
        let lines = text.strip_prefix('\u{feff}').unwrap_or(text).lines();
        Self { label, lines, detail, count: 0, line: 1, vertices: 0, textures: 0, normals: 0, corners: Vec::new() }
    }

    /// Line on which the last statement starts, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Error at the last statement.
    pub fn refuse(&self, message: impl Display) -> Error {
        Error::failed(format_args!("{}:{}: {message}", self.label, self.line))
    }

    /// Next statement; `None` at the end.
    ///
    /// # Errors
    /// One line that names the place and what is wrong there.
    pub fn next(&mut self) -> Result<Option<Statement<'_>>> {
        while let Some(text) = self.next_line() {
            let mut words = text.split('#').next().unwrap_or_default().split_ascii_whitespace();
            let Some(keyword) = words.next() else { continue };
            match keyword {
                "v" => return self.vertex(words).map(|place| Some(Statement::Vertex(place))),
                "f" | "fo" => {
                    self.face(words)?;
                    return Ok(Some(Statement::Face(&self.corners)));
                }
                "usemtl" => return Ok(Some(Statement::Material(material(text)))),
                "vn" if self.detail == Detail::Full => {
                    self.normals += 1;
                    return Ok(Some(Statement::Normal([(); 3].map(|()| number(words.next())))));
                }
                "vt" if self.detail == Detail::Full => {
                    self.textures += 1;
                    return Ok(Some(Statement::Texture([(); 2].map(|()| number(words.next())))));
                }
                "vn" | "vt" => {}
                _ if SKIPPED.contains(&keyword) => {}
                _ if CURVED.contains(&keyword) => {
                    let message = "curves and curved surfaces are not read; export the mesh as polygons";
                    return Err(self.refuse(format_args!("{keyword}: {message}")));
                }
                other => {
                    let other = shown(other);
                    let message =
                        format!("unknown statement {other:?}; an OBJ consists of v, vt, vn, f, usemtl and others");
                    return Err(self.refuse(message));
                }
            }
        }
        self.line = self.count.max(1);
        Ok(None)
    }

    /// Next line, joined with the lines that continue it.
    fn next_line(&mut self) -> Option<Cow<'a, str>> {
        let first = self.take_line()?;
        self.line = self.count;
        let Some(begin) = continued(first) else { return Some(Cow::Borrowed(first)) };
        let mut joined = begin.to_owned();
        while let Some(next) = self.take_line() {
            joined.push(' ');
            match continued(next) {
                Some(part) => joined.push_str(part),
                None => {
                    joined.push_str(next);
                    break;
                }
            }
        }
        Some(Cow::Owned(joined))
    }

    fn take_line(&mut self) -> Option<&'a str> {
        self.count += 1;
        let line = self.lines.next();
        self.count -= usize::from(line.is_none());
        line
    }

    fn vertex<'w>(&mut self, mut words: impl Iterator<Item = &'w str>) -> Result<[f64; 3]> {
        if self.vertices == MAX_VERTICES {
            return Err(self.refuse(format_args!("more than {MAX_VERTICES} vertices")));
        }
        let mut place = [0.0; 3];
        for coordinate in &mut place {
            let word = words.next().ok_or_else(|| self.refuse("a vertex needs three coordinates"))?;
            *coordinate = word.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
                let comma = if word.contains(',') { "; write a point, not a comma, before decimals" } else { "" };
                self.refuse(format_args!("coordinate {:?} is not a finite number{comma}", shown(word)))
            })?;
        }
        self.vertices += 1;
        Ok(place)
    }

    /// Reads a face into `corners`.
    fn face<'w>(&mut self, words: impl Iterator<Item = &'w str>) -> Result<()> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let mut count = 0;
        for word in words {
            let corner = self.corner(word)?;
            count += 1;
            if corners.last().is_none_or(|last: &FaceCorner| last.vertex != corner.vertex) {
                corners.push(corner);
            }
        }
        while corners.len() > 1 && corners.first().map(|c| c.vertex) == corners.last().map(|c| c.vertex) {
            corners.pop();
        }
        self.corners = corners;
        if count < 3 {
            return Err(self.refuse(format_args!("a face needs at least three corners, found {count}")));
        }
        Ok(())
    }

    /// Reads a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<FaceCorner> {
        let mut numbers = word.split('/');
        let first = numbers.next().unwrap_or_default();
        let read = |number: &str, count: usize, what: &str| -> Result<u32> {
            let given: i64 = number.parse().map_err(|_| {
                self.refuse(format_args!("corner {:?}: {:?} is no {what} number", shown(word), shown(number)))
            })?;
            let count_signed = i64::try_from(count).unwrap_or(i64::MAX);
            let index = if given < 0 { count_signed.checked_add(given) } else { given.checked_sub(1) };
            let index = index.filter(|index| (0..count_signed).contains(index));
            index
                .and_then(|index| u32::try_from(index).ok())
                .ok_or_else(|| self.refuse(format_args!("{what} {given} does not exist; {count} are defined above")))
        };
        let vertex = read(first, self.vertices, "vertex")?;
        if self.detail == Detail::Places {
            return Ok(FaceCorner { vertex, texture: None, normal: None });
        }
        let mut optional = |count: usize, what: &str| {
            let number = numbers.next().filter(|number| !number.is_empty());
            number.map(|number| read(number, count, what)).transpose()
        };
        let texture = optional(self.textures, "texture coordinate")?;
        Ok(FaceCorner { vertex, texture, normal: optional(self.normals, "normal")? })
    }
}

/// Text of a line before the backslash at its end, if it has one outside a comment.
fn continued(line: &str) -> Option<&str> {
    let begin = line.trim_end().strip_suffix('\\')?;
    (!begin.contains('#')).then_some(begin)
}

/// Name in a `usemtl` line. It may contain `#`, but no word of it starts with one.
fn material(text: Cow<'_, str>) -> Cow<'_, str> {
    fn name(text: &str) -> &str {
        let rest = text.trim_start().strip_prefix("usemtl").unwrap_or_default();
        let comment = rest.match_indices('#').find(|&(at, _)| rest[..at].ends_with([' ', '\t']));
        rest[..comment.map_or(rest.len(), |(at, _)| at)].trim()
    }
    match text {
        Cow::Borrowed(text) => Cow::Borrowed(name(text)),
        Cow::Owned(text) => Cow::Owned(name(&text).to_owned()),
    }
}

/// Number in a word, NaN if there is none.
fn number(word: Option<&str>) -> f64 {
    word.and_then(|word| word.parse().ok()).unwrap_or(f64::NAN)
}

/// Beginning of a word, for a message.
fn shown(word: &str) -> &str {
    word.char_indices().nth(SHOWN).map_or(word, |(end, _)| &word[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faces(text: &str) -> Vec<Vec<FaceCorner>> {
        let mut reader = Reader::new("m.obj", text, Detail::Full);
        let mut faces = Vec::new();
        while let Some(statement) = reader.next().unwrap() {
            if let Statement::Face(corners) = statement {
                faces.push(corners.to_vec());
            }
        }
        faces
    }

    fn refusal(text: &str) -> String {
        let mut reader = Reader::new("m.obj", text, Detail::Full);
        loop {
            match reader.next() {
                Err(error) => return error.to_string(),
                Ok(None) => panic!("{text:?} is read"),
                Ok(Some(_)) => {}
            }
        }
    }

    fn at(vertices: [u32; 3]) -> Vec<FaceCorner> {
        vertices.map(|vertex| FaceCorner { vertex, texture: None, normal: None }).to_vec()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0 1\nv 1 1 0 0.5 0.5 1\nv 0 1 0\n";

    #[test]
    fn a_backslash_continues_a_line_and_errors_name_its_first() {
        for text in ["f 1 \\\n2 \\\n3", "f 1 2\\\r\n 3\r\n", "f \\ \n1 2 3 # \\\n", "f 1 2 3 # end \\\nl 1 2"] {
            assert_eq!(faces(&format!("{SQUARE}{text}")), [at([0, 1, 2])], "{text:?}");
        }
        assert_eq!(faces(&format!("{SQUARE}f 1 2 3 \\")), [at([0, 1, 2])]);
        assert_eq!(
            refusal(&format!("{SQUARE}f 1 \\\n2 \\\n9\n")),
            "m.obj:5: vertex 9 does not exist; 4 are defined above"
        );
        assert!(refusal(&format!("{SQUARE}f 1 \\\n2 \\\n3\nf 1 2")).starts_with("m.obj:8: "));
    }

    #[test]
    fn repeated_corners_count_once() {
        for face in ["1 2 3 1", "1 2 3 3", "1 1 2 2 3 1 1", "-4 -3 -2 -4"] {
            assert_eq!(faces(&format!("{SQUARE}f {face}")), [at([0, 1, 2])], "{face}");
        }
        assert_eq!(faces(&format!("{SQUARE}f 1 1 1"))[0].len(), 1);
    }

    #[test]
    fn corners_name_textures_and_normals() {
        let text =
            format!("\u{feff}{SQUARE}vt 0.5 0.25\nvn 0 0 1\nvn 0 nan(ind) 1\nf 1/1 2//2 -2/1/-2\nf 1/ 2// 3//\n");
        let corner = |vertex, texture, normal| FaceCorner { vertex, texture, normal };
        let named = vec![corner(0, Some(0), None), corner(1, None, Some(1)), corner(2, Some(0), Some(0))];
        assert_eq!(faces(&text), [named, at([0, 1, 2])]);
        assert!(refusal(&format!("{SQUARE}f 1/1 2 3")).contains("texture coordinate 1 does not exist; 0 are defined"));
        assert!(refusal(&format!("{SQUARE}f 1//x 2 3")).contains("corner \"1//x\": \"x\" is no normal number"));
        // Who asks for places alone does not care.
        let mut places = Reader::new("m.obj", "v 0 0 0\nvn x\nf 1/9/9 1/x 1//", Detail::Places);
        assert_eq!(places.next(), Ok(Some(Statement::Vertex([0.0; 3]))));
        assert!(matches!(places.next(), Ok(Some(Statement::Face(_)))));
        assert_eq!(places.next(), Ok(None));
    }

    #[test]
    fn names_keep_spaces_and_hashes_and_lose_comments() {
        for (text, name) in [
            ("usemtl two words \t", "two words"),
            ("usemtl  Material#3 # red", "Material#3"),
            ("\tusemtl glass\r\n", "glass"),
            ("usemtl", ""),
            ("usemtl two \\\nwords", "two  words"),
        ] {
            let mut reader = Reader::new("m.obj", text, Detail::Places);
            assert_eq!(reader.next(), Ok(Some(Statement::Material(name.into()))), "{text:?}");
        }
    }

    #[test]
    fn statements_without_surface_are_skipped_and_others_named() {
        let skipped = "# c\n\n   \no x y\ng\ns off\nmg 1 2\nl 1 2\np 1\nmtllib a b.mtl\nlod 1\nusemap off\n";
        assert_eq!(faces(&format!("{SQUARE}{skipped}fo 1 2 3")), [at([0, 1, 2])]);
        assert!(refusal("cstype bspline\n").starts_with("m.obj:1: cstype: curves and curved surfaces are not read"));
        assert!(refusal("\n<html>\n").starts_with("m.obj:2: unknown statement \"<html>\""));
        assert!(refusal(&"x".repeat(1 << 20)).len() < 200);
        assert!(refusal("v 1,5 2 3\n").contains("coordinate \"1,5\" is not a finite number; write a point"));
        assert!(refusal("v 1e999 2 3\n").contains("\"1e999\" is not a finite number"));
    }

    #[test]
    fn files_of_other_encodings_are_read_where_their_numbers_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("m.obj");
        std::fs::write(&path, b"# cr\xe9\xe9 par\nv 0 0 0\n").unwrap();
        assert_eq!(read_file(&path, "").unwrap(), "# cr\u{fffd}\u{fffd} par\nv 0 0 0\n");
        std::fs::write(&path, b"\xff\xfev\0 \0").unwrap();
        assert!(read_file(&path, "").unwrap_err().to_string().ends_with("is UTF-16 text; save the file as UTF-8"));
        assert!(read_file(folder.path(), "").unwrap_err().to_string().ends_with("is a folder, expected a file"));
        std::fs::remove_file(&path).unwrap();
        let message = read_file(&path, "; a mesh is an .obj file").unwrap_err().to_string();
        assert!(message.starts_with("cannot read ") && message.ends_with("; a mesh is an .obj file"), "{message}");
    }
}
