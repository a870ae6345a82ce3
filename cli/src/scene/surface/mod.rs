//! Surfaces that a scene file describes in place of a mesh: `[cell] surface = { kind = "…", … }`.
//!
//! Each kind becomes the same triangle mesh as an OBJ file would, from x = 0, y = 0 to the period, z up, normals up (of
//! particles: outwards). What is random is drawn from `seed` alone (an integer, 0 if left out), so that a scene is the same wherever it
//! is loaded. Lengths are in nanometres. The scene needs one `[interface.NAME]` for each name in the last column, and may
//! have no others.
//!
//! | kind | is | interfaces |
//! |---|---|---|
//! | `sines` | a smooth bumpy sheet, or two of them a vertical distance apart | `upper`; with `offset_nm` also `lower` |
//! | `pits` | a hexagonal lattice of concave spherical caps | `pits` |
//! | `lamellae` | a ridge along y that carries shelves on both sides | `cuticle` |
//! | `grooves` | a profile, the same at every y | `grooves` |
//! | `pyramids` | upright or inverted square pyramids | `pyramids` |
//! | `scratches` | random heights along x, the same at every y | `scratches` |
//! | `particles` | closed ellipsoids or flakes in a layer between planes | `top`, with `film_nm` also `film`, `base`, `particle` |
//!
//! The keys of each kind are described in its file's first lines; all but those marked optional are required.
//!
//! - `sines`: `waves` (1 to 1000), `highest` (1 to 100), `rms_slope`, `grid = [nx, ny]`; optional `seed`, `offset_nm`
//! - `pits`: `depth_nm`; optional `rings` (8)
//! - `lamellae`: `shelves`, `width_nm`, `shelf_nm`, `gap_nm`, `trunk_nm`; optional `top_width_nm` (as `width_nm`), `stagger_nm` (0)
//! - `grooves`: `points_nm = [[x, z], …]`
//! - `pyramids`: `count = [nx, ny]`; optional `angle_deg` (54.7356), `fill = [least, most]` ([1, 1]), `inverted` (false), `seed`
//! - `scratches`: `segments` (2 to 100 000), `rms_slope`; optional `seed`
//! - `particles`: `shape = "ellipsoid" | "flake"`, `radii_nm = [x, y, z]`, `count = [nx, ny, nz]`, `depth_nm`; optional
//!   `film_nm` (none), `tilt_deg` (0), `subdivisions` (2), `seed`

mod grooves;
mod lamellae;
mod particles;
mod pits;
mod pyramids;
mod scratches;
mod sines;

use std::path::Path;

use glam::DVec3;

use super::MAX_LENGTH_NM;
use super::diagnostics::nearest;
use super::mesh::{Mesh, Triangle};
use super::toml_value::{Item, Table};
use crate::support::error::Result;
use crate::support::text::toml_key;

/// Far finer than any microscopic surface needs; a slip in a count asks for billions.
const MAX_TRIANGLES: u64 = 1_000_000;

/// Kind, its interfaces in the order of their numbers, and how it is made.
const KINDS: &[(&str, Interfaces, Generator)] = &[
    ("sines", sines::interfaces, sines::build),
    ("pits", |_| &["pits"], pits::build),
    ("lamellae", |_| &["cuticle"], lamellae::build),
    ("grooves", |_| &["grooves"], grooves::build),
    ("pyramids", |_| &["pyramids"], pyramids::build),
    ("scratches", |_| &["scratches"], scratches::build),
    ("particles", particles::interfaces, particles::build),
];

type Interfaces = fn(&Table<'_>) -> &'static [&'static str];
type Generator = fn(&Table<'_>, &mut Builder) -> Result<()>;

/// The mesh of `surface = { … }`; `names` are the scene's interfaces.
pub(super) fn build(item: &Item<'_>, label: &str, period_nm: [f64; 2], names: &[&str]) -> Result<Mesh> {
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
    let mut builder = Builder { mesh, numbers, line: item.line(), period_nm };
    generate(&table, &mut builder)?;
    Ok(builder.mesh)
}

/// A mesh being made.
struct Builder {
    mesh: Mesh,
    /// The scene's number of each interface of the kind.
    numbers: Vec<u16>,
    line: u32,
    period_nm: [f64; 2],
}

impl Builder {
    fn vertex(&mut self, point: DVec3) -> u32 {
        self.mesh.vertices.push(point.to_array());
        self.mesh.vertices.len() as u32 - 1 // MAX_TRIANGLES bounds it
    }

    /// A triangle of the kind's interface of this number, counter-clockwise seen from the side of its normal.
    fn triangle(&mut self, vertices: [u32; 3], interface: usize) {
        self.mesh.triangles.push(Triangle { vertices, interface: self.numbers[interface], line: self.line });
    }

    fn quad(&mut self, [a, b, c, d]: [u32; 4], interface: usize) {
        self.triangle([a, b, c], interface);
        self.triangle([a, c, d], interface);
    }

    /// A horizontal plane over the whole period, its normal up.
    fn plane(&mut self, z_nm: f64, interface: usize) {
        let [x, y] = self.period_nm;
        let corners = [(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)].map(|(x, y)| self.vertex(DVec3::new(x, y, z_nm)));
        self.quad(corners, interface);
    }

    /// The surface under a line of (x, z), left to right, at every y; its normals point to the left of the line's way, that is up.
    fn extrude(&mut self, profile: &[[f64; 2]], interface: usize) {
        let y = self.period_nm[1];
        let mut ends = Vec::with_capacity(profile.len());
        for &[x, z] in profile {
            ends.push([0.0, y].map(|y| self.vertex(DVec3::new(x, y, z))));
        }
        for pair in ends.windows(2) {
            let ([a, d], [b, c]) = (pair[0], pair[1]);
            self.quad([a, b, c, d], interface);
        }
    }

    /// A height field of nx × ny squares, each two triangles, and its vertices' height.
    fn height_field(&mut self, [nx, ny]: [u32; 2], interface: usize, height: impl Fn(f64, f64) -> f64) {
        let [px, py] = self.period_nm;
        let first = self.mesh.vertices.len() as u32;
        for j in 0..=ny {
            for i in 0..=nx {
                let (u, v) = (f64::from(i) / f64::from(nx), f64::from(j) / f64::from(ny));
                // The opposite border repeats this one to the last digit.
                let z = height(if i == nx { 0.0 } else { u }, if j == ny { 0.0 } else { v });
                self.vertex(DVec3::new(u * px, v * py, z));
            }
        }
        let at = |i: u32, j: u32| first + j * (nx + 1) + i;
        for j in 0..ny {
            for i in 0..nx {
                self.quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], interface);
            }
        }
    }
}

/// Refuses a surface of too many triangles before any of it is made.
fn bounded(table: &Table<'_>, triangles: u64) -> Result<()> {
    if triangles > MAX_TRIANGLES {
        return Err(table.refuse(format_args!("{triangles} triangles; at most {MAX_TRIANGLES}; use smaller counts")));
    }
    Ok(())
}

/// Within [least, most].
fn within(item: &Item<'_>, [least, most]: [f64; 2]) -> Result<f64> {
    match item.number()? {
        x if (least..=most).contains(&x) => Ok(x),
        x => Err(item.refuse(format_args!("{x} must lie between {least} and {most}"))),
    }
}

/// A length of more than 0 nm.
fn length(table: &Table<'_>, key: &str) -> Result<f64> {
    positive(&table.require(key, &format!("{key} = 1000.0"))?)
}

fn positive(item: &Item<'_>) -> Result<f64> {
    match item.number()? {
        x if x > 0.0 && x <= MAX_LENGTH_NM => Ok(x),
        x => Err(item.refuse(format_args!("{x} nm; a length here is more than 0 nm and at most a metre"))),
    }
}

/// An integer between the limits.
fn count(item: &Item<'_>, [least, most]: [u32; 2]) -> Result<u32> {
    match item.count(most)? {
        n if n >= least => Ok(n),
        n => Err(item.refuse(format_args!("{n} is too few; at least {least}"))),
    }
}

/// A list of exactly N values.
fn list<'a, const N: usize>(item: &Item<'a>) -> Result<[Item<'a>; N]> {
    let found = || item.refuse(format_args!("expected a list of {N}, found {}", item.found()));
    item.array()?.try_into().map_err(|_| found())
}

/// A list of N integers from 1 to `most`.
fn counts<const N: usize>(table: &Table<'_>, key: &str, most: u32) -> Result<[u32; N]> {
    let example = vec!["4"; N].join(", ");
    let items = list::<N>(&table.require(key, &format!("{key} = [{example}]"))?)?;
    let mut numbers = [0; N];
    for (number, item) in numbers.iter_mut().zip(&items) {
        *number = count(item, [1, most])?;
    }
    Ok(numbers)
}

fn random(table: &Table<'_>) -> Result<Random> {
    Ok(Random(table.get("seed").map_or(Ok(0), |item| item.count(u32::MAX))?.into()))
}

/// SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): every seed, 0 too, gives a good sequence.
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.unit()
    }

    /// Of mean 0 and variance 1 (Box and Muller, 1958).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.unit()).cos()
    }
}

#[cfg(test)]
#[path = "tests.rs"]
mod tests;
