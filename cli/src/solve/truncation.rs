//! The limit on light that a result leaves out, and the errors for results beyond it.

use crate::solve::mesh_scene::MeshScene;
use crate::support::error::{Error, Result};

/// The largest share of the light that a result may leave out.
///
/// Where paths add as powers it bounds the error of a reflectance Y. CIELAB's L* changes by at most 903 for each unit
/// of Y, near black: by 0.9 here, less than the smallest difference that is seen. Where waves interfere, a power p that
/// is left out may move a reflectance R by 2√(R p) and more; such waves are given up at a power of 1e-13, or
/// 1e-12 in single precision, far below this share.
pub const MAX_TRUNCATED: f64 = 1e-3;

/// Refuses waves of which more power is left in flight than came in.
pub(crate) fn refuse_divergence(mesh_scene: &MeshScene<'_>, truncated: f64) -> Result<()> {
    /// Rounding of a sum over wavelengths whose weights add up to 1.
    const ROUNDING: f64 = 1e-9;
    if truncated <= 1.0 + ROUNDING {
        return Ok(());
    }
    Err(Error::failed(format_args!(
        "{}: interfering waves do not converge in this cell; scatter and estimate add powers with --coherence none",
        mesh_scene.scene().name
    )))
}

/// Refuses a result that leaves out more light than [`MAX_TRUNCATED`].
pub(crate) fn refuse_truncation(mesh_scene: &MeshScene<'_>, truncated: f64, remedy: &str) -> Result<()> {
    if truncated <= MAX_TRUNCATED {
        return Ok(());
    }
    Err(Error::failed(format_args!(
        "{}: {truncated:.1e} of the light was lost or given up on its way, more than the {MAX_TRUNCATED:.0e} that a result may \
         leave out; {remedy}",
        mesh_scene.scene().name
    )))
}
