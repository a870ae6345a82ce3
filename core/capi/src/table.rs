//! Tables at run time: checked views of table blobs, which borrow the bytes.

use crate::memory::{Results, Tagged, list, shared};
use crate::status::{Status, status_of};
use core::f32::consts::FRAC_PI_2;
use glam::Vec3;
use goniochrome::table::blob::{Blob, Contents, space_number};
use goniochrome::table::{FilmSample, FilmTable};

/// Size of a gonio_table in bytes.
pub const GONIO_TABLE_SIZE: usize = 8 * 40;
/// Alignment of a gonio_table in bytes.
pub const GONIO_TABLE_ALIGN: usize = 8;

const _: () = assert!(size_of::<Table>() == GONIO_TABLE_SIZE && align_of::<Table>() == GONIO_TABLE_ALIGN);

/// View of a table blob; made by gonio_table_view. It may be moved, and shared between threads.
#[repr(C)]
#[derive(Debug)]
pub struct Table {
    opaque: [u64; 40],
}

/// Kind of a table: a mirror-like surface, which reflects into one direction only.
pub const GONIO_KIND_MIRROR: u32 = 1;
/// Kind of a table: a surface that reflects into every direction.
pub const GONIO_KIND_SCATTER: u32 = 2;

/// Kind of a table: a periodic surface, which reflects into diffraction orders. The functions gonio_orders_… take it.
pub const GONIO_KIND_ORDERS: u32 = 3;

/// Kind of a table: a mirror-like surface with a transmittance, a thickness that varies, or a finish, by which it
/// reflects into every direction. The functions gonio_film_… take it. Functions without a thickness take the first.
pub const GONIO_KIND_FILM: u32 = 4;

/// Kind, channels and colour space of a table.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TableDescription {
    /// GONIO_KIND_MIRROR, GONIO_KIND_SCATTER, GONIO_KIND_ORDERS or GONIO_KIND_FILM.
    pub kind: u32,
    /// Number of channels. The first three are red, green and blue. 3 for orders, the RGB weights of their wavelengths.
    pub channels: u32,
    /// Colour space: GONIO_SPACE_…; 0 if it is unknown, 4 for the matrix printed in the paper.
    pub space: u32,
}

/// Lobe of flat facets: an exact direction into which they reflect.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FacetLobe {
    /// Direction, a unit vector; zeros if the lobe is not above the surface.
    pub direction: [f32; 3],
    /// RGB fraction of the light that leaves in this direction: the radiance seen is it times the radiance from there.
    pub reflectance: [f32; 3],
}

/// Outgoing direction that was drawn, with its density and weight.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Direction, a unit vector.
    pub wo: [f32; 3],
    /// Density per solid angle. It is 1 for a mirror-like surface without a finish, which has no density. 0 for a draw
    /// without light, which has weight 0 and counts as a sample.
    pub pdf: f32,
    /// RGB of the BRDF times cos theta_o divided by the density; the reflectance of a mirror-like surface without a
    /// finish.
    pub weight: [f32; 3],
}

/// Checks a table blob of `size` bytes, at any alignment, and makes a view of it. The bytes are not copied: they must
/// outlive the view and must not change. The time is proportional to the size.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types, and `bytes` to `size` bytes.
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
    status_of(|| unsafe { Tagged::<Blob<'static>>::write(table, object) })
}

/// Describes a table: its kind, channels and colour space.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_describe(table: *const Table, description: *mut TableDescription) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, description) = unsafe { (view(table)?, Results::new(description, 1)?) };
        let (kind, channels) = match &blob.contents {
            Contents::Mirror(table) => (GONIO_KIND_MIRROR, table.channels()),
            Contents::Film(table) => (GONIO_KIND_FILM, table.channels()),
            Contents::Scatter(table, _) => (GONIO_KIND_SCATTER, table.channels()),
            Contents::Orders(_) => (GONIO_KIND_ORDERS, 3),
        };
        let space = space_number(blob.space);
        description.write([TableDescription { kind, channels: channels as u32, space }]);
        Ok(())
    })
}

/// Looks up the RGB reflectance of a mirror-like surface at `cos_theta`. It is constant beyond the table's largest
/// angle. NaN and cosines outside [0, 1] give GONIO_STATUS_ANGLE.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_reflectance(table: *const Table, cos_theta: f32, rgb: *mut f32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, rgb) = unsafe { (view(table)?, Results::new(rgb, 3)?) };
        if !(0.0..=1.0).contains(&cos_theta) {
            return Err(Status::Angle);
        }
        rgb.write(match &blob.contents {
            Contents::Mirror(table) => table.rgb(angle(cos_theta)),
            Contents::Film(table) => table.reflectance(cos_theta, table.range_nm()[0]),
            _ => return Err(Status::WrongKind),
        });
        Ok(())
    })
}

/// Looks up the RGB BRDF in 1/sr, without the cosine, of a surface that reflects into every direction. Directions are
/// unit vectors in the surface's frame, whose z is the normal; both leave the surface. The result is 0 if either is
/// below it. The lobes of flat facets are not part of it: gonio_table_lobe gives each. It takes tables of
/// GONIO_KIND_SCATTER and GONIO_KIND_FILM; without a finish, the latter give 0.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi`, `wo` and `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_rgb(table: *const Table, wi: *const f32, wo: *const f32, rgb: *mut f32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, wo, rgb) = unsafe { (view(table)?, direction(wi)?, direction(wo)?, Results::new(rgb, 3)?) };
        rgb.write(match &blob.contents {
            Contents::Scatter(table, _) => table.rgb(wi, wo),
            Contents::Film(table) => table.eval(unit(wi)?, unit(wo)?, table.range_nm()[0]),
            _ => return Err(Status::WrongKind),
        });
        Ok(())
    })
}

/// Looks up the RGB albedo of a surface that reflects into every direction: the fraction of the light from `wi` that it
/// reflects, lobes included; 0 if `wi` is below the surface. It sums over the whole table: keep the result.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi` and `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_albedo(table: *const Table, wi: *const f32, rgb: *mut f32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, rgb) = unsafe { (view(table)?, direction(wi)?, Results::new(rgb, 3)?) };
        let Contents::Scatter(table, _) = &blob.contents else { return Err(Status::WrongKind) };
        let mut albedo = [0.0; 3];
        table.albedo(wi, &mut albedo);
        rgb.write(repeated(albedo, table.channels()));
        Ok(())
    })
}

/// Counts the lobes of flat facets of a surface that reflects into every direction. Most tables have none.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_lobe_count(table: *const Table, count: *mut u32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, count) = unsafe { (view(table)?, Results::new(count, 1)?) };
        let Contents::Scatter(table, _) = &blob.contents else { return Err(Status::WrongKind) };
        count.write([table.layout().lobes() as u32]);
        Ok(())
    })
}

/// Looks up a lobe of flat facets for light from `wi`: its direction, and the fraction of the light that it reflects.
/// The radiance that a viewer in the direction `wi` receives by it is the reflectance times the radiance from the
/// lobe's direction. Both are 0 if `wi` or the lobe is below the surface.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_lobe(
    table: *const Table,
    wi: *const f32,
    lobe: u32,
    result: *mut FacetLobe,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, result) = unsafe { (view(table)?, direction(wi)?, Results::new(result, 1)?) };
        let Contents::Scatter(table, _) = &blob.contents else { return Err(Status::WrongKind) };
        let lobe = lobe as usize;
        if lobe >= table.layout().lobes() {
            return Err(Status::Index);
        }
        let mut rgb = [0.0; 3];
        let direction = table.reflected(wi, lobe, &mut rgb).map_or([0.0; 3], |direction| direction.to_array());
        result.write([FacetLobe { direction, reflectance: repeated(rgb, table.channels()) }]);
        Ok(())
    })
}

/// Looks up the density per solid angle with which gonio_table_sample and gonio_film_sample draw `wo` for `wi`; 0 if
/// either is below the surface. It takes tables of GONIO_KIND_SCATTER and GONIO_KIND_FILM; without a finish, the latter
/// give 0.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi` and `wo` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_pdf(table: *const Table, wi: *const f32, wo: *const f32, pdf: *mut f32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, wo, pdf) = unsafe { (view(table)?, direction(wi)?, direction(wo)?, Results::new(pdf, 1)?) };
        pdf.write([match &blob.contents {
            Contents::Scatter(_, sampler) => sampler.pdf(wi, wo),
            Contents::Film(table) => table.pdf(unit(wi)?, unit(wo)?),
            _ => return Err(Status::WrongKind),
        }]);
        Ok(())
    })
}

/// Draws an outgoing direction for `wi`, which must lie above the surface, by two numbers in [0, 1). It takes
/// all tables but those of orders; the lobes of flat facets are not drawn. Some draws are without light: their weight
/// and density are 0, and their direction is the mirror image of `wi`.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats, `u` to two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_table_sample(
    table: *const Table,
    wi: *const f32,
    u: *const f32,
    sample: *mut Sample,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (blob, wi, u, sample) =
            unsafe { (view(table)?, direction(wi)?, *shared(u.cast::<[f32; 2]>())?, Results::new(sample, 1)?) };
        check_draw(wi, u)?;
        let (wo, pdf, weight) = match &blob.contents {
            Contents::Mirror(table) => (mirrored(wi), 1.0, table.rgb(angle(wi.z.min(1.0)))),
            Contents::Scatter(table, sampler) => {
                // A draw below the horizon has no density. The division comes last, so 0 stays 0 however small that is.
                let (wo, pdf) = sampler.sample(wi, u).unwrap_or((mirrored(wi), 0.0));
                let weight = |f: f32| if pdf > 0.0 { f * wo.z / pdf } else { 0.0 };
                (wo, pdf, table.rgb(wi, wo).map(weight))
            }
            Contents::Film(table) => {
                sample.write([sampled(table, wi, u, table.range_nm()[0])?]);
                return Ok(());
            }
            Contents::Orders(_) => return Err(Status::WrongKind),
        };
        sample.write([Sample { wo: wo.to_array(), pdf, weight }]);
        Ok(())
    })
}

/// Refuses numbers outside [0, 1), and a direction that is not above the surface.
fn check_draw(wi: Vec3, u: [f32; 2]) -> Result<(), Status> {
    if !u.iter().all(|u| (0.0..1.0).contains(u)) {
        return Err(Status::Argument);
    }
    if wi.z <= 0.0 {
        return Err(Status::Direction);
    }
    Ok(())
}

/// Draw of a mirror-like surface.
pub(crate) fn sampled(film: &FilmTable<'_>, wi: Vec3, u: [f32; 2], thickness_nm: f32) -> Result<Sample, Status> {
    check_draw(wi, u)?;
    let wi = unit(wi)?;
    Ok(match film.sample(wi, u, thickness_nm) {
        Some(FilmSample { wo, pdf, weight }) => Sample { wo: wo.to_array(), pdf: pdf.unwrap_or(1.0), weight },
        None => Sample { wo: mirrored(wi).to_array(), pdf: 0.0, weight: [0.0; 3] },
    })
}

/// Direction into which a mirror reflects.
fn mirrored(wi: Vec3) -> Vec3 {
    Vec3::new(-wi.x, -wi.y, wi.z)
}

/// RGB of a table with so many channels, of which the last is repeated.
fn repeated([r, g, b]: [f32; 3], channels: usize) -> [f32; 3] {
    match channels {
        1 => [r; 3],
        2 => [r, g, g],
        _ => [r, g, b],
    }
}

/// View that has been made in a gonio_table.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a readable table that nobody changes meanwhile.
pub(crate) unsafe fn view<'a>(table: *const Table) -> Result<&'a Blob<'static>, Status> {
    // SAFETY: the caller's promise.
    unsafe { Tagged::get(table) }
}

/// Reads a direction, which is finite and not zero.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to three numbers.
pub(crate) unsafe fn direction(pointer: *const f32) -> Result<Vec3, Status> {
    // SAFETY: the caller's promise.
    let direction = Vec3::from_array(*unsafe { shared(pointer.cast::<[f32; 3]>()) }?);
    if direction.is_finite() && direction != Vec3::ZERO { Ok(direction) } else { Err(Status::Direction) }
}

/// Direction of unit length.
pub(crate) fn unit(direction: Vec3) -> Result<Vec3, Status> {
    direction.try_normalize().ok_or(Status::Direction)
}

/// Angle θ of a cosine in [0, 1].
fn angle(cos_theta: f32) -> f32 {
    libm::acosf(cos_theta).min(FRAC_PI_2)
}
