//! Mirror-like surfaces with a transmittance, a thickness that varies, or a finish.

use crate::memory::{Results, shared};
use crate::status::{Status, status_of};
use crate::table::{Sample, Table, direction, sampled, unit, view};
use goniochrome::microfacet::{Distribution, Masking};
use goniochrome::table::FilmTable;
use goniochrome::table::blob::Contents;

/// Finish of a mirror-like surface: none, the surface is smooth.
pub const GONIO_FINISH_NONE: u32 = 0;
/// Finish: GGX facets with correlated masking and shadowing.
pub const GONIO_FINISH_GGX: u32 = 1;
/// Finish: GGX facets with separable masking and shadowing.
pub const GONIO_FINISH_GGX_SEPARABLE: u32 = 2;
/// Finish: Beckmann facets with correlated masking and shadowing.
pub const GONIO_FINISH_BECKMANN: u32 = 3;
/// Finish: Beckmann facets with separable masking and shadowing.
pub const GONIO_FINISH_BECKMANN_SEPARABLE: u32 = 4;

/// Finish: tabulated facets with correlated masking and shadowing.
pub const GONIO_FINISH_TABULATED: u32 = 5;
/// Finish: tabulated facets with separable masking and shadowing.
pub const GONIO_FINISH_TABULATED_SEPARABLE: u32 = 6;

/// Transmittance, thicknesses and finish of a mirror-like surface.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FilmDescription {
    /// Number of thicknesses; 1 where none varies.
    pub thicknesses: u32,
    /// First and last thickness in nm of the layer that varies. Equal where none does.
    pub range_nm: [f32; 2],
    /// 1 if the table holds a transmittance, else 0.
    pub transparent: u32,
    /// Finish: GONIO_FINISH_…
    pub finish: u32,
    /// Roughness alpha along x and y; 0 without a finish, and for tabulated facets.
    pub roughness: [f32; 2],
}

/// Describes a mirror-like surface, of GONIO_KIND_MIRROR or GONIO_KIND_FILM.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_film_describe(table: *const Table, description: *mut FilmDescription) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (film, description) = unsafe { (film(table)?, Results::new(description, 1)?) };
        let finish =
            film.finish().map_or(GONIO_FINISH_NONE, |finish| match (finish.distribution(), finish.masking()) {
                (Some(Distribution::Ggx), Masking::Correlated) => GONIO_FINISH_GGX,
                (Some(Distribution::Ggx), Masking::Separable) => GONIO_FINISH_GGX_SEPARABLE,
                (Some(Distribution::Beckmann), Masking::Correlated) => GONIO_FINISH_BECKMANN,
                (Some(Distribution::Beckmann), Masking::Separable) => GONIO_FINISH_BECKMANN_SEPARABLE,
                (None, Masking::Correlated) => GONIO_FINISH_TABULATED,
                (None, Masking::Separable) => GONIO_FINISH_TABULATED_SEPARABLE,
            });
        description.write([FilmDescription {
            thicknesses: film.thicknesses() as u32,
            range_nm: film.range_nm(),
            transparent: u32::from(film.is_transparent()),
            finish,
            roughness: film.finish().and_then(|finish| finish.alpha()).unwrap_or_default(),
        }]);
        Ok(())
    })
}

/// Looks up the RGB reflectance of a mirror-like surface at `cos_theta`, for a thickness in nm from 0 to 1e9 of the
/// layer that varies. It is constant beyond the table's angles and thicknesses. With a finish, it is that of each
/// facet. NaN and cosines outside [0, 1] give GONIO_STATUS_ANGLE.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_film_reflectance(
    table: *const Table,
    cos_theta: f32,
    thickness_nm: f32,
    rgb: *mut f32,
) -> Status {
    // SAFETY: the caller's promises.
    unsafe { at_angle(table, cos_theta, thickness_nm, rgb, FilmTable::reflectance) }
}

/// Looks up the RGB transmittance of a mirror-like surface, as gonio_film_reflectance does the reflectance; 0 if the
/// table holds none. It is that of the smooth surface: a finish is one of reflected light.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_film_transmittance(
    table: *const Table,
    cos_theta: f32,
    thickness_nm: f32,
    rgb: *mut f32,
) -> Status {
    // SAFETY: the caller's promises.
    unsafe { at_angle(table, cos_theta, thickness_nm, rgb, FilmTable::transmittance) }
}

/// Looks up the RGB BRDF in 1/sr, without the cosine, of a mirror-like surface with a finish, for a thickness in nm
/// from 0 to 1e9. Directions are in the surface's frame, whose z is the normal; both leave the surface. The result is 0
/// if either is below it, and without a finish. A finish with energy compensation returns the light of several bounces
/// too. gonio_table_pdf gives the density of gonio_film_sample.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi`, `wo` and `rgb` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_film_rgb(
    table: *const Table,
    wi: *const f32,
    wo: *const f32,
    thickness_nm: f32,
    rgb: *mut f32,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (film, wi, wo, rgb) = unsafe { (film(table)?, direction(wi)?, direction(wo)?, Results::new(rgb, 3)?) };
        rgb.write(film.eval(unit(wi)?, unit(wo)?, thickness(thickness_nm)?));
        Ok(())
    })
}

/// Draws an outgoing direction for `wi`, which must lie above the surface, by two numbers in [0, 1), for a thickness in
/// nm from 0 to 1e9. Without a finish it is the mirror direction, with density 1. Some draws are without light: their
/// weight and density are 0, and their direction is the mirror image of `wi`.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wi` to three floats, `u` to two.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_film_sample(
    table: *const Table,
    wi: *const f32,
    u: *const f32,
    thickness_nm: f32,
    sample: *mut Sample,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (film, wi, u, sample) =
            unsafe { (film(table)?, direction(wi)?, *shared(u.cast::<[f32; 2]>())?, Results::new(sample, 1)?) };
        sample.write([sampled(&film, wi, u, thickness(thickness_nm)?)?]);
        Ok(())
    })
}

/// Looks up one of the quantities of an angle.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `rgb` to three floats.
unsafe fn at_angle(
    table: *const Table,
    cos_theta: f32,
    thickness_nm: f32,
    rgb: *mut f32,
    quantity: impl Fn(&FilmTable<'static>, f32, f32) -> [f32; 3],
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (film, rgb) = unsafe { (film(table)?, Results::new(rgb, 3)?) };
        if !(0.0..=1.0).contains(&cos_theta) {
            return Err(Status::Angle);
        }
        rgb.write(quantity(&film, cos_theta, thickness(thickness_nm)?));
        Ok(())
    })
}

/// Mirror-like table that a view has been made of.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a readable table that nobody changes meanwhile.
unsafe fn film(table: *const Table) -> Result<FilmTable<'static>, Status> {
    // SAFETY: the caller's promise.
    match unsafe { &view(table)?.contents } {
        Contents::Film(film) => Ok(*film),
        Contents::Mirror(mirror) => Ok((*mirror).into()),
        _ => Err(Status::WrongKind),
    }
}

/// Refuses a thickness that is not from 0 to 1e9 nm.
fn thickness(nm: f32) -> Result<f32, Status> {
    if (0.0..=1e9).contains(&nm) { Ok(nm) } else { Err(Status::Thickness) }
}
