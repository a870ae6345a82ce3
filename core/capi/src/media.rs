//! Media as C describes them.

use crate::memory::list;
use crate::status::Status;
use goniochrome::optics::medium::{Dispersion, Extrapolate, Medium as CoreMedium};

/// Most media of a stack or a cell.
pub const GONIO_MAX_MEDIA: usize = 16;

/// Most n and k, and least n in its inverse: as on the command line. Squares of squares stay within single precision.
const MAX_INDEX: f64 = 1e6;
/// Most of a length, and of a wavelength, in nanometres: a metre.
pub(crate) const MAX_NM: f64 = 1e9;
/// Least wavelength in nanometres.
const MIN_NM: f64 = 1e-3;

/// n + ik of a medium against vacuum wavelength. The arrays must outlive what is made of them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Medium {
    /// Vacuum wavelengths in nanometres, strictly increasing; not read, and may be NULL, if count is 1.
    pub wavelength_nm: *const f64,
    /// n at each wavelength, linear between them; from 1e-6 to 1e6.
    pub n: *const f64,
    /// k at each wavelength, from 0 to 1e6; NULL for a medium that does not absorb.
    pub k: *const f64,
    /// Number of wavelengths; 1 for the same n and k at all of them.
    pub count: usize,
}

/// The media of an object, checked.
pub(crate) struct Media {
    media: [CoreMedium<'static>; GONIO_MAX_MEDIA],
    count: usize,
}

impl Media {
    /// Checks media.
    ///
    /// # Safety
    /// The pointers are NULL, misaligned, or point to as many elements as stated, which outlive the result.
    pub unsafe fn new(media: *const Medium, count: usize) -> Result<Self, Status> {
        if count > GONIO_MAX_MEDIA {
            return Err(Status::TooMany);
        }
        // SAFETY: the caller's promise.
        let given = unsafe { list(media, count) }?;
        let mut checked = Self { media: [CoreMedium::VACUUM; GONIO_MAX_MEDIA], count };
        for (place, medium) in checked.media.iter_mut().zip(given) {
            // SAFETY: the caller's promise.
            *place = unsafe { checked_medium(medium) }?;
        }
        Ok(checked)
    }

    pub fn as_slice(&self) -> &[CoreMedium<'static>] {
        self.media.get(..self.count).unwrap_or(&self.media)
    }

    /// The index of a medium that is there.
    pub fn index(&self, medium: u16) -> Result<u16, Status> {
        if usize::from(medium) < self.count { Ok(medium) } else { Err(Status::Index) }
    }

    /// Refuses wavelengths at which a medium cannot be evaluated, or the one that light comes from absorbs too much.
    pub fn check(&self, wavelengths_nm: &[f64], ambient: u16) -> Result<(), Status> {
        if wavelengths_nm.is_empty() || !wavelengths_nm.iter().all(|nm| (MIN_NM..=MAX_NM).contains(nm)) {
            return Err(Status::Wavelength);
        }
        for &nm in wavelengths_nm {
            for (index, medium) in self.as_slice().iter().enumerate() {
                if index == usize::from(ambient) { medium.ambient_eta(nm) } else { medium.eta(nm) }?;
            }
        }
        Ok(())
    }
}

/// # Safety
/// That of [`Media::new`].
unsafe fn checked_medium(medium: &Medium) -> Result<CoreMedium<'static>, Status> {
    if medium.count == 0 {
        return Err(Status::Medium);
    }
    // SAFETY: the caller's promise.
    let column = |pointer| unsafe { list(pointer, medium.count) };
    let dispersion = |value: &'static [f64]| -> Result<Dispersion<'static>, Status> {
        Ok(match *value {
            [constant] => Dispersion::Constant(constant),
            _ => Dispersion::Table { wavelength_nm: column(medium.wavelength_nm)?, value },
        })
    };
    let within = |values: &'static [f64], least: f64| match values.iter().all(|x| (least..=MAX_INDEX).contains(x)) {
        true => Ok(values),
        false => Err(Status::Medium),
    };
    let n = dispersion(within(column(medium.n)?, MAX_INDEX.recip())?)?;
    let k = if medium.k.is_null() { Dispersion::Constant(0.0) } else { dispersion(within(column(medium.k)?, 0.0)?)? };
    Ok(CoreMedium::new(n, k, Extrapolate::Refuse)?)
}
