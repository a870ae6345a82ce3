//! Many rays by turns: while the memory of one is fetched, others go on.

use super::traversal::{PendingChildren, Traversal, TraversalStack};
use super::{Bvh, Hit, MAX_DEPTH, Ray};
use glam::DVec3;

/// Rays on their way at once.
const IN_FLIGHT: usize = 16;
const _: () = assert!(IN_FLIGHT.is_power_of_two());

/// Hierarchies of fewer bytes are taken to lie in a near cache, where asking for memory costs more than it gains.
const NEAR_CACHE: usize = 1 << 20;

/// Stands where no ray is on its way.
const NO_RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::X, t_min: 0.0, t_max: 0.0 };

/// A ray on its way.
struct InFlight {
    ray: usize,
    walk: Traversal,
    levels: TraversalStack,
}

pub(super) fn intersect_batch(
    bvh: &Bvh<'_>,
    rays: &[Ray],
    hits: &mut [Option<Hit>],
    mut accept: impl FnMut(usize, &Hit) -> bool,
) {
    hits.fill(None);
    let fetched = size_of_val(bvh.nodes) + size_of_val(bvh.corners) > NEAR_CACHE;
    let mut coming = rays.iter().enumerate().take(hits.len()).filter(|(_, ray)| ray.has_direction());
    let mut turns: [InFlight; IN_FLIGHT] = core::array::from_fn(|_| {
        let walk = Traversal::new(bvh, &NO_RAY);
        InFlight { ray: 0, walk, levels: [PendingChildren::NONE; MAX_DEPTH] }
    });
    let mut live = 0;
    for (turn, (i, ray)) in turns.iter_mut().zip(coming.by_ref()) {
        (turn.ray, turn.walk) = (i, Traversal::new(bvh, ray));
        live += 1;
    }
    while live > 0 {
        let mut place = 0;
        while place < live {
            let turn = &mut turns[place % IN_FLIGHT];
            if turn.walk.step(bvh, &mut turn.levels, &mut |hit| accept(turn.ray, hit)) {
                if fetched {
                    turn.walk.fetch(bvh);
                }
                place += 1;
                continue;
            }
            if let Some(hit) = hits.get_mut(turn.ray) {
                *hit = turn.walk.hit();
            }
            if let Some((i, ray)) = coming.next() {
                (turn.ray, turn.walk) = (i, Traversal::new(bvh, ray));
                place += 1;
            } else {
                live -= 1;
                turns.swap(place % IN_FLIGHT, live % IN_FLIGHT);
            }
        }
    }
}
