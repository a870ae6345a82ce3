//! Single or double precision: the numbers that a computation is made with.

/// The precision of the numbers of a computation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision. R and T of planes to 1e-5: samples that it cannot hold are computed again with more digits.
    #[default]
    F32,
    /// Double precision. R and T of planes to 1e-11, likewise.
    F64,
}

impl Precision {
    /// Most by which rounding may move R or T of planes in closed form and with closed loops.
    #[must_use]
    pub fn tolerance(self) -> f64 {
        match self {
            Self::F32 => 1e-5,
            Self::F64 => 1e-11,
        }
    }
}
