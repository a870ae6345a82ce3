//! Meshes to test with.

extern crate std;

use super::{Mesh, RandomVectors};
use glam::DVec3;
use std::vec::Vec;

/// Small triangles at random places in a cube.
pub(super) fn soup(count: usize) -> Mesh {
    let mut random = RandomVectors::new(1);
    let mut vertices = Vec::new();
    for _ in 0..count {
        let middle = random.cube();
        vertices.extend((0..3).map(|_| middle + 0.1 * random.cube()));
    }
    Mesh(vertices, (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
}

/// A wavy sheet over [−1, 1]² of 2 cells² triangles that face upwards.
pub(super) fn sheet(cells: u32) -> Mesh {
    let row = cells + 1;
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(cells) - 1.0;
    let height = |x: f64, y: f64| 0.1 * libm::sin(19.0 * x) * libm::cos(23.0 * y) + 0.05 * libm::sin(7.0 * x + 5.0 * y);
    let vertices = (0..row * row).map(|i| (at(i % row), at(i / row))).map(|(x, y)| DVec3::new(x, y, height(x, y)));
    let corners = (0..cells * cells).map(|i| i % cells + i / cells * row);
    let triangles = corners.flat_map(|a| [[a, a + 1, a + row + 1], [a, a + row + 1, a + row]]);
    Mesh(vertices.collect(), triangles.collect())
}

/// A closed slab: [`sheet`], a copy of it below, and walls between them.
pub(super) fn slab(cells: u32) -> Mesh {
    let Mesh(mut vertices, mut triangles) = sheet(cells);
    let (row, count) = (cells + 1, vertices.len() as u32);
    vertices.extend_from_within(..);
    vertices[count as usize..].iter_mut().for_each(|v| v.z -= 0.5);
    let below: Vec<_> = triangles.iter().map(|t| [t[0] + count, t[2] + count, t[1] + count]).collect();
    triangles.extend(below);
    let mut wall = |a: u32, b: u32| triangles.extend([[a, a + count, b + count], [a, b + count, b]]);
    for i in 0..cells {
        wall(i, i + 1);
        wall((i + 1) * row + cells, i * row + cells);
        wall((i + 1) * row, i * row);
        wall(cells * row + i + 1, cells * row + i);
    }
    Mesh(vertices, triangles)
}

/// A subdivided icosahedron whose radius varies by a fifth; its vertices are shared.
pub(super) fn bumpy_sphere(subdivisions: usize) -> Mesh {
    let g = (1.0 + libm::sqrt(5.0)) / 2.0;
    let mut vertices = Vec::new();
    for (s, t) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        vertices.extend([DVec3::new(s, t, 0.0), DVec3::new(0.0, s, t), DVec3::new(t, 0.0, s)]);
    }
    let mut triangles: Vec<[u32; 3]> = Vec::new();
    // The faces are the triples at mutual distance 2.
    let near = |i: usize, j: usize| (vertices[i].distance(vertices[j]) - 2.0).abs() < 1e-9;
    for (i, j, k) in (0..12).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| (i, j, k)))) {
        if near(i, j) && near(j, k) && near(k, i) {
            let outwards = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]).dot(vertices[i]) > 0.0;
            triangles.push(if outwards { [i, j, k] } else { [i, k, j] }.map(|v| v as u32));
        }
    }
    assert_eq!(triangles.len(), 20);
    for _ in 0..subdivisions {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]));
                vertices.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    for v in &mut vertices {
        *v = v.normalize();
        *v *= 1.0 + 0.1 * libm::sin(9.0 * v.x) * libm::cos(8.0 * v.y + 3.0 * v.z);
    }
    Mesh(vertices, triangles)
}
