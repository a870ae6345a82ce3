//! Errors of tables.

/// Largest magnitude of a table's value, far above any reflectance or BRDF. With this bound interpolated values, and
/// albedos as sums of at most 2²⁰ values, stay within single precision.
pub const MAX_MAGNITUDE: f32 = 1e30;

/// An error for which a table, a grid of directions or a sampler is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableError {
    /// The table has fewer than two rows or no channels, or the slice is not rows × channels long. A table of orders
    /// has no wavelength, no order, or more than 2²⁰ orders.
    Shape,
    /// The largest angle is not in (0, π/2].
    ThetaMax,
    /// A value is NaN, infinite or beyond [`MAX_MAGNITUDE`], or an incident direction's cumulative probabilities in a
    /// blob are not sound.
    NotFinite {
        /// Index in the slice.
        index: usize,
    },
    /// A side of the grid is not from 1 to 1024, or the number of outgoing azimuths is not a multiple of the incident
    /// ones.
    Layout,
    /// A side of a grid of orders is not from 2 to 1024, or a period is not positive and finite.
    OrderLayout,
    /// The numbers of an order are not whole, or not 0 along an axis along which the surface does not vary; or
    /// wavelengths are not positive and increasing, an index is not positive, or an RGB weight is not finite.
    Orders,
    /// A strength of an order is NaN, negative or beyond [`MAX_MAGNITUDE`].
    Strength {
        /// Index in the slice.
        index: usize,
    },
    /// The slice does not have the length that the layout requires.
    Length {
        /// Required number of values.
        required: usize,
    },
}

impl core::fmt::Display for TableError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::Shape => {
                write!(f, "a table needs at least two angles, a channel, and a value for each channel at each angle")
            }
            Self::ThetaMax => write!(f, "the largest angle must lie in (0, 90] degrees"),
            Self::NotFinite { index } => {
                write!(f, "value {index} is not a number from −{MAX_MAGNITUDE:e} to {MAX_MAGNITUDE:e}")
            }
            Self::Layout => write!(
                f,
                "a grid needs at least one direction each way, at most 1024 a side, and a number of outgoing azimuths \
                 that is a multiple of the incident ones"
            ),
            Self::OrderLayout => {
                write!(f, "a grid of orders needs 2 to 1024 nodes a side, and periods that are positive and finite")
            }
            Self::Orders => write!(
                f,
                "orders need whole numbers, 0 along an axis without a period, increasing positive wavelengths, positive \
                 indices and finite weights"
            ),
            Self::Strength { index } => write!(f, "strength {index} is not a number from 0 to {MAX_MAGNITUDE:e}"),
            Self::Length { required } => write!(f, "the layout needs {required} values"),
        }
    }
}

impl core::error::Error for TableError {}
