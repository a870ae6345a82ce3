//! Tables at run time: a checked view of a table blob, looked up where it lies.

use crate::memory::{Made, Results, list, shared};
use crate::status::{Status, answer};
use core::f32::consts::FRAC_PI_2;
use glam::Vec3;
use goniochrome::table::blob::{Blob, Contents, space_number};

/// Bytes of a gonio_table.
pub const GONIO_TABLE_SIZE: usize = 8 * 32;
/// Alignment of a gonio_table.
pub const GONIO_TABLE_ALIGN: usize = 8;

const _: () = assert!(size_of::<Table>() == GONIO_TABLE_SIZE && align_of::<Table>() == GONIO_TABLE_ALIGN);

/// A view of a table blob; made by gonio_table_view. It may be moved, and shared between threads.
#[repr(C)]
pub struct Table {
    opaque: [u64; 32],
}

/// A mirror-like surface: one direction out for one in.
pub const GONIO_KIND_MIRROR: u32 = 1;
/// A surface that reflects everywhere.
pub const GONIO_KIND_SCATTER: u32 = 2;

/// What a table holds.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TableDescription {
    /// GONIO_KIND_MIRROR or GONIO_KIND_SCATTER.
    pub kind: u32,
    /// Channels; RGB is that of the first three.
    pub channels: u32,
    /// GONIO_SPACE_…; 0 if the blob does not say, 4 for the matrix that the paper prints.
    pub space: u32,
}

/// A direction that was drawn, and what light from it is worth.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Sample {
    /// The direction, a unit vector.
    pub wo: [f32; 3],
    /// Its density per solid angle; 1 for a mirror-like surface, which has no other.
    pub pdf: f32,
    /// BRDF times cos theta_o over the density, RGB; for a mirror-like surface its reflectance.
    pub weight: [f32; 3],
}

/// Checks a table blob of `size` bytes, at any alignment, and looks at it where it lies: the bytes must outlive the view and
/// must not change. Takes time in proportion to the size.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say, and `bytes` to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_view(table: *mut Table, bytes: *const u8, size: usize) -> Status {
    let object = || {
        if bytes.is_null() {
            return Err(Status::NullPointer);
        }
        // SAFETY: the caller's promise.
        Ok(Blob::read(unsafe { list(bytes, size) }?)?)
    };
    // SAFETY: the caller's promise.
    answer(|| unsafe { Made::<Blob<'static>>::make(table, object) })
}

/// What the table holds.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_describe(table: *const Table, description: *mut TableDescription) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (blob, description) = unsafe { (view(table)?, Results::new(description, 1)?) };
        let (kind, channels) = match &blob.contents {
            Contents::Mirror(table) => (GONIO_KIND_MIRROR, table.channels()),
            Contents::Scatter(table, _) => (GONIO_KIND_SCATTER, table.channels()),
        };
        let space = space_number(blob.space);
        description.write([TableDescription { kind, channels: channels as u32, space }]);
        Ok(())
    })
}

/// Reflectance of a mirror-like surface at `cos_theta`, RGB. Beyond the table's largest angle it is held. NaN and what is
/// outside [0, 1]: GONIO_STATUS_ANGLE.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_reflectance(table: *const Table, cos_theta: f32, rgb: *mut f32) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (blob, rgb) = unsafe { (view(table)?, Results::new(rgb, 3)?) };
        if !(0.0..=1.0).contains(&cos_theta) {
            return Err(Status::Angle);
        }
        let Contents::Mirror(table) = &blob.contents else { return Err(Status::WrongKind) };
        rgb.write(table.rgb(angle(cos_theta)));
        Ok(())
    })
}

/// The BRDF in 1/sr of a surface that reflects everywhere, RGB, without the cosine. Directions are unit vectors in the
/// surface's frame, z its normal, both leaving the surface; 0 if either is below it.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say; `wi`, `wo` and `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_rgb(table: *const Table, wi: *const f32, wo: *const f32, rgb: *mut f32) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, wo, rgb) = unsafe { (view(table)?, direction(wi)?, direction(wo)?, Results::new(rgb, 3)?) };
        let Contents::Scatter(table, _) = &blob.contents else { return Err(Status::WrongKind) };
        rgb.write(table.rgb(wi, wo));
        Ok(())
    })
}

/// The density per solid angle with which gonio_table_sample draws `wo` for `wi`; 0 below the surface.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say; `wi` and `wo` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_pdf(table: *const Table, wi: *const f32, wo: *const f32, pdf: *mut f32) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, wo, pdf) = unsafe { (view(table)?, direction(wi)?, direction(wo)?, Results::new(pdf, 1)?) };
        let Contents::Scatter(_, sampler) = &blob.contents else { return Err(Status::WrongKind) };
        pdf.write([sampler.pdf(wi, wo)]);
        Ok(())
    })
}

/// Draws a direction for `wi`, which must lie above the surface, from two numbers in [0, 1). Either kind of table.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to what their types say; `wi` to three floats, `u` to two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_sample(
    table: *const Table,
    wi: *const f32,
    u: *const f32,
    sample: *mut Sample,
) -> Status {
    answer(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, u, sample) =
            unsafe { (view(table)?, direction(wi)?, *shared(u.cast::<[f32; 2]>())?, Results::new(sample, 1)?) };
        if !u.iter().all(|u| (0.0..1.0).contains(u)) {
            return Err(Status::Argument);
        }
        if wi.z <= 0.0 {
            return Err(Status::Direction);
        }
        let (wo, pdf, weight) = match &blob.contents {
            Contents::Mirror(table) => (Vec3::new(-wi.x, -wi.y, wi.z), 1.0, table.rgb(angle(wi.z.min(1.0)))),
            Contents::Scatter(table, sampler) => {
                let (wo, pdf) = sampler.sample(wi, u).ok_or(Status::Direction)?;
                // Divided last: 0 stays 0 however improbable the direction.
                let weight = |f: f32| if pdf > 0.0 { f * wo.z / pdf } else { 0.0 };
                (wo, pdf, table.rgb(wi, wo).map(weight))
            }
        };
        sample.write([Sample { wo: wo.to_array(), pdf, weight }]);
        Ok(())
    })
}

/// # Safety
/// That of [`Made::of`].
unsafe fn view<'a>(table: *const Table) -> Result<&'a Blob<'static>, Status> {
    // SAFETY: the caller's promise.
    unsafe { Made::of(table) }
}

/// # Safety
/// A pointer that is neither null nor misaligned points to three numbers.
unsafe fn direction(pointer: *const f32) -> Result<Vec3, Status> {
    // SAFETY: the caller's promise.
    let direction = Vec3::from_array(*unsafe { shared(pointer.cast::<[f32; 3]>()) }?);
    if direction.is_finite() && direction != Vec3::ZERO { Ok(direction) } else { Err(Status::Direction) }
}

/// θ of a cosine in [0, 1].
fn angle(cos_theta: f32) -> f32 {
    libm::acosf(cos_theta).min(FRAC_PI_2)
}
