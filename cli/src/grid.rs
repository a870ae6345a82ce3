//! Angles and wavelengths as the command line gives them.

use std::str::FromStr;

use goniochrome::colour::VISIBLE_NM;

use crate::error::{Error, Result};
use crate::planar::Planar;
use crate::table::{MAX_ANGLES, MAX_WAVELENGTHS};

/// `380,436,546`, `380:780:5`, `auto` or `420:700:auto`.
#[derive(Debug, Clone, PartialEq)]
pub enum Wavelengths {
    /// These.
    List(Vec<f64>),
    /// Evenly from the first to the last, as many as the scene's longest optical path needs.
    Auto([f64; 2]),
}

/// `0,30,60` or `0:85:5`, degrees in [0, 90).
#[derive(Debug, Clone, PartialEq)]
pub struct Angles(pub Vec<f64>);

/// A list, or a range with a step, that increases.
fn numbers(text: &str, what: &str, most: usize) -> std::result::Result<Vec<f64>, String> {
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
            // The last step may miss the end by the rounding of the division.
            let steps = ((end - start) / step * (1.0 + 4.0 * f64::EPSILON)).floor();
            if steps >= most as f64 {
                return Err(format!("{:.0} {what} are more than the {most} allowed", steps + 1.0));
            }
            (0..=steps as usize).map(|i| start + i as f64 * step).collect()
        }
        _ => return Err("expected a list a,b,c or a range start:end:step".into()),
    };
    if values.len() > most {
        return Err(format!("{} {what} are more than the {most} allowed", values.len()));
    }
    match values.windows(2).find(|pair| pair[0] >= pair[1]) {
        Some(pair) => Err(format!("{what} must increase: {} does not come after {}", pair[1], pair[0])),
        None => Ok(values),
    }
}

impl FromStr for Wavelengths {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let [first, last] = VISIBLE_NM.map(f64::from);
        if text == "auto" {
            return Ok(Self::Auto([first, last]));
        }
        let positive = |values: Vec<f64>| match values.iter().find(|nm| **nm <= 0.0) {
            Some(nm) => Err(format!("wavelength {nm} nm must be positive")),
            None => Ok(values),
        };
        if let Some(range) = text.strip_suffix(":auto") {
            return match positive(numbers(&range.replace(':', ","), "wavelengths", 2)?)?[..] {
                [first, last] => Ok(Self::Auto([first, last])),
                _ => Err("expected start:end:auto".into()),
            };
        }
        positive(numbers(text, "wavelengths", MAX_WAVELENGTHS)?).map(Self::List)
    }
}

impl FromStr for Angles {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let values = numbers(text, "angles", MAX_ANGLES)?;
        match values.iter().find(|theta| !(0.0..90.0).contains(*theta)) {
            Some(theta) => Err(format!("angle {theta} lies outside [0, 90) degrees")),
            None => Ok(Self(values)),
        }
    }
}

/// Samples per interference fringe at the shortest wavelength. Four keep cubic interpolation of a sine within 2 %, and colour
/// sums over many fringes, which average that out, within 2e-3 (`tests/colour.rs`).
const SAMPLES_PER_FRINGE: f64 = 4.0;
/// The observer and the dispersion of materials are smooth over this step.
const COARSEST_STEP_NM: f64 = 10.0;

impl Wavelengths {
    /// The visible range in even steps.
    #[must_use]
    pub fn every(step_nm: f64) -> Self {
        let [first, last] = VISIBLE_NM.map(f64::from);
        Self::List((0..=((last - first) / step_nm) as u32).map(|i| first + f64::from(i) * step_nm).collect())
    }

    /// The wavelengths to compute for a scene.
    ///
    /// # Errors
    /// If `auto` needs more than a table can hold, or a medium has no data in the range.
    pub fn resolve(&self, planar: &Planar<'_>) -> Result<Vec<f64>> {
        let [first, last] = match self {
            Self::List(list) => return Ok(list.clone()),
            Self::Auto(range) => *range,
        };
        // Light crosses the stack and returns: fringes are λ²/path apart, closest at the short end.
        let path = 2.0 * planar.longest_optical_path_nm([first, last])?;
        let step = (first * first / (path * SAMPLES_PER_FRINGE)).min(COARSEST_STEP_NM);
        let intervals = ((last - first) / step).ceil().max(1.0);
        if intervals >= MAX_WAVELENGTHS as f64 {
            return Err(Error::failed(format_args!(
                "{}: an optical path of {:.0} nm needs {intervals:.0} wavelengths, more than the {MAX_WAVELENGTHS} allowed; \
                 give a narrower range start:end:auto or name the wavelengths",
                planar.scene().name,
                path / 2.0
            )));
        }
        let step = (last - first) / intervals;
        Ok((0..=intervals as usize).map(|i| (first + i as f64 * step).min(last)).collect())
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
        assert_eq!("0:85:5".parse::<Angles>().map(|a| a.0.len()), Ok(18));
        assert_eq!("0:0.3:0.1".parse::<Angles>().map(|a| a.0.len()), Ok(4));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |text: &str| text.parse::<Wavelengths>().unwrap_err();
        assert!(wrong("500,400").contains("must increase"));
        assert!(wrong("0,400").contains("must be positive"));
        assert!(wrong("-5").contains("must be positive"));
        assert!(wrong("400:500:-1").contains("start:end:step"));
        assert!(wrong("400:500:1e-9").contains("more than the 8192 allowed"));
        assert!(wrong("nan").contains("not a number"));
        assert!(wrong("").contains("not a number"));
        assert!("90".parse::<Angles>().unwrap_err().contains("[0, 90)"));
        assert!("-1".parse::<Angles>().unwrap_err().contains("[0, 90)"));
    }
}
