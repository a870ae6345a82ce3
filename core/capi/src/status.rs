//! Status of a call.

use core::ffi::{CStr, c_char};
use goniochrome::geometry::bvh::BvhError;
use goniochrome::geometry::facet::CellError;
use goniochrome::optics::medium::MediumError;
use goniochrome::optics::stack::StackError;
use goniochrome::table::blob::BlobError;

/// Status that a call returns. Results are written only if it is GONIO_STATUS_OK.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The call has succeeded.
    Ok = 0,
    /// A pointer is NULL.
    NullPointer = 1,
    /// A pointer is not aligned for its type.
    Misaligned = 2,
    /// The object has not been made, or making it has failed.
    NotMade = 3,
    /// The memory that was handed over is too small.
    Memory = 4,
    /// There are more elements than the object has room for, or than memory can hold.
    TooMany = 5,
    /// cos theta is not in [0, 1].
    Angle = 6,
    /// A direction is not finite, is zero, or points below the surface where it must not.
    Direction = 7,
    /// There are no wavelengths, or one is not from 1e-3 to 1e9 nm.
    Wavelength = 8,
    /// A medium's data are empty, not finite, not increasing in wavelength, or out of range (n from 1e-6 to 1e6, k from
    /// 0 to 1e6).
    Medium = 9,
    /// A medium has no data at a wavelength.
    NoData = 10,
    /// An index refers to a medium, an interface, a vertex, an order, a wavelength or a lobe that does not
    /// exist.
    Index = 11,
    /// A thickness is not from 0 to 1e9 nm.
    Thickness = 12,
    /// The medium that the light comes from absorbs too much: its k is above 1e-3.
    Ambient = 13,
    /// The mesh is empty, not finite or beyond 1e9 nm, or a triangle has no area.
    Mesh = 14,
    /// The period is not positive, or the mesh leaves it.
    Period = 15,
    /// A count or an enumerator is out of range.
    Argument = 16,
    /// Interfering waves do not converge in this cell; trace it without interference.
    Diverged = 17,
    /// The table is of another kind.
    WrongKind = 18,
    /// The bytes do not begin with the magic of a table blob.
    BlobMagic = 19,
    /// The table blob is of a later version.
    BlobVersion = 20,
    /// The table blob is truncated, or followed by other bytes.
    BlobLength = 21,
    /// The table blob is damaged: its checksum differs.
    BlobChecksum = 22,
    /// A field of the table blob's header has no meaning.
    BlobField = 23,
    /// The table blob's dimensions do not fit its size.
    BlobDimensions = 24,
    /// The table blob's values are not sound.
    BlobValues = 25,
    /// The table blob holds a scatter table of a version before 0.2: make and export the table anew.
    BlobRetired = 26,
}

impl Status {
    /// Texts of the statuses, by their numbers.
    const TEXT: [&'static CStr; 27] = [
        c"done",
        c"a pointer is NULL",
        c"a pointer is not aligned for what it points to",
        c"the object has not been made, or its making failed",
        c"the memory handed over is too small",
        c"more elements than there is room for",
        c"cos theta is not in [0, 1]",
        c"a direction is not finite, is zero, or points below the surface",
        c"no wavelengths, or one is not from 1e-3 to 1e9 nm",
        c"a medium's data are empty, not finite, not increasing, or not passive",
        c"a medium has no data at a wavelength",
        c"an index names a medium, an interface, a vertex, an order, a wavelength or a lobe that is not there",
        c"a thickness is not from 0 to 1e9 nm",
        c"the medium that the light comes from absorbs: its k is above 1e-3",
        c"the mesh is empty or not finite, or a triangle has no area",
        c"the period is not positive, or the mesh leaves it",
        c"a count or an enumerator is out of range",
        c"interfering waves do not converge in this cell; trace it without interference",
        c"the table is of another kind",
        c"the bytes are not a table blob",
        c"the table blob is of a later version than this library",
        c"the table blob is cut short, or followed by other bytes",
        c"the table blob is damaged: its checksum differs",
        c"a field of the table blob's header has no meaning",
        c"the table blob's dimensions do not fit its size",
        c"the table blob's values are not sound",
        c"the table blob holds a scatter table of a version before 0.2; make and export the table anew",
    ];
}

/// One line of English that describes a status. Any other number has a text too.
#[unsafe(no_mangle)]
pub extern "C" fn gonio_status_text(status: i32) -> *const c_char {
    let known = usize::try_from(status).ok().and_then(|index| Status::TEXT.get(index).copied());
    known.unwrap_or(c"no status of this library").as_ptr()
}

/// Status of a call whose body may return early with another status than OK.
pub(crate) fn status_of(body: impl FnOnce() -> Result<(), Status>) -> Status {
    body().err().unwrap_or(Status::Ok)
}

impl From<MediumError> for Status {
    fn from(error: MediumError) -> Self {
        match error {
            MediumError::OutOfRange { .. } | MediumError::Unknown { .. } => Self::NoData,
            MediumError::Opaque { .. } => Self::Ambient,
            _ => Self::Medium,
        }
    }
}

impl From<StackError> for Status {
    fn from(error: StackError) -> Self {
        match error {
            StackError::Memory { .. } => Self::TooMany,
            StackError::Thickness { .. } => Self::Thickness,
        }
    }
}

impl From<BvhError> for Status {
    fn from(error: BvhError) -> Self {
        match error {
            BvhError::Empty | BvhError::NotFinite { .. } => Self::Mesh,
            BvhError::NoVertex { .. } => Self::Index,
            BvhError::TooMany => Self::TooMany,
            BvhError::Memory { .. } => Self::Memory,
        }
    }
}

impl From<CellError> for Status {
    fn from(error: CellError) -> Self {
        match error {
            CellError::NoInterface { .. } => Self::Index,
            CellError::Period => Self::Period,
            _ => Self::Mesh,
        }
    }
}

impl From<BlobError> for Status {
    fn from(error: BlobError) -> Self {
        match error {
            BlobError::Magic => Self::BlobMagic,
            BlobError::Version { .. } => Self::BlobVersion,
            BlobError::Length { .. } => Self::BlobLength,
            BlobError::Checksum => Self::BlobChecksum,
            BlobError::Field { .. } => Self::BlobField,
            BlobError::Retired => Self::BlobRetired,
            BlobError::Dimensions => Self::BlobDimensions,
            BlobError::Table(_) | BlobError::Range { .. } => Self::BlobValues,
        }
    }
}
