//! Surfaces that a scene file describes in place of a mesh: `[cell] surface = { kind = "…", … }`.
//!
//! Each kind becomes a triangle mesh like that of an OBJ file, from x = 0, y = 0 to the period, with z and the normals
//! up (normals of particles point outwards). Random numbers follow from `seed` alone (an integer, 0 if left out), so
//! that a scene is the same on every machine. Lengths are in nanometres. The scene needs one `[interface.NAME]` for
//! each name in the last column, and may have no others.
//!
//! | kind | is | interfaces |
//! |---|---|---|
//! | `sines` | a smooth bumpy sheet, or two at a vertical distance | `upper`; with `offset_nm` also `lower` |
//! | `pits` | a hexagonal lattice of concave spherical caps | `pits` |
//! | `lamellae` | a ridge along y that carries shelves on both sides | `cuticle` |
//! | `grooves` | a profile, the same at every y | `grooves` |
//! | `lines` | rectangular lines of one medium on a substrate of another | `line`, `foot`, `base` |
//! | `pyramids` | upright or inverted square pyramids | `pyramids` |
//! | `scratches` | random heights along x, the same at every y | `scratches` |
//! | `particles` | closed ellipsoids or flakes in a layer | `top`, with `film_nm` also `film`, `base`, `particle` |
//! | `height_map` | measured heights from a PNG, OpenEXR, TIFF or NPY file | `heights` |
//!
//! The first lines of each kind's file describe its keys. All but those marked optional are required.
//!
//! - `sines`: `waves` (1 to 1000), `highest` (1 to 100), `rms_slope`, `grid = [nx, ny]`; optional `seed`, `offset_nm`
//! - `pits`: `depth_nm`; optional `rings` (40)
//! - `lamellae`: `shelves`, `width_nm`, `shelf_nm`, `gap_nm`, `trunk_nm`; optional `top_width_nm` (as `width_nm`),
//!   `stagger_nm` (0)
//! - `grooves`: `points_nm = [[x, z], …]`
//! - `lines`: `width_nm`, `height_nm`
//! - `pyramids`: `count = [nx, ny]`; optional `angle_deg` (54.7356), `fill = [min, max]` ([1, 1]), `inverted` (false),
//!   `seed`
//! - `scratches`: `segments` (2 to 100 000), `rms_slope`; optional `seed`
//! - `particles`: `shape = "ellipsoid" | "flake"`, `radii_nm = [x, y, z]`, `count = [nx, ny, nz]`, `depth_nm`; optional
//!   `film_nm` (none), `tilt_deg` (0), `subdivisions` (2), `seed`
//! - `height_map`: `file`; `height_nm` (required for integers); optional `size_nm` (with it `[cell]` needs no
//!   `period_nm`), `edges = "mirror" | "blend" | "wrap"` (mirror), `level` (true; with wrap false), `smooth_nm` (none),
//!   `grid = [nx, ny]` (at most 128 a side)

mod builder;
mod keys;
mod random;
mod grooves;
mod height_map;
mod lamellae;
mod lines;
mod particles;
mod pits;
mod pyramids;
mod scratches;
mod sines;
mod kinds;

pub(super) use kinds::{Generated, build, mesh_of_map, single};

#[cfg(test)]
#[path = "tests.rs"]
mod tests;

#[cfg(test)]
mod height_map_tests;
