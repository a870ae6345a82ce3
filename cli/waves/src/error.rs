//! Errors of the solvers.

/// An error for which a solver has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveError {
    /// An eigenvalue decomposition did not converge, or a matrix had no finite inverse.
    Singular,
    /// A period or thickness that is not positive, edges or corners that do not ascend within a period, or another
    /// number of media than of edges.
    Profile,
    /// Light that does not travel in the half-space above, or a wavelength that is not positive.
    Light,
}

impl std::fmt::Display for WaveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Singular => write!(f, "the equations of the waves have no finite solution"),
            Self::Profile => write!(
                f,
                "the profile is not one: lengths must be positive, edges ascend within a period, each with one medium"
            ),
            Self::Light => {
                write!(f, "the light does not travel towards the surface: its angle must be below 90 degrees")
            }
        }
    }
}

impl std::error::Error for WaveError {}
