//! Metadata of a table: text under keys, with the keys that this program writes and reads.

use std::collections::BTreeMap;

use goniochrome::colour::{Illuminant, RgbSpace};

use crate::colour::{self, space_named};

/// Key of the metadata that this program writes or reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MetadataKey {
    /// Program and version that made the table.
    Generator,
    /// Name of the scene.
    Scene,
    /// The scene file as read.
    SceneToml,
    /// `--model`: `physical` or `paper`.
    Model,
    /// `--method` of a planar scene.
    Method,
    /// `--precision`.
    Precision,
    /// `--coherence` of a cell.
    Coherence,
    /// `--seed` of a cell.
    Seed,
    /// `--reciprocal` of a cell: `true` or `false`.
    Reciprocal,
    /// Light that the colours belong to: `D65` or `E`.
    Illuminant,
    /// Colour space of the linear RGB, by the name that `colour::space_name` gives.
    ColourSpace,
    /// Coherence between the periods of a cell: `coherent` or `random`.
    Periods,
    /// Largest error bar of an efficiency of diffraction orders.
    ErrorMax,
    /// Standard observer of the colours.
    Observer,
    /// Largest power left out of a sample of a planar scene.
    TruncatedMax,
    /// Samples of a planar scene that were computed again with more digits.
    Recomputed,
    /// Samples of `--method hits` that fell back to closed loops.
    FellBack,
    /// Imbalance of power of largest size.
    ImbalanceMax,
    /// Warnings that the command printed; absent without one.
    Warning,
    /// The medium behind a transparent planar scene: `ambient`, as in front, or `body`.
    Backing,
    /// Roughness α of a finish along x and y.
    FinishRoughness,
    /// Distribution of the facets of a finish: `ggx`, `beckmann` or `tabulated`.
    FinishDistribution,
    /// Masking of the facets of a finish: `correlated` or `separable`.
    FinishMasking,
    /// Tabulated facets of a finish: rings, sectors and densities.
    FinishFacets,
    /// `true` where a finish has energy compensation; else absent.
    FinishCompensation,
}

impl AsRef<str> for MetadataKey {
    fn as_ref(&self) -> &str {
        match self {
            Self::Generator => "generator",
            Self::Scene => "scene",
            Self::SceneToml => "scene_toml",
            Self::Model => "model",
            Self::Method => "method",
            Self::Precision => "precision",
            Self::Coherence => "coherence",
            Self::Seed => "seed",
            Self::Reciprocal => "reciprocal",
            Self::Illuminant => "illuminant",
            Self::ColourSpace => "colour_space",
            Self::Periods => "periods",
            Self::ErrorMax => "error_max",
            Self::Observer => "observer",
            Self::TruncatedMax => "truncated_max",
            Self::Recomputed => "recomputed",
            Self::FellBack => "fell_back",
            Self::ImbalanceMax => "imbalance_max",
            Self::Warning => "warning",
            Self::Backing => "backing",
            Self::FinishRoughness => "finish_roughness",
            Self::FinishDistribution => "finish_distribution",
            Self::FinishMasking => "finish_masking",
            Self::FinishFacets => "finish_facets",
            Self::FinishCompensation => "finish_energy_compensation",
        }
    }
}

/// Metadata of a table, in the order of its keys. Files of others may hold keys beside those of [`MetadataKey`].
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Metadata {
    entries: BTreeMap<String, String>,
}

impl Metadata {
    /// Text under a key.
    #[must_use]
    pub fn get(&self, key: impl AsRef<str>) -> Option<&str> {
        self.entries.get(key.as_ref()).map(String::as_str)
    }

    /// Sets the text under a key, whatever was there before.
    pub fn insert(&mut self, key: impl AsRef<str>, value: impl Into<String>) {
        self.entries.insert(key.as_ref().to_owned(), value.into());
    }

    /// All entries, in the order of their keys.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// Name of the scene that the table was made from, or `table` where it is unknown.
    #[must_use]
    pub fn scene_name(&self) -> &str {
        self.get(MetadataKey::Scene).unwrap_or("table")
    }

    /// Illuminant of the table's colours; D65 where none is named.
    #[must_use]
    pub fn illuminant(&self) -> Illuminant {
        match self.get(MetadataKey::Illuminant) {
            Some("E") => Illuminant::E,
            _ => Illuminant::D65,
        }
    }

    /// Colour space that the metadata name.
    #[must_use]
    pub fn named_space(&self) -> Option<RgbSpace> {
        self.get(MetadataKey::ColourSpace).and_then(space_named)
    }

    /// Colour space of the table's colours; sRGB where none is named.
    #[must_use]
    pub fn space(&self) -> RgbSpace {
        self.named_space().unwrap_or(RgbSpace::Srgb)
    }

    /// Colour space in which a screen takes the table's colours: linear sRGB, except that the paper's matrix is a
    /// display of its own and stays.
    #[must_use]
    pub fn screen_space(&self) -> RgbSpace {
        if self.space() == RgbSpace::Paper { RgbSpace::Paper } else { RgbSpace::Srgb }
    }

    /// Colours of the table, converted from its own space to [`Metadata::screen_space`].
    #[must_use]
    pub fn screen_rgb(&self, rgb: &[[f32; 3]]) -> Vec<[f32; 3]> {
        colour::converted(self.space(), self.screen_space(), rgb)
    }
}

impl From<BTreeMap<String, String>> for Metadata {
    fn from(entries: BTreeMap<String, String>) -> Self {
        Self { entries }
    }
}

impl<K: AsRef<str>, V: Into<String>> FromIterator<(K, V)> for Metadata {
    fn from_iter<I: IntoIterator<Item = (K, V)>>(entries: I) -> Self {
        let entries = entries.into_iter().map(|(key, value)| (key.as_ref().to_owned(), value.into()));
        Self { entries: entries.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_d65_and_srgb_unless_the_entries_say_otherwise() {
        let of = |illuminant: &str, space: &str| {
            let entries = [(MetadataKey::Illuminant, illuminant), (MetadataKey::ColourSpace, space)];
            let metadata: Metadata = entries.into_iter().collect();
            (metadata.illuminant(), metadata.space(), metadata.screen_space())
        };
        let (none, srgb) = (Metadata::default(), RgbSpace::Srgb);
        assert_eq!((none.illuminant(), none.space(), none.screen_space()), (Illuminant::D65, srgb, srgb));
        assert_eq!(of("E", "paper"), (Illuminant::E, RgbSpace::Paper, RgbSpace::Paper));
        assert_eq!(of("D65", "rec2020"), (Illuminant::D65, RgbSpace::Rec2020, srgb));
        assert_eq!(of("candle", "ACEScg"), (Illuminant::D65, RgbSpace::AcesCg, srgb));
    }

    #[test]
    fn a_table_without_a_scene_is_called_a_table() {
        let mut metadata = Metadata::default();
        assert_eq!(metadata.scene_name(), "table");
        metadata.insert(MetadataKey::Scene, "films");
        assert_eq!((metadata.scene_name(), metadata.get("scene")), ("films", Some("films")));
        assert_eq!(metadata.iter().collect::<Vec<_>>(), [("scene", "films")]);
    }
}
