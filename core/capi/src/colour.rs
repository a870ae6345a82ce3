//! Colour: weights that turn a spectrum into RGB.

use crate::memory::Tagged;
use crate::status::{Status, status_of};
use goniochrome::colour::{Illuminant as CoreIlluminant, Quadrature, RgbSpace, xyz_weights};

/// Number of wavelengths over which colours are summed: 380, 385, … 780 nm.
const SAMPLES: usize = 81;
/// Size of a gonio_colour in bytes.
pub const GONIO_COLOUR_SIZE: usize = 8 * 384;
/// Alignment of a gonio_colour in bytes.
pub const GONIO_COLOUR_ALIGN: usize = 8;

const _: () = assert!(size_of::<Colour>() == GONIO_COLOUR_SIZE && align_of::<Colour>() == GONIO_COLOUR_ALIGN);

/// Conversion of spectra to RGB; made by gonio_colour_make. It may be moved, and shared between threads.
#[repr(C)]
#[derive(Debug)]
pub struct Colour {
    opaque: [u64; 384],
}

/// Illuminant D65: daylight of 6504 K.
pub const GONIO_ILLUMINANT_D65: u32 = 0;
/// Illuminant E: equal energy at every wavelength.
pub const GONIO_ILLUMINANT_E: u32 = 1;

/// Colour space linear sRGB: Rec. 709 primaries.
pub const GONIO_SPACE_SRGB: u32 = 1;
/// Colour space linear Rec. 2020.
pub const GONIO_SPACE_REC2020: u32 = 2;
/// Colour space ACEScg.
pub const GONIO_SPACE_ACESCG: u32 = 3;

/// Contents of a gonio_colour.
pub(crate) struct ColourObject {
    wavelengths_nm: [f64; SAMPLES],
    weights: [[f64; 3]; SAMPLES],
    space: RgbSpace,
}

/// Makes the conversion of spectra to RGB under `illuminant` (GONIO_ILLUMINANT_…) in `space` (GONIO_SPACE_…).
///
/// # Safety
/// A pointer that is neither NULL nor misaligned points to an object of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_colour_make(colour: *mut Colour, illuminant: u32, space: u32) -> Status {
    let object = || {
        let illuminant = match illuminant {
            GONIO_ILLUMINANT_D65 => CoreIlluminant::D65,
            GONIO_ILLUMINANT_E => CoreIlluminant::E,
            _ => return Err(Status::Argument),
        };
        let space = match space {
            GONIO_SPACE_SRGB => RgbSpace::Srgb,
            GONIO_SPACE_REC2020 => RgbSpace::Rec2020,
            GONIO_SPACE_ACESCG => RgbSpace::AcesCg,
            _ => return Err(Status::Argument),
        };
        let wavelengths_nm = core::array::from_fn(|i| 380.0 + 5.0 * i as f64);
        let mut weights = [[0.0; 3]; SAMPLES];
        xyz_weights(&wavelengths_nm, illuminant, Quadrature::Interpolated, &mut weights)
            .map_err(|_| Status::Wavelength)?;
        Ok(ColourObject { wavelengths_nm, weights, space })
    };
    // SAFETY: the caller's promise.
    status_of(|| unsafe { Tagged::write(colour, object) })
}

impl ColourObject {
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    pub fn sum(&self) -> ColourSum<'_> {
        ColourSum { colour: self, xyz: [0.0; 3] }
    }
}

/// Sum over the wavelengths of a reflectance spectrum.
pub(crate) struct ColourSum<'c> {
    colour: &'c ColourObject,
    xyz: [f64; 3],
}

impl ColourSum<'_> {
    /// Adds the reflectance at the wavelength of an index.
    pub fn add(&mut self, index: usize, reflectance: f64) {
        let weights = self.colour.weights.get(index).copied().unwrap_or_default();
        for (sum, weight) in self.xyz.iter_mut().zip(weights) {
            *sum += weight * reflectance;
        }
    }

    pub fn rgb(&self) -> [f64; 3] {
        self.colour.space.from_xyz(self.xyz)
    }
}
