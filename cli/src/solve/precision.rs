//! Single or double precision, and the one place where it chooses the lanes of a computation.

/// The precision of the numbers of a computation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision. R and T of planar scenes hold to 1e-5: samples that it cannot hold are computed again with
    /// more digits.
    #[default]
    F32,
    /// Double precision. R and T of planar scenes hold to 1e-11: samples that it cannot hold are computed again with
    /// more digits.
    F64,
}

impl Precision {
    /// The largest error that rounding may cause in R or T of a planar scene, in closed form and with closed loops.
    #[must_use]
    pub fn tolerance(self) -> f64 {
        match self {
            Self::F32 => 1e-5,
            Self::F64 => 1e-11,
        }
    }
}

/// Evaluates an expression with the lanes of a precision as a type: `in_lanes!(precision, V => run::<V>(scene))`.
macro_rules! in_lanes {
    ($precision:expr, $lanes:ident => $run:expr) => {
        match $precision {
            $crate::solve::precision::Precision::F32 => {
                type $lanes = goniochrome::simd::lanes::F32;
                $run
            }
            $crate::solve::precision::Precision::F64 => {
                type $lanes = goniochrome::simd::lanes::F64;
                $run
            }
        }
    };
}
pub(crate) use in_lanes;
