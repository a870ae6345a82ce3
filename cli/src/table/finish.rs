//! The finish of a mirror-like table: its roughness, in the table's metadata or by the user's choice.

use goniochrome::microfacet::{Distribution, Finish, Masking};

use crate::scene::{DISTRIBUTIONS, MASKINGS, named};
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
pub fn finish(distribution: Distribution, masking: Masking, roughness: [f64; 2]) -> Result<Finish> {
    Finish::new(distribution, masking, roughness.map(|alpha| alpha as f32)).map_err(|error| {
        let [x, y] = roughness;
        Error::usage(format_args!("a finish of roughness {x} and {y}: {error}"))
    })
}

/// Writes a finish into a table's metadata.
pub fn keep(finish: &Finish, metadata: &mut Metadata) {
    let [x, y] = finish.alpha();
    metadata.insert(MetadataKey::FinishRoughness, format!("{x} {y}"));
    metadata.insert(MetadataKey::FinishDistribution, name_of(&DISTRIBUTIONS, finish.distribution()));
    metadata.insert(MetadataKey::FinishMasking, name_of(&MASKINGS, finish.masking()));
}

/// Whether a table's metadata hold a finish.
#[must_use]
pub fn is_finished(metadata: &Metadata) -> bool {
    metadata.get(MetadataKey::FinishRoughness).is_some()
}

/// The finish that a table's metadata hold.
fn kept(metadata: &Metadata) -> Result<Option<Finish>> {
    let Some(text) = metadata.get(MetadataKey::FinishRoughness) else { return Ok(None) };
    let damaged = |key: MetadataKey| {
        let (key, value) = (key.as_ref(), metadata.get(key).unwrap_or_default());
        Error::failed(format_args!("the table's {key} is {value:?}, which is no finish; estimate the table anew"))
    };
    let numbers: Vec<f32> = text.split(' ').filter_map(|number| number.parse().ok()).collect();
    let roughness = <[f32; 2]>::try_from(numbers).map_err(|_| damaged(MetadataKey::FinishRoughness))?;
    let value = |key: MetadataKey| metadata.get(key).unwrap_or_default();
    let distribution = named(&DISTRIBUTIONS, value(MetadataKey::FinishDistribution));
    let masking = named(&MASKINGS, value(MetadataKey::FinishMasking));
    let distribution = distribution.ok_or_else(|| damaged(MetadataKey::FinishDistribution))?;
    let masking = masking.ok_or_else(|| damaged(MetadataKey::FinishMasking))?;
    Finish::new(distribution, masking, roughness).map(Some).map_err(|_| damaged(MetadataKey::FinishRoughness))
}

/// What a user asks for in place of a table's finish.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FinishChoice {
    /// Roughness along x and y; 0 for a mirror.
    pub roughness: Option<[f64; 2]>,
    /// Distribution of the facets.
    pub distribution: Option<Distribution>,
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
    pub fn of(&self, metadata: &Metadata) -> Result<Option<Finish>> {
        self.instead_of(kept(metadata)?)
    }

    /// The finish of a surface with a finish of its own, or none; `None` for a mirror.
    ///
    /// # Errors
    /// A distribution without a roughness.
    pub fn instead_of(&self, own: Option<Finish>) -> Result<Option<Finish>> {
        let distribution = self.distribution.or(own.map(|own| own.distribution())).unwrap_or_default();
        let masking = own.map_or(Masking::default(), |own| own.masking());
        let own_roughness = own.map(|own| own.alpha().map(f64::from));
        match self.roughness.or(own_roughness) {
            Some([0.0, 0.0]) => Ok(None),
            Some(roughness) => finish(distribution, masking, roughness).map(Some),
            None if self.distribution.is_some() => Err(Error::usage(
                "--distribution: is that of a rough surface, and the table's is smooth; give --roughness too",
            )),
            None => Ok(None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finish_comes_back_from_metadata_and_options_come_first() {
        let mut metadata = Metadata::default();
        let none = FinishChoice::default();
        assert_eq!(none.of(&metadata).unwrap(), None);
        let own = finish(Distribution::Beckmann, Masking::Separable, [0.1, 0.4]).unwrap();
        keep(&own, &mut metadata);
        assert_eq!(none.of(&metadata).unwrap(), Some(own));
        let choice = FinishChoice { roughness: Some([0.3, 0.3]), distribution: None };
        let other = finish(Distribution::Beckmann, Masking::Separable, [0.3, 0.3]).unwrap();
        assert_eq!(choice.of(&metadata).unwrap(), Some(other));
        let mirror = FinishChoice { roughness: Some([0.0, 0.0]), distribution: None };
        assert_eq!(mirror.of(&metadata).unwrap(), None);
        metadata.insert(MetadataKey::FinishRoughness, "0.1 rough");
        let error = none.of(&metadata).unwrap_err().to_string();
        assert!(error.contains("finish_roughness is \"0.1 rough\"") && error.contains("anew"), "{error}");
    }
}
