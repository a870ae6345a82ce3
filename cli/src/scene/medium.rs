//! A medium that owns its coefficients and tables, checked once.

use goniochrome::medium::{Dispersion, Extrapolate, Formula, Medium, MediumError};

/// The wavelengths at which formulas are tried when a medium is made, in nanometres.
const TRIED_NM: std::ops::RangeInclusive<u16> = 360..=830;

/// A real function of wavelength; the owned twin of [`Dispersion`].
#[derive(Clone, Debug, PartialEq)]
pub enum OwnedDispersion {
    /// The same at every wavelength.
    Constant(f64),
    /// A formula of the wavelength in micrometres.
    Formula {
        /// Which one.
        formula: Formula,
        /// c₁, c₂, …
        coefficients: Vec<f64>,
        /// The wavelengths for which the formula holds, ends included.
        range_nm: [f64; 2],
    },
    /// Samples, linear in wavelength between them.
    Table {
        /// Strictly increasing.
        wavelength_nm: Vec<f64>,
        /// One value for each wavelength.
        value: Vec<f64>,
    },
}

impl OwnedDispersion {
    /// The core's view of this function.
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

/// A passive medium: n(λ), k(λ), and what to do beyond their data.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnedMedium {
    n: OwnedDispersion,
    k: OwnedDispersion,
    extrapolate: Extrapolate,
}

impl OwnedMedium {
    /// A medium from its n and its k. Unless both are constant they are tried at every nanometre of the visible that they cover,
    /// so that a pole or n ≤ 0 is found here and not in the middle of a run.
    ///
    /// # Errors
    /// Those of [`Medium::new`], and [`MediumError::NotPassive`] for a formula.
    pub fn new(n: OwnedDispersion, k: OwnedDispersion, extrapolate: Extrapolate) -> Result<Self, MediumError> {
        let medium = Medium::new(n.borrow(), k.borrow(), extrapolate)?;
        let constant = [&n, &k].iter().all(|part| matches!(part, OwnedDispersion::Constant(_)));
        for nm in TRIED_NM.filter(|_| !constant) {
            match medium.eta(f64::from(nm)) {
                Ok(_) | Err(MediumError::OutOfRange { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(Self { n, k, extrapolate })
    }

    /// A medium of the same n + ik at every wavelength.
    ///
    /// # Errors
    /// [`MediumError::NotFinite`], [`MediumError::NotPassive`].
    pub fn constant(n: f64, k: f64) -> Result<Self, MediumError> {
        Self::new(OwnedDispersion::Constant(n), OwnedDispersion::Constant(k), Extrapolate::Refuse)
    }

    /// The core's view of this medium.
    ///
    /// # Panics
    /// Never: the constructor made the same check.
    #[must_use]
    pub fn borrow(&self) -> Medium<'_> {
        Medium::new(self.n.borrow(), self.k.borrow(), self.extrapolate).expect("checked by OwnedMedium::new")
    }

    /// True where no datum of k is zero: such a medium absorbs at every wavelength.
    #[must_use]
    pub fn always_absorbs(&self) -> bool {
        match &self.k {
            OwnedDispersion::Constant(k) => *k > 0.0,
            OwnedDispersion::Table { value, .. } => value.iter().all(|k| *k > 0.0),
            OwnedDispersion::Formula { .. } => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_medium_is_checked_where_its_formula_holds() {
        let formula = |coefficients: &[f64], range_nm| {
            let n =
                OwnedDispersion::Formula { formula: Formula::Cauchy, coefficients: coefficients.to_vec(), range_nm };
            OwnedMedium::new(n, OwnedDispersion::Constant(0.0), Extrapolate::Refuse)
        };
        let cauchy = formula(&[1.5, 0.01, -2.0], [400.0, 700.0]).unwrap();
        assert!((cauchy.borrow().eta(500.0).unwrap().re - 1.54).abs() < 1e-12);
        assert!(matches!(formula(&[-1.0], [400.0, 700.0]), Err(MediumError::NotPassive { .. })));
    }

    #[test]
    fn a_medium_that_is_clear_somewhere_does_not_always_absorb() {
        let tabulated = |k: [f64; 2]| {
            let k = OwnedDispersion::Table { wavelength_nm: vec![400.0, 700.0], value: k.to_vec() };
            OwnedMedium::new(OwnedDispersion::Constant(1.5), k, Extrapolate::Refuse).unwrap().always_absorbs()
        };
        assert!(tabulated([0.1, 2.0]));
        assert!(!tabulated([0.1, 0.0]));
        assert!(OwnedMedium::constant(1.5, 0.1).unwrap().always_absorbs());
        assert!(!OwnedMedium::constant(1.5, 0.0).unwrap().always_absorbs());
        assert!(OwnedMedium::constant(1.5, -0.1).is_err());
    }
}
