//! BRDF table of a cell of tilted facets in memory.

use goniochrome::table::ScatterLayout;

use crate::support::error::{Error, Result};
use crate::table::metadata::Metadata;
use crate::table::mirror::{MAX_WAVELENGTHS, check_wavelengths};
use crate::table::statistics::MeanWithError;

/// Maximum number of pairs of directions of a table: 16 × 32 incident by 64 × 128 outgoing.
pub const MAX_PAIRS: usize = 1 << 22;

/// Largest product of pairs of directions and wavelengths of a table: 512 MiB.
pub const MAX_VALUES: usize = 1 << 27;

/// Energy balance of one incident direction: fractions of the incident light, weighted by luminance.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Energy {
    /// Light that leaves through the top: the directional albedo.
    pub reflected: MeanWithError,
    /// Light that leaves through the bottom.
    pub transmitted: f64,
    /// Light that media absorb.
    pub absorbed: f64,
    /// Light of rays that were dropped or lost.
    pub truncated: f64,
    /// 1 less the reflected, transmitted, absorbed and truncated light. Without interference it is rounding alone;
    /// where paths interfere, power balances only on average.
    pub imbalance: MeanWithError,
    /// Fraction of starting rays that were traced without interference, since their interference series diverges.
    pub without_interference: f64,
    /// Number of starting rays.
    pub rays: u64,
}

/// BRDF table of a cell: f(wi, wo) on a grid of directions, spectral and RGB, in 1/sr, unpolarised. Values are means
/// over each outgoing bin.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterTable {
    /// Grid of directions.
    pub layout: ScatterLayout,
    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    pub wavelength_nm: Vec<f64>,
    /// f, `[incident][wavelength][bin]`, row-major, not negative.
    pub brdf: Vec<f32>,
    /// Linear RGB of f, `[incident][bin]`; components may be negative.
    pub rgb: Vec<[f32; 3]>,
    /// Standard error of the luminance of f, `[incident][bin]`, not negative.
    pub luminance_error: Vec<f32>,
    /// Energy balance of each incident direction.
    pub energy: Vec<Energy>,
    /// Provenance of the table: scene, seed, colour space.
    pub metadata: Metadata,
}

impl ScatterTable {
    /// f at each bin for one incident direction and wavelength.
    #[must_use]
    pub fn row(&self, incident: usize, wavelength: usize) -> &[f32] {
        let bins = self.layout.bins().count();
        &self.brdf[(incident * self.wavelength_nm.len() + wavelength) * bins..][..bins]
    }

    /// f of one pair of directions at each wavelength, in 1/sr; pairs count as in `rgb`.
    pub fn spectrum(&self, pair: usize) -> impl Iterator<Item = f32> {
        let bins = self.layout.bins().count();
        let (incident, bin) = (pair / bins, pair % bins);
        (0..self.wavelength_nm.len()).map(move |wavelength| self.row(incident, wavelength)[bin])
    }

    /// Checks sizes and values.
    ///
    /// # Errors
    /// An empty or too large table, arrays whose lengths do not fit the layout, wavelengths that are not positive or do
    /// not increase, a value or standard error that is negative or not finite, a colour or energy that is not finite.
    pub fn check(&self) -> Result<()> {
        check_scatter_size(&self.layout, self.wavelength_nm.len())?;
        let pairs = self.layout.count();
        for (name, found, expected) in [
            ("values", self.brdf.len(), pairs * self.wavelength_nm.len()),
            ("RGB colours", self.rgb.len(), pairs),
            ("errors", self.luminance_error.len(), pairs),
            ("energies", self.energy.len(), self.layout.incident_count()),
        ] {
            if found != expected {
                return Err(Error::failed(format_args!("the table has {found} {name} where {expected} belong")));
            }
        }
        check_wavelengths(&self.wavelength_nm)?;
        if let Some(value) = bad_value(&self.brdf) {
            return Err(Error::failed(format_args!("a value of the BRDF is {value}")));
        }
        if let Some(value) = bad_value(&self.luminance_error) {
            return Err(Error::failed(format_args!("a standard error is {value}")));
        }
        if self.rgb.iter().flatten().any(|c| !c.is_finite()) {
            return Err(Error::failed("a colour is not finite"));
        }
        let numbers = |e: &Energy| {
            let (reflected, imbalance) = (e.reflected, e.imbalance);
            let rest =
                [e.transmitted, e.absorbed, e.truncated, imbalance.value, imbalance.std_error, e.without_interference];
            [reflected.value, reflected.std_error].into_iter().chain(rest)
        };
        if self.energy.iter().flat_map(numbers).any(|x| !x.is_finite()) {
            return Err(Error::failed("an energy is not finite"));
        }
        Ok(())
    }

    /// Imbalance of largest size, among those for which `counts` is true.
    #[must_use]
    pub fn worst_imbalance(&self, counts: impl Fn(MeanWithError) -> bool) -> MeanWithError {
        let larger = |a: MeanWithError, b: MeanWithError| if b.value.abs() > a.value.abs() { b } else { a };
        let imbalances = self.energy.iter().map(|energy| energy.imbalance);
        imbalances.filter(|imbalance| counts(*imbalance)).fold(MeanWithError::default(), larger)
    }

    /// Largest standard error of a directional albedo.
    #[must_use]
    pub fn worst_error(&self) -> f64 {
        self.energy.iter().map(|energy| energy.reflected.std_error).fold(0.0, f64::max)
    }
}

/// First number that is negative or not finite. Most tables have none, so a whole chunk is tested at once.
fn bad_value(values: &[f32]) -> Option<f32> {
    let good = |x: &f32| (0.0..f32::INFINITY).contains(x);
    let sound = |chunk: &&[f32]| chunk.iter().fold(true, |sound, x| sound & good(x));
    values.chunks(1024).find(|chunk| !sound(chunk))?.iter().copied().find(|x| !good(x))
}

/// Refuses sizes that only a damaged file or a mistyped option asks for.
pub(crate) fn check_scatter_size(layout: &ScatterLayout, wavelengths: usize) -> Result<()> {
    if wavelengths == 0 {
        return Err(Error::failed("the table is empty: it has no wavelengths"));
    }
    let pairs = layout.count();
    if pairs > MAX_PAIRS || wavelengths > MAX_WAVELENGTHS || pairs.saturating_mul(wavelengths) > MAX_VALUES {
        return Err(Error::failed(format_args!(
            "{pairs} pairs of directions × {wavelengths} wavelengths are too many; \
             limits are {MAX_PAIRS}, {MAX_WAVELENGTHS} and {MAX_VALUES} together"
        )));
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use goniochrome::measure::bins::DirectionBins;

    use super::*;

    /// 2 × 2 incident directions, 2 × 4 bins, 2 wavelengths, every value its own.
    pub(crate) fn sample() -> ScatterTable {
        let layout = ScatterLayout::new(2, 2, DirectionBins { cos: 2, phi: 4 }).unwrap();
        let pairs = layout.count();
        let own = |i: usize| 1.0 / (i as f32 + 3.0);
        let energy = |i: usize| Energy {
            reflected: MeanWithError { value: 1.0 / (i as f64 + 3.0), std_error: 1e-3 / 7.0 },
            transmitted: 0.25,
            absorbed: -1e-17,
            truncated: 1.0 / 3.0,
            imbalance: MeanWithError { value: -1e-3 / 7.0, std_error: 1e-4 / 3.0 },
            without_interference: 1.0 / 7.0,
            rays: 4096 << i,
        };
        ScatterTable {
            layout,
            wavelength_nm: vec![435.833_333_333_333_3, 700.0],
            brdf: (0..2 * pairs).map(own).collect(),
            rgb: (0..pairs).map(|i| [own(i), -own(i), 2.0 * own(i)]).collect(),
            luminance_error: (0..pairs).map(|i| 0.1 * own(i)).collect(),
            energy: (0..4).map(energy).collect(),
            metadata: [("scene", "bumps")].into_iter().collect(),
        }
    }

    #[test]
    fn each_kind_of_damage_is_named() {
        sample().check().unwrap();
        let refusal = |damage: fn(&mut ScatterTable)| {
            let mut table = sample();
            damage(&mut table);
            table.check().unwrap_err().to_string()
        };
        assert_eq!(refusal(|t| t.brdf[5] = -1.0), "a value of the BRDF is -1");
        assert_eq!(refusal(|t| t.luminance_error[5] = f32::NAN), "a standard error is NaN");
        assert_eq!(refusal(|t| t.rgb[0][1] = f32::INFINITY), "a colour is not finite");
        assert_eq!(refusal(|t| t.energy[3].truncated = f64::NAN), "an energy is not finite");
        assert_eq!(refusal(|t| t.rgb.truncate(3)), "the table has 3 RGB colours where 32 belong");
        assert!(refusal(|t| t.wavelength_nm.clear()).contains("no wavelengths"));
        assert!(refusal(|t| t.wavelength_nm[1] = 1.0).contains("does not increase"));
        assert!(refusal(|t| t.wavelength_nm = vec![1.0; MAX_WAVELENGTHS + 1]).contains("too many"));
    }
}
