//! The complex refractive index η(λ) = n + ik of a medium: constants, dispersion formulas, borrowed tables.
//!
//! The formulas are those of the refractiveindex.info database (M. N. Polyanskiy, *Sci. Data* 11, 94 (2024)), numbered
//! as there. A [`Medium`] is checked when it is made. Its evaluation fails where a wavelength lies outside the range of
//! the data or beside an unknown value of a table, and where a formula gives no passive medium.

use crate::simd::complex::ComplexLanes;
use crate::simd::lanes::Lanes;
use num_complex::Complex64;

mod formula;

pub use formula::Formula;

/// Index of a medium in the list of media of a scene.
pub type MediumIndex = u16;

/// A real function of wavelength: the n or the k of a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion<'a> {
    /// One value at every wavelength.
    Constant(f64),
    /// A formula of the wavelength in micrometres.
    Formula {
        /// The formula.
        formula: Formula,
        /// The coefficients c₁, c₂, …
        coefficients: &'a [f64],
        /// The wavelengths for which the formula was fitted, ends included.
        range_nm: [f64; 2],
    },
    /// Samples, with linear interpolation in wavelength.
    Table {
        /// The wavelengths, strictly increasing.
        wavelength_nm: &'a [f64],
        /// One value for each wavelength. NaN marks an unknown value; nothing is known between it and its neighbours.
        value: &'a [f64],
    },
}

/// One of the two parts of η = n + ik.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndexPart {
    /// The refractive index n.
    N,
    /// The extinction coefficient k.
    K,
}

impl core::fmt::Display for IndexPart {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::N => "n",
            Self::K => "k",
        })
    }
}

/// Largest k of a medium through which light may arrive.
///
/// In an absorbing medium a plane wave whose n sin θ is real decays towards the surface. Its power is the one at the
/// surface, Re κ for a unit amplitude, and R = |r|². The incident and the reflected wave also exchange the power
/// 2 Im κ Im r, in the same units, which belongs to neither. R + T + A therefore differs from 1 by up to
/// 2 |r| Im κ/Re κ ≤ 2 (k/n)/cos²θ, to first order in k/n. At the largest k and normal incidence this is 2e-3/n.
pub const MAX_AMBIENT_K: f64 = 1e-3;

/// The treatment of wavelengths outside the range of the data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extrapolate {
    /// Refuses the wavelength, with [`MediumError::OutOfRange`].
    #[default]
    Refuse,
    /// Uses the value at the nearest end of the range.
    Clamp,
}

/// An error in a medium, for which it is refused, or in its evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MediumError {
    /// A number is NaN or infinite, or no value of a table is known.
    NotFinite {
        /// Index of the number among the coefficients or rows.
        index: usize,
    },
    /// The medium is not passive: n ≤ 0 or k < 0 (gain).
    NotPassive {
        /// The offending n.
        n: f64,
        /// The offending k.
        k: f64,
        /// The wavelength; 0 for a constant.
        wavelength_nm: f64,
    },
    /// A table's wavelengths do not increase, or are not positive, at this row.
    NotIncreasing {
        /// Index of the row, from 0.
        index: usize,
    },
    /// A table has no rows, or columns of different lengths; or lists of wavelengths, media or memory do not fit
    /// together.
    Shape,
    /// The wavelength lies outside the data of n or k.
    OutOfRange {
        /// The part of η that has no data there.
        part: IndexPart,
        /// The wavelength asked for.
        wavelength_nm: f64,
        /// The range of wavelengths with data of this part, ends included.
        range_nm: [f64; 2],
    },
    /// The wavelength lies beside an unknown value of a table.
    Unknown {
        /// The part of η that is not known.
        part: IndexPart,
        /// The wavelength asked for.
        wavelength_nm: f64,
    },
    /// Light cannot arrive through this medium: its k is above [`MAX_AMBIENT_K`].
    Opaque {
        /// The medium's k.
        k: f64,
        /// The wavelength asked for.
        wavelength_nm: f64,
    },
}

impl core::fmt::Display for MediumError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match *self {
            Self::NotFinite { index } => write!(f, "number {} is not finite", index + 1),
            Self::NotPassive { n, k, wavelength_nm } if wavelength_nm > 0.0 => {
                write!(f, "n = {n}, k = {k} at {wavelength_nm} nm is not passive (n > 0 and k >= 0 are required)")
            }
            Self::NotPassive { n, k, .. } => {
                write!(f, "n = {n}, k = {k} is not passive (n > 0 and k >= 0 are required)")
            }
            Self::NotIncreasing { index } => write!(f, "row {}: wavelengths must be positive and increase", index + 1),
            Self::Shape => write!(f, "the table is empty or its columns differ in length"),
            Self::OutOfRange { part, wavelength_nm, range_nm: [from, to] } => {
                write!(f, "no data for {part} at {wavelength_nm} nm ({part} covers {from} to {to} nm)")
            }
            Self::Unknown { part, wavelength_nm } => write!(f, "{part} is not known at {wavelength_nm} nm"),
            Self::Opaque { k, wavelength_nm } => write!(
                f,
                "k = {k} at {wavelength_nm} nm; light can arrive only through a medium with k up to {MAX_AMBIENT_K}"
            ),
        }
    }
}

impl core::error::Error for MediumError {}

impl Dispersion<'_> {
    /// The range of wavelengths with data, ends included.
    #[must_use]
    pub fn range_nm(&self) -> [f64; 2] {
        match *self {
            Self::Constant(_) => [0.0, f64::INFINITY],
            Self::Formula { range_nm, .. } => range_nm,
            Self::Table { wavelength_nm, .. } => match (wavelength_nm.first(), wavelength_nm.last()) {
                (Some(&from), Some(&to)) => [from, to],
                _ => [0.0, 0.0],
            },
        }
    }

    /// Checks that the numbers are finite and the wavelengths positive and in order.
    fn check(&self) -> Result<(), MediumError> {
        let finite = |values: &[f64]| match values.iter().position(|x| !x.is_finite()) {
            Some(index) => Err(MediumError::NotFinite { index }),
            None => Ok(()),
        };
        match *self {
            Self::Constant(x) => finite(&[x]),
            Self::Formula { coefficients, range_nm, .. } => {
                finite(coefficients)?;
                finite(&range_nm)?;
                if range_nm[0] > 0.0 && range_nm[0] <= range_nm[1] {
                    Ok(())
                } else {
                    Err(MediumError::NotIncreasing { index: 0 })
                }
            }
            Self::Table { wavelength_nm, value } => {
                if wavelength_nm.is_empty() || wavelength_nm.len() != value.len() {
                    return Err(MediumError::Shape);
                }
                finite(wavelength_nm)?;
                if let Some(index) = value.iter().position(|x| x.is_infinite()) {
                    return Err(MediumError::NotFinite { index });
                }
                if value.iter().all(|x| x.is_nan()) {
                    return Err(MediumError::NotFinite { index: 0 });
                }
                let mut last = 0.0;
                match wavelength_nm.iter().position(|&nm| core::mem::replace(&mut last, nm) >= nm) {
                    Some(index) => Err(MediumError::NotIncreasing { index }),
                    None => Ok(()),
                }
            }
        }
    }

    /// The value at a wavelength in [`Dispersion::range_nm`]; NaN where a table does not know it.
    fn at(&self, nm: f64) -> f64 {
        match *self {
            Self::Constant(x) => x,
            Self::Formula { formula, coefficients, .. } => formula.evaluate(coefficients, nm * 1e-3),
            Self::Table { wavelength_nm: x, value: y } => {
                let upper = x.partition_point(|&l| l < nm);
                let row = |row: usize| Some((*x.get(row)?, *y.get(row)?));
                match (upper.checked_sub(1).and_then(row), row(upper)) {
                    // A row's own value, even beside an unknown one.
                    (_, Some((x1, y1))) if x1 <= nm => y1,
                    (Some((x0, y0)), Some((x1, y1))) => {
                        let w = (nm - x0) / (x1 - x0);
                        y0 + w * (y1 - y0)
                    }
                    (Some((_, y)), None) | (None, Some((_, y))) => y,
                    (None, None) => 0.0,
                }
            }
        }
    }
}

/// A passive, isotropic, non-magnetic medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium<'a> {
    n: Dispersion<'a>,
    k: Dispersion<'a>,
    extrapolate: Extrapolate,
}

impl<'a> Medium<'a> {
    /// The vacuum, η = 1.
    pub const VACUUM: Self =
        Self { n: Dispersion::Constant(1.0), k: Dispersion::Constant(0.0), extrapolate: Extrapolate::Refuse };

    /// A medium of one η at every wavelength.
    ///
    /// # Errors
    /// [`MediumError::NotFinite`] if n or k is NaN or infinite, [`MediumError::NotPassive`] if n ≤ 0 or k < 0.
    pub fn constant(eta: Complex64) -> Result<Self, MediumError> {
        Self::new(Dispersion::Constant(eta.re), Dispersion::Constant(eta.im), Extrapolate::Refuse)
    }

    /// A medium from its n and its k. It has data where both have; one that clamps continues n and k each beyond its
    /// own range.
    ///
    /// # Errors
    /// [`MediumError::NotFinite`], [`MediumError::NotPassive`], [`MediumError::NotIncreasing`] or
    /// [`MediumError::Shape`]. A formula that gives n ≤ 0 is found only when it is evaluated.
    pub fn new(n: Dispersion<'a>, k: Dispersion<'a>, extrapolate: Extrapolate) -> Result<Self, MediumError> {
        n.check()?;
        k.check()?;
        let bad = |x: &Dispersion<'_>, passive: fn(f64) -> bool| match *x {
            Dispersion::Constant(x) => (!passive(x)).then_some((x, 0.0)),
            Dispersion::Table { wavelength_nm, value } => {
                let mut rows = value.iter().copied().zip(wavelength_nm.iter().copied());
                rows.find(|&(value, _)| !passive(value) && !value.is_nan())
            }
            Dispersion::Formula { .. } => None,
        };
        if let Some((n, wavelength_nm)) = bad(&n, |n| n > 0.0) {
            return Err(MediumError::NotPassive { n, k: 0.0, wavelength_nm });
        }
        if let Some((k, wavelength_nm)) = bad(&k, |k| k >= 0.0) {
            return Err(MediumError::NotPassive { n: n.at(wavelength_nm), k, wavelength_nm });
        }
        Ok(Self { n, k, extrapolate })
    }

    /// The range of wavelengths for which both n and k have data, ends included. If there is none, the first end
    /// exceeds the last.
    #[must_use]
    pub fn range_nm(&self) -> [f64; 2] {
        let ([n0, n1], [k0, k1]) = (self.n.range_nm(), self.k.range_nm());
        [n0.max(k0), n1.min(k1)]
    }

    /// The range of wavelengths for which n, or k, has data, ends included.
    #[must_use]
    pub fn part_range_nm(&self, part: IndexPart) -> [f64; 2] {
        self.part(part).range_nm()
    }

    /// n or k as a function of wavelength.
    fn part(&self, part: IndexPart) -> &Dispersion<'a> {
        match part {
            IndexPart::N => &self.n,
            IndexPart::K => &self.k,
        }
    }

    /// The value of n or k at a wavelength.
    fn value(&self, part: IndexPart, wavelength_nm: f64) -> Result<f64, MediumError> {
        let dispersion = self.part(part);
        let range_nm @ [from, to] = dispersion.range_nm();
        // Files give micrometres, and their conversion may move an end of the range by a rounding.
        let slack = 4.0 * f64::EPSILON * wavelength_nm;
        let inside = wavelength_nm >= from - slack && wavelength_nm <= to + slack;
        if !inside && self.extrapolate == Extrapolate::Refuse {
            return Err(MediumError::OutOfRange { part, wavelength_nm, range_nm });
        }
        let value = dispersion.at(wavelength_nm.max(from).min(to));
        match dispersion {
            Dispersion::Table { .. } if value.is_nan() => Err(MediumError::Unknown { part, wavelength_nm }),
            _ => Ok(value),
        }
    }

    /// The complex index η = n + ik at a vacuum wavelength in nanometres.
    ///
    /// # Errors
    /// [`MediumError::OutOfRange`] unless the medium clamps; [`MediumError::Unknown`] beside an unknown value;
    /// [`MediumError::NotPassive`] where a formula leaves the passive domain.
    pub fn eta(&self, wavelength_nm: f64) -> Result<Complex64, MediumError> {
        let n = self.value(IndexPart::N, wavelength_nm)?;
        let k = self.value(IndexPart::K, wavelength_nm)?;
        if n > 0.0 && n.is_finite() && k >= 0.0 && k.is_finite() {
            Ok(Complex64::new(n, k))
        } else {
            Err(MediumError::NotPassive { n, k, wavelength_nm })
        }
    }

    /// The complex index η of a medium in which light arrives.
    ///
    /// # Errors
    /// Those of [`Medium::eta`], and [`MediumError::Opaque`] where k exceeds [`MAX_AMBIENT_K`].
    pub fn ambient_eta(&self, wavelength_nm: f64) -> Result<Complex64, MediumError> {
        match self.eta(wavelength_nm)? {
            Complex64 { im: k, .. } if k > MAX_AMBIENT_K => Err(MediumError::Opaque { k, wavelength_nm }),
            eta => Ok(eta),
        }
    }
}

/// The media of a scene at one group of wavelengths, one wavelength in each lane.
#[derive(Clone, Copy, Debug)]
pub struct MediaLanes<'a, V: Lanes> {
    wavelength_nm: V::Precise,
    eta: &'a [ComplexLanes<V::Precise>],
}

impl<'a, V: Lanes> MediaLanes<'a, V> {
    /// Evaluates `media` at the first `V::WIDTH` of `wavelengths_nm`; where there are fewer, the last is repeated.
    /// `memory` holds one element for each medium.
    ///
    /// # Errors
    /// The index of the first medium that refuses a wavelength, with the error of [`Medium::eta`] at the first
    /// wavelength that it refuses. [`MediumError::Shape`] if there is no wavelength, one is not positive and finite, or
    /// `memory` and `media` differ in length.
    pub fn evaluate(
        media: &[Medium<'_>],
        wavelengths_nm: &[f64],
        memory: &'a mut [ComplexLanes<V::Precise>],
    ) -> Result<Self, (usize, MediumError)> {
        let Some(&last) = wavelengths_nm.last() else { return Err((0, MediumError::Shape)) };
        let positive = wavelengths_nm.iter().all(|&nm| nm > 0.0 && nm.is_finite());
        if memory.len() != media.len() || !positive {
            return Err((0, MediumError::Shape));
        }
        let nm = |lane: usize| wavelengths_nm.get(lane).copied().unwrap_or(last);
        for (index, (medium, out)) in media.iter().zip(memory.iter_mut()).enumerate() {
            let mut refused = None;
            *out = ComplexLanes::from_fn(|lane| {
                medium.eta(nm(lane)).unwrap_or_else(|error| {
                    refused.get_or_insert(error);
                    Complex64::new(1.0, 0.0)
                })
            });
            if let Some(error) = refused {
                return Err((index, error));
            }
        }
        Ok(Self { wavelength_nm: <V::Precise as Lanes>::from_fn(nm), eta: memory })
    }

    /// The complex index η of a medium; 1 beyond the last medium.
    #[inline]
    pub fn eta_of(&self, medium: MediumIndex) -> ComplexLanes<V::Precise> {
        self.eta.get(usize::from(medium)).copied().unwrap_or_else(ComplexLanes::one)
    }

    /// The vacuum wavelengths in nanometres.
    pub fn wavelength_nm(&self) -> V::Precise {
        self.wavelength_nm
    }

    /// The complex indices η of the media, in the order of the scene.
    pub fn eta(&self) -> &'a [ComplexLanes<V::Precise>] {
        self.eta
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_interpolates_and_names_its_range() {
        let medium = Medium::new(
            Dispersion::Table { wavelength_nm: &[400.0, 600.0], value: &[1.5, 1.7] },
            Dispersion::Constant(0.0),
            Extrapolate::Refuse,
        )
        .unwrap();
        assert!((medium.eta(450.0).unwrap().re - 1.55).abs() < 1e-12);
        assert!((medium.eta(600.0).unwrap().re - 1.7).abs() < 1e-12);
        assert_eq!(
            medium.eta(700.0),
            Err(MediumError::OutOfRange { part: IndexPart::N, wavelength_nm: 700.0, range_nm: [400.0, 600.0] })
        );
        let clamped = Medium { extrapolate: Extrapolate::Clamp, ..medium };
        assert!((clamped.eta(700.0).unwrap().re - 1.7).abs() < 1e-12);
    }

    #[test]
    fn gain_disorder_and_nonsense_are_refused_by_place() {
        let k = |value| Medium::new(Dispersion::Constant(1.5), Dispersion::Constant(value), Extrapolate::Refuse);
        assert!(matches!(k(-0.1), Err(MediumError::NotPassive { .. })));
        assert!(matches!(k(f64::NAN), Err(MediumError::NotFinite { index: 0 })));
        let table = |wavelength_nm: &'static [f64]| {
            Medium::new(
                Dispersion::Table { wavelength_nm, value: &[1.5, 1.5, 1.5] },
                Dispersion::Constant(0.0),
                Extrapolate::Refuse,
            )
        };
        assert_eq!(table(&[400.0, 500.0, 450.0]), Err(MediumError::NotIncreasing { index: 2 }));
        assert_eq!(table(&[400.0, 500.0]), Err(MediumError::Shape));
    }

    #[test]
    fn a_value_that_is_not_known_is_missing_up_to_its_neighbours() {
        let value = &[1.5, 1.6, f64::NAN, 1.7, 1.8];
        let n = Dispersion::Table { wavelength_nm: &[400.0, 500.0, 550.0, 600.0, 700.0], value };
        let medium = Medium::new(n, Dispersion::Constant(0.0), Extrapolate::Refuse).unwrap();
        for (nm, n) in [(450.0, 1.55), (500.0, 1.6), (600.0, 1.7), (650.0, 1.75)] {
            assert!((medium.eta(nm).unwrap().re - n).abs() < 1e-12, "{nm}");
        }
        for wavelength_nm in [500.1, 550.0, 599.9] {
            assert_eq!(medium.eta(wavelength_nm), Err(MediumError::Unknown { part: IndexPart::N, wavelength_nm }));
        }
        let blank = Dispersion::Table { wavelength_nm: &[400.0, 500.0], value: &[f64::NAN; 2] };
        let refused = Medium::new(blank, Dispersion::Constant(0.0), Extrapolate::Refuse);
        assert_eq!(refused, Err(MediumError::NotFinite { index: 0 }));
    }

    #[test]
    fn n_and_k_are_clamped_each_by_itself() {
        let table = |wavelength_nm, value| Dispersion::Table { wavelength_nm, value };
        let (n, k) = (table(&[400.0, 500.0], &[1.5, 1.6]), table(&[600.0, 700.0], &[0.2, 0.1]));
        let clamped = Medium::new(n, k, Extrapolate::Clamp).unwrap();
        assert_eq!(clamped.eta(550.0), Ok(Complex64::new(1.6, 0.2)));
        assert_eq!(clamped.eta(650.0).unwrap().re, 1.6);
        let strict = Medium::new(n, k, Extrapolate::Refuse).unwrap();
        let refused = MediumError::OutOfRange { part: IndexPart::K, wavelength_nm: 450.0, range_nm: [600.0, 700.0] };
        assert_eq!(strict.eta(450.0), Err(refused));
    }

    #[test]
    fn light_arrives_through_faint_absorption_alone() {
        let medium = |k| Medium::constant(Complex64::new(1.5, k)).unwrap();
        assert_eq!(medium(1e-8).ambient_eta(550.0), Ok(Complex64::new(1.5, 1e-8)));
        assert!(medium(MAX_AMBIENT_K).ambient_eta(550.0).is_ok());
        let (k, wavelength_nm) = (1.01e-3, 550.0);
        assert_eq!(medium(k).ambient_eta(wavelength_nm), Err(MediumError::Opaque { k, wavelength_nm }));
    }

    #[test]
    fn the_first_wavelength_without_data_is_named() {
        use crate::simd::lanes::F32;
        let n = Dispersion::Table { wavelength_nm: &[400.0, 600.0], value: &[1.5, 1.7] };
        let media = [Medium::new(n, Dispersion::Constant(0.0), Extrapolate::Refuse).unwrap()];
        let mut eta = [ComplexLanes::zero()];
        let refused = MediaLanes::<F32>::evaluate(&media, &[380.0, 385.0, 390.0, 395.0], &mut eta).unwrap_err();
        assert!(matches!(refused, (0, MediumError::OutOfRange { wavelength_nm: 380.0, .. })), "{refused:?}");
    }
}
