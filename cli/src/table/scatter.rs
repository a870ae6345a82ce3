//! BRDF table of a cell of tilted facets in memory.

use goniochrome::table::{FacetLobe, HalfVectorWarp, ScatterLayout, ScatterTable as Lookup};

use crate::support::error::{Error, Result};
use crate::support::memory::filled;
use crate::table::metadata::Metadata;
use crate::table::mirror::{MAX_WAVELENGTHS, check_wavelengths};
use crate::table::statistics::MeanWithError;

/// Maximum number of values of a table in one channel: 16 × 32 incident directions by 64 × 128 nodes.
pub const MAX_COUNT: usize = 1 << 22;

/// Largest product of values and wavelengths of a table: 512 MiB.
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

/// BRDF table of a cell of facets, spectral and RGB, unpolarised: s = f(wi, wo) cos θ_i cos θ_o in 1/sr at the nodes of
/// the layout's square of half vectors, and the fraction ρ of the light that each lobe of flat facets reflects.
///
/// Each incident direction has the places of [`ScatterLayout::places`]: nodes, then lobes.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterTable {
    /// Grid of directions.
    pub layout: ScatterLayout,
    /// Densities of the warp over u and over v, at equally spaced knots: see [`HalfVectorWarp`].
    pub warp: [Vec<f32>; 2],
    /// Lobes of flat facets, as many as the layout says.
    pub lobes: Vec<FacetLobe>,
    /// Vacuum wavelengths in nanometres, strictly increasing and positive.
    pub wavelength_nm: Vec<f64>,
    /// s and ρ, `[incident][wavelength][place]`, row-major, not negative.
    pub values: Vec<f32>,
    /// Linear RGB of s and ρ, `[incident][place]`; components may be negative.
    pub rgb: Vec<[f32; 3]>,
    /// Standard error of the luminance of s and ρ, `[incident][place]`, not negative.
    pub luminance_error: Vec<f32>,
    /// Energy balance of each incident direction.
    pub energy: Vec<Energy>,
    /// Provenance of the table: scene, seed, colour space.
    pub metadata: Metadata,
}

/// Values of a [`ScatterTable`] in some channels, ready to be looked up.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterLookup {
    layout: ScatterLayout,
    /// Pairs of density and integral of the warp over u and over v.
    pairs: [Vec<f32>; 2],
    lobes: Vec<[f32; FacetLobe::LEN]>,
    /// `[incident][place][channel]`.
    values: Vec<f32>,
    channels: usize,
}

impl ScatterLookup {
    /// The table that looks the values up.
    ///
    /// # Errors
    /// A value that is not finite.
    pub fn table(&self) -> Result<Lookup<'_>> {
        let [u, v] = &self.pairs;
        let warp = HalfVectorWarp::from_pairs(u, v).map_err(Error::failed)?;
        Lookup::new(&self.values, self.layout, warp, &self.lobes, self.channels).map_err(Error::failed)
    }

    /// Number of channels.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Grid of directions.
    #[must_use]
    pub fn layout(&self) -> ScatterLayout {
        self.layout
    }

    /// All values, `[incident][place][channel]`.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// All values, to be changed.
    pub fn values_mut(&mut self) -> &mut [f32] {
        &mut self.values
    }
}

/// Pairs of density and integral of the warp of these densities, over u and over v.
///
/// # Errors
/// Densities that are too few or too many, not finite, or too small.
pub(crate) fn warp_pairs([u, v]: &[Vec<f32>; 2]) -> Result<[Vec<f32>; 2]> {
    let mut memory = vec![0.0; HalfVectorWarp::required_len([u.len(), v.len()])];
    HalfVectorWarp::new([u, v], &mut memory).map_err(Error::failed)?;
    let of_v = memory.split_off(2 * u.len());
    Ok([memory, of_v])
}

impl ScatterTable {
    /// Values at each place for one incident direction and wavelength.
    #[must_use]
    pub fn row(&self, incident: usize, wavelength: usize) -> &[f32] {
        let places = self.layout.places();
        &self.values[(incident * self.wavelength_nm.len() + wavelength) * places..][..places]
    }

    /// Values of one place at each wavelength; places count as in `rgb`.
    pub fn spectrum(&self, place: usize) -> impl Iterator<Item = f32> {
        let (incident, place) = (place / self.layout.places(), place % self.layout.places());
        (0..self.wavelength_nm.len()).map(move |wavelength| self.row(incident, wavelength)[place])
    }

    /// The look-up of values in channels of the caller's, `[incident][place][channel]`.
    ///
    /// # Errors
    /// A warp without sense.
    pub fn lookup(&self, values: Vec<f32>, channels: usize) -> Result<ScatterLookup> {
        let lobes = self.lobes.iter().map(FacetLobe::to_numbers).collect();
        Ok(ScatterLookup { layout: self.layout, pairs: warp_pairs(&self.warp)?, lobes, values, channels })
    }

    /// The look-up of the table's own RGB.
    ///
    /// # Errors
    /// A warp without sense.
    pub fn rgb_lookup(&self) -> Result<ScatterLookup> {
        self.lookup(self.rgb.as_flattened().to_vec(), 3)
    }

    /// The look-up of the wavelengths, a channel each.
    ///
    /// # Errors
    /// A warp without sense, or too little memory.
    pub fn spectral_lookup(&self) -> Result<ScatterLookup> {
        let channels = self.wavelength_nm.len();
        let mut values = filled(0.0, self.values.len(), "the spectra")?;
        for (place, out) in values.chunks_mut(channels).enumerate() {
            out.iter_mut().zip(self.spectrum(place)).for_each(|(out, value)| *out = value);
        }
        self.lookup(values, channels)
    }

    /// Checks sizes and values.
    ///
    /// # Errors
    /// An empty or too large table, arrays whose lengths do not fit the layout, a warp or lobes without sense,
    /// wavelengths that are not positive or do not increase, a value or standard error that is negative or not finite,
    /// a colour or energy that is not finite.
    pub fn check(&self) -> Result<()> {
        check_scatter_size(&self.layout, self.wavelength_nm.len())?;
        let count = self.layout.count();
        for (name, found, expected) in [
            ("values", self.values.len(), count * self.wavelength_nm.len()),
            ("RGB colours", self.rgb.len(), count),
            ("errors", self.luminance_error.len(), count),
            ("lobes", self.lobes.len(), self.layout.lobes()),
            ("energies", self.energy.len(), self.layout.incident_count()),
        ] {
            if found != expected {
                return Err(Error::failed(format_args!("the table has {found} {name} where {expected} belong")));
            }
        }
        check_wavelengths(&self.wavelength_nm)?;
        if let Some(value) = bad_value(&self.values) {
            return Err(Error::failed(format_args!("a value of the BRDF is {value}")));
        }
        if let Some(value) = bad_value(&self.luminance_error) {
            return Err(Error::failed(format_args!("a standard error is {value}")));
        }
        if self.rgb.iter().flatten().any(|c| !c.is_finite()) {
            return Err(Error::failed("a colour is not finite"));
        }
        self.rgb_lookup()?.table()?;
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
    let count = layout.count();
    if count > MAX_COUNT || wavelengths > MAX_WAVELENGTHS || count.saturating_mul(wavelengths) > MAX_VALUES {
        return Err(Error::failed(format_args!(
            "{count} values × {wavelengths} wavelengths are too many; \
             limits are {MAX_COUNT}, {MAX_WAVELENGTHS} and {MAX_VALUES} together"
        )));
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::{Mat3, Vec3};

    use super::*;

    /// 2 × 2 incident directions, 3 × 2 nodes and a lobe, 2 wavelengths, every value its own.
    pub(crate) fn sample() -> ScatterTable {
        let layout = ScatterLayout::new([2, 2], [3, 2], 1).unwrap();
        let count = layout.count();
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
            warp: [vec![0.5, 1.5, 1.0], vec![1.0, 2.0, 1.0]],
            lobes: vec![FacetLobe { index: 1.5, matrix: Mat3::from_diagonal(Vec3::new(1.0, 1.0, -1.0)) }],
            wavelength_nm: vec![435.833_333_333_333_3, 700.0],
            values: (0..2 * count).map(own).collect(),
            rgb: (0..count).map(|i| [own(i), -own(i), 2.0 * own(i)]).collect(),
            luminance_error: (0..count).map(|i| 0.1 * own(i)).collect(),
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
        assert_eq!(refusal(|t| t.values[5] = -1.0), "a value of the BRDF is -1");
        assert_eq!(refusal(|t| t.luminance_error[5] = f32::NAN), "a standard error is NaN");
        assert_eq!(refusal(|t| t.rgb[0][1] = f32::INFINITY), "a colour is not finite");
        assert_eq!(refusal(|t| t.energy[3].truncated = f64::NAN), "an energy is not finite");
        assert_eq!(refusal(|t| t.rgb.truncate(3)), "the table has 3 RGB colours where 28 belong");
        assert!(refusal(|t| t.wavelength_nm.clear()).contains("no wavelengths"));
        assert!(refusal(|t| t.wavelength_nm[1] = 1.0).contains("does not increase"));
        assert!(refusal(|t| t.wavelength_nm = vec![1.0; MAX_WAVELENGTHS + 1]).contains("too many"));
    }
}
