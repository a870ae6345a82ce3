//! The limits of interfering waves in a mesh: the slots in which they wait to merge with equal waves, and the power
//! below which they are dropped.

use goniochrome::simd::lanes::{F32, F64};
use goniochrome::simd::ray_lanes::RayLanes;
use goniochrome::trace::coherent_mesh::{WaveField, WaveState};
use goniochrome::trace::waves::{Limits, Slot};

use crate::solve::mesh_scene::MeshScene;

/// The limits of waves whose fields add in bins. Waves below this power in flight are dropped:
/// amplitudes of 3e-7, which a loop of gain g would turn into 3e-7/|1 − g|.
pub(crate) const WAVE_LIMITS: Limits = Limits { in_flight: 1e-13, generations: 10_000 };

/// The limits of the interfering waves of one starting ray, whose exits add as powers with those of other rays.
///
/// In single precision waves below 1e-12 in flight are dropped: their amplitude of 1e-6 moves a reflectance R by
/// 2e-6 √R, less than the error of planes in single precision.
pub(crate) fn ray_limits<V: RayLanes>() -> Limits {
    let in_flight = if V::UNIT_ROUNDOFF > f64::EPSILON { 1e-12 } else { WAVE_LIMITS.in_flight };
    Limits { in_flight, ..WAVE_LIMITS }
}

/// Slots where waves cannot fall back to incoherent paths.
const WITHOUT_FALLBACK: usize = 36;

/// Slots for a cell whose waves cannot fall back to incoherent paths.
pub(crate) fn slots_without_fallback(mesh_scene: &MeshScene<'_>) -> usize {
    WITHOUT_FALLBACK.max(slots_with_fallback(mesh_scene))
}

/// Slots for a cell whose further waves fall back to incoherent paths: as many as a planar stack of the cell's
/// interfaces needs, and two pairs for waves that a ray sends beyond an edge. Light that needs more is scattered by
/// curved facets and never merges: between 6 and 26 slots the soap film reflects the same within a thousandth.
pub(crate) fn slots_with_fallback(mesh_scene: &MeshScene<'_>) -> usize {
    2 * mesh_scene.interface_count() + 4
}

const _: () = assert!(WITHOUT_FALLBACK * size_of::<Slot<WaveState<F32>, WaveField<F32>>>() <= 64 * 1024);
const _: () = assert!(WITHOUT_FALLBACK * size_of::<Slot<WaveState<F64>, WaveField<F64>>>() <= 64 * 1024);
