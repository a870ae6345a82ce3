//! n or k as a function of wavelength, with its own coefficients or samples.

use goniochrome::optics::medium::{Dispersion, Formula};

/// Real function of wavelength that owns its data; [`Dispersion`] borrows them.
#[derive(Clone, Debug)]
pub enum OwnedDispersion {
    /// One value at every wavelength.
    Constant(f64),
    /// A formula of the wavelength in micrometres.
    Formula {
        /// Kind of formula.
        formula: Formula,
        /// Coefficients c₁, c₂, …
        coefficients: Vec<f64>,
        /// Wavelengths for which the formula holds, ends included.
        range_nm: [f64; 2],
    },
    /// Samples, linear in wavelength between them.
    Table {
        /// Wavelengths, strictly increasing.
        wavelength_nm: Vec<f64>,
        /// One value for each wavelength; NaN where it is not known.
        value: Vec<f64>,
    },
}

/// Compares values by their bits, so that unknown values (NaN) are equal to one another.
impl PartialEq for OwnedDispersion {
    fn eq(&self, other: &Self) -> bool {
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        match (self, other) {
            (Self::Constant(a), Self::Constant(b)) => a == b,
            (
                Self::Formula { formula: f, coefficients: a, range_nm: x },
                Self::Formula { formula: g, coefficients: b, range_nm: y },
            ) => f == g && a == b && x == y,
            (Self::Table { wavelength_nm: x, value: a }, Self::Table { wavelength_nm: y, value: b }) => {
                x == y && bits(a) == bits(b)
            }
            _ => false,
        }
    }
}

impl OwnedDispersion {
    /// The function as the core's [`Dispersion`], which borrows the data.
    #[must_use]
    pub fn borrow(&self) -> Dispersion<'_> {
        match self {
            Self::Constant(x) => Dispersion::Constant(*x),
            Self::Formula { formula, coefficients, range_nm } => {
                Dispersion::Formula { formula: *formula, coefficients, range_nm: *range_nm }
            }
            Self::Table { wavelength_nm, value } => Dispersion::Table { wavelength_nm, value },
        }
    }
}
