//! `[finish]` of a scene file: the roughness of a planar scene.

mod owned;
mod columns;
mod normals;

use std::path::PathBuf;

use goniochrome::microfacet::{Distribution, Finish, Masking};

use super::diagnostics::{SourceText, read_text};
use super::mesh::Mesh;
use super::mesh_frame::MeshFrame;
use super::surface;
use super::toml_value::{TomlItem, TomlTable};
use crate::support::error::Result;

pub use owned::{FinishFacets, OwnedFacets, OwnedFinish};

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

/// Maximum length of a file of columns: a fine grid has a million rows of some twenty bytes.
const MAX_COLUMN_BYTES: u64 = 32 << 20;

/// Reads `[finish]`; `label` is the scene's name in messages, and `find` gives the path of a file that it names.
///
/// # Errors
/// A roughness beyond its range, a name that is unknown, a file or a surface that has no distribution of normals.
pub(super) fn finish(
    table: &TomlTable<'_>,
    label: &str,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<OwnedFinish> {
    table.allow(&["roughness", "distribution", "masking", "isotropic", "energy_compensation"])?;
    let compensation = table.get("energy_compensation").map(|item| item.flag()).transpose()?.unwrap_or(false);
    Ok(OwnedFinish::new(finish_facets(table, label, find)?).compensated(compensation))
}

/// Reads the facets of `[finish]`.
fn finish_facets(
    table: &TomlTable<'_>,
    label: &str,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<FinishFacets> {
    let masking = choice(table, "masking", &MASKINGS)?.unwrap_or_default();
    let distribution = table.get("distribution");
    if let Some(item) = distribution.as_ref().filter(|item| item.as_text().is_none()) {
        if let Some(roughness) = table.get("roughness") {
            return Err(roughness.refuse("tabulated facets have their own; remove it"));
        }
        return Ok(FinishFacets::Tabulated(facets(item, table.get("isotropic"), label, find)?, masking));
    }
    if let Some(item) = table.get("isotropic") {
        return Err(item.refuse("is for the normals of a mesh or a surface; remove it"));
    }
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
    let distribution = choice(table, "distribution", &DISTRIBUTIONS)?.unwrap_or_default();
    Finish::new(distribution, masking, alpha.map(|alpha| alpha as f32))
        .map(FinishFacets::Analytic)
        .map_err(|error| roughness.refuse(error))
}

/// Reads `distribution = { file = "…" }` or `distribution = { surface = { … }, period_nm = [x, y] }`.
fn facets(
    item: &TomlItem<'_>,
    isotropic: Option<TomlItem<'_>>,
    label: &str,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<OwnedFacets> {
    let table = item.table("distribution")?;
    let all_azimuths = isotropic.as_ref().map(TomlItem::flag).transpose()?.unwrap_or(false);
    if let Some(surface) = table.get("surface") {
        table.allow(&["surface", "period_nm"])?;
        let mesh = surface::single(&surface, label, table.get("period_nm").as_ref(), find)?;
        return normals::facets(&mesh, all_azimuths).map_err(|message| surface.refuse(message));
    }
    let file = table.require("file", "file = \"normals.csv\", a mesh or a height map; or surface = { … }")?;
    let path = find(&file)?;
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("obj") => {
            table.allow(&["file", "axes", "unit_nm"])?;
            let mesh = Mesh::read(&path, None, MeshFrame::read(&table)?)?;
            normals::facets(&mesh, all_azimuths).map_err(|message| file.refuse(message))
        }
        Some("csv" | "txt" | "dat" | "tsv") => {
            table.allow(&["file"])?;
            if let Some(isotropic) = isotropic {
                return Err(isotropic.refuse("is for normals; a file of theta_deg and D is isotropic: remove it"));
            }
            let text = read_text(&path, MAX_COLUMN_BYTES)?;
            columns::parse(&SourceText { label: &path.display().to_string(), text: &text })
        }
        _ => {
            let mesh = surface::mesh_of_map(&table, label, find)?;
            normals::facets(&mesh, all_azimuths).map_err(|message| file.refuse(message))
        }
    }
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
