//! Planar stacks: spectral reflectance and RGB.

use crate::colour::{Colour, ColourObject};
use crate::media::{GONIO_MAX_MEDIA, MAX_NM, Media, Medium};
use crate::memory::{Results, Tagged, list};
use crate::status::{Status, status_of};
use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack as CoreStack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F64, Lanes};

/// Largest number of layers of a stack.
pub const GONIO_MAX_LAYERS: usize = 31;
/// Index that stands for a perfect mirror instead of the medium below an interface.
pub const GONIO_MIRROR: u16 = 0xffff;
/// Size of a gonio_stack in bytes.
pub const GONIO_STACK_SIZE: usize = 8 * 384;
/// Alignment of a gonio_stack in bytes.
pub const GONIO_STACK_ALIGN: usize = 8;

const _: () = assert!(size_of::<Stack>() == GONIO_STACK_SIZE && align_of::<Stack>() == GONIO_STACK_ALIGN);
const PLANES: usize = GONIO_MAX_LAYERS + 1;
const _: () = assert!(GONIO_MAX_MEDIA <= PLANES);

/// Planar stack; made by gonio_stack_make. It may be moved.
#[repr(C)]
#[derive(Debug)]
pub struct Stack {
    opaque: [u64; 384],
}

/// Layer of a stack.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// Thickness in nanometres, from 0 to 1e9.
    pub thickness_nm: f64,
    /// Index of the layer's medium.
    pub medium: u16,
}

/// Contents of a gonio_stack.
struct StackObject {
    media: Media,
    layers: [Film; GONIO_MAX_LAYERS],
    layer_count: usize,
    ambient: u16,
    substrate: Below,
}

/// Makes a stack of `layer_count` layers, listed from the top. Light comes from medium `ambient`; below the last layer
/// lies medium `substrate`, or GONIO_MIRROR. The layers are copied; the media's arrays are not.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say. The
/// media's arrays outlive the stack.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_stack_make(
    stack: *mut Stack,
    media: *const Medium,
    media_count: usize,
    ambient: u16,
    layers: *const Layer,
    layer_count: usize,
    substrate: u16,
) -> Status {
    let object = || {
        if layer_count > GONIO_MAX_LAYERS {
            return Err(Status::TooMany);
        }
        // SAFETY: the caller's promises.
        let (media, given) = unsafe { (Media::new(media, media_count)?, list(layers, layer_count)?) };
        let ambient = media.index(ambient)?;
        let substrate = if substrate == GONIO_MIRROR { Below::Mirror } else { Below::Medium(media.index(substrate)?) };
        let mut layers = [Film { medium: 0, thickness_nm: 0.0 }; GONIO_MAX_LAYERS];
        for (place, layer) in layers.iter_mut().zip(given) {
            if !(0.0..=MAX_NM).contains(&layer.thickness_nm) {
                return Err(Status::Thickness);
            }
            *place = Film { medium: media.index(layer.medium)?, thickness_nm: layer.thickness_nm };
        }
        let object = StackObject { media, layers, layer_count, ambient, substrate };
        object.build(&mut StackArrays::new())?;
        Ok(object)
    };
    // SAFETY: the caller's promises.
    status_of(|| unsafe { Tagged::write(stack, object) })
}

/// Computes the reflectance for s and p polarised light that arrives at `cos_theta`, at each of `count` wavelengths.
///
/// cos_theta is in [0, 1]; at 0 the result is the limit: everything is reflected. Any other value, and NaN, give
/// GONIO_STATUS_ANGLE. Results differ from exact arithmetic by less than 1e-6: computation is in double precision and
/// is rounded once. It uses 20 KiB of stack, 35 KiB with AVX-512.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to as many elements of their types as the counts say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_stack_reflectance(
    stack: *const Stack,
    cos_theta: f64,
    wavelength_nm: *const f64,
    count: usize,
    reflectance_s: *mut f32,
    reflectance_p: *mut f32,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (object, wavelengths, s, p) = unsafe {
            let object = Tagged::<StackObject>::get(stack)?;
            let wavelengths = list(wavelength_nm, count)?;
            (object, wavelengths, Results::new(reflectance_s, count)?, Results::new(reflectance_p, count)?)
        };
        let cos_theta = checked_cosine(cos_theta)?;
        object.media.check(wavelengths, object.ambient)?;
        object.for_each_reflectance(cos_theta, wavelengths, |index, [r_s, r_p]| {
            s.write_at(index, r_s as f32);
            p.write_at(index, r_p as f32);
        })
    })
}

/// Computes the linear RGB of unpolarised light that is reflected at `cos_theta`, in [0, 1]. Components may be
/// negative.
///
/// It sums over 81 wavelengths, 5 nm apart. For films in air up to n d = 6 micrometres the result is within 5e-4 of the
/// integral. Thicker stacks and narrow filters have fringes between those wavelengths, and would be tinted: compute
/// their reflectance at finer wavelengths by gonio_stack_reflectance and sum that.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_stack_rgb(
    stack: *const Stack,
    colour: *const Colour,
    cos_theta: f64,
    rgb: *mut f32,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (object, colour, rgb) = unsafe {
            (Tagged::<StackObject>::get(stack)?, Tagged::<ColourObject>::get(colour)?, Results::new(rgb, 3)?)
        };
        let cos_theta = checked_cosine(cos_theta)?;
        object.media.check(colour.wavelengths_nm(), object.ambient)?;
        let mut sum = colour.sum();
        object
            .for_each_reflectance(cos_theta, colour.wavelengths_nm(), |index, [s, p]| sum.add(index, 0.5 * (s + p)))?;
        rgb.write(sum.rgb().map(|c| c as f32));
        Ok(())
    })
}

/// Refuses a cosine that is not in [0, 1].
fn checked_cosine(cos_theta: f64) -> Result<f64, Status> {
    if (0.0..=1.0).contains(&cos_theta) { Ok(cos_theta) } else { Err(Status::Angle) }
}

impl StackObject {
    /// Builds the core's stack in arrays.
    fn build<'m>(&self, arrays: &'m mut StackArrays<PLANES>) -> Result<CoreStack<'m>, Status> {
        let layers = self.layers.iter().take(self.layer_count).copied();
        Ok(CoreStack::new(self.ambient, layers, self.substrate, arrays.memory())?)
    }

    /// Calls `put` with the index of each wavelength and the reflectance of s and p there.
    ///
    /// It computes in double precision: single precision loses digits in narrow filters and near critical angles.
    fn for_each_reflectance(
        &self,
        cos_theta: f64,
        wavelengths_nm: &[f64],
        mut put: impl FnMut(usize, [f64; 2]),
    ) -> Result<(), Status> {
        let mut arrays = StackArrays::new();
        let stack = self.build(&mut arrays)?;
        let media = self.media.as_slice();
        let mut eta = [ComplexLanes::zero(); GONIO_MAX_MEDIA];
        let eta = eta.get_mut(..media.len()).ok_or(Status::TooMany)?;
        for (group, wavelengths) in wavelengths_nm.chunks(F64::WIDTH).enumerate() {
            let lanes = MediaLanes::<F64>::evaluate(media, wavelengths, eta).map_err(|(_, error)| error)?;
            let mut memory = PreparedStackArrays::<F64, PLANES>::new();
            let incidence = Incidence::from_cosine(cos_theta);
            let prepared = PreparedStack::prepare(stack, &lanes, incidence, Model::Physical, memory.memory())
                .map_err(|_| Status::TooMany)?;
            let reflectance = prepared.reflectance(prepared.reflection());
            for lane in 0..wavelengths.len() {
                let power = reflectance.map(|power| Lanes::lane(power, lane));
                put(group * F64::WIDTH + lane, [power.s, power.p]);
            }
        }
        Ok(())
    }
}
