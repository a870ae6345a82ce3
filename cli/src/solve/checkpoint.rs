//! Checkpoints: the finished parts of long work, kept beside its output. After an interruption the same command
//! resumes.
//!
//! `OUTPUT.checkpoint` is a log. Its head is text: a line for each input that decides the numbers. Records follow, one
//! for each finished part in the order of finishing: the part's number (u64, little endian), its bytes, SHA-256 of
//! both. Reading stops at the first record that is cut short or does not match its sum; the parts after it are computed
//! again. The file is locked while a run writes it, so that a second run to the same output is refused, and is removed
//! when the output is complete.

use std::fmt::{self, Display, Write as _};
use std::fs::{File, TryLockError};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use base64::Engine;
use sha2::{Digest, Sha256};

use crate::scene::Scene;
use crate::support::error::{Error, Result};
use crate::support::output;

/// The first line of every checkpoint.
const TITLE: &str = "goniochrome checkpoint";

/// The time between syncs to disk: a power cut loses at most the work of this time, if the disk obeys.
const SYNC_EVERY: Duration = Duration::from_secs(5);

/// Bytes of a part's number.
pub(super) const NUMBER_BYTES: usize = size_of::<u64>();

/// Bytes of a SHA-256 sum.
pub(super) const SUM_BYTES: usize = 32;

/// The inputs that decide the numbers of a run: a checkpoint with another identity is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity(String);

impl Identity {
    /// The identity of this program: equal versions with other instruction sets may round differently.
    #[must_use]
    pub fn of_program() -> Self {
        let (version, level) = (env!("CARGO_PKG_VERSION"), goniochrome::simd::lanes::simd_level());
        Self(format!("{TITLE}\nversion: goniochrome {version} ({level})\n"))
    }

    /// The identity of this program at work on a scene: its media and its geometry, wherever its files lie.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Self {
        let identity = Self::of_program();
        match scene.shape.polygons() {
            None => identity.and("scene", &(&scene.media, &scene.shape)),
            Some(cell) => {
                let mesh = cell.mesh();
                identity
                    .and("scene", &(&scene.media, cell.period_nm(), cell.interfaces()))
                    .and("mesh", &(&mesh.vertices, &mesh.triangles))
            }
        }
    }

    /// The identity that a file of a finished share names.
    #[must_use]
    pub fn of_head(head: &[u8]) -> Self {
        Self(String::from_utf8_lossy(head).into_owned())
    }

    /// The bytes at the head of a checkpoint.
    #[must_use]
    pub fn head(&self) -> &[u8] {
        self.0.as_bytes()
    }

    /// Adds the input that `what` names. Everything that matters of `value` must show when it is printed by `{:?}`.
    #[must_use]
    pub fn and(mut self, what: &str, value: &dyn fmt::Debug) -> Self {
        struct Hash(Sha256);
        impl fmt::Write for Hash {
            fn write_str(&mut self, text: &str) -> fmt::Result {
                self.0.update(text);
                Ok(())
            }
        }
        let mut hash = Hash(Sha256::new());
        // Neither the hash nor a derived `Debug` fails.
        let _ = write!(hash, "{value:?}");
        let sum = base64::engine::general_purpose::STANDARD_NO_PAD.encode(hash.0.finalize());
        let _ = writeln!(self.0, "{what}: {sum}");
        self
    }
}

/// The checkpoint of one run.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    log: Mutex<Log>,
}

#[derive(Debug)]
struct Log {
    file: File,
    /// The place of the next record; all records before it are whole.
    end: u64,
    /// Whether the file outlives this run: it has records, or belongs to another run.
    stays: bool,
    /// Whether an earlier run has left records, or the beginning of one.
    resumed: bool,
    /// Bytes of what each record holds, once it is known.
    record_bytes: usize,
    synced: Instant,
}

impl Checkpoint {
    /// Opens or creates the checkpoint of an output, and locks it. `restart` discards the parts that an earlier run has
    /// finished, whatever it computed. Returns `None` if the output is a device or a pipe, which has no folder for it.
    ///
    /// # Errors
    /// A checkpoint that another run has locked, that belongs to other work, or that cannot be written.
    pub fn open(output: &Path, identity: &Identity, restart: bool) -> Result<Option<Self>> {
        let target = std::fs::canonicalize(output).unwrap_or_else(|_| output.to_path_buf());
        if output::is_stream(&target) {
            return Ok(None);
        }
        let mut path = target.into_os_string();
        path.push(".checkpoint");
        let path = PathBuf::from(path);
        if path.is_dir() {
            return Err(Error::failed(format_args!("{} is a folder; choose another output", path.display())));
        }
        let file = locked(&path, output)?;
        let log = Log { file, end: 0, stays: false, resumed: false, record_bytes: 0, synced: Instant::now() };
        let checkpoint = Self { path, log: Mutex::new(log) };
        checkpoint.begin(&identity.0, restart)?;
        Ok(Some(checkpoint))
    }

    /// Checks the head, or writes it where the file has none or a part of one. `restart` overwrites any checkpoint.
    fn begin(&self, head: &str, restart: bool) -> Result<()> {
        let mut log = self.log();
        // Heads end well within the first KiB.
        let mut found = Vec::new();
        (&log.file)
            .take(head.len().max(1024) as u64)
            .read_to_end(&mut found)
            .map_err(|error| self.unreadable(&error))?;
        let discards = restart && found.starts_with(TITLE.as_bytes());
        if !discards && found.starts_with(head.as_bytes()) {
            log.stays = true; // `restore` finds out whether it has records
            log.resumed = found.len() > head.len();
        } else if discards || head.as_bytes().starts_with(&found) {
            log.file
                .set_len(0)
                .and_then(|()| log.write_at(0, head.as_bytes()))
                .map_err(|error| self.unwritten(&error))?;
        } else {
            log.stays = true;
            return Err(self.foreign(head, &String::from_utf8_lossy(&found)));
        }
        log.end = head.len() as u64;
        Ok(())
    }

    /// The note to print as the work begins: what happens if it is interrupted.
    #[must_use]
    pub fn says(&self) -> String {
        let path = self.path.display();
        if self.log().resumed {
            return format!("resumes from {path}; --restart begins anew");
        }
        format!(
            "finished directions are kept in {path}: after an interruption the same command resumes, --restart begins anew"
        )
    }

    /// Calls `take` with the number and bytes of every finished part, each of `length` bytes and with a number below
    /// `count`. Returns how many parts there are.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn restore(&self, length: usize, count: usize, mut take: impl FnMut(usize, &[u8])) -> Result<usize> {
        let mut log = self.log();
        log.record_bytes = length;
        let mut record = vec![0; NUMBER_BYTES + length + SUM_BYTES];
        let mut reader = BufReader::new(&log.file);
        let mut end = log.end;
        let mut seen = vec![false; count];
        reader.seek(SeekFrom::Start(end)).map_err(|error| self.unreadable(&error))?;
        loop {
            match reader.read_exact(&mut record) {
                Ok(()) => {}
                Err(error) if error.kind() == ErrorKind::UnexpectedEof => break,
                Err(error) => return Err(self.unreadable(&error)),
            }
            let (content, sum) = record.split_at(NUMBER_BYTES + length);
            let (number, part) = content.split_at(NUMBER_BYTES);
            let number = number.try_into().map_or(u64::MAX, u64::from_le_bytes);
            let Some(seen) = usize::try_from(number).ok().and_then(|number| seen.get_mut(number)) else { break };
            if Sha256::digest(content)[..] != *sum {
                break;
            }
            *seen = true;
            take(number as usize, part);
            end += record.len() as u64;
        }
        let records = seen.into_iter().filter(|seen| *seen).count();
        (log.end, log.stays) = (end, records > 0);
        Ok(records)
    }

    /// Appends a finished part.
    ///
    /// # Errors
    /// A disk that is full or broken. The records before this one stay.
    pub fn keep(&self, number: usize, part: &[u8]) -> Result<()> {
        let mut record = Vec::with_capacity(NUMBER_BYTES + part.len() + SUM_BYTES);
        record.extend((number as u64).to_le_bytes());
        record.extend(part);
        let sum = Sha256::digest(&record);
        record.extend(&sum[..]);
        let mut log = self.log();
        let end = log.end;
        if let Err(error) = log.write_at(end, &record) {
            // Half a record would be ignored; removing it gives the disk room again.
            let _ = log.file.set_len(end);
            let kept = "what is finished is kept, and the same command goes on from there";
            return Err(Error::failed(format_args!("{}; {kept}", self.unwritten(&error))));
        }
        log.end += record.len() as u64;
        log.stays = true;
        Ok(())
    }

    /// Closes the file by a seal, and makes it the output. `seal` makes its bytes of the number of records and the
    /// bytes that each holds, which [`Checkpoint::restore`] has learned.
    ///
    /// # Errors
    /// A disk that is full or broken; the checkpoint stays.
    pub fn close(self, output: &Path, head: &[u8], seal: impl FnOnce(u64, u64) -> Vec<u8>) -> Result<()> {
        let mut log = self.log();
        let record_bytes = log.record_bytes as u64;
        let records = (log.end - head.len() as u64) / ((NUMBER_BYTES + SUM_BYTES) as u64 + record_bytes);
        let (end, bytes) = (log.end, seal(records, record_bytes));
        log.stays = true;
        let target = std::fs::canonicalize(output).unwrap_or_else(|_| output.to_path_buf());
        log.file
            .set_len(end)
            .and_then(|()| log.write_at(end, &bytes))
            .and_then(|()| log.file.sync_data())
            .and_then(|()| std::fs::rename(&self.path, &target))
            .map_err(|error| self.unwritten(&error))
    }

    /// Lets the file end with this run: its parts belong to a result that was refused.
    pub fn abandon(&self) {
        self.log().stays = false;
    }

    /// Removes the checkpoint: the output is complete, or was refused.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(self) -> Result<()> {
        // From now on a file of this name belongs to another run.
        self.log().stays = true;
        std::fs::remove_file(&self.path)
            .map_err(|error| Error::failed(format_args!("cannot remove {}: {error}", self.path.display())))
    }

    fn log(&self) -> std::sync::MutexGuard<'_, Log> {
        // A worker that panicked has left whole records before `end`.
        self.log.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn unreadable(&self, error: &io::Error) -> Error {
        Error::failed(format_args!("{}: cannot read: {error}", self.path.display()))
    }

    fn unwritten(&self, error: &io::Error) -> Error {
        output::explain(&self.path, error)
    }

    /// The error for a checkpoint that belongs to other work.
    fn foreign(&self, head: &str, found: &str) -> Error {
        let path = self.path.display();
        if found.lines().next() != Some(TITLE) {
            return Error::failed(format_args!("{path} is no checkpoint; move it away or choose another output"));
        }
        let (ours, theirs) = head.lines().zip(found.lines()).find(|(ours, theirs)| ours != theirs).unwrap_or_default();
        let what = ours.split(':').next().unwrap_or_default();
        let why: &dyn Display = match theirs.strip_prefix("version: ") {
            Some(version) => &format!("comes from {version}, another version"),
            None => &format!("belongs to other work: not the same {what}"),
        };
        let remedy = "finish it by the command that began it, or begin anew by --restart";
        Error::failed(format_args!("{path} {why}; {remedy}"))
    }
}

/// Removes the file if it has no record.
impl Drop for Checkpoint {
    fn drop(&mut self) {
        if !self.log().stays {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

impl Log {
    fn write_at(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(place))?;
        self.file.write_all(bytes)?;
        if self.synced.elapsed() >= SYNC_EVERY {
            self.file.sync_data()?;
            self.synced = Instant::now();
        }
        Ok(())
    }
}

/// Opens and locks the file at `path`; creates it if it is missing.
fn locked(path: &Path, output: &Path) -> Result<File> {
    loop {
        let file = File::options().read(true).write(true).create(true).truncate(false).open(path);
        let file = file.map_err(|error| output::explain(path, &error))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let output = output.display();
                let message = format!("another run is writing {output}; wait for its end or choose another output");
                return Err(Error::failed(message));
            }
            // Some network disks have no locks. Runs that meet there still write whole files, and the last one stays.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(output::explain(path, &error)),
        }
        // Between opening and locking, a finished run may have removed the file; then the lock is on an unnamed file.
        if output::is_still_at(&file, path) {
            return Ok(file);
        }
    }
}

#[cfg(test)]
#[path = "checkpoint_tests.rs"]
mod tests;
