//! Planar stacks: reflectance, spectral and RGB.

use crate::colour::{Colour, ColourObject};
use crate::media::{GONIO_MAX_MEDIA, MAX_NM, Media, Medium};
use crate::memory::{Made, Results, list};
use crate::status::{Status, answer};
use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::MediaLanes;
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack as CoreStack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F64, Lanes};

/// Most layers of a stack.
pub const GONIO_MAX_LAYERS: usize = 31;
/// The index of a perfect mirror, in place of a medium below an interface.
pub const GONIO_MIRROR: u16 = 0xffff;
/// Bytes of a gonio_stack.
pub const GONIO_STACK_SIZE: usize = 8 * 384;
/// Alignment of a gonio_stack.
pub const GONIO_STACK_ALIGN: usize = 8;

const _: () = assert!(size_of::<Stack>() == GONIO_STACK_SIZE && align_of::<Stack>() == GONIO_STACK_ALIGN);
const PLANES: usize = GONIO_MAX_LAYERS + 1;
const _: () = assert!(GONIO_MAX_MEDIA <= PLANES);

/// A planar stack; made by gonio_stack_make. It may be moved.
#[repr(C)]
pub struct Stack {
    opaque: [u64; 384],
}

/// A layer.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Layer {
    /// Thickness in nanometres, from 0 to 1e9.
    pub thickness_nm: f64,
    /// Which of the media.
    pub medium: u16,
}

struct StackObject {
    media: Media,
    layers: [Film; GONIO_MAX_LAYERS],
    layer_count: usize,
    ambient: u16,
    substrate: Below,
}

/// Makes a stack: `layer_count` layers from the top, light from medium `ambient`, below the last layer medium
/// `substrate` or GONIO_MIRROR. The layers are copied, the media's arrays are not.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types and counts say; the media's arrays outlive
/// the stack.
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
        object.laid_out(&mut StackArrays::new())?;
        Ok(object)
    };
    // SAFETY: the caller's promises.
    answer(|| unsafe { Made::make(stack, object) })
}

/// Reflectance of light that arrives at `cos_theta`, polarised s and p, at each of `count` wavelengths.
///
/// cos_theta in (0, 1]; at 0 the limit: everything is reflected. NaN and all else: GONIO_STATUS_ANGLE. The differences
/// from exact arithmetic are below 1e-6: it computes in double precision and rounds once. 20 KiB of stack are used, 35
/// with AVX-512.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types and counts say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_stack_reflectance(
    stack: *const Stack,
    cos_theta: f64,
    wavelength_nm: *const f64,
    count: usize,
    reflectance_s: *mut f32,
    reflectance_p: *mut f32,
) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (object, wavelengths, s, p) = unsafe {
            let object = Made::<StackObject>::of(stack)?;
            let wavelengths = list(wavelength_nm, count)?;
            (object, wavelengths, Results::new(reflectance_s, count)?, Results::new(reflectance_p, count)?)
        };
        let cos_theta = checked(cos_theta)?;
        object.media.check(wavelengths, object.ambient)?;
        object.each(cos_theta, wavelengths, |place, [r_s, r_p]| {
            s.write_at(place, r_s as f32);
            p.write_at(place, r_p as f32);
        })
    })
}

/// Linear RGB of the light that is reflected at `cos_theta`, unpolarised; components may be negative. Angles as for
/// gonio_stack_reflectance.
///
/// It sums 81 wavelengths, 5 nm apart: for films in air up to n d = 6 micrometres it is within 5e-4 of the integral.
/// Thicker stacks and narrow filters have fringes between those wavelengths, which tint them; sum finer ones by
/// gonio_stack_reflectance.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_stack_rgb(
    stack: *const Stack,
    colour: *const Colour,
    cos_theta: f64,
    rgb: *mut f32,
) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (object, colour, rgb) =
            unsafe { (Made::<StackObject>::of(stack)?, Made::<ColourObject>::of(colour)?, Results::new(rgb, 3)?) };
        let cos_theta = checked(cos_theta)?;
        object.media.check(colour.wavelengths_nm(), object.ambient)?;
        let mut sum = colour.sum();
        object.each(cos_theta, colour.wavelengths_nm(), |place, [s, p]| sum.add(place, 0.5 * (s + p)))?;
        rgb.write(sum.rgb().map(|c| c as f32));
        Ok(())
    })
}

/// A cosine in [0, 1].
fn checked(cos_theta: f64) -> Result<f64, Status> {
    if (0.0..=1.0).contains(&cos_theta) { Ok(cos_theta) } else { Err(Status::Angle) }
}

impl StackObject {
    fn laid_out<'m>(&self, arrays: &'m mut StackArrays<PLANES>) -> Result<CoreStack<'m>, Status> {
        let layers = self.layers.iter().take(self.layer_count).copied();
        Ok(CoreStack::new(self.ambient, layers, self.substrate, arrays.memory())?)
    }

    /// R of s and p at each wavelength, by its place. In double precision: single loses digits in narrow filters and
    /// near critical angles.
    fn each(&self, cos_theta: f64, wavelengths_nm: &[f64], mut put: impl FnMut(usize, [f64; 2])) -> Result<(), Status> {
        let mut arrays = StackArrays::new();
        let stack = self.laid_out(&mut arrays)?;
        let media = self.media.as_slice();
        let mut eta = [ComplexLanes::zero(); GONIO_MAX_MEDIA];
        let eta = eta.get_mut(..media.len()).ok_or(Status::TooMany)?;
        for (group, wavelengths) in wavelengths_nm.chunks(F64::WIDTH).enumerate() {
            let lanes = MediaLanes::<F64>::evaluate(media, wavelengths, eta).map_err(|(_, error)| error)?;
            let mut memory = PreparedStackArrays::<F64, PLANES>::new();
            let incidence = Incidence::from_cosine(cos_theta);
            let optics = PreparedStack::prepare(stack, &lanes, incidence, Model::Physical, memory.memory())
                .map_err(|_| Status::TooMany)?;
            let reflectance = optics.reflectance(optics.reflection());
            for lane in 0..wavelengths.len() {
                let power = reflectance.map(|power| Lanes::lane(power, lane));
                put(group * F64::WIDTH + lane, [power.s, power.p]);
            }
        }
        Ok(())
    }
}
