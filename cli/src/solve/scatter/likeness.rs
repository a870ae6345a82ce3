//! What light of several wavelengths has in common in a mesh, so that it is traced once for all of them.

use goniochrome::geometry::facet::Facet;

use crate::solve::mesh_scene::MeshScene;
use crate::solve::scatter::coherence::{Adding, Paths};

/// What rays of several wavelengths have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Likeness {
    /// Nothing: each wavelength refracts by itself.
    None,
    /// Their paths. Amplitudes differ by coatings, by absorption, or where waves of different phases merge.
    Paths,
    /// Their paths and amplitudes. Only phases differ.
    Light,
}

impl Likeness {
    /// What light of these wavelengths has in common, where rays add in this way.
    pub fn of(mesh_scene: &MeshScene<'_>, wavelength_nm: &[f64], adding: Adding) -> Self {
        if disperses(mesh_scene, wavelength_nm) {
            return Self::None;
        }
        let media = mesh_scene.media();
        let absorbs =
            |nm: f64| mesh_scene.sides().any(|medium| media[usize::from(medium)].eta(nm).is_ok_and(|eta| eta.im > 0.0));
        let merges = !matches!(adding, Adding::Powers(Paths::Alone)) && are_stacked(mesh_scene.facets());
        if mesh_scene.is_coated() || wavelength_nm.iter().copied().any(absorbs) || merges {
            Self::Paths
        } else {
            Self::Light
        }
    }
}

/// Whether light of these wavelengths needs paths of its own at each: a medium on either side of an interface has
/// indices that differ by more than would show over twice the height of the mesh, as those of air do not. Media in
/// coatings do not count: they turn no ray.
fn disperses(mesh_scene: &MeshScene<'_>, wavelength_nm: &[f64]) -> bool {
    /// Largest difference of an optical path, in wavelengths: phases differ by 6e-3 at most.
    const MAX_TURNS: f64 = 1e-3;
    let shortest = wavelength_nm.iter().copied().fold(f64::INFINITY, f64::min);
    let most = MAX_TURNS * shortest / (2.0 * mesh_scene.height_nm());
    let media = mesh_scene.media();
    mesh_scene.sides().any(|medium| {
        let index = |nm: f64| media[usize::from(medium)].eta(nm);
        let middle = index(wavelength_nm[wavelength_nm.len() / 2]);
        let agrees = |nm: &f64| matches!((&middle, index(*nm)), (Ok(a), Ok(b)) if (a - b).norm() <= most);
        !wavelength_nm.iter().all(agrees)
    })
}

/// Whether more than two planes of facets are parallel. Waves that cross such a stack of films meet again on paths of
/// many lengths, and must merge; those of one film do not.
fn are_stacked(facets: &[Facet]) -> bool {
    /// Parts of 1, and of a nanometre, that normals of parallel facets and places of one plane may differ by.
    const PARTS: [f64; 2] = [1e6, 1e3];
    let plane = |&Facet { normal, anchor_nm, .. }: &Facet| {
        // A facet may lie on its face or on its back.
        let leading = [normal.z, normal.y, normal.x].into_iter().find(|c| c.abs() * PARTS[0] > 1.0);
        let normal = if leading.is_some_and(|c| c < 0.0) { -normal } else { normal };
        let [x, y, z] = (normal * PARTS[0]).round().to_array();
        [x, y, z, (normal.dot(anchor_nm) * PARTS[1]).round()].map(|x| x as i64)
    };
    let mut planes: Vec<[i64; 4]> = facets.iter().map(plane).collect();
    planes.sort_unstable();
    planes.dedup();
    planes.windows(3).any(|three| three[0][..3] == three[2][..3])
}

/// Evaluates an expression with the lanes for the rays of a mesh at these wavelengths as a type:
/// `in_ray_lanes!(precision, likeness, wavelength_nm, V => run::<V>(scene))`. What they have in common is traced once
/// for up to 48 of them.
macro_rules! in_ray_lanes {
    ($precision:expr, $likeness:expr, $wavelength_nm:expr, $lanes:ident => $run:expr) => {
        $crate::solve::precision::in_lanes!($precision, Register => {
            use goniochrome::simd::{lanes::Lanes, registers::{Alike, Registers}};
            use $crate::solve::scatter::Likeness;
            const MANY: usize = 48 / <Register as Lanes>::WIDTH;
            match ($likeness, $wavelength_nm.len() <= <Register as Lanes>::WIDTH) {
                (Likeness::None, _) => {
                    type $lanes = Register;
                    $run
                }
                (Likeness::Paths, true) => {
                    type $lanes = Registers<Register, 1>;
                    $run
                }
                (Likeness::Paths, false) => {
                    type $lanes = Registers<Register, MANY>;
                    $run
                }
                (Likeness::Light, true) => {
                    type $lanes = Alike<Register, 1>;
                    $run
                }
                (Likeness::Light, false) => {
                    type $lanes = Alike<Register, MANY>;
                    $run
                }
            }
        })
    };
}
pub(crate) use in_ray_lanes;
