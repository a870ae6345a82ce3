//! The grid and the rays of a cell's table, unless the user names others.

use glam::DVec3;

use crate::solve::cell_table::flat::{are_parallel, flat_normals, is_of_lines};
use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::{Coherence, Likeness};

/// Sides of a table: incident directions in θ_i × φ_i, and half vectors outwards × around the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sides {
    /// Rows in θ_i and columns in φ_i.
    pub incident: [u32; 2],
    /// Nodes of half vectors along x and along y. A .bsdf file has equally many steps along both: the steps along x,
    /// one less than the nodes, and those along y have a small common multiple.
    pub half_vectors: [u32; 2],
}

impl Sides {
    /// Curved surfaces.
    pub const CURVED: Self = Self { incident: [15, 20], half_vectors: [13, 16] };
    /// Surfaces of lines: half vectors lie across the lines, so few azimuths of them are needed.
    pub const LINES: Self = Self { incident: [28, 20], half_vectors: [13, 8] };
    /// Surfaces of flat facets: lobes are exact, boxes hold the rest, and the power of lobes has kinks where a facet's
    /// shadow begins.
    pub const FLAT: Self = Self { incident: [22, 24], half_vectors: [7, 12] };
    /// Tables that are averaged around the normal: one incident azimuth.
    pub const ISOTROPIC: Self = Self { incident: [24, 1], half_vectors: [33, 32] };
}

/// Share of the area, seen from above, that flat facets have at least on surfaces of flat facets.
const MIN_FLAT: f64 = 0.9;

/// Default number of starting rays of an incident direction: some for each box.
const RAYS: u32 = 4096;
/// Default number where waves of several wavelengths pass between interfaces one by one: each ray costs as much as ten
/// others.
const RAYS_BETWEEN: u32 = 1024;

/// The default sides of the table of a cell. Together they hold at most 65 536 values in each channel, with
/// room for 40 lobes on surfaces of flat facets.
#[must_use]
pub fn default_sides(mesh_scene: &MeshScene<'_>) -> Sides {
    let flat = flat_normals(mesh_scene);
    let (mut area, mut of_flat) = (0.0, 0.0);
    for ([a, b, c], _, _) in mesh_scene.triangles() {
        let twice = (b - a).cross(c - a);
        let normal: DVec3 = twice.normalize_or_zero();
        area += twice.z.abs();
        if flat.iter().any(|flat| are_parallel(*flat, normal)) {
            of_flat += twice.z.abs();
        }
    }
    match () {
        () if of_flat >= MIN_FLAT * area => Sides::FLAT,
        () if is_of_lines(mesh_scene) => Sides::LINES,
        () => Sides::CURVED,
    }
}

/// The default number of starting rays of each incident direction.
#[must_use]
pub fn default_rays(mesh_scene: &MeshScene<'_>, wavelength_nm: &[f64], coherence: Coherence) -> u32 {
    let pass_between = mesh_scene.scene().shape.polygons().is_some_and(|cell| cell.interfaces().len() > 1);
    if pass_between && Likeness::of(mesh_scene, wavelength_nm, coherence.adding()) != Likeness::Light {
        RAYS_BETWEEN
    } else {
        RAYS
    }
}
