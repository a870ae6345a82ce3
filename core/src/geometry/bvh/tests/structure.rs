//! The tree fits its memory and its depth, and broken meshes are refused.

use super::*;

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
        assert_eq!(bvh.intersect_nearest(&ray, |_| true), nearest_of_all(&mesh, &ray));
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
    assert_eq!(hit, nearest_of_all(&mesh, &ray(DVec3::new(0.1, 0.2, 3.0), -DVec3::Z)));
}
