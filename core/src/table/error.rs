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
    /// The thicknesses of a film do not increase, or are not from 0 to 10⁹ nm.
    Thickness,
    /// A roughness of a finish is not from 0.001 to 1, numbers of tabulated facets are too large, not finite, or
    /// negative where they are densities, or energy compensation is missing or has losses that are not from 0 to 1.
    Finish,
    /// A value is NaN, infinite or beyond [`MAX_MAGNITUDE`], or an incident direction's cumulative probabilities in a
    /// blob are not sound.
    NotFinite {
        /// Index in the slice.
        index: usize,
    },
    /// A side of the grid is out of range: rows of incident directions and nodes along x are from 2 to 1024, columns
    /// and nodes along y from 1, lobes from 0.
    Layout,
    /// A density of a warp has fewer than 2 knots or more than 1025, is not finite, or is below a thousandth of its
    /// mean; or its integrals in a blob are not those of the density.
    Warp,
    /// The lobes are not as many as the layout says, or one has an index that is not from 0.001 to 1000 or a matrix
    /// that is not orthogonal.
    Lobe,
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
            Self::Thickness => write!(f, "thicknesses must increase, from 0 to 1e9 nm"),
            Self::Finish => {
                write!(
                    f,
                    "a finish needs a roughness from 0.001 to 1, or tabulated facets that are finite and not negative, and \
                     losses from 0 to 1 if it has any"
                )
            }
            Self::NotFinite { index } => {
                write!(f, "value {index} is not a number from −{MAX_MAGNITUDE:e} to {MAX_MAGNITUDE:e}")
            }
            Self::Layout => write!(
                f,
                "a grid needs 2 to 1024 incident angles and half-vector angles, 1 to 1024 azimuths of each, and at most \
                 1024 lobes"
            ),
            Self::Warp => {
                write!(f, "a warp needs 2 to 1025 densities along each axis, none below a thousandth of their mean")
            }
            Self::Lobe => write!(f, "each lobe needs an index from 0.001 to 1000 and an orthogonal matrix"),
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
