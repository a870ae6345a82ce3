//! Medium that owns its coefficients and tables, checked once.

use goniochrome::optics::medium::{Extrapolate, IndexPart, MAX_AMBIENT_K, Medium, MediumError};

use super::column::Notes;
use super::dispersion::OwnedDispersion;

/// Passive medium: n(λ), k(λ), the treatment of wavelengths beyond their data, and the faults of their tables.
#[derive(Clone, Debug)]
pub struct OwnedMedium {
    n: OwnedDispersion,
    k: OwnedDispersion,
    extrapolate: Extrapolate,
    n_notes: Notes,
    k_notes: Notes,
    /// Message about a guess made when it was read.
    guess: Option<String>,
}

/// Compares η alone: media are equal whatever file they come from.
impl PartialEq for OwnedMedium {
    fn eq(&self, other: &Self) -> bool {
        self.n == other.n && self.k == other.k && self.extrapolate == other.extrapolate
    }
}

impl OwnedMedium {
    /// Medium of a given n(λ) and k(λ). A formula that leaves the passive domain is found when it is evaluated.
    ///
    /// # Errors
    /// Refuses what [`Medium::new`] refuses: tables or ranges out of order, values that are not finite or not passive.
    pub fn new(n: OwnedDispersion, k: OwnedDispersion, extrapolate: Extrapolate) -> Result<Self, MediumError> {
        Medium::new(n.borrow(), k.borrow(), extrapolate)?;
        Ok(Self { n, k, extrapolate, n_notes: Notes::default(), k_notes: Notes::default(), guess: None })
    }

    /// Adds the faults of the tables of n and of k.
    pub(super) fn with_notes(self, n_notes: Notes, k_notes: Notes) -> Self {
        Self { n_notes, k_notes, ..self }
    }

    /// Adds the message about a guess made when it was read.
    pub(super) fn with_guess(self, guess: Option<String>) -> Self {
        Self { guess, ..self }
    }

    /// Medium with one n + ik at every wavelength.
    ///
    /// # Errors
    /// [`MediumError::NotFinite`] if n or k is not finite, [`MediumError::NotPassive`] if n ≤ 0 or k < 0.
    pub fn constant(n: f64, k: f64) -> Result<Self, MediumError> {
        Self::new(OwnedDispersion::Constant(n), OwnedDispersion::Constant(k), Extrapolate::Refuse)
    }

    /// The medium as the core's [`Medium`], which borrows the data.
    ///
    /// # Panics
    /// Never: the constructor made the same check.
    #[must_use]
    pub fn borrow(&self) -> Medium<'_> {
        Medium::new(self.n.borrow(), self.k.borrow(), self.extrapolate).expect("checked by OwnedMedium::new")
    }

    /// Whether every datum of k is above [`MAX_AMBIENT_K`]: such a medium lets light arrive at no wavelength.
    #[must_use]
    pub fn always_absorbs(&self) -> bool {
        match &self.k {
            OwnedDispersion::Constant(k) => *k > MAX_AMBIENT_K,
            OwnedDispersion::Table { value, .. } => value.iter().all(|k| *k > MAX_AMBIENT_K),
            OwnedDispersion::Formula { .. } => false,
        }
    }

    /// Describes an error of [`Medium::eta`] for this medium: which of n and k, where, and why.
    #[must_use]
    pub fn describe(&self, error: &MediumError) -> String {
        match *error {
            MediumError::OutOfRange { part, wavelength_nm, range_nm: [from, to] } => {
                let (other, [lower, upper]) = match part {
                    IndexPart::N => ("k", self.k.borrow().range_nm()),
                    IndexPart::K => ("n", self.n.borrow().range_nm()),
                };
                let other =
                    if upper < f64::INFINITY { format!(", {other} {lower} to {upper} nm") } else { String::new() };
                format!("no data for {part} at {wavelength_nm} nm ({part} covers {from} to {to} nm{other})")
            }
            MediumError::Unknown { part, wavelength_nm } => self.fault(part, wavelength_nm),
            MediumError::Opaque { .. } => {
                format!("{error}; lower its k, or make it a layer under a clear ambient medium")
            }
            _ => error.to_string(),
        }
    }

    /// Message about an unknown value: between which wavelengths, and why.
    fn fault(&self, part: IndexPart, wavelength_nm: f64) -> String {
        let (dispersion, notes) = match part {
            IndexPart::N => (&self.n, &self.n_notes),
            IndexPart::K => (&self.k, &self.k_notes),
        };
        let (mut lower, mut upper) = (0.0, f64::INFINITY);
        if let OwnedDispersion::Table { wavelength_nm: rows, value } = dispersion {
            for (&nm, _) in rows.iter().zip(value).filter(|(_, value)| !value.is_nan()) {
                if nm <= wavelength_nm {
                    lower = nm;
                } else {
                    upper = nm.min(upper);
                }
            }
        }
        let stretch = match (lower > 0.0, upper < f64::INFINITY) {
            (true, true) => format!("between {lower} and {upper} nm"),
            (true, false) => format!("above {lower} nm"),
            _ => format!("below {upper} nm"),
        };
        let reason = notes.faults.iter().find(|(nm, _)| lower < *nm && *nm < upper);
        let reason = reason.map_or_else(String::new, |(_, reason)| format!(": {reason}"));
        format!("{part} is not known at {wavelength_nm} nm ({stretch}){reason}")
    }

    /// Note for a user of the medium at these wavelengths: a guessed unit, or a k below 0 that is taken as 0.
    #[must_use]
    pub fn note(&self, wavelengths_nm: &[f64]) -> Option<String> {
        if let Some(guess) = &self.guess {
            return Some(guess.clone());
        }
        let OwnedDispersion::Table { wavelength_nm: rows, .. } = &self.k else { return None };
        // A row counts up to its neighbours.
        let counts = |row_nm: f64| {
            let at = rows.partition_point(|&nm| nm < row_nm);
            let from = at.checked_sub(1).map_or(0.0, |below| rows[below]);
            let to = rows.get(at + 1).copied().unwrap_or(f64::INFINITY);
            wavelengths_nm.iter().any(|&nm| from < nm && nm < to)
        };
        let row_nm = self.k_notes.rounded_nm.iter().find(|&&nm| counts(nm))?;
        Some(format!("k at {row_nm} nm lies just below 0, which is gain; it is taken as 0"))
    }
}

#[cfg(test)]
mod tests {
    use goniochrome::optics::medium::Formula;

    use super::*;

    #[test]
    fn a_formula_is_checked_where_it_is_asked() {
        let formula = |coefficients: &[f64]| {
            let (formula, range_nm) = (Formula::Cauchy, [400.0, 700.0]);
            let n = OwnedDispersion::Formula { formula, coefficients: coefficients.to_vec(), range_nm };
            OwnedMedium::new(n, OwnedDispersion::Constant(0.0), Extrapolate::Refuse).unwrap()
        };
        assert!((formula(&[1.5, 0.01, -2.0]).borrow().eta(500.0).unwrap().re - 1.54).abs() < 1e-12);
        // n = 3 λ - 1.5 with λ in micrometres: passive above 500 nm alone.
        let slope = formula(&[-1.5, 3.0, 1.0]);
        assert!(slope.borrow().eta(600.0).is_ok());
        assert!(matches!(slope.borrow().eta(450.0), Err(MediumError::NotPassive { .. })));
    }

    #[test]
    fn light_arrives_through_a_medium_that_is_clear_somewhere() {
        let tabulated = |k: [f64; 2]| {
            let k = OwnedDispersion::Table { wavelength_nm: vec![400.0, 700.0], value: k.to_vec() };
            OwnedMedium::new(OwnedDispersion::Constant(1.5), k, Extrapolate::Refuse).unwrap().always_absorbs()
        };
        assert!(tabulated([0.1, 2.0]));
        assert!(!tabulated([0.1, 1e-3]));
        assert!(OwnedMedium::constant(1.5, 0.1).unwrap().always_absorbs());
        assert!(!OwnedMedium::constant(1.5, 1e-8).unwrap().always_absorbs());
        assert!(OwnedMedium::constant(1.5, -0.1).is_err());
    }
}
