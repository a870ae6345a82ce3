//! Scenes: what stands in a scene file, an OBJ mesh and refractive index files, as plain data.

mod builtin;
mod watertight;
mod column;
mod delimited;
mod file;
mod toml_value;
mod media;
mod medium;
mod refractive_index_info;
mod mesh;
mod placement;
mod planes;
pub mod presets;
mod diagnostics;
mod surface;
mod yaml;

use std::path::{Path, PathBuf};

use goniochrome::optics::interface::{Below, Interface};
use goniochrome::optics::medium::{Extrapolate, MediumError, MediumIndex};

use crate::support::error::{Error, Result};

pub use builtin::{list as list_materials, names as material_names};
pub use medium::{OwnedDispersion, OwnedMedium};
pub use mesh::{Mesh, Triangle};
pub use planes::{FlatCell, Plane};
pub use watertight::ClosedCell;

/// Scene files are written by hand or by a script; 4 MiB hold some 50 000 layers.
const MAX_SCENE_BYTES: u64 = 4 << 20;

/// A metre: no film is thicker, and its phase still has ten digits.
const MAX_LENGTH_NM: f64 = 1e9;

/// A scene: media, and the surface that they form.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The scene's own name, else that of the preset or file.
    pub name: String,
    /// The scene file as read, for the metadata of what is made from it.
    pub toml: String,
    /// Every medium in use, each once; a [`MediumIndex`] counts in this list.
    pub media: Vec<NamedMedium>,
    /// What lies where.
    pub shape: Shape,
    /// Every file that was read, canonical, so that writing over an input can be refused.
    pub files: Vec<PathBuf>,
}

impl Scene {
    /// What the medium of this index says against a wavelength, with its name and the remedy that the scene has. A
    /// command that asks for wavelengths adds its own: see [`Error::no_data`].
    pub(crate) fn medium_error(&self, index: usize, error: &MediumError) -> Error {
        let NamedMedium { name, medium } = &self.media[index];
        let line = format!("{}: material {name}: {}", self.name, medium.describe(error));
        match error {
            MediumError::OutOfRange { .. } => Error::no_data(line),
            _ => Error::failed(line),
        }
    }
}

/// A medium and what the scene calls it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMedium {
    /// A material's name or its numbers, `1.56+0.06i`.
    pub name: String,
    /// η(λ).
    pub medium: OwnedMedium,
}

/// The kinds of scene. Which of them a mesh is decides [`Shape::of_mesh`] alone, with the check of that kind.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Plane layers.
    Stack {
        /// The medium in which light arrives.
        ambient: MediumIndex,
        /// From the top, repetitions written out.
        layers: Vec<Layer>,
        /// What lies under the last layer.
        substrate: Below,
    },
    /// A mesh of horizontal planes, periodic in x and y.
    Planes(FlatCell),
    /// A mesh of other facets, periodic in x and y: it scatters light.
    Mesh(ClosedCell),
}

impl Shape {
    /// What a mesh is. `interfaces` are what its triangles count, `media` what these divide.
    ///
    /// # Errors
    /// One line that names the first facet at fault, the place and the remedy: no command traces a mesh with a hole.
    pub fn of_mesh(
        mesh: Mesh,
        period_nm: [f64; 2],
        interfaces: Vec<NamedInterface>,
        media: &[NamedMedium],
    ) -> Result<Self> {
        match FlatCell::new(&mesh, period_nm, &interfaces, media)? {
            Some(flat) => Ok(Self::Planes(flat)),
            None => ClosedCell::new(mesh, period_nm, interfaces, media).map(Self::Mesh),
        }
    }

    /// The polygons of a mesh, of horizontal planes too; none of a stack.
    #[must_use]
    pub fn polygons(&self) -> Option<&ClosedCell> {
        match self {
            Self::Stack { .. } => None,
            Self::Planes(flat) => Some(flat.polygons()),
            Self::Mesh(closed) => Some(closed),
        }
    }
}

/// A plane layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// What it is made of.
    pub medium: MediumIndex,
    /// 0 or more; a layer of no thickness is legal and does nothing.
    pub thickness_nm: f64,
}

/// An `[interface.NAME]`.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedInterface {
    /// The `usemtl` name of its facets.
    pub name: String,
    /// The media on its two sides.
    pub interface: Interface,
    /// Films on the side of the facet's normal, the outermost first; they take up no room in the mesh.
    pub coating: Vec<Layer>,
}

/// The scene in a file, or the preset of that name. A file hides a preset of the same name.
///
/// # Errors
/// One line that names the place and the remedy; a name that is neither a file nor a preset is wrong usage.
pub fn load(name_or_path: &str) -> Result<Scene> {
    let path = Path::new(name_or_path);
    if path.exists() && !path.is_dir() {
        let text = diagnostics::read_text(path, MAX_SCENE_BYTES)?;
        let stem = path.file_stem().map_or(name_or_path.into(), |stem| stem.to_string_lossy());
        let mut scene = file::parse(name_or_path, &text, &stem, path.parent())?;
        scene.files.insert(0, diagnostics::canonical(path));
        return Ok(scene);
    }
    if let Some((name, toml)) = presets::find(name_or_path) {
        return file::parse(&format!("preset {name}"), toml, name, None);
    }
    if path.is_dir() {
        return Err(Error::failed(format_args!("{name_or_path}: is a folder, expected a scene file")));
    }
    if path.extension().is_some() || path.components().count() > 1 {
        return Err(Error::failed(format_args!("{name_or_path}: no such scene file; check the path")));
    }
    let said = format!("no file and no preset is called {name_or_path:?}");
    Err(Error::usage(match diagnostics::nearest(name_or_path, presets::names()) {
        Some(near) => format!("{said}; the nearest preset is {near:?} (`goniochrome presets` lists all)"),
        None => format!("{said}; `goniochrome presets` lists the presets"),
    }))
}

/// The scene in a text, with built-in materials alone: a text has no folder, so it can name no files.
///
/// # Errors
/// One line that names the place, under `label`, and the remedy.
pub fn parse(label: &str, text: &str) -> Result<Scene> {
    file::parse(label, text, label, None)
}

/// The medium in a text in the format of refractiveindex.info.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_nk(label: &str, text: &str) -> Result<OwnedMedium> {
    refractive_index_info::parse(&diagnostics::Source { label, text }, Extrapolate::Refuse)
}

/// The medium in columns of text: wavelength, n and, if it absorbs, k.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_columns(label: &str, text: &str) -> Result<OwnedMedium> {
    delimited::parse(&diagnostics::Source { label, text }, None, Extrapolate::Refuse)
}

/// The mesh in a text in Wavefront OBJ; `interfaces` are the names that `usemtl` may use.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_mesh(label: &str, text: &str, interfaces: &[&str]) -> Result<Mesh> {
    Mesh::parse(label, text, interfaces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_neither_file_nor_preset_gets_a_remedy() {
        let error = load("jewel-betle").unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert_eq!(
            error.to_string(),
            "no file and no preset is called \"jewel-betle\"; the nearest preset is \"jewel-beetle\" (`goniochrome presets` lists all)"
        );
        let error = load("nowhere/film.toml").unwrap_err();
        assert_eq!(
            (error.exit_code(), error.to_string().as_str()),
            (1, "nowhere/film.toml: no such scene file; check the path")
        );
        let folder = tempfile::tempdir().unwrap();
        let error = load(folder.path().to_str().unwrap()).unwrap_err();
        assert!(error.to_string().ends_with(": is a folder, expected a scene file"));
    }

    #[test]
    fn a_text_reads_no_files() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("n.yml");
        std::fs::write(&path, "DATA:\n  - type: formula 5\n    range: 0.3 0.9\n    coefficients: 1.7\n").unwrap();
        let text = format!("[stack]\nambient = 1\nsubstrate = 'x'\n[materials.x]\nfile = '{}'\n", path.display());
        let message = parse("text", &text).unwrap_err().to_string();
        assert!(message.ends_with("file: only a scene in a file can name files"), "{message}");
        assert_eq!(parse("text", text.replace("'x'", "'SiO2'").split("[mat").next().unwrap()).unwrap().media.len(), 2);
    }

    #[test]
    fn a_file_is_read_with_what_it_names() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        write("n.yml", "DATA:\n  - type: formula 5\n    wavelength_range: 0.3 0.9\n    coefficients: 1.7\n");
        write("square.obj", "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nusemtl top\nf 1 2 3 4\n");
        write(
            "film.toml",
            "[cell]\nmesh = \"square.obj\"\nperiod_nm = [9, 9.0]\n[interface.top]\nabove = 1\nbelow = \"X\"\n[materials.x]\nfile = \"n.yml\"\n",
        );
        let path = folder.path().join("film.toml");
        let scene = load(path.to_str().unwrap()).unwrap();
        assert_eq!(scene.name, "film");
        let root = folder.path().canonicalize().unwrap();
        assert_eq!(scene.files, ["film.toml", "n.yml", "square.obj"].map(|name| root.join(name)));
        let Shape::Planes(flat) = &scene.shape else { panic!("a plane") };
        let cell = flat.polygons();
        assert_eq!((cell.mesh().triangles.len(), cell.period_nm(), cell.interfaces().len()), (2, [9.0, 9.0], 1));
        assert_eq!(scene.media.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["1", "x"]);
        write("n.yml", "DATA:\n  - type: tabulated nk\n    data: |\n        0.5 1.5\n");
        let message = load(path.to_str().unwrap()).unwrap_err().to_string();
        assert!(message.ends_with("n.yml:4: the row needs 3 numbers (wavelength, n, k) but has 2"), "{message}");
    }
}
