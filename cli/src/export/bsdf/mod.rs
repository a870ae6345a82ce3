//! RGL's tensor file (Dupuy and Jakob 2018), which Mitsuba 3 (`measured`), pbrt-v4 and powitacq read.
//!
//! Half vectors lie on a unit square: u = sqrt(2 θ_m/π) on the last axis and v = (φ_m + π)/2π, where φ_m counts from
//! φ_i for isotropic tables. `vndf` warps a uniform square onto it, and `luminance` refines the warp. `spectra` (or
//! `rgb`) holds f cos θ_o · 4σ/D on the square before the warp, so that f cos θ_o = spectra · `ndf`/(4 `sigma`). The
//! parameters θ_i, φ_i are the table's incident directions; f is taken as reciprocal, since renderers take them as the
//! viewer's. The warp is the same for all θ_i; `luminance` alone makes samples follow the BRDF.

pub mod density;
pub mod grid;
pub mod tensor;
mod contents;
mod albedo;
mod half_vectors;
mod resampled;

use glam::Vec3;

use self::grid::BsdfGrid;
use super::reflection::{LobeWidth, Reflection, ReflectionKind};
use crate::scene::LEAST_ROUGHNESS;
use crate::support::error::Result;
use crate::table::Table;

/// What becomes of negative components of colours out of gamut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gamut {
    /// They become 0.
    #[default]
    Clip,
    /// They stay: sums over light keep their colour, but renderers may warn.
    Keep,
}

/// The bytes of the tensor file of a table, with its wavelengths or, with `rgb`, its colours, of the gamut said.
///
/// # Errors
/// A width that is missing or has no use, RGB of a table without colours, a table whose nodes fit no square, or too
/// little memory.
pub fn encode(table: &Table, width: LobeWidth, rgb: Option<Gamut>) -> Result<Vec<u8>> {
    let reflection = Reflection::new(table, width, rgb.is_some())?;
    let reflection = if rgb == Some(Gamut::Clip) { reflection.clipped() } else { reflection };
    let contents = match reflection.kind() {
        ReflectionKind::Lobe { finish, .. } => {
            let facets = finish.finish();
            let alpha = match facets.alpha() {
                Some(alpha) => alpha,
                // Of tabulated facets: the roughness of the GGX facets of which a grazing direction sees as much.
                None => {
                    reflection.check_isotropic()?;
                    [2.0 * facets.visible_area(Vec3::X); 2]
                }
            };
            let alpha = alpha.map(|alpha| f64::from(alpha).clamp(LEAST_ROUGHNESS, 1.0));
            resampled::contents(&reflection, BsdfGrid::of_lobe(alpha, reflection.channels))?
        }
        ReflectionKind::Scatter(lookup, gaussian) => half_vectors::contents(&reflection, lookup, *gaussian)?,
        ReflectionKind::Orders(lobes) => resampled::contents(&reflection, BsdfGrid::of_orders(lobes))?,
    };
    let description = format!("{}, goniochrome {}", table.name(), env!("CARGO_PKG_VERSION"));
    Ok(contents.encode(description, &reflection.wavelength_nm))
}
