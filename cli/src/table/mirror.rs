//! BRDF table of a mirror-like surface in memory.

use crate::colour::visible;
use crate::support::error::{Error, Result};
use crate::table::metadata::Metadata;

/// Maximum number of angles of a table; steps of 0.01° need 9001.
pub const MAX_ANGLES: usize = 16_384;

/// Maximum number of wavelengths of a table; steps of 0.1 nm over the visible range need 4001.
pub const MAX_WAVELENGTHS: usize = 8_192;

/// Largest product of angles and wavelengths of a table: 64 MB per polarisation.
pub const MAX_SAMPLES: usize = 1 << 24;

/// BRDF table of a mirror-like surface: the reflectance ρ(θ, λ) of light that leaves at its angle of incidence.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MirrorTable {
    /// Angles from the normal in degrees, strictly increasing in 0..=90.
    pub theta_deg: Vec<f64>,
    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    pub wavelength_nm: Vec<f64>,
    /// Power reflectance of s light, `[theta][wavelength]`, row-major.
    pub reflectance_s: Vec<f32>,
    /// Power reflectance of p light, `[theta][wavelength]`, row-major.
    pub reflectance_p: Vec<f32>,
    /// Linear RGB per angle; components may be negative or above 1. Empty where no wavelength is visible.
    pub rgb: Vec<[f32; 3]>,
    /// Provenance of the table: scene, model, colour space.
    pub metadata: Metadata,
}

impl MirrorTable {
    /// Checks sizes and values.
    ///
    /// # Errors
    /// An empty or too large table, arrays whose lengths do not fit together, angles or wavelengths that are out of
    /// range or do not increase, a reflectance that is negative or not finite, a colour that is not finite.
    pub fn check(&self) -> Result<()> {
        let (angles, wavelengths) = (self.theta_deg.len(), self.wavelength_nm.len());
        check_size(angles, wavelengths)?;
        let samples = angles * wavelengths;
        check_count("s reflectances", self.reflectance_s.len(), samples)?;
        check_count("p reflectances", self.reflectance_p.len(), samples)?;
        check_axis("theta_deg", &self.theta_deg, |theta| (0.0..=90.0).contains(&theta))?;
        check_wavelengths(&self.wavelength_nm)?;
        check_count("RGB colours", self.rgb.len(), if visible(&self.wavelength_nm) { angles } else { 0 })?;
        for (name, values) in [("s", &self.reflectance_s), ("p", &self.reflectance_p)] {
            // The paper's flux is an amplitude sum and may exceed 1, so only sign and finiteness are checked.
            if let Some(i) = values.iter().position(|r| !r.is_finite() || *r < 0.0) {
                let (theta, nm) = (self.theta_deg[i / wavelengths], self.wavelength_nm[i % wavelengths]);
                let value = values[i];
                return Err(Error::failed(format_args!("{name} reflectance at {theta}° and {nm} nm is {value}")));
            }
        }
        match self.rgb.iter().position(|rgb| rgb.iter().any(|c| !c.is_finite())) {
            Some(i) => Err(Error::failed(format_args!("the colour at {}° is not finite", self.theta_deg[i]))),
            None => Ok(()),
        }
    }

    /// Linear RGB per angle.
    ///
    /// # Errors
    /// A table without colours, since none of its wavelengths is visible.
    pub fn colours(&self) -> Result<&[[f32; 3]]> {
        if self.rgb.is_empty() {
            return Err(Error::failed(
                "the table has no colour, as its wavelengths are invisible; its spectra can be drawn by --kind spectrum or map",
            ));
        }
        Ok(&self.rgb)
    }

    /// Unpolarised reflectance, the mean of s and p, `[theta][wavelength]`.
    pub fn unpolarised(&self) -> impl Iterator<Item = f64> {
        let polarised = self.reflectance_s.iter().zip(&self.reflectance_p);
        polarised.map(|(&s, &p)| 0.5 * (f64::from(s) + f64::from(p)))
    }

    /// Linear RGB at any angle, interpolated between its neighbours and constant beyond the ends.
    ///
    /// # Panics
    /// If the table has no colours.
    #[must_use]
    pub fn rgb_at(&self, theta_deg: f64) -> [f32; 3] {
        let (below, above, weight) = neighbours(&self.theta_deg, theta_deg);
        let (low, high, weight) = (self.rgb[below], self.rgb[above], weight as f32);
        std::array::from_fn(|c| low[c] + weight * (high[c] - low[c]))
    }
}

/// The places of the two neighbours of a value on an increasing axis, and the weight of the second in linear
/// interpolation. Beyond an end of the axis, both are this end and the weight is 0.
///
/// # Panics
/// If the axis is empty.
#[must_use]
pub fn neighbours(axis: &[f64], at: f64) -> (usize, usize, f64) {
    let above = axis.partition_point(|&known| known < at);
    if above == 0 || above == axis.len() {
        let end = above.min(axis.len() - 1);
        return (end, end, 0.0);
    }
    let (low, high) = (axis[above - 1], axis[above]);
    (above - 1, above, (at - low) / (high - low))
}

fn check_count(name: &str, found: usize, expected: usize) -> Result<()> {
    if found != expected {
        return Err(Error::failed(format_args!("the table has {found} {name} where {expected} belong")));
    }
    Ok(())
}

/// Refuses empty tables, and sizes that only a damaged file asks for.
pub(crate) fn check_size(angles: usize, wavelengths: usize) -> Result<()> {
    if angles == 0 || wavelengths == 0 {
        return Err(Error::failed(format_args!("the table is empty: {angles} angles × {wavelengths} wavelengths")));
    }
    if angles > MAX_ANGLES || wavelengths > MAX_WAVELENGTHS || angles * wavelengths > MAX_SAMPLES {
        return Err(Error::failed(format_args!(
            "{angles} angles × {wavelengths} wavelengths are too many; \
             limits are {MAX_ANGLES}, {MAX_WAVELENGTHS} and {MAX_SAMPLES} together"
        )));
    }
    Ok(())
}

/// Refuses wavelengths that are not positive or do not increase.
pub(crate) fn check_wavelengths(wavelength_nm: &[f64]) -> Result<()> {
    check_axis("wavelength_nm", wavelength_nm, |nm| nm > 0.0 && nm.is_finite())
}

fn check_axis(name: &str, values: &[f64], in_range: impl Fn(f64) -> bool) -> Result<()> {
    if let Some(i) = values.iter().position(|&v| !in_range(v)) {
        return Err(Error::failed(format_args!("{name}[{i}] = {} is out of range", values[i])));
    }
    match values.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(i) => Err(Error::failed(format_args!("{name} does not increase after entry {i} ({})", values[i]))),
        None => Ok(()),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// 3 angles, 2 wavelengths, values that no rounding keeps by luck.
    pub(crate) fn sample() -> MirrorTable {
        MirrorTable {
            theta_deg: vec![0.0, 1.0 / 3.0, 89.9],
            wavelength_nm: vec![435.833_333_333_333_3, 700.0],
            reflectance_s: vec![0.1, 0.2, 0.3, 0.4, 0.5, 1.2],
            reflectance_p: vec![0.0, 0.7, 1.0 / 3.0, 0.4, 0.25, 0.125],
            rgb: vec![[1.39, 0.72, -0.01], [0.5, 0.5, 0.5], [0.0, 0.1, 0.2]],
            metadata: [("scene", "três \"films\"\nn = 2.4, θ"), ("model", "physical"), ("note", "")]
                .into_iter()
                .collect(),
        }
    }

    #[test]
    fn each_kind_of_damage_is_named() {
        sample().check().unwrap();
        let refusal = |damage: fn(&mut MirrorTable)| {
            let mut table = sample();
            damage(&mut table);
            table.check().unwrap_err().to_string()
        };
        assert_eq!(
            refusal(|t| t.reflectance_p[3] = f32::NAN),
            "p reflectance at 0.3333333333333333° and 700 nm is NaN"
        );
        assert_eq!(refusal(|t| t.reflectance_s[0] = -0.5), "s reflectance at 0° and 435.8333333333333 nm is -0.5");
        assert_eq!(refusal(|t| t.rgb[2][1] = f32::INFINITY), "the colour at 89.9° is not finite");
        assert_eq!(refusal(|t| t.theta_deg[2] = 90.5), "theta_deg[2] = 90.5 is out of range");
        assert_eq!(
            refusal(|t| t.wavelength_nm[1] = 1.0),
            "wavelength_nm does not increase after entry 0 (435.8333333333333)"
        );
        assert_eq!(refusal(|t| t.wavelength_nm[0] = f64::NAN), "wavelength_nm[0] = NaN is out of range");
        assert_eq!(refusal(|t| t.rgb.truncate(2)), "the table has 2 RGB colours where 3 belong");
        assert!(refusal(|t| t.theta_deg.clear()).starts_with("the table is empty"));
        assert!(refusal(|t| t.theta_deg = vec![0.0; MAX_ANGLES + 1]).contains("are too many"));
    }

    #[expect(clippy::float_cmp, reason = "powers of two are exact")]
    #[test]
    fn colours_are_interpolated_between_angles_and_held_beyond_them() {
        let table = MirrorTable {
            theta_deg: vec![10.0, 20.0],
            rgb: vec![[0.0, 1.0, -1.0], [1.0, 0.0, 1.0]],
            ..MirrorTable::default()
        };
        assert_eq!(table.rgb_at(12.5), [0.25, 0.75, -0.5]);
        assert_eq!(table.rgb_at(0.0), table.rgb[0]);
        assert_eq!(table.rgb_at(10.0), table.rgb[0]);
        assert_eq!(table.rgb_at(20.0), table.rgb[1]);
        assert_eq!(table.rgb_at(90.0), table.rgb[1]);
    }
}
