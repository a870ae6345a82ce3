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

/// Maximum number of thicknesses of a table.
pub const MAX_THICKNESSES: usize = 4096;

/// BRDF table of a mirror-like surface: the reflectance ρ(θ, λ) of light that leaves at its angle of incidence, and the
/// transmittance where the light goes on behind the surface.
///
/// A table over the thickness of a layer has these once for each thickness: its rows are `[thickness][theta]`. Other
/// tables have one row for each angle.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MirrorTable {
    /// Angles from the normal in degrees, strictly increasing in 0..=90.
    pub theta_deg: Vec<f64>,
    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    pub wavelength_nm: Vec<f64>,
    /// Thicknesses of a layer, in a table over them.
    pub thickness: Option<ThicknessAxis>,
    /// Power reflectance of s light, `[row][wavelength]`, row-major.
    pub reflectance_s: Vec<f32>,
    /// Power reflectance of p light, `[row][wavelength]`, row-major.
    pub reflectance_p: Vec<f32>,
    /// Linear RGB of the reflectance per row; components may be negative or above 1. Empty where no wavelength is
    /// visible.
    pub rgb: Vec<[f32; 3]>,
    /// Power transmittance of s light like the reflectance, or empty: the medium behind absorbs light.
    pub transmittance_s: Vec<f32>,
    /// Power transmittance of p light like the reflectance, or empty.
    pub transmittance_p: Vec<f32>,
    /// Linear RGB of the transmittance per row, or empty.
    pub rgb_transmitted: Vec<[f32; 3]>,
    /// Provenance of the table: scene, model, colour space.
    pub metadata: Metadata,
}

/// The layer whose thickness varies within a table, and its thicknesses.
#[derive(Debug, Clone, PartialEq)]
pub struct ThicknessAxis {
    /// The layer, counted from 1 at the top.
    pub layer: usize,
    /// Thicknesses in nanometres, strictly increasing and not negative, at least two.
    pub nm: Vec<f64>,
}

impl ThicknessAxis {
    /// The first and the last thickness.
    #[must_use]
    pub fn range_nm(&self) -> [f64; 2] {
        [self.nm[0], self.nm[self.nm.len() - 1]]
    }
}

impl MirrorTable {
    /// Checks sizes and values.
    ///
    /// # Errors
    /// An empty or too large table, arrays whose lengths do not fit together, angles, wavelengths or thicknesses that
    /// are out of range or do not increase, a power that is negative or not finite, a colour that is not finite.
    pub fn check(&self) -> Result<()> {
        let (angles, wavelengths) = (self.theta_deg.len(), self.wavelength_nm.len());
        check_size(self.thicknesses(), angles, wavelengths)?;
        let (rows, samples) = (self.rows(), self.rows() * wavelengths);
        let colours = if visible(&self.wavelength_nm) { rows } else { 0 };
        check_axis("theta_deg", &self.theta_deg, |theta| (0.0..=90.0).contains(&theta))?;
        check_wavelengths(&self.wavelength_nm)?;
        if let Some(ThicknessAxis { layer, nm }) = &self.thickness {
            check_axis("thickness_nm", nm, |nm| nm >= 0.0 && nm.is_finite())?;
            if *layer == 0 || nm.len() < 2 {
                return Err(Error::failed(format_args!("the table has {} thicknesses of layer {layer}", nm.len())));
            }
        }
        let [through, colours_through] = if self.is_transparent() { [samples, colours] } else { [0; 2] };
        // The paper's flux is an amplitude sum and may exceed 1, so only sign and finiteness are checked.
        for (name, values, belong) in [
            ("s reflectance", &self.reflectance_s, samples),
            ("p reflectance", &self.reflectance_p, samples),
            ("s transmittance", &self.transmittance_s, through),
            ("p transmittance", &self.transmittance_p, through),
        ] {
            check_count(&format!("{name}s"), values.len(), belong)?;
            if let Some(i) = values.iter().position(|power| !power.is_finite() || *power < 0.0) {
                let (place, nm) = (self.place(i / wavelengths), self.wavelength_nm[i % wavelengths]);
                return Err(Error::failed(format_args!("{name} at {place} and {nm} nm is {}", values[i])));
            }
        }
        for (name, colours, belong) in
            [("colour", &self.rgb, colours), ("transmitted colour", &self.rgb_transmitted, colours_through)]
        {
            check_count(&format!("RGB {name}s"), colours.len(), belong)?;
            if let Some(row) = colours.iter().position(|rgb| rgb.iter().any(|c| !c.is_finite())) {
                return Err(Error::failed(format_args!("the {name} at {} is not finite", self.place(row))));
            }
        }
        Ok(())
    }

    /// The number of thicknesses; 1 for a table of one surface.
    #[must_use]
    pub fn thicknesses(&self) -> usize {
        self.thickness.as_ref().map_or(1, |axis| axis.nm.len())
    }

    /// The number of rows: one for each thickness and angle.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.thicknesses() * self.theta_deg.len()
    }

    /// Whether the table holds transmitted light.
    #[must_use]
    pub fn is_transparent(&self) -> bool {
        !self.transmittance_s.is_empty()
    }

    /// The angle and the thickness of a row, to be named in a message.
    fn place(&self, row: usize) -> String {
        let theta = self.theta_deg[row % self.theta_deg.len()];
        match &self.thickness {
            Some(axis) => format!("{theta}°, thickness {} nm", axis.nm[row / self.theta_deg.len()]),
            None => format!("{theta}°"),
        }
    }

    /// The table of the surface where the layer that varies is so thick: linear between the table's thicknesses,
    /// constant beyond them. A table of one surface stays as it is.
    #[must_use]
    pub fn at_thickness(&self, thickness_nm: f64) -> Self {
        let Some(axis) = &self.thickness else { return self.clone() };
        let (below, above, weight) = neighbours(&axis.nm, thickness_nm);
        Self {
            thickness: None,
            reflectance_s: between(&self.reflectance_s, axis.nm.len(), below, above, weight),
            reflectance_p: between(&self.reflectance_p, axis.nm.len(), below, above, weight),
            rgb: colours_between(&self.rgb, axis.nm.len(), below, above, weight),
            transmittance_s: between(&self.transmittance_s, axis.nm.len(), below, above, weight),
            transmittance_p: between(&self.transmittance_p, axis.nm.len(), below, above, weight),
            rgb_transmitted: colours_between(&self.rgb_transmitted, axis.nm.len(), below, above, weight),
            theta_deg: self.theta_deg.clone(),
            wavelength_nm: self.wavelength_nm.clone(),
            metadata: self.metadata.clone(),
        }
    }

    /// Linear RGB of the reflectance per row.
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

    /// Unpolarised reflectance, the mean of s and p, `[row][wavelength]`.
    pub fn unpolarised(&self) -> impl Iterator<Item = f64> {
        means(&self.reflectance_s, &self.reflectance_p)
    }

    /// Unpolarised transmittance like [`MirrorTable::unpolarised`]; nothing in a table without.
    pub fn unpolarised_transmittance(&self) -> impl Iterator<Item = f64> {
        means(&self.transmittance_s, &self.transmittance_p)
    }

    /// Linear RGB at any angle, interpolated between its neighbours and constant beyond the ends; that of the first
    /// thickness, where a table has several.
    ///
    /// # Panics
    /// If the table has no colours.
    #[must_use]
    pub fn rgb_at(&self, theta_deg: f64) -> [f32; 3] {
        self.rgb_of(0, theta_deg)
    }

    /// Linear RGB of one of the table's thicknesses at any angle, interpolated between its neighbours and constant
    /// beyond the ends.
    ///
    /// # Panics
    /// If the table has no colours, or no such thickness.
    #[must_use]
    pub fn rgb_of(&self, thickness: usize, theta_deg: f64) -> [f32; 3] {
        let (below, above, weight) = neighbours(&self.theta_deg, theta_deg);
        let [low, high] = [below, above].map(|angle| self.rgb[thickness * self.theta_deg.len() + angle]);
        let weight = weight as f32;
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

/// Means of the powers of s and p.
fn means(s: &[f32], p: &[f32]) -> impl Iterator<Item = f64> {
    s.iter().zip(p).map(|(&s, &p)| 0.5 * (f64::from(s) + f64::from(p)))
}

/// Values of a row of blocks, between two of its blocks.
fn between(values: &[f32], blocks: usize, below: usize, above: usize, weight: f64) -> Vec<f32> {
    let (length, weight) = (values.len() / blocks, weight as f32);
    let block = |at: usize| &values[at * length..][..length];
    block(below).iter().zip(block(above)).map(|(low, high)| (1.0 - weight) * low + weight * high).collect()
}

fn colours_between(colours: &[[f32; 3]], blocks: usize, below: usize, above: usize, weight: f64) -> Vec<[f32; 3]> {
    between(colours.as_flattened(), blocks, below, above, weight).as_chunks().0.to_vec()
}

fn check_count(name: &str, found: usize, expected: usize) -> Result<()> {
    if found != expected {
        return Err(Error::failed(format_args!("the table has {found} {name} where {expected} belong")));
    }
    Ok(())
}

/// Refuses empty tables, and sizes that only a damaged file asks for.
pub(crate) fn check_size(thicknesses: usize, angles: usize, wavelengths: usize) -> Result<()> {
    let by = if thicknesses == 1 { String::new() } else { format!("{thicknesses} thicknesses × ") };
    if thicknesses == 0 || angles == 0 || wavelengths == 0 {
        return Err(Error::failed(format_args!("the table is empty: {by}{angles} angles × {wavelengths} wavelengths")));
    }
    if thicknesses > MAX_THICKNESSES
        || angles > MAX_ANGLES
        || wavelengths > MAX_WAVELENGTHS
        || thicknesses * angles * wavelengths > MAX_SAMPLES
    {
        let by_limit = if thicknesses == 1 { String::new() } else { format!("{MAX_THICKNESSES}, ") };
        return Err(Error::failed(format_args!(
            "{by}{angles} angles × {wavelengths} wavelengths are too many; \
             limits are {by_limit}{MAX_ANGLES}, {MAX_WAVELENGTHS} and {MAX_SAMPLES} together"
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
            transmittance_s: vec![0.9, 0.8, 0.6, 0.5, 0.25, 0.0],
            transmittance_p: vec![1.0, 0.3, 0.5, 0.1, 0.7, 1.0 / 7.0],
            rgb_transmitted: vec![[0.9, 0.7, 0.11], [0.1, 0.2, 0.3], [1.5, 0.1, -0.2]],
            thickness: None,
            metadata: [("scene", "três \"films\"\nn = 2.4, θ"), ("model", "physical"), ("note", "")]
                .into_iter()
                .collect(),
        }
    }

    /// [`sample`] at 0 nm and without light at 40 nm, transparent no more.
    pub(crate) fn family() -> MirrorTable {
        let mut table = sample();
        table.thickness = Some(ThicknessAxis { layer: 2, nm: vec![0.0, 40.0] });
        table.reflectance_s.extend([0.0; 6]);
        table.reflectance_p.extend([0.0; 6]);
        table.rgb.extend([[0.0; 3]; 3]);
        table.transmittance_s.clear();
        table.transmittance_p.clear();
        table.rgb_transmitted.clear();
        table
    }

    #[test]
    fn a_family_is_linear_between_thicknesses() {
        family().check().unwrap();
        let at = family().at_thickness(30.0);
        at.check().unwrap();
        assert_eq!((at.rows(), at.reflectance_s[4], at.rgb[1]), (3, 0.125, [0.125; 3]));
        assert_eq!(family().at_thickness(-5.0).rgb, sample().rgb);
        assert_eq!(sample().at_thickness(30.0), sample());
        let mut damaged = family();
        damaged.reflectance_p[7] = -1.0;
        let place = "p reflectance at 0°, thickness 40 nm and 700 nm is -1";
        assert_eq!(damaged.check().unwrap_err().to_string(), place);
        damaged.thickness = Some(ThicknessAxis { layer: 2, nm: vec![40.0, 40.0] });
        assert!(damaged.check().unwrap_err().to_string().contains("thickness_nm does not increase"));
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
