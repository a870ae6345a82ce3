//! The scene file: TOML in, [`Scene`] out.
//!
//! ```toml
//! name = "film"                       # these three document the scene; optional
//! description = "one line"
//! source = "where its dimensions come from"
//! extrapolate = "clamp"               # beyond its data a material keeps its last value; without this it is refused
//!
//! [stack]                             # plane layers, top to bottom
//! ambient = 1.0                       # a medium: a number n, a pair [n, k] or the name of a material
//! layers = [ { material = 2.4, thickness_nm = 180.0, spread_nm = 10.0 }, # spread: optional, of the thickness over
//!                                     # the surface: the standard deviation of a Gaussian
//!            { repeat = 2, layers = [ { material = "air", thickness_nm = 180.0 } ] } ]
//! substrate = "mirror"                # a medium, or "mirror": a perfect mirror
//!
//! [finish]                            # optional: plane layers on a surface that is rough, as microfacets
//! roughness = 0.2                     # α; or [0.1, 0.4] along the tangent and the binormal
//! distribution = "ggx"                # optional: of the facets' normals; or "beckmann"
//! masking = "correlated"              # optional: or "separable", which is darker at grazing angles
//!
//! [cell]                              # or a mesh; a scene has one of the two
//! mesh = "bumps.obj"                  # nanometres, z up; paths start at the scene file
//! axes = "y-up"                       # optional, for a mesh with y up: x, y, z of the file are x, −z, y of the cell
//! unit_nm = 1000.0                    # optional, the unit of the mesh; here micrometres
//! # surface = { kind = "pits", … }    # instead of a mesh: made here, see `surface/mod.rs`; a height map may give the
//!                                     # period
//! period_nm = [20000.0, 20000.0]      # what the mesh spans in x and y, wherever it starts; it repeats
//! periods = "coherent"                # optional: periods are exact copies, whose light leaves in diffraction orders;
//!                                     # "random": they differ in height at random, and their light does not interfere
//! front = "air"                       # optional: the uppermost medium is a plate, far thicker than light is coherent,
//!                                     # and light arrives through its plane front face from this medium; waves alone
//! [interface.glass]                   # one for each `usemtl` name
//! above = 1.0                         # the medium on the side of the facet's normal
//! below = 1.5                         # a medium or "mirror"
//! coating = [ { material = "MgF2", thickness_nm = 100.0 } ]  # optional films on the facets, written like `layers`,
//!                                     # from `above` to `below`; they take up no room in the mesh
//!
//! [materials.chitin]                  # n and k, a table or a file; hides a built-in material of the same name
//! n = 1.56
//! k = 0.06
//! [materials.dye]
//! table = [[400, 1.5, 0.01], [700, 1.48, 0.0]]  # rows of wavelength in nm, n and, if it absorbs, k
//! [materials.rutile]
//! file = "TiO2-Devore-o.yml"          # in the format of refractiveindex.info, or columns of text, see `delimited.rs`
//! unit = "um"                         # of wavelengths in columns of text, "nm" or "um", if no header names it
//! extrapolate = "clamp"
//! ```

use std::path::{Path, PathBuf};

use goniochrome::optics::interface::{Below, Interface};
use goniochrome::optics::medium::{Extrapolate, MediumIndex};
use toml::de::DeTable;

use super::delimited::{self, Unit};
use super::diagnostics::{SourceText, canonical, read_text};
use super::media::{self, Media};
use super::medium::OwnedMedium;
use super::mesh::Mesh;
use super::mesh_frame::MeshFrame;
use super::model::{Periods, Scene, Shape};
use super::parts::{Layer, MAX_LENGTH_NM, NamedInterface, ThicknessSpread};
use super::surface::{self, Generated};
use super::toml_value::{TomlItem, TomlTable};
use super::{finish, placement, refractive_index_info};
use crate::support::error::Result;
use crate::support::text::{one_line, toml_key};

/// Maximum number of layers with repetitions written out. Real mirrors have hundreds; a mistyped `repeat` asks for
/// millions.
const MAX_LAYERS: u32 = 10_000;

/// Maximum nesting of `repeat` within `repeat`.
const MAX_REPEAT_DEPTH: u32 = 16;

/// Maximum length of a refractive index file.
const MAX_NK_BYTES: u64 = 16 << 20;

/// Reader of a scene file: its media and the files met so far.
struct SceneReader<'a> {
    /// Name of the scene in messages.
    label: &'a str,
    /// Folder where relative paths start; without it the scene can name no files.
    folder: Option<&'a Path>,
    media: Media,
    files: Vec<PathBuf>,
    /// Number of layers met so far, each entry once.
    entries: u32,
}

/// Geometry of a scene as written.
enum Geometry {
    Stack(Shape),
    Cell { mesh: Mesh, period_nm: [f64; 2], interfaces: Vec<NamedInterface>, extras: CellExtras },
}

/// What a scene says of a cell beside its facets.
#[derive(Default)]
struct CellExtras {
    periods: Option<Periods>,
    front: Option<MediumIndex>,
    notes: Vec<String>,
}

/// Source of a cell's facets.
enum Facets<'a> {
    Mesh(TomlItem<'a>),
    Surface(TomlItem<'a>),
}

/// Whether a scene's finish is read; a table has its own, and may be far from the files that the scene names for it.
#[derive(Clone, Copy)]
pub(super) enum FinishKey {
    Read,
    Skip,
}

/// Reads the scene in a text. `name` is used unless the text has one.
pub(super) fn parse(label: &str, text: &str, name: &str, folder: Option<&Path>, finish: FinishKey) -> Result<Scene> {
    let source = SourceText { label, text };
    let document = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        source.refuse(offset, format_args!("not valid TOML: {}", error.message()))
    })?;
    let root = TomlTable::root(source, document.get_ref());
    root.allow(&["name", "description", "source", "extrapolate", "stack", "cell", "finish", "materials", "interface"])?;
    for key in ["description", "source"] {
        root.get(key).map(|item| item.text()).transpose()?;
    }
    let name = root.get("name").map(|item| item.text()).transpose()?.unwrap_or(name);
    let name = one_line(name);
    let extrapolate = extrapolate(&root, Extrapolate::Refuse)?;
    let mut reader = SceneReader { label, folder, media: Media::new(extrapolate), files: Vec::new(), entries: 0 };
    if let Some(materials) = root.get("materials") {
        for item in materials.table("[materials]")?.entries() {
            let medium = reader.material(&item, extrapolate)?;
            reader.media.declare(&item, medium)?;
        }
    }
    let described = match (root.get("stack"), root.get("cell")) {
        (Some(stack), None) => {
            if let Some(item) = root.get("interface") {
                return Err(item.refuse("only a [cell] has interfaces; remove it"));
            }
            Geometry::Stack(reader.stack(&stack.table("[stack]")?)?)
        }
        (None, Some(cell)) => reader.cell(&cell.table("[cell]")?, root.get("interface"))?,
        (Some(_), Some(cell)) => return Err(cell.refuse("a scene has either [stack] or [cell]; remove one")),
        (None, None) => return Err(root.refuse("neither [stack] nor [cell]; add one")),
    };
    let finish = match (root.get("finish"), finish) {
        (None, _) | (_, FinishKey::Skip) => None,
        (Some(item), _) => Some(finish::finish(&item.table("[finish]")?, label, &mut |item| reader.path(item))?),
    };
    let SceneReader { media, files, .. } = reader;
    let media = media.finish();
    let (shape, CellExtras { periods, front, notes }) = match described {
        Geometry::Stack(shape) => (shape, CellExtras::default()),
        Geometry::Cell { mesh, period_nm, interfaces, extras } => {
            (Shape::of_mesh(mesh, period_nm, interfaces, &media)?, extras)
        }
    };
    if let (Shape::Mesh(_), Some(item)) = (&shape, root.get("finish")) {
        return Err(item.refuse("a cell of tilted facets has its own roughness; remove [finish]"));
    }
    Ok(Scene { name, toml: text.to_owned(), media, shape, finish, periods, front, notes, files })
}

fn extrapolate(table: &TomlTable<'_>, default: Extrapolate) -> Result<Extrapolate> {
    match table.get("extrapolate") {
        None => Ok(default),
        Some(item) => match item.text()? {
            "clamp" => Ok(Extrapolate::Clamp),
            "refuse" => Ok(Extrapolate::Refuse),
            other => Err(item.refuse(format_args!("{other:?} is unknown; write \"clamp\" or \"refuse\""))),
        },
    }
}

/// Whether a file of n and k has the format of refractiveindex.info, judged by its name or its one required key.
fn is_yaml(path: &Path, content: &str) -> bool {
    let named =
        path.extension().is_some_and(|name| name.eq_ignore_ascii_case("yml") || name.eq_ignore_ascii_case("yaml"));
    named || content.lines().any(|line| line.trim_end() == "DATA:")
}

fn unit(item: &TomlItem<'_>) -> Result<Unit> {
    let named = item.text()?;
    Unit::parse(named).ok_or_else(|| item.refuse(format_args!("{named:?} is unknown; write \"nm\" or \"um\"")))
}

/// Value of `periods`.
fn periods(item: &TomlItem<'_>) -> Result<Periods> {
    match item.text()? {
        "coherent" => Ok(Periods::Coherent),
        "random" => Ok(Periods::Random),
        other => Err(item.refuse(format_args!("{other:?} is unknown; write \"coherent\" or \"random\""))),
    }
}

/// Value as a length from 0 nm to a metre.
fn length(item: &TomlItem<'_>) -> Result<f64> {
    match item.number()? {
        x if x < 0.0 => Err(item.refuse(format_args!("{x} is negative; lengths are 0 nm or more"))),
        x if x > MAX_LENGTH_NM => Err(item.refuse(format_args!("{x} is more than {MAX_LENGTH_NM} nm, a metre"))),
        x => Ok(x),
    }
}

impl SceneReader<'_> {
    fn path(&mut self, item: &TomlItem<'_>) -> Result<PathBuf> {
        let name = item.text()?;
        let folder = self.folder.ok_or_else(|| item.refuse("only a scene in a file can name files"))?;
        let path = folder.join(name);
        if !path.exists() {
            return Err(item.refuse(format_args!("{}: no such file; paths start at the scene file", path.display())));
        }
        self.files.push(canonical(&path));
        Ok(path)
    }

    /// Reads `[materials.NAME]`: n and k, a table, or a file.
    fn material(&mut self, item: &TomlItem<'_>, default: Extrapolate) -> Result<OwnedMedium> {
        let table = item.table(format!("[materials.{}]", toml_key(item.key())))?;
        table.allow(&["n", "k", "table", "file", "unit", "extrapolate", "description", "source"])?;
        let extrapolate = extrapolate(&table, default)?;
        let unit = table.get("unit").map(|item| unit(&item)).transpose()?;
        if let (Some(item), None) = (table.get("unit"), table.get("file")) {
            return Err(item.refuse("only columns of text in a file have a unit; an inline table is in nm"));
        }
        if let Some(rows) = table.get("table") {
            if let Some(other) = ["n", "k", "file"].into_iter().find_map(|key| table.get(key)) {
                return Err(other.refuse("a material has either a table, a file, or n and k; keep one"));
            }
            return self.inline(&rows, extrapolate);
        }
        match (table.get("n"), table.get("k"), table.get("file")) {
            (Some(n), k, None) => {
                let k_value = k.as_ref().map_or(Ok(0.0), TomlItem::number)?;
                media::constant(k.as_ref().unwrap_or(&n), n.number()?, k_value)
            }
            (None, None, Some(file)) => {
                let path = self.path(&file)?;
                let content = read_text(&path, MAX_NK_BYTES)?;
                let source = SourceText { label: &path.to_string_lossy(), text: &content };
                match (is_yaml(&path, &content), table.get("unit")) {
                    (false, _) => delimited::parse(&source, unit, extrapolate),
                    (true, None) => refractive_index_info::parse(&source, extrapolate),
                    (true, Some(unit)) => {
                        Err(unit.refuse("the format of refractiveindex.info is in micrometres; remove it"))
                    }
                }
            }
            (Some(_), _, Some(file)) | (None, Some(_), Some(file)) => {
                Err(file.refuse("a material has either a file or n and k; remove one"))
            }
            (None, Some(k), None) => Err(k.refuse("k without n; add n")),
            (None, None, None) => Err(table.refuse("no data; add n (and k), table or file")),
        }
    }

    /// Reads `table = [[nm, n, k], …]`.
    fn inline(&self, item: &TomlItem<'_>, extrapolate: Extrapolate) -> Result<OwnedMedium> {
        let mut rows = Vec::new();
        for row in item.array()? {
            let numbers = row.array()?.iter().map(TomlItem::number).collect::<Result<Vec<_>>>()?;
            if !(2..=3).contains(&numbers.len()) {
                return Err(row.refuse(format_args!("a row of {} numbers; write [nm, n] or [nm, n, k]", numbers.len())));
            }
            rows.push((row.line() as usize, numbers));
        }
        if rows.is_empty() {
            return Err(item.refuse("no rows; write table = [[400, 1.5, 0.0], [700, 1.48, 0.0]]"));
        }
        delimited::inline(&SourceText { label: self.label, text: "" }, &rows, extrapolate)
    }

    fn stack(&mut self, table: &TomlTable<'_>) -> Result<Shape> {
        table.allow(&["ambient", "layers", "substrate"])?;
        let ambient = self.media.resolve_ambient(&table.require("ambient", "ambient = 1.0, for air \"air\"")?)?;
        let layers = table.get("layers").map_or(Ok(Vec::new()), |item| self.layers(&item))?;
        let substrate = table.require("substrate", "a number, a pair [n, k], a material or \"mirror\"")?;
        let substrate = self.media.resolve_below(&substrate)?;
        Ok(Shape::Stack { ambient, layers, substrate })
    }

    /// Reads a list of layers and writes its repetitions out. The layers are counted first, which bounds the memory.
    fn layers(&mut self, item: &TomlItem<'_>) -> Result<Vec<Layer>> {
        let count = count_layers(item, 0)?;
        if count > u64::from(MAX_LAYERS) {
            return Err(item.refuse(format_args!("{count} layers after writing out repeat; at most {MAX_LAYERS}")));
        }
        self.expand(item)
    }

    fn expand(&mut self, item: &TomlItem<'_>) -> Result<Vec<Layer>> {
        let mut layers = Vec::new();
        for entry in item.array()? {
            let table = layer_table(&entry)?;
            if let Some(repeat) = table.get("repeat") {
                let group = self.expand(&table.require("layers", "layers = [ … ]")?)?;
                layers.extend(group.repeat(repeat.count(MAX_LAYERS)? as usize));
            } else {
                let medium = self.medium(&table.require("material", "a number, a pair [n, k] or a material")?)?;
                let thickness_nm = length(&table.require("thickness_nm", "thickness_nm = 100.0")?)?;
                let sigma_nm = table.get("spread_nm").map_or(Ok(0.0), |item| length(&item))?;
                let spread = ThicknessSpread { sigma_nm, entry: self.entries };
                self.entries += 1;
                layers.push(Layer { medium, thickness_nm, spread: (sigma_nm > 0.0).then_some(spread) });
            }
        }
        Ok(layers)
    }

    fn medium(&mut self, item: &TomlItem<'_>) -> Result<MediumIndex> {
        self.media.resolve(item)
    }

    fn cell(&mut self, table: &TomlTable<'_>, interfaces: Option<TomlItem<'_>>) -> Result<Geometry> {
        table.allow(&["mesh", "surface", "period_nm", "periods", "front", "axes", "unit_nm"])?;
        let facets = match (table.get("mesh"), table.get("surface")) {
            (Some(mesh), None) => Facets::Mesh(mesh),
            (None, Some(surface)) => Facets::Surface(surface),
            (Some(_), Some(item)) => return Err(item.refuse("a [cell] has either a mesh or a surface; remove one")),
            (None, None) => return Err(table.refuse("neither mesh nor surface; write mesh = \"file.obj\"")),
        };
        if let Facets::Surface(_) = facets
            && let Some(item) = ["axes", "unit_nm"].iter().find_map(|key| table.get(key))
        {
            return Err(item.refuse("only a mesh has it; remove it"));
        }
        // A height map that says what it spans gives the period.
        let spans = |surface: &TomlItem<'_>| Ok(surface.table("surface")?.get("size_nm").is_some());
        let period_nm = match (table.get("period_nm"), &facets) {
            (None, Facets::Surface(surface)) if spans(surface)? => [0.0; 2],
            _ => period(&table.require("period_nm", "period_nm = [x, y]")?)?,
        };
        let periods = table.get("periods").map(|item| periods(&item)).transpose()?;
        let front = table.get("front").map(|item| self.media.resolve_ambient(&item)).transpose()?;
        let missing = "a [cell] needs one [interface.NAME] for each usemtl name of its mesh; add them";
        let entries = interfaces.ok_or_else(|| table.refuse(missing))?.table("[interface]")?.entries();
        let interfaces = entries.map(|item| self.interface(&item)).collect::<Result<Vec<_>>>()?;
        if interfaces.len() > usize::from(u16::MAX) {
            return Err(table.refuse(format_args!("{} interfaces; at most {}", interfaces.len(), u16::MAX)));
        }
        let names: Vec<&str> = interfaces.iter().map(|interface| interface.name.as_str()).collect();
        let frame = MeshFrame::read(table)?;
        let Generated { mut mesh, period_nm, notes } = match facets {
            Facets::Mesh(item) => {
                let mesh = Mesh::read(&self.path(&item)?, Some(&names), frame)?;
                Generated { mesh, period_nm, notes: Vec::new() }
            }
            Facets::Surface(item) => {
                let label = self.label;
                surface::build(&item, label, period_nm, Some(&names), &mut |item| self.path(item))?
            }
        };
        mesh.drop_unused();
        placement::fit(&mut mesh, period_nm, frame)?;
        Ok(Geometry::Cell { mesh, period_nm, interfaces, extras: CellExtras { periods, front, notes } })
    }

    fn interface(&mut self, item: &TomlItem<'_>) -> Result<NamedInterface> {
        let table = item.table(format!("[interface.{}]", toml_key(item.key())))?;
        table.allow(&["above", "below", "coating"])?;
        let above = table.require("above", "the medium on the side of the facet's normal")?;
        let above = self.medium(&above)?;
        let below = table.require("below", "the medium behind the facet, or \"mirror\"")?;
        let below: Below = self.media.resolve_below(&below)?;
        let coating = table.get("coating").map_or(Ok(Vec::new()), |item| self.layers(&item))?;
        if let (Some(item), true) = (table.get("coating"), coating.iter().any(|layer| layer.spread.is_some())) {
            return Err(item.refuse("a coating has one thickness; remove spread_nm, which is for layers of a [stack]"));
        }
        Ok(NamedInterface { name: item.key().to_owned(), interface: Interface { above, below }, coating })
    }
}

/// Periods in x and y, each more than 0.
fn period(item: &TomlItem<'_>) -> Result<[f64; 2]> {
    let period_nm = match item.array()?.as_slice() {
        [x, y] => [length(x)?, length(y)?],
        _ => return Err(item.refuse(format_args!("expected two lengths [x, y], found {}", item.found()))),
    };
    if period_nm.contains(&0.0) {
        return Err(item.refuse("a period must be more than 0 nm"));
    }
    Ok(period_nm)
}

/// Table of a layer, or of a repeated group of layers.
fn layer_table<'a>(entry: &TomlItem<'a>) -> Result<TomlTable<'a>> {
    let table = entry.table("layer")?;
    table.allow(&["material", "thickness_nm", "spread_nm", "repeat", "layers"])?;
    let group = ["repeat", "layers"].iter().any(|key| table.get(key).is_some());
    let single = ["material", "thickness_nm", "spread_nm"].iter().any(|key| table.get(key).is_some());
    match (group, single) {
        (true, true) => Err(table.refuse("either material and thickness_nm, or repeat and layers; not both")),
        (true, false) => table.require("repeat", "repeat = 10").map(|_| table.clone()),
        _ => Ok(table),
    }
}

/// Number of layers of a list with repetitions written out.
fn count_layers(item: &TomlItem<'_>, depth: u32) -> Result<u64> {
    if depth > MAX_REPEAT_DEPTH {
        return Err(item.refuse(format_args!("repeat within repeat, more than {MAX_REPEAT_DEPTH} deep")));
    }
    let mut count = 0u64;
    for entry in item.array()? {
        let table = layer_table(&entry)?;
        let here = match table.get("repeat") {
            None => Some(1),
            Some(repeat) => {
                let group = count_layers(&table.require("layers", "layers = [ … ]")?, depth + 1)?;
                group.checked_mul(u64::from(repeat.count(MAX_LAYERS)?))
            }
        };
        let total = here.and_then(|here| count.checked_add(here));
        count =
            total.ok_or_else(|| item.refuse(format_args!("more than {} layers; at most {MAX_LAYERS}", u64::MAX)))?;
    }
    Ok(count)
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
