//! The finish of a mirror-like table: its roughness, in the table's metadata or by the user's choice.

use goniochrome::microfacet::{Distribution, Finish, MAX_RINGS, Masking, mean_reflectance};

use crate::scene::{DISTRIBUTIONS, FinishFacets, MASKINGS, OwnedFacets, OwnedFinish, named};
use crate::support::error::{Error, Result};
use crate::table::metadata::{Metadata, MetadataKey};

/// The name of a value in one of the lists above.
pub(crate) fn name_of<T: Copy + PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    names.iter().find(|(_, known)| *known == value).map_or("", |(name, _)| name)
}

/// A finish of these parts.
///
/// # Errors
/// A roughness that is not from 0.001 to 1.
pub fn finish(distribution: Distribution, masking: Masking, roughness: [f64; 2]) -> Result<Finish<'static>> {
    Finish::new(distribution, masking, roughness.map(|alpha| alpha as f32)).map_err(|error| {
        let [x, y] = roughness;
        Error::usage(format_args!("a finish of roughness {x} and {y}: {error}"))
    })
}

/// Writes a finish into a table's metadata.
pub fn keep(finish: &OwnedFinish, metadata: &mut Metadata) {
    let masking = match finish.facets() {
        FinishFacets::Analytic(finish) => {
            if let (Some([x, y]), Some(distribution)) = (finish.alpha(), finish.distribution()) {
                metadata.insert(MetadataKey::FinishRoughness, format!("{x} {y}"));
                metadata.insert(MetadataKey::FinishDistribution, name_of(&DISTRIBUTIONS, distribution));
            }
            finish.masking()
        }
        FinishFacets::Tabulated(facets, masking) => {
            metadata.insert(MetadataKey::FinishDistribution, TABULATED);
            metadata.insert(MetadataKey::FinishFacets, written(facets));
            *masking
        }
    };
    metadata.insert(MetadataKey::FinishMasking, name_of(&MASKINGS, masking));
    if finish.is_compensated() {
        metadata.insert(MetadataKey::FinishCompensation, "true");
    }
}

/// Name of a tabulated distribution.
pub(crate) const TABULATED: &str = "tabulated";

/// Facets as text: the numbers of rings and of sectors, and D at the nodes with four digits, as far as it is not 0.
fn written(facets: &OwnedFacets) -> String {
    let table = facets.table();
    let [rings, sectors] = table.size();
    let nodes: Vec<f32> = table.nodes().collect();
    let used = nodes.iter().rposition(|d| *d > 0.0).map_or(0, |last| last + 1);
    let mut text = format!("{rings} {sectors}");
    for d in &nodes[..used] {
        let scientific = format!("{d:.3e}");
        let plain = scientific.parse::<f32>().map_or_else(|_| String::new(), |d| d.to_string());
        text.push(' ');
        text.push_str(if plain.len() <= scientific.len() { &plain } else { &scientific });
    }
    text
}

/// Facets from their text; `None` if it is damaged.
fn read(text: &str) -> Option<OwnedFacets> {
    let mut words = text.split(' ');
    let mut size = || words.next()?.parse::<usize>().ok().filter(|size| *size <= MAX_RINGS);
    let (rings, sectors) = (size()?, size()?);
    let mut nodes = words.map(|word| word.parse().ok()).collect::<Option<Vec<f32>>>()?;
    let count = (rings + 1) * sectors;
    if nodes.len() > count {
        return None;
    }
    nodes.resize(count, 0.0);
    OwnedFacets::new([rings, sectors], &nodes).ok()
}

/// Whether a table's metadata hold a finish.
#[must_use]
pub fn is_finished(metadata: &Metadata) -> bool {
    metadata.get(MetadataKey::FinishDistribution).is_some()
}

/// The finish that a table's metadata hold.
fn kept(metadata: &Metadata) -> Result<Option<OwnedFinish>> {
    let Some(distribution) = metadata.get(MetadataKey::FinishDistribution) else { return Ok(None) };
    let damaged = |key: MetadataKey| {
        let value = metadata.get(key).unwrap_or_default();
        // A table of facets has thousands of digits.
        let shown: String = value.chars().take(SHOWN).collect();
        let key = key.as_ref();
        Error::failed(format_args!("the table's {key} is {shown:?}, which is no finish; estimate the table anew"))
    };
    let value = |key: MetadataKey| metadata.get(key).unwrap_or_default();
    let masking = named(&MASKINGS, value(MetadataKey::FinishMasking));
    let masking = masking.ok_or_else(|| damaged(MetadataKey::FinishMasking))?;
    let is_compensated = match metadata.get(MetadataKey::FinishCompensation) {
        None => false,
        Some("true") => true,
        Some(_) => return Err(damaged(MetadataKey::FinishCompensation)),
    };
    let of = |facets| Ok(Some(OwnedFinish::new(facets).compensated(is_compensated)));
    if distribution == TABULATED {
        let facets = read(value(MetadataKey::FinishFacets)).ok_or_else(|| damaged(MetadataKey::FinishFacets))?;
        return of(FinishFacets::Tabulated(facets, masking));
    }
    let distribution = named(&DISTRIBUTIONS, distribution).ok_or_else(|| damaged(MetadataKey::FinishDistribution))?;
    let numbers = value(MetadataKey::FinishRoughness).split(' ').map(|number| number.parse().ok());
    let roughness = numbers.collect::<Option<Vec<f32>>>().and_then(|numbers| <[f32; 2]>::try_from(numbers).ok());
    let finish = roughness.and_then(|roughness| Finish::new(distribution, masking, roughness).ok());
    of(FinishFacets::Analytic(finish.ok_or_else(|| damaged(MetadataKey::FinishRoughness))?))
}

/// Number of characters of damaged metadata that messages show.
const SHOWN: usize = 40;

/// What a user asks for in place of a table's finish.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FinishChoice {
    /// Roughness along x and y; 0 for a mirror.
    pub roughness: Option<[f64; 2]>,
    /// Distribution of the facets.
    pub distribution: Option<Distribution>,
    /// Whether the light of several bounces is returned.
    pub energy_compensation: Option<bool>,
}

impl FinishChoice {
    /// Whether anything is asked for.
    #[must_use]
    pub fn is_given(&self) -> bool {
        *self != Self::default()
    }

    /// The finish of a table; `None` for a mirror.
    ///
    /// # Errors
    /// Damaged metadata, or a distribution without a roughness.
    pub fn of(&self, metadata: &Metadata) -> Result<Option<OwnedFinish>> {
        self.instead_of(kept(metadata)?)
    }

    /// The finish of a surface with a finish of its own, or none; `None` for a mirror.
    ///
    /// # Errors
    /// A distribution without a roughness, or energy compensation of a mirror.
    pub fn instead_of(&self, own: Option<OwnedFinish>) -> Result<Option<OwnedFinish>> {
        let own_compensation = own.as_ref().is_some_and(OwnedFinish::is_compensated);
        let compensation = self.energy_compensation.unwrap_or(own_compensation);
        match self.rough_or_smooth(own)? {
            None if self.energy_compensation == Some(true) => Err(Error::usage(
                "--energy-compensation: a mirror loses no light to other facets; give --roughness, or leave it out",
            )),
            finish => Ok(finish.map(|finish| finish.compensated(compensation))),
        }
    }

    /// The facets of a surface with a finish of its own, or none.
    fn rough_or_smooth(&self, own: Option<OwnedFinish>) -> Result<Option<OwnedFinish>> {
        if self.roughness.is_none() && self.distribution.is_none() {
            return Ok(own);
        }
        let facets = own.as_ref().map(OwnedFinish::uncompensated);
        let own_roughness = facets.and_then(|own| own.alpha()).map(|alpha| alpha.map(f64::from));
        let distribution = self.distribution.or(facets.and_then(|own| own.distribution())).unwrap_or_default();
        let masking = facets.map_or(Masking::default(), |own| own.masking());
        match self.roughness.or(own_roughness) {
            Some([0.0, 0.0]) => Ok(None),
            Some(roughness) => finish(distribution, masking, roughness).map(OwnedFinish::analytic).map(Some),
            None => Err(Error::usage("--distribution: the table has no roughness for it; give --roughness too")),
        }
    }
}

/// What several bounces return of a reflectance `[thickness][theta][channel]` by a finish with energy compensation,
/// `[thickness][channel]`, in 1/sr; empty without.
#[must_use]
pub fn returned(finish: &Finish<'_>, theta_deg: &[f64], reflectance: &[f32], channels: usize) -> Vec<f32> {
    let Some(compensation) = finish.compensation() else { return Vec::new() };
    let of_thickness = |rho: &[f32]| -> Vec<f32> {
        let of_channel = |c: usize| {
            let rho = rho.iter().skip(c).step_by(channels);
            let pairs = theta_deg.iter().zip(rho).map(|(theta, rho)| [theta.to_radians(), f64::from(*rho)]);
            compensation.returned(mean_reflectance(pairs))
        };
        (0..channels).map(of_channel).collect()
    };
    reflectance.chunks(theta_deg.len() * channels).flat_map(of_thickness).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finish_comes_back_from_metadata_and_options_come_first() {
        let mut metadata = Metadata::default();
        let none = FinishChoice::default();
        assert_eq!(none.of(&metadata).unwrap(), None);
        let beckmann =
            |roughness| OwnedFinish::analytic(finish(Distribution::Beckmann, Masking::Separable, roughness).unwrap());
        let own = beckmann([0.1, 0.4]);
        keep(&own, &mut metadata);
        assert_eq!(none.of(&metadata).unwrap(), Some(own));
        let choice = FinishChoice { roughness: Some([0.3, 0.3]), ..none };
        assert_eq!(choice.of(&metadata).unwrap(), Some(beckmann([0.3, 0.3])));
        let mirror = FinishChoice { roughness: Some([0.0, 0.0]), ..none };
        assert_eq!(mirror.of(&metadata).unwrap(), None);
        let with = |energy_compensation| FinishChoice { energy_compensation, ..choice };
        let compensated = with(Some(true)).of(&metadata).unwrap().unwrap();
        assert_eq!(compensated, beckmann([0.3, 0.3]).compensated(true));
        keep(&compensated, &mut metadata);
        assert_eq!(none.of(&metadata).unwrap(), Some(compensated));
        assert_eq!(with(Some(false)).of(&metadata).unwrap(), Some(beckmann([0.3, 0.3])));
        let error = FinishChoice { energy_compensation: Some(true), ..mirror }.of(&metadata).unwrap_err().to_string();
        assert!(error.contains("a mirror loses no light"), "{error}");
        metadata.insert(MetadataKey::FinishCompensation, "3");
        let error = none.of(&metadata).unwrap_err().to_string();
        assert!(error.contains("finish_energy_compensation is \"3\""), "{error}");
        metadata.insert(MetadataKey::FinishCompensation, "true");
        metadata.insert(MetadataKey::FinishRoughness, "0.1 rough");
        let error = none.of(&metadata).unwrap_err().to_string();
        assert!(error.contains("finish_roughness is \"0.1 rough\"") && error.contains("anew"), "{error}");
    }

    #[test]
    fn tabulated_facets_come_back_from_metadata() {
        /// Half a unit of the fourth digit, and rounding of the sum that scales all.
        const WRITTEN: f32 = 6e-4;
        let size = [32, 8];
        let nodes: Vec<f32> = (0..33 * 8)
            .map(|node| {
                let (ring, turn) = ((node / 8) as f32 / 32.0, (node % 8) as f32 / 8.0 * std::f32::consts::TAU);
                (-40.0 * ring.powi(4) * (1.0 + 0.5 * (2.0 * turn).cos())).exp()
            })
            .map(|d| if d < 1e-6 { 0.0 } else { d })
            .collect();
        let own = OwnedFacets::new(size, &nodes).unwrap();
        let mut metadata = Metadata::default();
        keep(&OwnedFinish::new(FinishFacets::Tabulated(own.clone(), Masking::Separable)), &mut metadata);
        assert!(is_finished(&metadata));
        let read = kept(&metadata).unwrap().unwrap();
        let FinishFacets::Tabulated(found, masking) = read.facets() else { panic!("facets") };
        assert_eq!((found.table().size(), *masking), (size, Masking::Separable));
        for (found, wanted) in found.table().nodes().zip(own.table().nodes()) {
            assert!((found - wanted).abs() <= WRITTEN * wanted, "{found} {wanted}");
        }
        let choice = FinishChoice { distribution: Some(Distribution::Ggx), ..FinishChoice::default() };
        assert!(choice.of(&metadata).unwrap_err().to_string().contains("give --roughness too"));
        for damaged in ["", "4 1 1 2 x", "4 1 1 1 1 1 1 1", "99999 1 1", "4 1", "4 2 1"] {
            metadata.insert(MetadataKey::FinishFacets, damaged);
            assert!(kept(&metadata).unwrap_err().to_string().contains("finish_facets"), "{damaged}");
        }
    }
}
