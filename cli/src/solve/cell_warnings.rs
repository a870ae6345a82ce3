//! Warnings about the result of a cell: printed, and kept in the file.

use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{Adding, Coherence};
use crate::solve::truncation::MAX_TRUNCATED;
use crate::table::statistics::MeanWithError;

/// The largest imbalance of power without a warning. Bumpy films keep their power to a hundredth.
const MAX_IMBALANCE: f64 = 0.01;
/// The largest imbalance of power without a warning, in standard errors.
const MAX_DEVIATIONS: f64 = 4.0;

/// A warning if the power of interfering waves does not balance.
#[must_use]
pub fn unbalanced(coherence: Coherence, imbalance: MeanWithError) -> Option<String> {
    let MeanWithError { value, std_error } = imbalance;
    match coherence.adding() {
        Adding::Powers(_) | Adding::Fields if value.abs() > MAX_IMBALANCE.max(MAX_DEVIATIONS * std_error) => {
            Some(format!(
                "power balances only to {value:.3} with --coherence {}, since paths that interfere here do not \
                 interfere in all directions; --coherence none keeps power",
                coherence.name()
            ))
        }
        // Only reflected orders are computed: their missing power is not a fault.
        Adding::Powers(_) | Adding::Fields | Adding::Orders => None,
    }
}

/// The largest share of starting rays traced incoherently without a warning: a reflectance may change by as much.
const MAX_SHARE: f64 = 0.01;

/// A warning if many starting rays were traced without interference.
#[must_use]
pub fn not_converged(share: f64) -> Option<String> {
    (share > MAX_SHARE).then(|| {
        format!(
            "the waves of {:.0} % of the starting rays do not converge to {MAX_TRUNCATED:.0e}; those rays are traced without interference",
            100.0 * share
        )
    })
}

/// A warning if wavelengths are too far apart for the fringes of films on or between facets.
#[must_use]
pub fn too_few(mesh_scene: &MeshScene<'_>, coherence: Coherence, wavelength_nm: &[f64]) -> Option<String> {
    /// The wavelength at which fringes are judged: those of shorter waves are closer, but hardly seen.
    const JUDGED_NM: f64 = 450.0;
    /// The fewest wavelengths in a fringe: with three, colours of single films are within 1e-3.
    const MIN_PER_FRINGE: f64 = 3.0;
    let step_nm = wavelength_nm.windows(2).find(|pair| pair[1] >= JUDGED_NM).map(|pair| pair[1] - pair[0])?;
    let path_nm = mesh_scene.film_path_nm(JUDGED_NM);
    let fringe_nm = JUDGED_NM * JUDGED_NM / (2.0 * path_nm);
    (coherence != Coherence::None && step_nm * MIN_PER_FRINGE > fringe_nm).then(|| {
        format!(
            "{} wavelengths may be too few for the fringes of films, an optical path of {path_nm:.0} nm: colours may be \
             wrong; name wavelengths {:.1} nm apart",
            wavelength_nm.len(),
            (fringe_nm / 4.0).max(0.1)
        )
    })
}
