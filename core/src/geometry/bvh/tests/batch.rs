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
