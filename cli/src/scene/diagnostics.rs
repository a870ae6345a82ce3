//! Text input, and messages that name the place of a fault in it.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use crate::support::error::{Error, Result};
use crate::support::input::read_bytes;

/// Text with the name that messages give it.
#[derive(Clone, Copy)]
pub(super) struct SourceText<'a> {
    pub label: &'a str,
    pub text: &'a str,
}

impl SourceText<'_> {
    /// Error at a byte offset: `label:line:column: message`, counted from 1.
    pub fn refuse(&self, offset: usize, message: impl Display) -> Error {
        let before = self.text.get(..offset).unwrap_or(self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
        Error::failed(format_args!("{}:{line}:{column}: {message}", self.label))
    }

    /// Line of a byte offset, counted from 1.
    pub fn line(&self, offset: usize) -> u32 {
        let before = self.text.get(..offset).unwrap_or(self.text);
        u32::try_from(before.matches('\n').count()).map_or(u32::MAX, |lines| lines.saturating_add(1))
    }

    /// Error at a line, counted from 1.
    pub fn refuse_line(&self, line: usize, message: impl Display) -> Error {
        Error::failed(format_args!("{}:{line}: {message}", self.label))
    }
}

/// Reads the text of a file, without a byte order mark, of at most `limit` bytes.
pub(super) fn read_text(path: &Path, limit: u64) -> Result<String> {
    let label = path.display();
    let failed = |error: std::io::Error| Error::failed(format_args!("{label}: cannot read: {error}"));
    let bytes = read_bytes(path, limit, "this kind of file", failed)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let line = error.as_bytes()[..good].iter().filter(|&&b| b == b'\n').count() + 1;
        Error::failed(format_args!("{label}:{line}: not UTF-8 text; save the file as UTF-8"))
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(rest) => rest.to_owned(),
        None => text,
    })
}

/// Canonical path of a file, or the path as given where it has none (a pipe).
pub(super) fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_owned())
}

/// Candidate that `name` was probably meant to be, in upper or lower case: one that contains it, or one with at most
/// one wrong letter in three. `None` if no candidate is that near, since a far guess misleads.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    const LETTERS_PER_SLIP: usize = 3;
    let name = name.to_lowercase();
    let slips = |candidate: &str| {
        let candidate = candidate.to_lowercase();
        let part = name.chars().count() >= LETTERS_PER_SLIP && candidate.contains(&name);
        let slips = strsim::damerau_levenshtein(&name, &candidate);
        let longer = name.chars().count().max(candidate.chars().count());
        (part || slips * LETTERS_PER_SLIP <= longer).then_some(slips)
    };
    let near = candidates.into_iter().filter_map(|candidate| slips(candidate).map(|slips| (slips, candidate)));
    near.min_by_key(|&(slips, _)| slips).map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let source = SourceText { label: "a.toml", text: "é = 1\nöö = x" };
        assert_eq!(source.refuse(0, "no").to_string(), "a.toml:1:1: no");
        let x = source.text.find('x').unwrap();
        assert_eq!(source.refuse(x, "no").to_string(), "a.toml:2:6: no");
        assert_eq!(source.refuse_line(7, "no").to_string(), "a.toml:7: no");
    }

    #[test]
    fn reading_refuses_folders_long_files_and_other_encodings() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read_text(folder.path(), 8).unwrap_err().to_string().ends_with("is a folder, expected a file"));
        let path = folder.path().join("f");
        assert!(read_text(&path, 8).unwrap_err().to_string().contains("cannot read"));
        std::fs::write(&path, b"\xef\xbb\xbfok").unwrap();
        assert_eq!(read_text(&path, 8).unwrap(), "ok");
        assert!(read_text(&path, 4).unwrap_err().to_string().contains("longer than"));
        std::fs::write(&path, b"a\nb\xff").unwrap();
        assert!(read_text(&path, 8).unwrap_err().to_string().contains("f:2: not UTF-8"));
    }

    #[test]
    fn the_nearest_name_ignores_case() {
        assert_eq!(nearest("tio", ["air", "TiO2", "Si"]), Some("TiO2"));
        assert_eq!(nearest("x", []), None);
    }

    #[test]
    fn only_what_is_near_is_suggested() {
        let presets = ["paper-fig3", "anodised-titanium", "morpho-stack", "soap-bubble"];
        assert_eq!(nearest("nonexist", presets), None);
        assert_eq!(nearest("morpho", presets), Some("morpho-stack"));
        assert_eq!(nearest("paper-fgi3", presets), Some("paper-fig3"));
        assert_eq!(nearest("zzz", ["n", "k", "file"]), None);
        assert_eq!(nearest("Ni", ["Si", "Ti"]), None);
    }
}
