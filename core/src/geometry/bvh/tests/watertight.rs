//! Rays through vertices and edges of a closed mesh hit it.

use super::*;

/// Checks that rays from inside a mesh that is star-shaped about `from` hit it at every vertex and at points of every
/// edge.
fn assert_sealed(mesh: &Mesh, from: DVec3) {
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = RandomVectors::new(3);
    let edges = mesh.1.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]);
    let ends = edges.map(|(a, b)| (mesh.0[a as usize], mesh.0[b as usize]));
    let targets = ends.flat_map(|(a, b)| [a, 0.5 * (a + b), a + random.unit() * (b - a)]);
    for target in targets {
        let hit =
            bvh.intersect_nearest(&ray(from, target - from), |_| true).unwrap_or_else(|| panic!("leak at {target}"));
        // The direction reaches the target: t = 1 up to the rounding of the coordinates, magnified by grazing edges.
        assert!((hit.t - 1.0).abs() < 1e-3 && !hit.front, "{hit:?}");
    }
}

#[test]
fn closed_meshes_do_not_leak_at_edges_and_vertices() {
    assert_sealed(&bumpy_sphere(4), DVec3::ZERO);
    assert_sealed(&bumpy_sphere(3), DVec3::new(0.03, -0.02, 0.05));
}

#[test]
fn scale_and_place_do_not_matter() {
    for scale in [1e-3, 1.0, 1e3, 1e6, 1e9] {
        for away in [0.0, 1e3, 1e6] {
            let by = DVec3::new(1.0, -0.7, 0.3) * away * scale;
            assert_sealed(&bumpy_sphere(2).moved(scale, by), by);
        }
    }
    assert_sealed(&bumpy_sphere(2).moved(1e-3, DVec3::splat(1e9 / 3.0)), DVec3::splat(1e9 / 3.0));
}

#[test]
fn vertical_rays_meet_every_vertex_and_edge_of_a_sheet() {
    for by in [DVec3::ZERO, DVec3::new(1e9, -3e8, 1e7)] {
        let mesh = sheet(64).moved(37.7, by);
        let mut memory = mesh.memory();
        let bvh = mesh.bvh(&mut memory);
        let above = |x: f64, y: f64| ray(DVec3::new(x, y, by.z + 100.0), -DVec3::Z);
        let edges = mesh.1.iter().flat_map(|t| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]]);
        for [a, b] in edges.map(|edge| edge.map(|v| mesh.0[v as usize])) {
            assert!(bvh.intersect_nearest(&above(a.x, a.y), |_| true).is_some_and(|hit| hit.front), "{a}");
            // Rounded midpoints of border edges may lie outside by a rounding, except along the axes.
            let on_border = (a.x - b.x).abs() > 0.0 && (a.y - b.y).abs() > 0.0;
            let middle = 0.5 * (a + b);
            assert!(on_border || bvh.intersect_nearest(&above(middle.x, middle.y), |_| true).is_some(), "{middle}");
            let below = ray(DVec3::new(a.x, a.y, by.z - 100.0), DVec3::Z);
            assert!(bvh.intersect_nearest(&below, |_| true).is_some_and(|hit| !hit.front), "{a}");
        }
    }
}

/// Rays between lattice points run along edges, diagonals and faces of unit cubes and through their corners.
#[test]
fn rays_along_edges_of_cubes_stay_inside() {
    const SIDE: i32 = 7;
    let mut random = RandomVectors::new(5);
    let filled: Vec<bool> = (0..SIDE * SIDE * SIDE).map(|_| random.unit() < 0.93).collect();
    let full = |x: i32, y: i32, z: i32| {
        [x, y, z].iter().all(|c| (0..SIDE).contains(c)) && filled[(x + SIDE * (y + SIDE * z)) as usize]
    };
    let lattice = |c: [i32; 3]| c[0] + (SIDE + 1) * (c[1] + (SIDE + 1) * c[2]);
    let cells = || (0..SIDE * SIDE * SIDE).map(|i| [i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE]);
    let mut triangles = Vec::new();
    for [x, y, z] in cells().filter(|&[x, y, z]| full(x, y, z)) {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut next = [x, y, z];
            next[axis] += 2 * side - 1;
            if !full(next[0], next[1], next[2]) {
                let corner = |u: i32, v: i32| {
                    let mut c = [x, y, z];
                    c[axis] += side;
                    c[(axis + 1) % 3] += u;
                    c[(axis + 2) % 3] += v;
                    lattice(c) as u32
                };
                let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
                triangles.extend(if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
            }
        }
    }
    let row = SIDE + 1;
    let points =
        (0..row * row * row).map(|i| DVec3::new((i % row).into(), (i / row % row).into(), (i / row / row).into()));
    let mesh = Mesh(points.collect(), triangles);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);

    // The cubes that touch a point.
    let touching = |p: DVec3| {
        let span = |c: f64| (libm::ceil(c - 1e-9) as i32 - 1)..=(libm::floor(c + 1e-9) as i32);
        span(p.x).flat_map(move |x| span(p.y).flat_map(move |y| span(p.z).map(move |z| [x, y, z])))
    };
    let mut rays = 0;
    for origin in mesh.0.iter().copied() {
        if !touching(origin).all(|[x, y, z]| full(x, y, z)) {
            continue;
        }
        for i in 0..7 * 7 * 7 {
            let direction = DVec3::new((i % 7 - 3).into(), (i / 7 % 7 - 3).into(), (i / 49 - 3).into());
            if direction == DVec3::ZERO {
                assert_eq!(bvh.intersect_nearest(&ray(origin, direction), |_| true), None);
                continue;
            }
            let hit = bvh
                .intersect_nearest(&ray(origin, direction), |_| true)
                .unwrap_or_else(|| panic!("{origin} {direction}"));
            assert_eq!(Some(hit), nearest_of_all(&mesh, &ray(origin, direction)));
            for step in 0..50 {
                let p = origin + direction * (hit.t * f64::from(step) / 50.0);
                assert!(touching(p).any(|[x, y, z]| full(x, y, z)), "{origin} {direction} leaves at {p}");
            }
            rays += 1;
        }
    }
    assert!(rays > 10_000, "{rays}");
}
