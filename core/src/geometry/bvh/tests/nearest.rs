//! The nearest hit agrees with every triangle tested in turn.

use super::*;

/// All hits by the independent triangle test of Möller & Trumbore (1997), nearest first, each with its smallest
/// barycentric coordinate.
fn moeller_trumbore(mesh: &Mesh, ray: &Ray) -> Vec<(Hit, f64)> {
    let mut hits = Vec::new();
    for (triangle, &[a, b, c]) in (0..).zip(&mesh.1) {
        let [a, b, c] = [a, b, c].map(|v| mesh.0[v as usize]);
        let (e1, e2) = (b - a, c - a);
        let p = ray.direction.cross(e2);
        let s = ray.origin - a;
        let q = s.cross(e1);
        let (u, v, t) = (s.dot(p) / e1.dot(p), ray.direction.dot(q) / e1.dot(p), e2.dot(q) / e1.dot(p));
        let min = u.min(v).min(1.0 - u - v);
        // Edge-on triangles give NaN, which min would drop.
        if e1.dot(p) != 0.0 && min >= 0.0 && t >= ray.t_min && t <= ray.t_max {
            hits.push((Hit { triangle, t, front: ray.direction.dot(e1.cross(e2)) < 0.0 }, min));
        }
    }
    hits.sort_by(|a, b| a.0.t.total_cmp(&b.0.t));
    hits
}

#[test]
fn agrees_with_all_triangles_in_turn() {
    let mut random = RandomVectors::new(2);
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
            assert_eq!(hit, nearest_of_all(&mesh, &ray), "{ray:?}");
            // The other test must agree where nothing is near an edge.
            let reference = moeller_trumbore(&mesh, &ray);
            match (hit, reference.first()) {
                (Some(hit), Some((want, min))) if *min > 1e-9 && reference.get(1).is_none_or(|r| r.0.t > want.t) => {
                    assert_eq!((hit.triangle, hit.front), (want.triangle, want.front), "{ray:?}");
                    // A barycentric coordinate above 1e-9 leaves t seven digits or more.
                    assert!((hit.t - want.t).abs() <= 1e-7 * want.t.max(1.0), "{hit:?} {want:?}");
                    compared += 1;
                }
                (None, Some((_, min))) => assert!(*min < 1e-9, "{ray:?}"),
                _ => {}
            }
        }
    }
    assert!(compared > 15_000, "{compared}");
}

#[test]
fn a_distant_origin_still_hits_what_it_aims_at() {
    let mesh = bumpy_sphere(3);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let mut random = RandomVectors::new(4);
    for distance in [1e3, 1e6, 1e9] {
        for _ in 0..2000 {
            let origin = random.cube().normalize() * distance;
            let ray = ray(origin, 0.5 * random.cube() - origin);
            let hit = bvh.intersect_nearest(&ray, |_| true);
            assert!(hit.is_some_and(|hit| hit.front));
            assert_eq!(hit, nearest_of_all(&mesh, &ray));
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
    let mut random = RandomVectors::new(9);
    let mut hits = 0;
    for _ in 0..20_000 {
        let origin = 3.0 * random.cube();
        let ray = ray(origin, DVec3::X * (random.unit() - 0.5) - origin);
        let hit = bvh.intersect_nearest(&ray, |_| true);
        // Which triangle is a matter of rounding, whether one is hit is not.
        assert_eq!(hit.is_some(), nearest_of_all(&mesh, &ray).is_some(), "{ray:?}");
        hits += usize::from(hit.is_some());
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn equal_products_are_told_apart() {
    // (1 + ε)(1 − ε) rounds to 1.
    let (p, q) = ([1.0, 1.0 - f64::EPSILON], [1.0 + f64::EPSILON, 1.0]);
    assert!(exact_cross(p, q) > 0.0);
    assert_eq!(exact_cross(q, p), -exact_cross(p, q));
    assert_eq!(exact_cross(p, p), 0.0);
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
    let mut random = RandomVectors::new(6);
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
        let mut random = RandomVectors::new(7);
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
