//! Media of a scene, each listed once: declared materials, built-in materials and plain numbers.

use std::collections::HashMap;

use goniochrome::optics::interface::Below;
use goniochrome::optics::medium::{Extrapolate, MediumIndex};

use super::builtin;
use super::column::MAX_INDEX;
use super::diagnostics::nearest;
use super::medium::OwnedMedium;
use super::parts::NamedMedium;
use super::toml_value::TomlItem;
use crate::support::error::Result;
use crate::support::text::toml_key;

/// Refusal of an ambient medium that absorbs at every wavelength more than [`MAX_AMBIENT_K`].
///
/// [`MAX_AMBIENT_K`]: goniochrome::optics::medium::MAX_AMBIENT_K
const AMBIENT_ABSORBS: &str =
    "light cannot arrive through a medium that absorbs; use k <= 0.001, or make it a layer under a clear ambient";

/// Name of a perfect mirror, where a medium below is expected.
const MIRROR: &str = "mirror";

/// Collector of the media that a scene uses.
pub(super) struct Media {
    /// Treatment of wavelengths beyond the data of built-in materials.
    extrapolate: Extrapolate,
    /// Declared materials, `[materials.X]`, by lower-case name.
    declared: HashMap<String, NamedMedium>,
    /// Index in `list` of each material or number met so far.
    seen: HashMap<MediumKey, MediumIndex>,
    list: Vec<NamedMedium>,
}

/// MediumKey of a medium: a name in lower case, or n and k by their bits.
#[derive(PartialEq, Eq, Hash)]
enum MediumKey {
    Name(String),
    Number(u64, u64),
}

impl Media {
    pub fn new(extrapolate: Extrapolate) -> Self {
        Self { extrapolate, declared: HashMap::new(), seen: HashMap::new(), list: Vec::new() }
    }

    /// Declares `[materials.NAME]`, which hides a built-in material of that name.
    pub fn declare(&mut self, item: &TomlItem<'_>, medium: OwnedMedium) -> Result<()> {
        let name = item.key();
        if name.eq_ignore_ascii_case(MIRROR) {
            return Err(item.refuse("this name stands for a perfect mirror; choose another"));
        }
        let medium = NamedMedium { name: name.to_owned(), medium };
        match self.declared.insert(name.to_lowercase(), medium) {
            None => Ok(()),
            Some(other) => Err(item.refuse(format_args!(
                "[materials.{}] has the same name but for upper and lower case; rename one",
                toml_key(&other.name)
            ))),
        }
    }

    /// Medium that a value names: a number n, a pair [n, k], or the name of a material.
    pub fn resolve(&mut self, item: &TomlItem<'_>) -> Result<MediumIndex> {
        let forms = "a number, a pair [n, k] or the name of a material";
        let (key, name, make): (MediumKey, String, OwnedMedium);
        if let Some(text) = item.as_text() {
            key = MediumKey::Name(text.to_lowercase());
            if let Some(&index) = self.seen.get(&key) {
                return Ok(index);
            }
            NamedMedium { name, medium: make } = self.find(item, text)?;
        } else {
            let (n, k) = match item.as_array().as_deref() {
                Some([n, k]) => (n.number()?, k.number()?),
                None if item.is_number() => (item.number()?, 0.0),
                _ => return Err(item.refuse(format_args!("expected {forms}, found {}", item.found()))),
            };
            make = constant(item, n, k)?;
            key = MediumKey::Number(n.to_bits(), k.to_bits());
            if let Some(&index) = self.seen.get(&key) {
                return Ok(index);
            }
            name = if k == 0.0 { n.to_string() } else { format!("{n}+{k}i") };
        }
        let index = self.add(item, name, make)?;
        self.seen.insert(key, index);
        Ok(index)
    }

    /// Medium or perfect mirror below an interface.
    pub fn resolve_below(&mut self, item: &TomlItem<'_>) -> Result<Below> {
        match item.as_text() {
            Some(text) if text.eq_ignore_ascii_case(MIRROR) => Ok(Below::Mirror),
            _ => self.resolve(item).map(Below::Medium),
        }
    }

    /// Medium in which light arrives. It must hardly absorb: otherwise no wave arrives from far away.
    pub fn resolve_ambient(&mut self, item: &TomlItem<'_>) -> Result<MediumIndex> {
        let index = self.resolve(item)?;
        if self.list[usize::from(index)].medium.always_absorbs() {
            return Err(item.refuse(AMBIENT_ABSORBS));
        }
        Ok(index)
    }

    pub fn finish(self) -> Vec<NamedMedium> {
        self.list
    }

    fn find(&self, item: &TomlItem<'_>, name: &str) -> Result<NamedMedium> {
        if name.eq_ignore_ascii_case(MIRROR) {
            return Err(item.refuse("a perfect mirror can only be a substrate or lie below an interface"));
        }
        if let Some(found) = self.declared.get(&name.to_lowercase()) {
            return Ok(found.clone());
        }
        if let Some(found) = builtin::get(name, self.extrapolate) {
            return found;
        }
        let known = self
            .declared
            .values()
            .map(|medium| medium.name.as_str())
            .chain(builtin::names().map(|name| -> &str { name }));
        let key = toml_key(name);
        Err(item.refuse(match nearest(name, known) {
            Some(near) => format!("unknown material {name:?}; nearest is {near:?}, or declare [materials.{key}]"),
            None => {
                let known = builtin::names().collect::<Vec<_>>().join(", ");
                format!("unknown material {name:?}; declare [materials.{key}] (built in: {known})")
            }
        }))
    }

    /// Adds a medium, or finds an equal one. Equal η under two names is one medium, since facets compare media by
    /// index.
    fn add(&mut self, item: &TomlItem<'_>, name: String, medium: OwnedMedium) -> Result<MediumIndex> {
        let index = self.list.iter().position(|known| known.medium == medium).unwrap_or_else(|| {
            self.list.push(NamedMedium { name, medium });
            self.list.len() - 1
        });
        MediumIndex::try_from(index).map_err(|_| item.refuse(format_args!("more than {} media", MediumIndex::MAX)))
    }
}

/// Constant medium; `item` is the place of the error unless n > 0 and k ≥ 0.
pub(super) fn constant(item: &TomlItem<'_>, n: f64, k: f64) -> Result<OwnedMedium> {
    if n.max(k) > MAX_INDEX {
        return Err(item.refuse(format_args!("n = {n}, k = {k}: more than {MAX_INDEX}")));
    }
    if k < 0.0 {
        return Err(item.refuse(format_args!("k = {k} is gain; k must not be negative: for n − ik write +k")));
    }
    OwnedMedium::constant(n, k).map_err(|error| item.refuse(error))
}
