//! Errors of blobs.

use super::error::TableError;

/// Version of blobs that this library writes, and the only one that it reads.
pub(super) const VERSION: u32 = 1;

/// An error for which a blob cannot be read or written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BlobError {
    /// The bytes do not begin with a blob's magic.
    Magic,
    /// The blob has a version that this reader does not know.
    Version {
        /// Version of the blob.
        found: u32,
    },
    /// There are more or fewer bytes than the blob has.
    Length {
        /// Size of the whole blob, or of the header if there are fewer bytes than that.
        required: u64,
    },
    /// The bytes have changed since they were written.
    Checksum,
    /// A field of the header, or the padding, has a value without meaning.
    Field {
        /// Offset of the field.
        offset: usize,
    },
    /// The blob holds a scatter table of fixed outgoing bins, as versions before 0.2 wrote them: export the table anew.
    Retired,
    /// The dimensions in the header do not fit the size that it states.
    Dimensions,
    /// The table or its sampler is not sound.
    Table(TableError),
    /// A value is beyond half precision (when written), or not finite (when read).
    Range {
        /// Index of the value.
        index: usize,
    },
}

impl core::fmt::Display for BlobError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Magic => write!(f, "the bytes are not a table blob"),
            Self::Version { found } => write!(f, "the blob has version {found}; this library reads version {VERSION}"),
            Self::Length { required } => write!(f, "the blob should have {required} bytes"),
            Self::Checksum => write!(f, "the blob is damaged: its checksum differs"),
            Self::Field { offset } => write!(f, "the blob's field at byte {offset} has no meaning"),
            Self::Retired => {
                write!(f, "the blob holds bins of a version before 0.2; estimate and export the table anew")
            }
            Self::Dimensions => write!(f, "the blob's dimensions do not fit its size"),
            Self::Table(error) => error.fmt(f),
            Self::Range { index } => write!(f, "value {index} is too large for half precision or not finite"),
        }
    }
}

impl core::error::Error for BlobError {}

impl From<TableError> for BlobError {
    fn from(error: TableError) -> Self {
        Self::Table(error)
    }
}
