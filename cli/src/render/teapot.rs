//! Newell's teapot as a mesh: 32 bicubic Bézier patches.

use std::collections::HashMap;
use std::sync::OnceLock;

use glam::DVec3;

use super::mesh::TriangleMesh;

/// Control points of a patch, row by row.
type Patch = [[DVec3; 4]; 4];

/// Distance below which two places are one: some 10⁻¹² of the pot, above the rounding of Bézier's sums.
const SAME_PLACE: f64 = 1e-11;

/// Length below which a derivative counts as 0: those at the pot's regular points are longer than 0.1.
const VANISHES: f64 = 1e-9;

/// The control points as Newell published them, with the bottom that was added later.
fn patches() -> &'static [Patch] {
    static PATCHES: OnceLock<Vec<Patch>> = OnceLock::new();
    PATCHES.get_or_init(|| {
        let text = include_str!("../../data/mesh/teapot.bpt");
        // Only lines of three numbers are points: the first line counts the patches, and each patch begins with its two
        // degrees.
        let points: Vec<DVec3> = text
            .lines()
            .filter_map(|line| {
                let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
                <[f64; 3]>::try_from(numbers).ok().map(DVec3::from_array)
            })
            .collect();
        points.chunks_exact(16).map(|p| std::array::from_fn(|row| std::array::from_fn(|i| p[4 * row + i]))).collect()
    })
}

impl TriangleMesh {
    /// Newell's teapot, each of its 32 patches cut into `level` × `level` quads. t follows the first parameter of the
    /// patch, which runs around the pot.
    ///
    /// Normals and tangents are those of the patches themselves, at their poles the limits.
    #[must_use]
    pub fn teapot(level: u32) -> Self {
        tessellate(level)
    }
}

fn tessellate(level: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    let mut places = HashMap::new();
    let at = |step: u32| f64::from(step) / f64::from(level);
    for patch in patches() {
        let first = mesh.positions.len() as u32;
        for row in 0..=level {
            for column in 0..=level {
                let point = PatchPoint::at(patch, at(column), at(row));
                // Patches that share an edge compute it by different sums: the first one's result counts.
                let key = point.position.to_array().map(|x| (x / SAME_PLACE).round() as i64);
                let position = *places.entry(key).or_insert(point.position);
                mesh.push(position, point.normal, point.tangent);
            }
        }
        mesh.grid(first, level, level, true);
    }
    mesh
}

/// A point of a patch with its frame.
struct PatchPoint {
    position: DVec3,
    normal: DVec3,
    tangent: DVec3,
}

impl PatchPoint {
    /// The point of a patch at parameters u and v in [0, 1].
    fn at(patch: &Patch, u: f64, v: f64) -> Self {
        let sum = |along: [f64; 4], across: [f64; 4]| -> DVec3 {
            patch.iter().zip(across).map(|(row, y)| y * row.iter().zip(along).map(|(&p, x)| x * p).sum::<DVec3>()).sum()
        };
        let (mut du, mut dv) = (sum(bernstein_slopes(u), bernstein(v)), sum(bernstein(u), bernstein_slopes(v)));
        // At a pole a whole edge of the patch is one point, and the derivative along it is 0. Just inside, it is the
        // mixed derivative times the distance from the edge.
        let mixed = || sum(bernstein_slopes(u), bernstein_slopes(v));
        if du.length() < VANISHES {
            du = if v < 0.5 { mixed() } else { -mixed() };
        }
        if dv.length() < VANISHES {
            dv = if u < 0.5 { mixed() } else { -mixed() };
        }
        Self { position: sum(bernstein(u), bernstein(v)), normal: du.cross(dv).normalize(), tangent: du }
    }
}

/// Bernstein polynomials of degree 3 at t.
fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

/// Derivatives of the Bernstein polynomials of degree 3 at t.
fn bernstein_slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}

#[cfg(test)]
mod tests {
    use super::super::mesh::tests::{check, open_edges};
    use super::*;

    #[test]
    fn all_patches_are_read() {
        assert_eq!(patches().len(), 32);
        assert_eq!(patches()[0][0][0], DVec3::new(1.4, 0.0, 2.4));
        assert_eq!(patches()[31][3][3].z, 0.15);
    }

    #[test]
    fn normals_are_outward_everywhere_and_whole() {
        for level in [1, 2, 7, 32] {
            let mesh = tessellate(level);
            assert!(mesh.normals.iter().chain(&mesh.tangents).all(|v| v.is_finite()));
            if level > 2 {
                check(&mesh);
            }
        }
    }

    #[test]
    fn patches_meet_without_seams() {
        let mesh = tessellate(8);
        // Open in the original: the inner rim and the lid's edge, 4 patches each; both ends of the handle and of the
        // spout, 2 patches each.
        assert_eq!(open_edges(&mesh), 16 * 8);
        let mut places: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
        for (i, p) in mesh.positions.iter().enumerate() {
            places.entry(p.to_array().map(f64::to_bits)).or_default().push(i);
        }
        // Patches meet smoothly everywhere but where the lower end of the handle touches the pot.
        let apart = |pair: &[usize]| mesh.normals[pair[0]].distance(mesh.normals[pair[1]]) > 1e-6;
        let creases: Vec<DVec3> =
            places.values().filter(|shared| shared.windows(2).any(apart)).map(|s| mesh.positions[s[0]]).collect();
        assert_eq!(creases, [DVec3::new(-2.0, 0.0, 0.9)]);
        let near = |a: DVec3| mesh.positions.iter().filter(|p| p.distance(a) < 1e-6 && **p != a).count();
        assert!(mesh.positions.iter().step_by(37).all(|&p| near(p) == 0));
    }
}
