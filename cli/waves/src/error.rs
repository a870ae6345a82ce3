//! Errors of the solvers.

/// An error for which a solver has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaveError {
    /// An eigenvalue decomposition did not converge, or a matrix had no finite inverse.
    Singular,
}

impl std::fmt::Display for WaveError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Singular => write!(f, "the equations of the waves have no finite solution"),
        }
    }
}

impl std::error::Error for WaveError {}
