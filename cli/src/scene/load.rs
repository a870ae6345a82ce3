//! Scenes, media and meshes from files, presets and texts.

use std::path::Path;

use goniochrome::optics::medium::Extrapolate;

use super::diagnostics::{SourceText, canonical, nearest, read_text};
use super::file::FinishKey;
use super::medium::OwnedMedium;
use super::mesh::Mesh;
use super::model::Scene;
use super::{delimited, file, presets, refractive_index_info};
use crate::support::error::{Error, Result};

/// Maximum length of a scene file: 4 MiB hold some 50 000 layers.
const MAX_SCENE_BYTES: u64 = 4 << 20;

/// Loads the scene in a file, or the preset of that name. A file hides a preset with its name.
///
/// # Errors
/// One line that names the place and the remedy; a name that is neither a file nor a preset is wrong usage.
pub fn load(name_or_path: &str) -> Result<Scene> {
    let path = Path::new(name_or_path);
    if path.exists() && !path.is_dir() {
        let text = read_text(path, MAX_SCENE_BYTES)?;
        let stem = path.file_stem().map_or(name_or_path.into(), |stem| stem.to_string_lossy());
        let mut scene = file::parse(name_or_path, &text, &stem, path.parent(), FinishKey::Read)?;
        scene.files.insert(0, canonical(path));
        return Ok(scene);
    }
    if let Some((name, toml)) = presets::find(name_or_path) {
        return file::parse(&format!("preset {name}"), toml, name, None, FinishKey::Read);
    }
    if path.is_dir() {
        return Err(Error::failed(format_args!("{name_or_path}: is a folder, expected a scene file")));
    }
    if path.extension().is_some() || path.components().count() > 1 {
        return Err(Error::failed(format_args!("{name_or_path}: no such scene file; check the path")));
    }
    let said = format!("no file and no preset is called {name_or_path:?}");
    Err(Error::usage(match nearest(name_or_path, presets::names()) {
        Some(near) => format!("{said}; the nearest preset is {near:?} (`goniochrome presets` lists all)"),
        None => format!("{said}; `goniochrome presets` lists the presets"),
    }))
}

/// Reads the scene in a text, with built-in materials alone: a text has no folder, so it can name no files.
///
/// # Errors
/// One line that names the place, under `label`, and the remedy.
pub fn parse(label: &str, text: &str) -> Result<Scene> {
    file::parse(label, text, label, None, FinishKey::Read)
}

/// Reads the scene in a table's header as [`parse`] does, without its finish, which the table has itself.
///
/// # Errors
/// One line that names the place, under `label`, and the remedy.
pub fn parse_without_finish(label: &str, text: &str) -> Result<Scene> {
    file::parse(label, text, label, None, FinishKey::Skip)
}

/// Reads the medium in a text in the format of refractiveindex.info.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_nk(label: &str, text: &str) -> Result<OwnedMedium> {
    refractive_index_info::parse(&SourceText { label, text }, Extrapolate::Refuse)
}

/// Reads the medium in columns of text: wavelength, n and, if it absorbs, k.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_columns(label: &str, text: &str) -> Result<OwnedMedium> {
    delimited::parse(&SourceText { label, text }, None, Extrapolate::Refuse)
}

/// Reads the mesh in a text in Wavefront OBJ; `interfaces` are the names that `usemtl` may use.
///
/// # Errors
/// One line that names the place, under `label`.
pub fn parse_mesh(label: &str, text: &str, interfaces: &[&str]) -> Result<Mesh> {
    Mesh::parse(label, text, interfaces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Shape;

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
