//! Rays traversed together hit what each hits by itself.

use super::*;

#[test]
fn many_rays_hit_what_each_hits_alone() {
    let mut random = RandomVectors::new(9);
    // The last is too large for what is taken to be near.
    for mesh in [soup(300), slab(8), sheet(12), sheet(120).moved(1e3, DVec3::splat(-5e2))] {
        let mut memory = mesh.memory();
        let bvh = mesh.bvh(&mut memory);
        let rays: Vec<Ray> = (0..20_011)
            .map(|i| {
                let target = mesh.0[(random.unit() * mesh.0.len() as f64) as usize];
                let direction = random.direction();
                let mut ray = ray(target - random.unit() * direction + 1e-3 * random.cube(), direction);
                match i % 64 {
                    0..16 => (ray.t_min, ray.t_max) = (0.3 * random.unit(), 0.3 + random.unit()),
                    16 => ray.t_min = f64::NEG_INFINITY,
                    17 => ray.t_min = f64::INFINITY,
                    18 => ray.t_min = f64::NAN,
                    19 => ray.t_max = f64::NAN,
                    20 => ray.t_max = f64::NEG_INFINITY,
                    21 => ray.direction = DVec3::ZERO,
                    22 => ray.origin.y = f64::NAN,
                    23 => ray.direction.x = f64::INFINITY,
                    24 => ray.t_max = ray.t_min,
                    _ => {}
                }
                ray
            })
            .collect();
        let admits = |i: usize, hit: &Hit| !i.is_multiple_of(5) || hit.front;
        let alone: Vec<_> = (0..).zip(&rays).map(|(i, ray)| bvh.intersect_nearest(ray, |hit| admits(i, hit))).collect();
        let hit_count = alone.iter().flatten().count();
        assert!(hit_count > 3_000, "{hit_count}");
        for count in [0, 1, 15, 16, 17, rays.len()] {
            let mut hits = vec![Some(Hit { triangle: 7, t: 7.0, front: true }); count];
            bvh.intersect_batch(&rays[..count], &mut hits, admits);
            assert_eq!(hits, alone[..count]);
        }
    }
}

#[test]
fn lists_of_unequal_length_share_their_beginning() {
    let mesh = sheet(12);
    let mut memory = mesh.memory();
    let bvh = mesh.bvh(&mut memory);
    let down = ray(DVec3::new(0.1, 0.2, 1.0), -DVec3::Z);
    let hit = bvh.intersect_nearest(&down, |_| true);
    assert!(hit.is_some());
    let mut hits = [hit; 5];
    bvh.intersect_batch(&[down; 2], &mut hits, |_, _| true);
    assert_eq!(hits, [hit, hit, None, None, None]);
    let mut hits = [None; 2];
    bvh.intersect_batch(&[down; 40], &mut hits, |i, _| i < 1);
    assert_eq!(hits, [hit, None]);
}

#[test]
fn coherent_rays_hit_what_each_hits_alone() {
    const SIDE: usize = 96;
    for mesh in [soup(300), slab(8), sheet(12), sheet(120).moved(1e3, DVec3::splat(-5e2))] {
        let mut memory = mesh.memory();
        let bvh = mesh.bvh(&mut memory);
        let low = mesh.0.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = mesh.0.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let (centre, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
        let (mut hit_count, mut ray_count) = (0, 0);
        // From outside, from within, from far away, along an axis; narrow, wide, and parallel; beside the mesh too.
        for (from, spread) in [
            (DVec3::new(0.4, 1.1, 2.9), 0.8),
            (DVec3::new(0.01, 0.02, 0.03), 0.9),
            (DVec3::new(3e6, 1e6, 2e6), 1.5),
            (DVec3::new(0.0, 0.0, 2.0), 1.0),
            (DVec3::new(0.0, 3.0, 0.0), 0.01),
        ] {
            let (x, y) = from.any_orthonormal_pair();
            for parallel in [false, true] {
                let rays: Vec<Ray> = (0..SIDE * SIDE)
                    .map(|i| {
                        let [u, v] = [i % SIDE, i / SIDE].map(|k| 2.0 * k as f64 / SIDE as f64 - 1.0);
                        let aside = spread * radius * (u * x + v * y);
                        let target = if parallel { DVec3::ZERO } else { aside };
                        let origin = centre + radius * from + (aside - target);
                        ray(origin, centre + aside - origin)
                    })
                    .collect();
                let alone: Vec<_> = rays.iter().map(|ray| bvh.intersect_nearest(ray, |_| true)).collect();
                hit_count += alone.iter().flatten().count();
                ray_count += rays.len();
                let mut hits = vec![None; rays.len()];
                bvh.intersect_batch(&rays, &mut hits, |_, _| true);
                assert_eq!(hits, alone, "{from} {spread} {parallel}");
            }
        }
        assert!((ray_count / 16..ray_count * 15 / 16).contains(&hit_count), "{hit_count} of {ray_count}");
    }
}
