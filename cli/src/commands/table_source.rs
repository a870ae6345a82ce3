//! The table that a command draws: read from a file, or made in memory from a scene.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::commands::make_table::make_table_in_memory;
use crate::scene::{Scene, load};
use crate::support::error::Result;
use crate::support::progress::note;
use crate::table::{Table, file};

/// The source of a table.
pub(super) enum TableSource {
    /// A file that `estimate` wrote.
    File(PathBuf),
    /// A scene file or a preset.
    Scene(Box<Scene>),
}

impl TableSource {
    /// The source that the first argument of `plot`, `render` and `view` names. Names that end in .exr and files that
    /// begin as OpenEXR are tables; everything else is a scene.
    ///
    /// # Errors
    /// A scene that cannot be read, or is not a scene.
    pub fn find(name: &Path) -> Result<Self> {
        let named = name.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
        match name.to_str() {
            Some(scene) if !named && !begins_as_exr(name) => Ok(Self::Scene(Box::new(load(scene)?))),
            _ => Ok(Self::File(name.to_owned())),
        }
    }

    /// The files that are read; no output may overwrite them.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::File(path) => vec![path.clone()],
            Self::Scene(scene) => scene.files.clone(),
        }
    }

    /// The table. For a scene it is made by the defaults of `estimate`, for cells with fewer rays.
    ///
    /// # Errors
    /// A file that is not a table; a scene that cannot be computed.
    pub fn table(&self, quiet: bool) -> Result<Table> {
        match self {
            Self::File(path) => file::read(path),
            Self::Scene(scene) => {
                let (table, summary) = make_table_in_memory(scene, quiet)?;
                note(
                    quiet,
                    format_args!("{}: {summary}; `goniochrome estimate` keeps a table and has options", scene.name),
                );
                Ok(table)
            }
        }
    }
}

/// Whether a file has OpenEXR's magic number.
fn begins_as_exr(path: &Path) -> bool {
    const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
    let mut found = [0; 4];
    path.is_file() && File::open(path).is_ok_and(|mut file| file.read_exact(&mut found).is_ok()) && found == MAGIC
}
