//! `[finish]` of a scene file: the roughness of a planar scene.

use goniochrome::microfacet::{Distribution, Finish, Masking};

use super::toml_value::{TomlItem, TomlTable};
use crate::support::error::Result;

/// The smallest roughness that a user may give: a smoother surface is a mirror.
pub const LEAST_ROUGHNESS: f64 = 1e-3;

/// Names of distributions.
pub const DISTRIBUTIONS: [(&str, Distribution); 2] = [("ggx", Distribution::Ggx), ("beckmann", Distribution::Beckmann)];

/// Names of kinds of masking.
pub const MASKINGS: [(&str, Masking); 2] = [("correlated", Masking::Correlated), ("separable", Masking::Separable)];

/// The value of a name in one of the lists above.
pub fn named<T: Copy>(names: &[(&str, T)], name: &str) -> Option<T> {
    names.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Reads `[finish]`.
///
/// # Errors
/// A roughness beyond its range, a name that is unknown.
pub(super) fn finish(table: &TomlTable<'_>) -> Result<Finish> {
    table.allow(&["roughness", "distribution", "masking"])?;
    let roughness = table.require("roughness", "roughness = 0.2")?;
    let alpha = match roughness.as_array().as_deref() {
        None => [roughness.number()?; 2],
        Some([x, y]) => [x.number()?, y.number()?],
        Some(_) => return Err(roughness.refuse("expected one number, or two for the tangent and the binormal")),
    };
    if !alpha.iter().all(|alpha| (LEAST_ROUGHNESS..=1.0).contains(alpha)) {
        return Err(
            roughness.refuse(format_args!("a roughness is from {LEAST_ROUGHNESS} to 1; a mirror has no [finish]"))
        );
    }
    let distribution: Option<Distribution> = choice(table, "distribution", &DISTRIBUTIONS)?;
    let masking: Option<Masking> = choice(table, "masking", &MASKINGS)?;
    Finish::new(distribution.unwrap_or_default(), masking.unwrap_or_default(), alpha.map(|alpha| alpha as f32))
        .map_err(|error| roughness.refuse(error))
}

/// The value of a key that takes one of a list of names.
fn choice<T: Copy>(table: &TomlTable<'_>, key: &str, names: &[(&str, T)]) -> Result<Option<T>> {
    let of = |item: TomlItem<'_>| {
        let name = item.text()?;
        let known: Vec<String> = names.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        named(names, name).ok_or_else(|| item.refuse(format_args!("{name:?} is unknown; write {}", known.join(" or "))))
    };
    table.get(key).map(of).transpose()
}
