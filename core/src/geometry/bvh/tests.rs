extern crate std;

mod meshes;
mod batch;

use super::*;
use meshes::{bumpy_sphere, sheet, slab, soup};
use std::vec::Vec;
use std::{print, println, vec};

/// Vertices and triangles.
#[derive(Clone)]
struct Mesh(Vec<DVec3>, Vec<[u32; 3]>);

/// The memory of a hierarchy.
struct Memory(Vec<Node>, Vec<u32>, Vec<f64>);

impl Mesh {
    fn memory(&self) -> Memory {
        let count = self.1.len();
        Memory(vec![Node::EMPTY; Bvh::required_nodes(count)], vec![0; count], vec![0.0; Bvh::required_corners(count)])
    }

    fn bvh<'a>(&'a self, memory: &'a mut Memory) -> Bvh<'a> {
        let bvh = Bvh::build(&self.0, &self.1, &mut memory.0, &mut memory.1, &mut memory.2).unwrap();
        check_structure(&bvh);
        bvh
    }

    fn moved(mut self, scale: f64, by: DVec3) -> Self {
        self.0.iter_mut().for_each(|v| *v = *v * scale + by);
        self
    }
}

/// Splitmix64 (Steele et al. 2014).
struct Random(u64);

impl Random {
    /// In [0, 1).
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// In the cube [−1, 1)³.
    fn cube(&mut self) -> DVec3 {
        DVec3::new(2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0)
    }

    /// Any direction, often along an axis, in a coordinate plane or nearly horizontal.
    fn direction(&mut self) -> DVec3 {
        let d = self.cube();
        match (8.0 * self.unit()) as u32 {
            0 => DVec3::Z * if d.z < 0.0 { -1.0 } else { 1.0 },
            1 => DVec3::X * if d.x < 0.0 { -1.0 } else { 1.0 },
            2 => DVec3::new(0.0, d.y, d.z),
            3 => DVec3::new(d.x, d.y, -0.0),
            4 => DVec3::new(d.x, d.y, 1e-4 * d.z),
            _ => d,
        }
    }
}

/// Depth within bounds, every triangle in one leaf, every box around its triangles. Returns the depth.
fn check_structure(bvh: &Bvh) -> usize {
    let mut seen = vec![false; bvh.triangles.len()];
    let (mut deepest, mut visited) = (0, 0);
    let all = [[f64::NEG_INFINITY; 3], [f64::INFINITY; 3]];
    let mut waiting = vec![(0usize, 1usize, all)];
    while let Some((node, depth, outer)) = waiting.pop() {
        deepest = deepest.max(depth);
        visited += 1;
        let node = &bvh.nodes[node];
        for i in 0..WIDTH {
            let side = |s: usize| core::array::from_fn(|axis| f64::from(node.bounds[axis][s][i]));
            let inner: [[f64; 3]; 2] = [side(0), side(1)];
            let (first, count) = (node.children[i].place(), node.children[i].count());
            if inner[0][0] == f64::INFINITY {
                assert_eq!(count, 0);
                continue;
            }
            assert!((0..3).all(|axis| inner[0][axis] >= outer[0][axis] && inner[1][axis] <= outer[1][axis]));
            if count == 0 {
                waiting.push((first, depth + 1, inner));
            }
            let leaf = (count > 0).then(|| Leaf::new(bvh.corners, Child::leaf(first, count)).unwrap());
            for triangle in leaf.iter().flat_map(|leaf| (0..count).map(|i| leaf.triangle(i) as usize)) {
                assert!(!core::mem::replace(&mut seen[triangle], true));
                for vertex in bvh.triangles[triangle] {
                    let v = ((bvh.vertices[vertex as usize] - bvh.frame.centre) * bvh.frame.scale).to_array();
                    assert!((0..3).all(|axis| inner[0][axis] < v[axis] && v[axis] < inner[1][axis]));
                }
            }
        }
    }
    let kept = seen.iter().filter(|seen| **seen).count();
    assert_eq!(bvh.corners.len(), Bvh::required_corners(kept));
    assert_eq!(visited, bvh.nodes.len());
    assert!(deepest <= MAX_DEPTH);
    deepest
}

fn ray(origin: DVec3, direction: DVec3) -> Ray {
    Ray { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
}

/// The same triangle test, on every triangle.
fn closest_of_all(mesh: &Mesh, ray: &Ray) -> Option<Hit> {
    let shear = Shear::new(ray);
    let hit = |(triangle, corners): (u32, &[u32; 3])| {
        let mut numbers = [0.0; WINDOW];
        numbers[..TERMS].copy_from_slice(&leaf::terms(corners.map(|v| mesh.0[v as usize]), triangle));
        let mut found = None;
        shear.intersect(Leaf::new(&numbers, Child::leaf(0, 1)).unwrap(), |hit| found = Some(hit));
        found
    };
    let hits = (0..).zip(&mesh.1).filter_map(hit);
    let inside = hits.filter(|hit| (ray.t_min..=ray.t_max).contains(&hit.t));
    inside.reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Möller & Trumbore (1997), an independent test, with the least barycentric coordinate of what it finds.
fn moeller_trumbore(mesh: &Mesh, ray: &Ray) -> Vec<(Hit, f64)> {
    let mut hits = Vec::new();
    for (triangle, &[a, b, c]) in (0..).zip(&mesh.1) {
        let [a, b, c] = [a, b, c].map(|v| mesh.0[v as usize]);
        let (e1, e2) = (b - a, c - a);
        let p = ray.direction.cross(e2);
        let s = ray.origin - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) / e1.dot(p), ray.direction.dot(q) / e1.dot(p), e2.dot(q) / e1.dot(p));
        let least = u.min(v).min(1.0 - u - v);
        // Edge-on triangles give NaN, which min would drop.
        if e1.dot(p) != 0.0 && least >= 0.0 && t >= ray.t_min && t <= ray.t_max {
            hits.push((Hit { triangle, t, front: ray.direction.dot(e1.cross(e2)) < 0.0 }, least));
        }
    }
    hits.sort_by(|a, b| a.0.t.total_cmp(&b.0.t));
    hits
}

#[test]
fn agrees_with_all_triangles_in_turn() {
    let mut random = Random(2);
    let mut compared = 0;
    for mesh in [soup(300), slab(8), sheet(12)] {
        let mut memory = mesh.memory();
        let bvh = mesh.bvh(&mut memory);
        for i in 0..40_000 {
            let mut ray = ray(1.2 * random.cube(), random.direction());
            if i % 4 == 0 {
                (ray.t_min, ray.t_max) = (0.3 * random.unit(), 0.3 + random.unit());
            }
            let hit = bvh.intersect_nearest(&ray, |_| true);
            assert_eq!(hit, closest_of_all(&mesh, &ray), "{ray:?}");
            // The other test must agree where nothing is near an edge.
            let reference = moeller_trumbore(&mesh, &ray);
            match (hit, reference.first()) {
                (Some(hit), Some((want, least)))
                    if *least > 1e-9 && reference.get(1).is_none_or(|r| r.0.t > want.t) =>
                {
                    assert_eq!((hit.triangle, hit.front), (want.triangle, want.front), "{ray:?}");
                    // A barycentric coordinate above 1e-9 leaves t seven digits or more.
                    assert!((hit.t - want.t).abs() <= 1e-7 * want.t.max(1.0), "{hit:?} {want:?}");
                    compared += 1;
                }
                (None, Some((_, least))) => assert!(*least < 1e-9, "{ray:?}"),
                _ => {}
            }
        }
    }
    assert!(compared > 15_000, "{compared}");
}

/// From inside a mesh that is star-shaped about `from`: at every vertex and at points of every edge.
fn assert_sealed(mesh: &Mesh, from: DVec3) {
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = Random(3);
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
fn a_distant_origin_still_hits_what_it_aims_at() {
    let mesh = bumpy_sphere(3);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = Random(4);
    for distance in [1e3, 1e6, 1e9] {
        for _ in 0..2000 {
            let origin = random.cube().normalize() * distance;
            let ray = ray(origin, 0.5 * random.cube() - origin);
            let hit = bvh.intersect_nearest(&ray, |_| true);
            assert!(hit.is_some_and(|hit| hit.front));
            assert_eq!(hit, closest_of_all(&mesh, &ray));
        }
    }
}

#[test]
fn boxes_thinner_than_a_rounding_are_not_missed() {
    // A needle about the x axis: only the slack lets a ray into its boxes.
    let mut mesh = bumpy_sphere(2);
    mesh.0.iter_mut().for_each(|v| *v *= DVec3::new(1.0, 1e-16, 1e-16));
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = Random(9);
    let mut hits = 0;
    for _ in 0..20_000 {
        let origin = 3.0 * random.cube();
        let ray = ray(origin, DVec3::X * (random.unit() - 0.5) - origin);
        let hit = bvh.intersect_nearest(&ray, |_| true);
        // Which triangle is a matter of rounding, whether one is hit is not.
        assert_eq!(hit.is_some(), closest_of_all(&mesh, &ray).is_some(), "{ray:?}");
        hits += usize::from(hit.is_some());
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn equal_products_are_told_apart() {
    // (1 + ε)(1 − ε) rounds to 1.
    let (p, q) = ([1.0, 1.0 - f64::EPSILON], [1.0 + f64::EPSILON, 1.0]);
    assert!(leaf::exact_cross(p, q) > 0.0);
    assert_eq!(leaf::exact_cross(q, p), -leaf::exact_cross(p, q));
    assert_eq!(leaf::exact_cross(p, p), 0.0);
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
    let mut random = Random(5);
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
            assert_eq!(Some(hit), closest_of_all(&mesh, &ray(origin, direction)));
            for step in 0..50 {
                let p = origin + direction * (hit.t * f64::from(step) / 50.0);
                assert!(touching(p).any(|[x, y, z]| full(x, y, z)), "{origin} {direction} leaves at {p}");
            }
            rays += 1;
        }
    }
    assert!(rays > 10_000, "{rays}");
}

#[test]
fn accept_and_limits_choose_among_hits() {
    // Planes at z = 0, −1, −2, of which the last faces down.
    let corner = |i: u32| DVec3::new(f64::from(i % 3 == 1) * 4.0, f64::from(i % 3 == 2) * 4.0, -f64::from(i / 3));
    let mesh = Mesh((0..9).map(corner).collect(), vec![[0, 1, 2], [3, 4, 5], [6, 8, 7]]);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let down = ray(DVec3::new(1.0, 1.0, 2.0), DVec3::new(0.0, 0.0, -2.0));
    let hit = |triangle: u32| Some(Hit { triangle, t: 1.0 + 0.5 * f64::from(triangle), front: triangle < 2 });
    assert_eq!(bvh.intersect_nearest(&down, |_| true), hit(0));
    assert_eq!(bvh.intersect_nearest(&down, |h| h.triangle != 0), hit(1));
    assert_eq!(bvh.intersect_nearest(&down, |h| !h.front), hit(2));
    assert_eq!(bvh.intersect_nearest(&down, |_| false), None);
    assert_eq!(bvh.intersect_nearest(&Ray { t_min: 1.5, ..down }, |_| true), hit(1));
    assert_eq!(bvh.intersect_nearest(&Ray { t_max: 1.0, ..down }, |_| true), hit(0));
    assert_eq!(bvh.intersect_nearest(&Ray { t_max: 0.999, ..down }, |_| true), None);
    assert_eq!(
        bvh.intersect_nearest(&Ray { t_min: -9.0, direction: DVec3::Z, ..down }, |_| true).map(|h| h.t),
        Some(-4.0)
    );
    let nan = DVec3::splat(f64::NAN);
    assert_eq!(bvh.intersect_nearest(&Ray { origin: nan, ..down }, |_| true), None);
    assert_eq!(bvh.intersect_nearest(&Ray { direction: nan, ..down }, |_| true), None);
    assert_eq!(bvh.intersect_nearest(&Ray { t_max: f64::NAN, ..down }, |_| true), None);
}

#[test]
fn coplanar_triangles_return_the_first() {
    let Mesh(vertices, triangles) = sheet(4);
    let mesh = Mesh(vertices, [triangles.clone(), triangles.clone(), triangles].concat());
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = Random(6);
    for _ in 0..1000 {
        let p = random.cube();
        let hit = bvh.intersect_nearest(&ray(DVec3::new(p.x, p.y, 3.0), -DVec3::Z), |_| true).unwrap();
        assert!(hit.triangle < 32);
    }
}

#[test]
fn triangles_without_area_are_never_hit() {
    let v = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let vertices = vec![v(0.0, 0.0), v(1.0, 0.0), v(2.0, 0.0), v(0.0, 1.0), v(0.5, 0.5), v(1e-200, 1e-200)];
    let flat = vec![[0, 0, 0], [0, 1, 2], [1, 1, 3], [3, 1, 4], [0, 3, 0]];
    let rays = || {
        let mut random = Random(7);
        let at = [v(0.5, 0.0), v(0.0, 0.0), v(1.0, 0.0), v(0.5, 0.5), v(0.25, 0.75), v(0.0, 0.5)];
        (0..6000).map(move |i| {
            let d = random.direction();
            ray(at[i % 6] - d, d)
        })
    };
    let mesh = Mesh(vertices.clone(), flat.clone());
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    assert!(rays().all(|ray| bvh.intersect_nearest(&ray, |_| true).is_none()));
    // Among others they are skipped, and the smallest triangle is not taken for one.
    let mesh = Mesh(vertices, [flat, vec![[0, 1, 3], [0, 1, 5]]].concat());
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    assert_eq!(bvh.corners.len(), Bvh::required_corners(2));
    assert!(rays().filter_map(|ray| bvh.intersect_nearest(&ray, |_| true)).all(|hit| hit.triangle >= 5));
    assert!(rays().any(|ray| bvh.intersect_nearest(&ray, |_| true).is_some()));
}

#[test]
fn depth_is_bounded_whatever_the_mesh() {
    let small = [DVec3::new(1.0, -0.5, 0.2), DVec3::new(-0.3, 0.9, 0.0), DVec3::new(-0.6, -0.7, -0.3)];
    let fan = |place: &dyn Fn(usize, DVec3) -> DVec3, count: usize| {
        let vertices = (0..count).flat_map(|i| small.map(|v| place(i, v)));
        Mesh(vertices.collect(), (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    };
    let exponential = |i: usize, v: DVec3| (v + DVec3::X * 3.0) * libm::exp2(i as f64 / 5.0 - 110.0);
    let meshes = [
        fan(&|_, v| v, 5000),
        fan(&|i, v| v.abs() * if i % 2 == 0 { 1.0 } else { -1.0 }, 5000),
        fan(&exponential, 1100),
        fan(&|i, v| exponential(i, v) * (1.0 + 1e-3 * v.x), 1100),
    ];
    let depths = meshes.map(|mesh| {
        let mut memory = mesh.memory();
        let bvh = mesh.bvh(&mut memory);
        let target = (mesh.0[0] + mesh.0[1] + mesh.0[2]) / 3.0;
        let ray = ray(target - small[0], small[0]);
        assert_eq!(bvh.intersect_nearest(&ray, |_| true), closest_of_all(&mesh, &ray));
        check_structure(&bvh)
    });
    // Exponential spacing would take the heuristic beyond a balanced tree, which has 5 levels.
    assert!(depths[2] > 8, "{depths:?}");
}

#[test]
fn what_is_wrong_is_named() {
    let mesh = sheet(4);
    let refuse = |vertices: &[DVec3], triangles: &[[u32; 3]], [nodes, order, corners]: [usize; 3]| {
        let mut nodes = vec![Node::EMPTY; nodes];
        Bvh::build(vertices, triangles, &mut nodes, &mut vec![0; order], &mut vec![0.0; corners]).err()
    };
    let (nodes, order, corners) = (Bvh::required_nodes(32), 32, Bvh::required_corners(32));
    let enough = [nodes, order, corners];
    let memory = Some(BvhError::Memory { nodes, order, corners });
    assert_eq!(refuse(&mesh.0, &[], enough), Some(BvhError::Empty));
    assert_eq!(refuse(&mesh.0, &mesh.1, [nodes - 1, order, corners]), memory);
    assert_eq!(refuse(&mesh.0, &mesh.1, [nodes, order - 1, corners]), memory);
    assert_eq!(refuse(&mesh.0, &mesh.1, [nodes, order, corners - 1]), memory);
    assert_eq!(refuse(&mesh.0, &mesh.1, enough), None);
    assert_eq!(refuse(&mesh.0[..24], &mesh.1, enough), Some(BvhError::NoVertex { triangle: 30 }));
    for bad in [f64::NAN, f64::INFINITY, -1e40] {
        let mut vertices = mesh.0.clone();
        vertices[7].y = bad;
        assert_eq!(refuse(&vertices, &mesh.1, enough), Some(BvhError::NotFinite { vertex: 7 }));
    }
}

#[test]
fn few_triangles_and_many_fit_the_required_memory() {
    for count in 1..40 {
        let mesh = soup(count);
        mesh.bvh(&mut mesh.memory());
    }
    let mesh = sheet(224);
    assert!(mesh.1.len() > 100_000);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let hit = bvh.intersect_nearest(&ray(DVec3::new(0.1, 0.2, 3.0), -DVec3::Z), |_| true);
    assert_eq!(hit, closest_of_all(&mesh, &ray(DVec3::new(0.1, 0.2, 3.0), -DVec3::Z)));
}

/// Run with `cargo test --release -p goniochrome bvh::tests::timing -- --ignored --nocapture`.
#[test]
#[ignore = "prints times"]
fn timing() {
    for cells in [50, 224, 707] {
        let mesh = sheet(cells);
        let mut memory = mesh.memory();
        let start = std::time::Instant::now();
        let bvh = Bvh::build(&mesh.0, &mesh.1, &mut memory.0, &mut memory.1, &mut memory.2).unwrap();
        print!(
            "{} triangles, {} nodes: built in {:.3} s",
            mesh.1.len(),
            bvh.nodes.len(),
            start.elapsed().as_secs_f64()
        );
        let mut random = Random(8);
        let down: Vec<Ray> = (0..1_000_000)
            .map(|_| {
                let (p, d) = (random.cube(), random.cube());
                ray(DVec3::new(p.x, p.y, 0.2), DVec3::new(d.x, d.y, -d.z.abs()))
            })
            .collect();
        // From where those hit, in any direction upwards: what a tracer does.
        let from_surface: Vec<Ray> = down
            .iter()
            .map(|r| {
                let t = bvh.intersect_nearest(r, |_| true).map_or(0.0, |hit| hit.t);
                let d = random.cube();
                ray(r.origin + r.direction * t, DVec3::new(d.x, d.y, d.z.abs()))
            })
            .collect();
        for (name, rays, t_min) in [("from above", down, 0.0), ("from the surface", from_surface, 1e-9)] {
            let start = std::time::Instant::now();
            let hits = rays.iter().filter(|r| bvh.intersect_nearest(&Ray { t_min, ..**r }, |_| true).is_some()).count();
            let rate = rays.len() as f64 / start.elapsed().as_secs_f64();
            print!("; {name} {:.2} M rays/s ({hits} hits)", rate / 1e6);
        }
        println!();
    }
}
