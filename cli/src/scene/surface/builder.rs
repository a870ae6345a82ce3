//! The mesh of a generated surface while it is made.

use std::path::PathBuf;

use glam::DVec3;

use crate::scene::mesh::{Mesh, Triangle};
use crate::scene::toml_value::{TomlItem, TomlTable};
use crate::support::error::Result;

/// Maximum number of triangles of a surface: far finer than any microscopic one needs; a slip in a count asks for
/// billions.
const MAX_TRIANGLES: u64 = 1_000_000;

/// Mesh under construction.
pub(super) struct Builder<'a> {
    pub mesh: Mesh,
    /// Index in the scene of each interface of the kind.
    pub numbers: Vec<u16>,
    /// Line of the surface in the scene file.
    pub line: u32,
    /// Period in x and y; zeros until a surface that knows its own writes it.
    pub period_nm: [f64; 2],
    /// What to say about the surface.
    pub notes: Vec<String>,
    /// Path of a file that the scene names.
    pub find: &'a mut dyn FnMut(&TomlItem<'_>) -> Result<PathBuf>,
}

impl Builder<'_> {
    /// Adds a vertex and returns its index.
    pub fn vertex(&mut self, point: DVec3) -> u32 {
        self.mesh.vertices.push(point.to_array());
        self.mesh.vertices.len() as u32 - 1 // MAX_TRIANGLES bounds it
    }

    /// Adds a triangle on an interface of the kind, counter-clockwise seen from the side of its normal.
    pub fn triangle(&mut self, vertices: [u32; 3], interface: usize) {
        self.mesh.triangles.push(Triangle { vertices, interface: self.numbers[interface], line: self.line });
    }

    /// Adds a quadrilateral as two triangles, counter-clockwise seen from the side of its normal.
    pub fn quad(&mut self, [a, b, c, d]: [u32; 4], interface: usize) {
        self.triangle([a, b, c], interface);
        self.triangle([a, c, d], interface);
    }

    /// Adds a horizontal plane over the whole period, its normal up.
    pub fn plane(&mut self, z_nm: f64, interface: usize) {
        let [x, y] = self.period_nm;
        let corners = [(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)].map(|(x, y)| self.vertex(DVec3::new(x, y, z_nm)));
        self.quad(corners, interface);
    }

    /// Extrudes a line of (x, z), from left to right, along y. The normals point to the left of the line's direction:
    /// up.
    pub fn extrude(&mut self, profile: &[[f64; 2]], interface: usize) {
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

    /// Adds a height field of nx × ny squares, each of two triangles; `height` takes fractions of the period.
    pub fn height_field(&mut self, [nx, ny]: [u32; 2], interface: usize, height: impl Fn(f64, f64) -> f64) {
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

/// Refuses a surface of too many triangles before it is made.
pub(super) fn bounded(table: &TomlTable<'_>, triangles: u64) -> Result<()> {
    if triangles > MAX_TRIANGLES {
        return Err(table.refuse(format_args!("{triangles} triangles; at most {MAX_TRIANGLES}; use smaller counts")));
    }
    Ok(())
}
