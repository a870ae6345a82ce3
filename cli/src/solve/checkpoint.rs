//! Finished parts of long work, kept beside its output: killed at any moment, the same command goes on from there.
//!
//! `OUTPUT.checkpoint` is a log. Its head is text: a line for each thing that decides the numbers. Records follow, one for each
//! finished part in the order in which they were finished: the part's number (u64, little endian), its bytes, SHA-256 of both.
//! Reading stops at the first record that is cut short or does not match its sum; what follows is computed again. The file is
//! locked while a run writes it, so that a second run to the same output is refused, and goes when the output is complete.

use std::fmt::{self, Display, Write as _};
use std::fs::{File, TryLockError};
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use base64::Engine;
use sha2::{Digest, Sha256};

use crate::support::error::{Error, Result};
use crate::support::output;

/// The first line of every checkpoint.
const TITLE: &str = "goniochrome checkpoint";

/// Most work that a power cut may cost, as far as the disk keeps its promises.
const SYNC_EVERY: Duration = Duration::from_secs(5);

/// A part's number.
const NUMBER_BYTES: usize = size_of::<u64>();

/// SHA-256.
const SUM_BYTES: usize = 32;

/// What decides the numbers: a checkpoint of anything else is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity(String);

impl Identity {
    /// Of this program; equal versions with other instructions may round differently.
    #[must_use]
    pub fn of_program() -> Self {
        let (version, level) = (env!("CARGO_PKG_VERSION"), goniochrome::simd::lanes::simd_level());
        Self(format!("{TITLE}\nversion: goniochrome {version} ({level})\n"))
    }

    /// And of what `what` names, all of which shows when it is printed by `{:?}`.
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

/// The log of one run.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    log: Mutex<Log>,
}

#[derive(Debug)]
struct Log {
    file: File,
    /// Where the next record goes; everything before it is whole.
    end: u64,
    /// Whether the file outlives this run: it has records, or is another's.
    stays: bool,
    /// An earlier run has left records, or the beginning of one.
    resumed: bool,
    synced: Instant,
}

impl Checkpoint {
    /// Opens the checkpoint of an output, or starts one, and locks it. `restart` discards what an earlier run has
    /// finished, whatever it computed. `None` where the output is a device or a pipe, which has no folder for it.
    ///
    /// # Errors
    /// Another run has it locked, it belongs to other work, or it cannot be written.
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
        let log = Log { file, end: 0, stays: false, resumed: false, synced: Instant::now() };
        let checkpoint = Self { path, log: Mutex::new(log) };
        checkpoint.begin(&identity.0, restart)?;
        Ok(Some(checkpoint))
    }

    /// Checks the head, or writes it where there is none or half a one. To `restart`, any checkpoint makes room for it.
    fn begin(&self, head: &str, restart: bool) -> Result<()> {
        let mut log = self.log();
        // Two heads differ in their first KiB, long before which they end.
        let mut found = Vec::new();
        (&log.file)
            .take(head.len().max(1024) as u64)
            .read_to_end(&mut found)
            .map_err(|error| self.unreadable(&error))?;
        let discards = restart && found.starts_with(TITLE.as_bytes());
        if !discards && found.starts_with(head.as_bytes()) {
            log.stays = true; // restoring will tell whether it has records
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

    /// What to tell the user as the work begins: what happens to it if it is interrupted.
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

    /// Hands every finished part, each of `length` bytes and with a number below `count`, to `take`; says how many there are.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn restore(&self, length: usize, count: usize, mut take: impl FnMut(usize, &[u8])) -> Result<usize> {
        let mut log = self.log();
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
    /// The disk is full, or broken. The records before this one stay.
    pub fn keep(&self, number: usize, part: &[u8]) -> Result<()> {
        let mut record = Vec::with_capacity(NUMBER_BYTES + part.len() + SUM_BYTES);
        record.extend((number as u64).to_le_bytes());
        record.extend(part);
        let sum = Sha256::digest(&record);
        record.extend(&sum[..]);
        let mut log = self.log();
        let end = log.end;
        if let Err(error) = log.write_at(end, &record) {
            // Half a record would be passed over anyway; without it the disk has room again.
            let _ = log.file.set_len(end);
            let kept = "what is finished is kept, and the same command goes on from there";
            return Err(Error::failed(format_args!("{}; {kept}", self.unwritten(&error))));
        }
        log.end += record.len() as u64;
        log.stays = true;
        Ok(())
    }

    /// The output is complete, or never will be.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(self) -> Result<()> {
        // Whatever gets this name from now on is another run's.
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

    /// The reason for which a checkpoint is not ours.
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

/// A log without a record is worth nothing: its file goes with it.
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

/// The file at `path`, made if need be, which nobody else has locked.
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
            // Some network disks know no locks. Runs that meet there still write whole files, the last of which stays.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(output::explain(path, &error)),
        }
        // Between opening and locking, a run that ended may have removed the file; then this is a file without a name.
        if output::is_still_at(&file, path) {
            return Ok(file);
        }
    }
}

#[cfg(test)]
#[path = "checkpoint_tests.rs"]
mod tests;
