//! What a user must know of a result of tilted facets: told at the prompt, and kept in the file.

use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{Adding, Coherence};
use crate::solve::truncation::MAX_TRUNCATED;
use crate::table::statistics::MeanWithError;

/// A power balance that is worse than this, and than [`FAR`] standard errors, is told. Bumpy films keep their power to
/// a hundredth.
const TOLD_IMBALANCE: f64 = 0.01;
/// Standard errors.
const FAR: f64 = 4.0;

/// A warning where the power of waves that interfere does not balance.
#[must_use]
pub fn unbalanced(coherence: Coherence, imbalance: MeanWithError) -> Option<String> {
    let MeanWithError { value, std_error } = imbalance;
    match coherence.adding() {
        Adding::Powers(_) | Adding::Fields if value.abs() > TOLD_IMBALANCE.max(FAR * std_error) => Some(format!(
            "power balances only to {value:.3} with --coherence {}, since paths that interfere here do not interfere in all \
             directions; --coherence none keeps power",
            coherence.name()
        )),
        // Of orders only those that are reflected are computed: what is missing is no fault.
        Adding::Powers(_) | Adding::Fields | Adding::Orders => None,
    }
}

/// A share of starting rays larger than this is told: it may change a reflectance by as much.
const TOLD_SHARE: f64 = 0.01;

/// A warning where many starting rays were followed without interference.
#[must_use]
pub fn without_sum(share: f64) -> Option<String> {
    (share > TOLD_SHARE).then(|| {
        format!(
            "the waves of {:.0} % of the starting rays do not converge to {MAX_TRUNCATED:.0e}; those rays are followed without interference",
            100.0 * share
        )
    })
}

/// A warning where wavelengths are too far apart for the fringes of films on or between facets.
#[must_use]
pub fn too_few(mesh_scene: &MeshScene<'_>, coherence: Coherence, wavelength_nm: &[f64]) -> Option<String> {
    /// Where fringes are judged: those of shorter waves are closer, but hardly seen.
    const JUDGED_NM: f64 = 450.0;
    /// With three and more a fringe, colours of single films are within 1e-3.
    const FEWEST: f64 = 3.0;
    let step_nm = wavelength_nm.windows(2).find(|pair| pair[1] >= JUDGED_NM).map(|pair| pair[1] - pair[0])?;
    let path_nm = mesh_scene.film_path_nm(JUDGED_NM);
    let fringe_nm = JUDGED_NM * JUDGED_NM / (2.0 * path_nm);
    (coherence != Coherence::None && step_nm * FEWEST > fringe_nm).then(|| {
        format!(
            "{} wavelengths may be too few for the fringes of films, an optical path of {path_nm:.0} nm: colours may be \
             wrong; name wavelengths {:.1} nm apart",
            wavelength_nm.len(),
            (fringe_nm / 4.0).max(0.1)
        )
    })
}
