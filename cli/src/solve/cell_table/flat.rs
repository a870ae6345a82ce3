//! Flat facets, which reflect into exact directions, and the lobes that they can make.

use std::collections::HashMap;

use glam::{DMat3, DVec3};
use goniochrome::optics::interface::Below;
use goniochrome::table::FacetLobe;

use crate::solve::mesh_scene::MeshScene;
use crate::support::error::Result;

/// The smallest area of all facets with parallel normals, over that of the period, that counts as flat. A curved
/// surface has some hundred facets or more, of other normals each; a pyramid, a shelf or a flake is a plane.
const MIN_AREA: f64 = 0.01;

/// The largest number of products of reflections that are looked for. It holds all of five hits in pyramids, and all of
/// two among forty flakes.
const MAX_PRODUCTS: usize = 2000;

/// Steps of the components of vectors and matrices that count as equal: far above the rounding of meshes in single
/// precision, far below a difference that a table would show.
const STEPS: f64 = 1e5;

/// Largest horizontal part of normals along lines: the rounding of meshes in single precision.
const ALONG: f64 = 1e-5;

/// The components of a vector or matrix in whole steps.
fn key<const N: usize>(numbers: [f64; N]) -> [i64; N] {
    numbers.map(|x| (x * STEPS).round() as i64)
}

/// Whether two unit normals are parallel, up to the rounding of meshes in single precision.
pub(super) fn are_parallel(a: DVec3, b: DVec3) -> bool {
    a.dot(b).abs() > 1.0 - 1e-9
}

/// The unit normals of flat facets, upwards, in a fixed order.
pub(super) fn flat_normals(mesh_scene: &MeshScene<'_>) -> Vec<DVec3> {
    let mut area: HashMap<[i64; 3], (DVec3, f64)> = HashMap::new();
    for ([a, b, c], _, _) in mesh_scene.triangles() {
        let twice = (b - a).cross(c - a);
        let normal = twice.normalize_or_zero();
        let upwards = if normal.z < -0.5 / STEPS || (normal.z < 0.5 / STEPS && normal.x + normal.y < 0.0) {
            -normal
        } else {
            normal
        };
        area.entry(key(upwards.to_array())).or_insert((upwards, 0.0)).1 += 0.5 * twice.length();
    }
    let [width, depth] = mesh_scene.period_nm();
    let mut flat: Vec<_> = area.into_iter().filter(|(_, (_, area))| *area >= MIN_AREA * width * depth).collect();
    flat.sort_by_key(|(key, _)| *key);
    flat.into_iter().map(|(_, (normal, _))| normal).collect()
}

/// Whether the surface does not vary along x or along y. Then light has no part of half vectors along the lines,
/// however often it is reflected.
pub(super) fn is_of_lines(mesh_scene: &MeshScene<'_>) -> bool {
    let mut along = DVec3::ZERO;
    for ([a, b, c], _, _) in mesh_scene.triangles() {
        along = along.max((b - a).cross(c - a).normalize_or_zero().abs());
    }
    along.x.min(along.y) < ALONG
}

/// The indices, over that of the ambient medium, in which facets may lie under horizontal planes: that of the ambient
/// medium first.
pub(super) fn indices_under_planes(mesh_scene: &MeshScene<'_>, wavelength_nm: f64) -> Result<Vec<f64>> {
    let media = mesh_scene.media();
    let index = |medium: u16| -> Result<f64> {
        let eta = media[usize::from(medium)].eta(wavelength_nm);
        eta.map(|eta| eta.re).map_err(|error| mesh_scene.scene().medium_error(medium.into(), &error))
    };
    let ambient = index(mesh_scene.above())?;
    let mut indices = vec![1.0];
    for ([a, b, c], interface, _) in mesh_scene.triangles() {
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if 1.0 - normal.z.abs() > 1.0 / STEPS {
            continue;
        }
        let below = if let Below::Medium(medium) = interface.below { Some(medium) } else { None };
        for medium in [Some(interface.above), below].into_iter().flatten() {
            let relative = index(medium)? / ambient;
            if relative > 1e-3 && relative < 1e3 && !indices.iter().any(|known| (relative - known).abs() < 1e-6) {
                indices.push(relative);
            }
        }
    }
    Ok(indices)
}

/// The lobes that products of reflections by facets of these normals may make, shorter products first.
pub(super) fn possible_lobes(normals: &[DVec3], indices: &[f64]) -> Vec<FacetLobe> {
    let reflections: Vec<DMat3> = normals
        .iter()
        .map(|&n| DMat3::IDENTITY - DMat3::from_cols(2.0 * n * n.x, 2.0 * n * n.y, 2.0 * n * n.z))
        .collect();
    let mut products = vec![DMat3::IDENTITY];
    let mut known: HashMap<[i64; 9], ()> = HashMap::from([(key(DMat3::IDENTITY.to_cols_array()), ())]);
    let mut next = 0;
    while next < products.len() && products.len() < MAX_PRODUCTS {
        let product = products[next];
        next += 1;
        for reflection in &reflections {
            let longer = *reflection * product;
            if known.insert(key(longer.to_cols_array()), ()).is_none() {
                products.push(longer);
            }
        }
    }
    let lobe = |product: &DMat3, index: f64| FacetLobe { index: index as f32, matrix: product.as_mat3() };
    products
        .iter()
        .flat_map(|product| {
            // Horizontal planes reflect and refract into the same direction in any medium.
            let level = (product.z_axis.z.abs() - 1.0).abs() < 1.0 / STEPS;
            let count = if level { 1 } else { indices.len() };
            indices[..count].iter().map(move |&index| lobe(product, index))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_facing_roofs_reflect_to_either_side() {
        let (sin, cos) = 0.3f64.sin_cos();
        let roofs = [DVec3::new(sin, 0.0, cos), DVec3::new(-sin, 0.0, cos)];
        let lobes = possible_lobes(&roofs, &[1.0]);
        // Rotations by multiples of 1.2 and reflections have no end.
        assert_eq!(lobes.len(), MAX_PRODUCTS);
        let wi = glam::Vec3::new(0.0, 0.0, 1.0);
        let found = lobes[1].direction(wi).unwrap();
        let expected = [-0.6f32.sin(), 0.6f32.sin()];
        assert!(expected.iter().any(|x| (found.x - x).abs() < 1e-6), "{found}");
    }

    #[test]
    fn a_plane_in_any_medium_is_one_mirror() {
        let lobes = possible_lobes(&[DVec3::Z], &[1.0, 1.33, 1.5]);
        assert_eq!(lobes.len(), 2);
        let wi = glam::Vec3::new(0.6, 0.0, 0.8);
        assert!((lobes[1].direction(wi).unwrap() - glam::Vec3::new(-0.6, 0.0, 0.8)).length() < 1e-6);
    }
}
