//! How the light that leaves a cell adds up: as powers, as fields in bins, or as fields in diffraction orders.

use crate::solve::mesh_scene::MeshScene;
use crate::solve::truncation::{refuse_divergence, refuse_truncation};
use crate::support::error::Result;

/// The coherence of the light that leaves a cell: which exits interfere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Coherence {
    /// Paths of one starting ray that leave within 40° interfere; starting rays add as powers.
    #[default]
    Ray,
    /// Every path adds as power: classic geometric optics.
    None,
    /// All exits in a bin interfere, whatever starting ray they come from: the paper's section 2.2, literally.
    Bin,
    /// The period is one coherent field, which leaves in diffraction orders; by rays, in reflection alone.
    Cell,
}

/// The sum that a [`Coherence`] asks for. Code that depends on the coherence matches on this type alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Adding {
    /// Starting rays add as powers.
    Powers(Paths),
    /// Fields of all starting rays add in bins.
    Fields,
    /// Fields of all starting rays add in diffraction orders.
    Orders,
}

/// The sum over the paths of one starting ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Paths {
    /// Paths add as amplitudes.
    Interfering,
    /// Paths add as powers.
    Alone,
}

impl Coherence {
    /// The name on the command line and in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ray => "ray",
            Self::None => "none",
            Self::Bin => "bin",
            Self::Cell => "cell",
        }
    }

    /// The sum that this coherence asks for.
    pub(crate) fn adding(self) -> Adding {
        match self {
            Self::Ray => Adding::Powers(Paths::Interfering),
            Self::None => Adding::Powers(Paths::Alone),
            Self::Bin => Adding::Fields,
            Self::Cell => Adding::Orders,
        }
    }

    /// Refuses a result that diverged or leaves out too much light: `totals` are the shares of the light that are
    /// reflected, transmitted, absorbed and truncated. Waves in absorbing bodies narrower than a wavelength may meet
    /// loops of gain above 1, whose sum by hits has no end.
    pub(crate) fn check_totals(self, mesh_scene: &MeshScene<'_>, totals: [f64; 4]) -> Result<()> {
        let truncated = if totals.iter().all(|total| total.is_finite()) { totals[3] } else { f64::INFINITY };
        refuse_divergence(mesh_scene, truncated)?;
        let remedy = match self.adding() {
            Adding::Powers(Paths::Alone) => "its surfaces may cut through one another: correct the mesh",
            Adding::Powers(Paths::Interfering) | Adding::Fields | Adding::Orders => "use --coherence none",
        };
        refuse_truncation(mesh_scene, truncated, remedy)
    }
}
