//! Lists and ranges of angles and wavelengths, as written on the command line.

use std::str::FromStr;

use goniochrome::colour::{Illuminant, VISIBLE_NM};

use crate::solve::planar_scene::PlanarScene;
use crate::solve::refine::{Choice, choose};
use crate::solve::spectra::SpectraRequest;
use crate::support::error::Result;
use crate::table::mirror::{MAX_ANGLES, MAX_WAVELENGTHS};

/// Wavelengths to compute, written as `380,436,546`, `380:780:5`, `auto` or `420:700:auto`.
#[derive(Debug, Clone, PartialEq)]
pub enum Wavelengths {
    /// The listed wavelengths, in the given order.
    List(Vec<f64>),
    /// As many wavelengths as the colours of the scene need, from the first to the last.
    Auto([f64; 2]),
}

/// Angles in degrees in [0, 90], in the given order, written as `0,30,60` or `0:85:5`.
#[derive(Debug, Clone, PartialEq)]
pub struct Angles(pub Vec<f64>);

/// Parses a list, or a range with a step, of at most `max` numbers.
fn numbers(text: &str, what: &str, max: usize) -> std::result::Result<Vec<f64>, String> {
    let number = |field: &str| {
        let value = field.trim().parse::<f64>().ok().filter(|x| x.is_finite());
        value.ok_or_else(|| format!("{field:?} is not a number"))
    };
    let values = match text.split(':').collect::<Vec<_>>()[..] {
        [_] => text.split(',').map(number).collect::<std::result::Result<Vec<_>, _>>()?,
        [start, end, step] => {
            let (start, end, step) = (number(start)?, number(end)?, number(step)?);
            if !(step > 0.0 && end >= start) {
                return Err("a range is start:end:step with end >= start and step > 0".into());
            }
            // Rounding of the division must not drop the end.
            let steps = ((end - start) / step * (1.0 + 4.0 * f64::EPSILON)).floor();
            if steps >= max as f64 {
                return Err(format!("{:.0} {what} are more than the {max} allowed", steps + 1.0));
            }
            (0..=steps as usize).map(|i| start + i as f64 * step).collect()
        }
        _ => return Err("expected a list a,b,c or a range start:end:step".into()),
    };
    if values.len() > max {
        return Err(format!("{} {what} are more than the {max} allowed", values.len()));
    }
    Ok(values)
}

/// The shortest wavelength: below any X-ray that has an index; the phase of a film of a metre still has digits.
const MIN_WAVELENGTH_NM: f64 = 1e-3;

impl FromStr for Wavelengths {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        if text == "auto" {
            return Ok(Self::VISIBLE);
        }
        let positive = |values: Vec<f64>| match values.iter().find(|nm| **nm < MIN_WAVELENGTH_NM) {
            Some(nm) if *nm > 0.0 => Err(format!("wavelength {nm} nm is shorter than {MIN_WAVELENGTH_NM} nm")),
            Some(nm) => Err(format!("wavelength {nm} nm must be positive")),
            None => Ok(values),
        };
        if let Some(range) = text.strip_suffix(":auto") {
            return match positive(numbers(&range.replace(':', ","), "wavelengths", 2)?)?[..] {
                [first, last] if first < last => Ok(Self::Auto([first, last])),
                _ => Err("expected start:end:auto with end > start".into()),
            };
        }
        positive(numbers(text, "wavelengths", MAX_WAVELENGTHS)?).map(Self::List)
    }
}

impl FromStr for Angles {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let values = numbers(text, "angles", MAX_ANGLES)?;
        match values.iter().find(|theta| !(0.0..=90.0).contains(*theta)) {
            Some(theta) => Err(format!("angle {theta} lies outside [0, 90] degrees")),
            None => Ok(Self(values)),
        }
    }
}

impl Wavelengths {
    /// As many wavelengths of the visible range as the colours of the scene need.
    pub const VISIBLE: Self = Self::Auto([VISIBLE_NM[0] as f64, VISIBLE_NM[1] as f64]);

    /// The visible range in even steps.
    #[must_use]
    pub fn every(step_nm: f64) -> Self {
        let [first, last] = VISIBLE_NM.map(f64::from);
        Self::List((0..=((last - first) / step_nm) as u32).map(|i| first + f64::from(i) * step_nm).collect())
    }

    /// The wavelengths in increasing order, each once, as colours and tables need them.
    #[must_use]
    pub fn increasing(&self) -> Self {
        let mut sorted = self.clone();
        if let Self::List(list) = &mut sorted {
            list.sort_by(f64::total_cmp);
            list.dedup();
        }
        sorted
    }

    /// The wavelengths to compute for a scene at some angles. Listed wavelengths come without colours.
    ///
    /// # Errors
    /// For `auto`: a medium without data in the range; an ambient medium that absorbs too much; an optical path of more
    /// than some millimetres.
    pub fn resolve(
        &self,
        planar: &PlanarScene<'_>,
        theta_deg: &[f64],
        illuminant: Illuminant,
        request: &SpectraRequest,
    ) -> Result<Choice> {
        match self {
            Self::List(list) => Ok(Choice { wavelength_nm: list.clone(), xyz: Vec::new() }),
            Self::Auto(range) => choose(planar, theta_deg, *range, illuminant, request),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges_are_read() {
        assert_eq!("380:390:5".parse(), Ok(Wavelengths::List(vec![380.0, 385.0, 390.0])));
        assert_eq!("450, 550.5".parse(), Ok(Wavelengths::List(vec![450.0, 550.5])));
        assert_eq!("auto".parse(), Ok(Wavelengths::Auto([380.0, 780.0])));
        assert_eq!("420:700:auto".parse(), Ok(Wavelengths::Auto([420.0, 700.0])));
        assert_eq!("500,400,500".parse(), Ok(Wavelengths::List(vec![500.0, 400.0, 500.0])));
        assert_eq!("0:85:5".parse::<Angles>().map(|a| a.0.len()), Ok(18));
        assert_eq!("60,30,90".parse(), Ok(Angles(vec![60.0, 30.0, 90.0])));
        assert_eq!("0:0.3:0.1".parse::<Angles>().map(|a| a.0.len()), Ok(4));
    }

    #[test]
    fn tables_take_each_wavelength_once_in_order() {
        let given = Wavelengths::List(vec![500.0, 400.0, 500.0]);
        assert_eq!(given.increasing(), Wavelengths::List(vec![400.0, 500.0]));
        assert_eq!(Wavelengths::Auto([400.0, 500.0]).increasing(), Wavelengths::Auto([400.0, 500.0]));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |text: &str| text.parse::<Wavelengths>().unwrap_err();
        assert!(wrong("500:400:auto").contains("end > start"));
        assert!(wrong("0,400").contains("must be positive"));
        assert!(wrong("-5").contains("must be positive"));
        assert!(wrong("1e-300").contains("shorter than 0.001 nm"));
        assert!(wrong("400:500:-1").contains("start:end:step"));
        assert!(wrong("400:500:1e-9").contains("more than the 8192 allowed"));
        assert!(wrong("nan").contains("not a number"));
        assert!(wrong("").contains("not a number"));
        assert!("90.1".parse::<Angles>().unwrap_err().contains("[0, 90]"));
        assert!("-1".parse::<Angles>().unwrap_err().contains("[0, 90]"));
    }
}
