//! The kinds of generated surfaces, and the mesh of a `surface = { … }`.

use std::path::{Path, PathBuf};

use super::builder::Builder;
use super::keys::{list, positive};
use super::{grooves, height_map, lamellae, lines, particles, pits, pyramids, scratches, sines};
use crate::scene::diagnostics::nearest;
use crate::scene::mesh::Mesh;
use crate::scene::toml_value::{TomlItem, TomlTable};
use crate::support::error::Result;
use crate::support::text::toml_key;

/// Name of each kind, its interfaces in the order of their numbers, and its generator.
const KINDS: &[(&str, Interfaces, Generator)] = &[
    ("sines", sines::interfaces, sines::build),
    ("pits", |_| &["pits"], pits::build),
    ("lamellae", |_| &["cuticle"], lamellae::build),
    ("grooves", |_| &["grooves"], grooves::build),
    ("lines", |_| lines::INTERFACES, lines::build),
    ("pyramids", |_| &["pyramids"], pyramids::build),
    ("scratches", |_| &["scratches"], scratches::build),
    ("particles", particles::interfaces, particles::build),
    ("height_map", |_| &["heights"], height_map::build),
];

type Interfaces = fn(&TomlTable<'_>) -> &'static [&'static str];
type Generator = fn(&TomlTable<'_>, &mut Builder<'_>) -> Result<()>;

/// Generated surface.
pub(in crate::scene) struct Generated {
    pub mesh: Mesh,
    /// Period in x and y.
    pub period_nm: [f64; 2],
    /// What to say about the surface.
    pub notes: Vec<String>,
}

/// Makes the surface of `surface = { … }`; `period_nm` is the scene's, zeros if it has none, `names` are its
/// interfaces, all of the kind's if `None`, and `find` gives the path of a file that it names.
pub(in crate::scene) fn build(
    item: &TomlItem<'_>,
    label: &str,
    period_nm: [f64; 2],
    names: Option<&[&str]>,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<Generated> {
    let table = item.table("surface")?;
    let kinds = KINDS.iter().map(|(kind, ..)| *kind);
    let list = kinds.clone().collect::<Vec<_>>().join(", ");
    let kind_item = table.require("kind", &format!("one of {list}"))?;
    let kind = kind_item.text()?;
    let Some((_, interfaces, generate)) = KINDS.iter().find(|(known, ..)| *known == kind) else {
        let near = nearest(kind, kinds).map_or_else(String::new, |near| format!("nearest is {near:?}; "));
        return Err(kind_item.refuse(format_args!("{kind:?} is unknown; {near}known: {list}")));
    };
    let wanted = interfaces(&table);
    let names = names.unwrap_or(wanted);
    let mut numbers = Vec::new();
    for wanted in wanted {
        let number = names.iter().position(|name| name == wanted).and_then(|number| u16::try_from(number).ok());
        numbers.push(number.ok_or_else(|| {
            item.refuse(format_args!("a surface of kind {kind:?} needs an [interface.{wanted}]; add it"))
        })?);
    }
    if let Some(other) = names.iter().find(|name| !wanted.contains(name)) {
        let wanted = wanted.join(", ");
        return Err(item.refuse(format_args!(
            "[interface.{}] is not of this surface; kind {kind:?} has {wanted}; remove or rename it",
            toml_key(other)
        )));
    }
    let mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: Path::new(label).to_owned() };
    let mut builder = Builder { mesh, numbers, line: item.line(), period_nm, notes: Vec::new(), find };
    generate(&table, &mut builder)?;
    let Builder { mesh, period_nm, notes, .. } = builder;
    Ok(Generated { mesh, period_nm, notes })
}

/// Mesh of a `surface = { … }` of one interface, for its facets alone.
pub(in crate::scene) fn single(
    item: &TomlItem<'_>,
    label: &str,
    period_nm: Option<&TomlItem<'_>>,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<Mesh> {
    let table = item.table("surface")?;
    let period_nm = match period_nm {
        Some(item) => {
            let [x, y] = list::<2>(item)?;
            [positive(&x)?, positive(&y)?]
        }
        None if table.get("size_nm").is_some() => [0.0; 2],
        None => return Err(item.refuse("period_nm is missing beside it; write period_nm = [x, y]")),
    };
    let mesh = build(item, label, period_nm, None, find)?.mesh;
    match mesh.triangles.iter().find(|triangle| triangle.interface > 0) {
        Some(_) => Err(item.refuse("a surface of several interfaces has no one distribution of normals; take another")),
        None => Ok(mesh),
    }
}

/// Mesh of a height map whose keys are those of `surface = { kind = "height_map", … }`, with `size_nm`.
pub(in crate::scene) fn mesh_of_map(
    table: &TomlTable<'_>,
    label: &str,
    find: &mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
) -> Result<Mesh> {
    table.require("size_nm", "size_nm = 10000.0, the width of the map")?;
    let mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: Path::new(label).to_owned() };
    let mut builder = Builder { mesh, numbers: vec![0], line: 1, period_nm: [0.0; 2], notes: Vec::new(), find };
    height_map::build(table, &mut builder)?;
    Ok(builder.mesh)
}
