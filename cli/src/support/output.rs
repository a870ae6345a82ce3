//! Files appear whole or not at all: every output is written beside its destination and renamed into place.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use crate::support::error::{Error, Result};

/// Writes `bytes` to `path`, replacing what is there only once everything is on disk.
///
/// # Errors
/// A folder in place of the file, a missing folder, no permission, a full disk. An earlier file stays as it was.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    write_with(path, |writer| writer.write_all(bytes))
}

/// Writes `text` to `path`, or to standard output where `path` is `-`.
///
/// # Errors
/// A file that [`write_file`] cannot write, a standard output that fails. A closed pipe is not an error.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    if path != Path::new("-") {
        return write_file(path, text.as_bytes());
    }
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        // `goniochrome … | head` has seen enough; that is not a failure.
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        result => result.map_err(|error| explain(Path::new("standard output"), &error)),
    }
}

/// Lets `fill` write to `path`. A failure leaves an earlier file untouched and no temporary file behind.
///
/// Symbolic links are followed. Devices and pipes (`/dev/null`) are written in place, since renaming would replace
/// them.
///
/// # Errors
/// A folder in place of the file, a missing folder, no permission, a full disk, an error of `fill`.
pub fn write_with(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    check_destination(path, &[])?;
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let written = if is_stream(&target) {
        File::options().write(true).open(&target).and_then(|file| filled(file, fill).map(drop))
    } else {
        staged(&target, fill).and_then(|file| named(file, &target))
    };
    written.map_err(|error| explain(path, &error))
}

/// Writes `bytes` to `path` and does `also`, another output: if that fails, `path` stays as it was.
///
/// # Errors
/// A file that [`write_file`] cannot write, an error of `also`.
pub fn write_file_and(path: &Path, bytes: &[u8], also: impl FnOnce() -> Result<()>) -> Result<()> {
    check_destination(path, &[])?;
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    if is_stream(&target) {
        also()?;
        return write_file(path, bytes);
    }
    let file = staged(&target, |writer| writer.write_all(bytes)).map_err(|error| explain(path, &error))?;
    also()?;
    named(file, &target).map_err(|error| explain(path, &error))
}

/// Refuses an output that is one of the inputs, whatever names and links lead to it.
///
/// # Errors
/// Wrong usage that names the output and the input.
pub fn refuse_overwrite_of_inputs(output: &Path, inputs: &[PathBuf]) -> Result<()> {
    match inputs.iter().find(|input| same_file(output, input)) {
        None => Ok(()),
        Some(input) => Err(Error::usage(format_args!(
            "the output {} would overwrite the input {}; choose another output",
            output.display(),
            input.display()
        ))),
    }
}

/// Refuses two outputs in one file, of which the second would replace the first.
///
/// # Errors
/// Wrong usage that names both outputs.
pub fn refuse_same_output(a: &Path, b: &Path) -> Result<()> {
    let place = |path: &Path| {
        let known = fs::canonicalize(folder_of(path)).ok().zip(path.file_name());
        known.map_or_else(|| path.to_owned(), |(folder, name)| folder.join(name))
    };
    if place(a) != place(b) && !same_file(a, b) {
        return Ok(());
    }
    let (a, b) = (a.display(), b.display());
    Err(Error::usage(format_args!("{a} and {b} are one file for two outputs; choose another for one of them")))
}

/// Refuses an output that cannot be written, before long work begins.
///
/// # Errors
/// An output that is one of the inputs, a folder, or in a folder that does not exist.
pub fn check_destination(output: &Path, inputs: &[PathBuf]) -> Result<()> {
    if output == Path::new("-") {
        return Ok(());
    }
    refuse_overwrite_of_inputs(output, inputs)?;
    if output.is_dir() {
        return Err(Error::failed(format_args!("{} is a folder; name a file in it", output.display())));
    }
    let folder = folder_of(output);
    if !folder.is_dir() {
        let folder = folder.display();
        return Err(Error::failed(format_args!("folder {folder} does not exist; create it or choose another output")));
    }
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// Whether the path leads to a device or a pipe.
pub(crate) fn is_stream(target: &Path) -> bool {
    target.exists() && !target.is_file()
}

/// Writes a temporary file beside the target, complete and on disk.
fn staged(target: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".goniochrome-");
    // Temporary files are private by default; a result gets the rights that any new file gets.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder_of(target))?;
    filled(temporary.as_file(), fill)?.sync_all()?;
    Ok(temporary)
}

/// Renames the file to its target and syncs the folder, so that the name is on disk too.
fn named(file: NamedTempFile, target: &Path) -> io::Result<()> {
    file.persist(target).map(drop).map_err(|error| error.error)?;
    // Not every system lets a folder be opened; the file itself is on disk.
    File::open(folder_of(target)).and_then(|folder| folder.sync_all()).or(Ok(()))
}

fn filled<W: Write>(file: W, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<W> {
    let mut writer = BufWriter::new(file);
    fill(&mut writer)?;
    writer.into_inner().map_err(io::IntoInnerError::into_error)
}

fn same_file(a: &Path, b: &Path) -> bool {
    let (Ok(a), Ok(b)) = (fs::canonicalize(a), fs::canonicalize(b)) else { return false };
    a == b || same_inode(&a, &b)
}

/// Whether the path leads to this open file, and not to one that took its name; always true where files have no inode.
pub(crate) fn is_still_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let number = |metadata: &fs::Metadata| (metadata.dev(), metadata.ino());
        matches!((file.metadata(), fs::metadata(path)), (Ok(a), Ok(b)) if number(&a) == number(&b))
    }
    #[cfg(not(unix))]
    {
        let _ = (file, path);
        true
    }
}

#[cfg(unix)]
fn same_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(a), fs::metadata(b)) {
        (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
        _ => false,
    }
}

#[cfg(not(unix))]
fn same_inode(_: &Path, _: &Path) -> bool {
    false
}

/// Error for a failure to write `path`, with the remedy.
pub(crate) fn explain(path: &Path, error: &io::Error) -> Error {
    let path = path.display();
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            Error::failed(format_args!("no space left to write {path}; free some or choose another output"))
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            Error::failed(format_args!("no permission to write {path}; choose another output"))
        }
        _ => Error::failed(format_args!("cannot write {path}: {error}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_file_is_written_and_replaced_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_file(&path, b"a longer first version").unwrap();
        write_text(&path, "second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(names_in(folder.path()), ["table.csv"]);
    }

    #[test]
    fn a_full_disk_keeps_the_old_file_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        write_file(&path, b"old").unwrap();
        let error = write_with(&path, |writer| {
            writer.write_all(&[0; 100_000])?;
            Err(ErrorKind::StorageFull.into())
        })
        .unwrap_err();
        assert!(error.to_string().starts_with("no space left to write "), "{error}");
        assert_eq!(error.exit_code(), 1);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names_in(folder.path()), ["table.csv"]);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_in_place() {
        let error = write_file(Path::new("/dev/full"), b"x").unwrap_err();
        assert_eq!(error.to_string(), "no space left to write /dev/full; free some or choose another output");
        write_file(Path::new("/dev/null"), b"x").unwrap();
        assert!(!Path::new("/dev/null").is_file());
    }

    #[test]
    fn of_two_outputs_none_appears_without_the_other() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let failed = || write_file(&at("nowhere/b"), b"2");
        assert!(write_file_and(&at("a"), b"1", failed).unwrap_err().to_string().contains("does not exist"));
        assert!(names_in(folder.path()).is_empty());
        write_file_and(&at("a"), b"1", || write_file(&at("b"), b"2")).unwrap();
        assert_eq!(names_in(folder.path()), ["a", "b"]);
        refuse_same_output(&at("a"), &at("b")).unwrap();
        assert_eq!(refuse_same_output(&at("new"), &at("./new")).unwrap_err().exit_code(), 2);
    }

    #[test]
    fn a_missing_folder_is_named_with_the_remedy() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("nowhere");
        let error = write_file(&missing.join("a.png"), b"x").unwrap_err();
        let expected = format!("folder {} does not exist; create it or choose another output", missing.display());
        assert_eq!(error.to_string(), expected);
        assert!(write_file(folder.path(), b"x").unwrap_err().to_string().contains("is a folder"));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_new_files_have_ordinary_rights() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        write_file(&real, b"1").unwrap();
        symlink(&real, &link).unwrap();
        write_file(&link, b"2").unwrap();
        assert_eq!(fs::read(&real).unwrap(), b"2");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        let plain = folder.path().join("plain");
        fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&real), mode(&plain));
    }

    #[cfg(unix)]
    #[test]
    fn an_input_is_recognised_behind_links() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        write_file(&at("scene.toml"), b"").unwrap();
        std::os::unix::fs::symlink(at("scene.toml"), at("soft")).unwrap();
        fs::hard_link(at("scene.toml"), at("hard")).unwrap();
        write_file(&at("other"), b"").unwrap();
        let inputs = [at("other.obj"), at("scene.toml")];
        for output in ["scene.toml", "soft", "hard", "./scene.toml"] {
            let error = refuse_overwrite_of_inputs(&at(output), &inputs).unwrap_err();
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains("would overwrite the input"), "{error}");
        }
        refuse_overwrite_of_inputs(&at("other"), &inputs).unwrap();
        refuse_overwrite_of_inputs(&at("new"), &inputs).unwrap();
    }
}
