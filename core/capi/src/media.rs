//! Media: their description in C, and checks.

use crate::memory::list;
use crate::status::Status;
use goniochrome::optics::medium::{Dispersion, Extrapolate, Medium as CoreMedium};

/// Largest number of media of a stack or a cell.
pub const GONIO_MAX_MEDIA: usize = 16;

/// Largest n and k; its inverse is the smallest n. The command line has the same bounds. Fourth powers stay within
/// single precision.
const MAX_INDEX: f64 = 1e6;
/// Largest length and wavelength in nanometres: a metre.
pub(crate) const MAX_NM: f64 = 1e9;
/// Smallest wavelength in nanometres.
const MIN_NM: f64 = 1e-3;

/// Complex refractive index n + ik of a medium by vacuum wavelength. The arrays must outlive the objects that are made
/// from it.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Medium {
    /// Vacuum wavelengths in nanometres, strictly increasing. Not read, and may be NULL, if count is 1.
    pub wavelength_nm: *const f64,
    /// n at each wavelength, from 1e-6 to 1e6; linear between them.
    pub n: *const f64,
    /// k at each wavelength, from 0 to 1e6; linear between them. NULL for a medium that does not absorb.
    pub k: *const f64,
    /// Number of wavelengths; 1 for a medium with the same n and k at every wavelength.
    pub count: usize,
}

/// Checked media of a stack or a cell.
pub(crate) struct Media {
    media: [CoreMedium<'static>; GONIO_MAX_MEDIA],
    count: usize,
}

impl Media {
    /// Checks media that C describes.
    ///
    /// # Safety
    /// Pointers that are neither NULL nor misaligned point to as many elements as stated, which outlive the result.
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

    /// Refuses an index of a medium that does not exist.
    pub fn index(&self, medium: u16) -> Result<u16, Status> {
        if usize::from(medium) < self.count { Ok(medium) } else { Err(Status::Index) }
    }

    /// Refuses wavelengths that are out of range, at which a medium has no data, or at which the ambient medium absorbs
    /// too much.
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

/// Checks one medium.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to `medium.count` elements, which outlive the result.
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
    let within = |values: &'static [f64], min: f64| match values.iter().all(|x| (min..=MAX_INDEX).contains(x)) {
        true => Ok(values),
        false => Err(Status::Medium),
    };
    let n = dispersion(within(column(medium.n)?, MAX_INDEX.recip())?)?;
    let k = if medium.k.is_null() { Dispersion::Constant(0.0) } else { dispersion(within(column(medium.k)?, 0.0)?)? };
    Ok(CoreMedium::new(n, k, Extrapolate::Refuse)?)
}
