//! Files of finished shares: a checkpoint that is complete, closed by a seal.
//!
//! After the head and the records of a [`Checkpoint`](super::checkpoint) come the seal, JSON text that says which share
//! this is and by which command it was made; its length (u64, little endian); and the SHA-256 sum of head and seal.

use std::fs::File;
use std::io::{BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::solve::checkpoint::{NUMBER_BYTES, SUM_BYTES};
use crate::solve::share::{MAX_SHARES, Share};
use crate::support::error::{Error, Result};

/// Largest seal in bytes.
const MAX_SEAL: u64 = 1 << 20;

/// What a seal says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seal {
    /// Arguments of the command, without the name of the program.
    pub arguments: Vec<String>,
    /// The scene file, or the name of a preset.
    pub scene: String,
    /// Number of the share, from 1, and number of shares.
    pub share: [u32; 2],
    /// Bytes of the head.
    pub head_bytes: u64,
    /// Bytes of what each record holds.
    pub record_bytes: u64,
    /// Number of records.
    pub records: u64,
}

impl Seal {
    /// The bytes that close a file with this head.
    ///
    /// # Panics
    /// Never: text and numbers can be written as JSON.
    #[must_use]
    pub fn bytes(&self, head: &[u8]) -> Vec<u8> {
        let text = serde_json::to_vec(self).expect("text and numbers");
        let sum = Sha256::new().chain_update(head).chain_update(&text).finalize();
        let length = (text.len() as u64).to_le_bytes();
        [&text[..], &length, &sum[..]].concat()
    }
}

/// The file of a finished share.
#[derive(Debug)]
pub struct SealedPart {
    path: PathBuf,
    /// The identity of the work: all shares of a table have the same.
    pub head: Vec<u8>,
    /// What the seal says.
    pub seal: Seal,
}

impl SealedPart {
    /// Opens a file, and checks its head, its seal and its length.
    ///
    /// # Errors
    /// A file that cannot be read, is no finished share, or is damaged: one line that names it.
    pub fn open(path: &Path) -> Result<Self> {
        let failed = |what: &str| Error::failed(format_args!("{}: {what}", path.display()));
        let unreadable = |error: std::io::Error| failed(&format!("cannot read: {error}"));
        let no_part = || {
            failed(
                "is no finished part, or is damaged; `goniochrome estimate --part` makes one, and goes on where it stopped",
            )
        };
        let mut file = File::open(path).map_err(unreadable)?;
        let length = file.metadata().map_err(unreadable)?.len();
        let end = (size_of::<u64>() + SUM_BYTES) as u64;
        let mut last = [0; size_of::<u64>() + SUM_BYTES];
        let read_at = |file: &mut File, at: u64, into: &mut [u8]| -> Result<()> {
            file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(into)).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => no_part(),
                _ => unreadable(error),
            })
        };
        read_at(&mut file, length.checked_sub(end).ok_or_else(no_part)?, &mut last)?;
        let (count, sum) = last.split_at(size_of::<u64>());
        let text_bytes = count.try_into().map_or(u64::MAX, u64::from_le_bytes);
        let seal_at = (length - end).checked_sub(text_bytes).filter(|_| text_bytes <= MAX_SEAL).ok_or_else(no_part)?;
        let mut text = vec![0; text_bytes as usize];
        read_at(&mut file, seal_at, &mut text)?;
        let seal: Seal = serde_json::from_slice(&text).map_err(|_| no_part())?;
        if seal.head_bytes > MAX_SEAL {
            return Err(no_part());
        }
        let mut head = vec![0; seal.head_bytes as usize];
        read_at(&mut file, 0, &mut head)?;
        if Sha256::new().chain_update(&head).chain_update(&text).finalize()[..] != *sum {
            return Err(no_part());
        }
        // A seal that no run has made may hold any numbers.
        let record = seal.record_bytes.checked_add((NUMBER_BYTES + SUM_BYTES) as u64);
        let records = record.and_then(|record| record.checked_mul(seal.records));
        let end = records.and_then(|records| records.checked_add(seal.head_bytes));
        let [number, of] = seal.share;
        if end != Some(seal_at) || !(1..=of).contains(&number) || of > MAX_SHARES {
            return Err(no_part());
        }
        Ok(Self { path: path.to_owned(), head, seal })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Which share of the table the file holds.
    #[must_use]
    pub fn share(&self) -> Share {
        let [number, of] = self.seal.share;
        Share { number, of }
    }

    /// Calls `take` with the number and the bytes of each record.
    ///
    /// # Errors
    /// A file that cannot be read or is damaged, or an error of `take`.
    pub fn records(&self, mut take: impl FnMut(usize, &[u8]) -> Result<()>) -> Result<()> {
        if self.seal.records == 0 {
            return Ok(());
        }
        let failed = |what: &str| Error::failed(format_args!("{}: {what}", self.path.display()));
        let unreadable = |error: std::io::Error| failed(&format!("cannot read: {error}"));
        let mut file = File::open(&self.path).map_err(unreadable)?;
        file.seek(SeekFrom::Start(self.seal.head_bytes)).map_err(unreadable)?;
        let mut reader = BufReader::new(file);
        let mut record = vec![0; NUMBER_BYTES + self.seal.record_bytes as usize + SUM_BYTES];
        for place in 1..=self.seal.records {
            reader.read_exact(&mut record).map_err(unreadable)?;
            let (content, sum) = record.split_at(record.len() - SUM_BYTES);
            if Sha256::digest(content)[..] != *sum {
                return Err(failed(&format!(
                    "is damaged in record {place} of {}; compute it again",
                    self.seal.records
                )));
            }
            let (number, part) = content.split_at(NUMBER_BYTES);
            take(number.try_into().map_or(usize::MAX, |number| u64::from_le_bytes(number) as usize), part)?;
        }
        Ok(())
    }
}
