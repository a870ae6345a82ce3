//! The command `goniochrome presets`.

use std::path::Path;

use crate::scene::{list_materials, load, presets};
use crate::support::error::Result;
use crate::support::output;

pub fn run(name: Option<&str>) -> Result<()> {
    let text = match name {
        Some(name) => match presets::get(name) {
            Some(toml) => toml.to_owned(),
            // Not a preset: `load` knows what to say.
            None => load(name)?.toml,
        },
        None => {
            let width = presets::names().map(str::len).max().unwrap_or(0);
            presets::list().map(|(name, description)| format!("{name:width$}  {description}\n")).collect()
        }
    };
    output::write_text(Path::new("-"), &text)
}

/// The command `goniochrome presets --materials`.
pub fn materials() -> Result<()> {
    output::write_text(Path::new("-"), &list_materials()?)
}
