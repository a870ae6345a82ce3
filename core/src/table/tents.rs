//! Solid angles that nodes of the warped square stand for.

use super::layout::ScatterLayout;
use super::warp::HalfVectorWarp;
use glam::Vec3;

/// Points of the midpoint rule along each side of a cell between four nodes.
const POINTS: usize = 8;

/// Calls `add(node, Ω)` several times for each node of the square, so that the sums of Ω are ∫ t(ω_o) dω_o over the
/// outgoing directions above the horizon, for the node's interpolation weight t (its tent) and light from `wi`. The sums
/// over all nodes add up to the solid angle that the square covers: 2π, as far as the warp's inverse is exact.
///
/// `origin` is the azimuth from which φ_m counts: 0, or that of `wi` in isotropic tables. The integral is a midpoint
/// rule of 8 × 8 points between four nodes. It errs by some 10⁻³ of a node's part, and by more where the horizon cuts a
/// cell; [`ScatterTable::albedo`](super::ScatterTable::albedo) uses the same rule, so that a table that was divided by
/// these numbers reflects exactly what was counted.
pub fn tent_solid_angles(
    layout: &ScatterLayout,
    warp: &HalfVectorWarp<'_>,
    wi: Vec3,
    origin: f32,
    mut add: impl FnMut(usize, f32),
) {
    let [u, v] = layout.square_sides();
    let cells = (u - 1, v);
    let area = 1.0 / ((u - 1) as f32 * v as f32 * (POINTS * POINTS) as f32);
    let part = |i: usize| (i as f32 + 0.5) / POINTS as f32;
    for column in 0..cells.0 {
        // sin θ_m, cos θ_m, and solid angle per area over wi·m and over the density along v.
        let along_u: [[f32; 3]; POINTS] = core::array::from_fn(|i| {
            let x = (column as f32 + part(i)) / (u - 1) as f32;
            let (m, solid_angle) = warp.half_vector([x, 0.0], 0.0);
            [libm::sqrtf((1.0 - m.z * m.z).max(0.0)), m.z, solid_angle * warp.density(1, 0)]
        });
        for row in 0..cells.1 {
            let mut corners = [0.0; 4];
            for j in 0..POINTS {
                let y = (row as f32 + part(j)) / v as f32;
                let (sin, cos, density) = warp.azimuth_of(y, origin);
                for (i, &[sin_m, cos_m, solid_angle]) in along_u.iter().enumerate() {
                    let cos_d = sin_m * (cos * wi.x + sin * wi.y) + cos_m * wi.z;
                    if cos_d > 0.0 && 2.0 * cos_d * cos_m > wi.z {
                        let here = solid_angle * cos_d / density * area;
                        let (right, upper) = (part(i), part(j));
                        corners[0] += here * (1.0 - right) * (1.0 - upper);
                        corners[1] += here * right * (1.0 - upper);
                        corners[2] += here * (1.0 - right) * upper;
                        corners[3] += here * right * upper;
                    }
                }
            }
            let next = (row + 1) % v;
            let nodes = [(row, column), (row, column + 1), (next, column), (next, column + 1)];
            for ((row, column), corner) in nodes.into_iter().zip(corners) {
                add((row * u + column) as usize, corner);
            }
        }
    }
}
