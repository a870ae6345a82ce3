//! BRDF tables over borrowed memory: layout, checks, look-up, sampling.
//!
//! - [`MirrorTable`]: a mirror-like surface reflects into one direction only, so its BRDF is
//!   f(wi, wo) = ρ(θ) δ(wo − mirror(wi)) / cos θ and its table is ρ(θ) for each channel: "2D" in the paper, angle ×
//!   wavelength (section 3.1).
//! - [`ScatterTable`]: a surface of tilted facets reflects everywhere; f(wi, wo) on a grid of directions
//!   ([`ScatterLayout`]), with [`ScatterSampler`] to draw wo.
//! - [`blob`]: either of them as bytes, to load without copying.

pub mod blob;
mod layout;
mod mirror;
mod sampler;
mod scatter;
mod values;

pub use layout::{Node, ScatterLayout};
pub use mirror::MirrorTable;
pub use sampler::ScatterSampler;
pub use scatter::ScatterTable;
use values::Values;

/// Largest magnitude of a value, far above any that is meant: what is interpolated from such values, and an albedo, the sum of at
/// most 2²⁰ of them, stays within single precision.
pub const LARGEST: f32 = 1e30;

/// Why a table was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableError {
    /// Fewer than two rows, no channels, or a slice that is not rows × channels long.
    Shape,
    /// The largest angle is not in (0, π/2].
    ThetaMax,
    /// A value that is NaN, infinite or beyond [`LARGEST`].
    NotFinite {
        /// Place in the slice.
        index: usize,
    },
    /// A grid of directions without directions, or whose incident azimuths are no middles of outgoing bins.
    Layout,
    /// A slice that has not the length that the layout asks for.
    Length {
        /// What the layout asks for.
        required: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Shape => {
                write!(f, "a table needs at least two angles, one channel, and as many values as both together")
            }
            Self::ThetaMax => write!(f, "the largest angle must lie in (0, 90] degrees"),
            Self::NotFinite { index } => write!(f, "value {index} is not a number from −{LARGEST:e} to {LARGEST:e}"),
            Self::Layout => write!(
                f,
                "a grid needs at least one direction each way, at most 1024 a side, and a number of outgoing azimuths that is a \
                 multiple of the incident ones"
            ),
            Self::Length { required } => write!(f, "the layout needs {required} values"),
        }
    }
}

impl core::error::Error for TableError {}
