//! Interleaved traversal of 16 rays: each step prefetches the ray's next node or leaf, so that its latency overlaps the
//! other rays' work.

use super::boxes::Slabs;
use super::leaf::{Leaf, Shear, TERMS};
use super::node::{Child, MAX_DEPTH, WIDTH};
use super::ray::{Hit, Ray};
use super::tree::Bvh;
use crate::simd::lanes::{OrderedKeys, prefetch};
use glam::DVec3;

/// Number of rays that are traversed at once.
const IN_FLIGHT: usize = 16;
const _: () = assert!(IN_FLIGHT.is_power_of_two());

/// Maximum size in bytes of a hierarchy that is taken to lie in a near cache, where a prefetch costs more than it
/// gains.
const MAX_NEAR_CACHE: usize = 1 << 20;

/// Number of doubles in a line of the cache.
const LINE: usize = 64 / size_of::<f64>();
/// Number of a leaf's lines that are prefetched. They hold 5.6 triangles, as many as most leaves have.
const PREFETCHED_LINES: usize = 7;

/// A ray for slots in which none is in flight.
const NO_RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::X, t_min: 0.0, t_max: 0.0 };

/// The children that wait to be visited, those of at most one node for each level.
type TraversalStack = [PendingChildren; MAX_DEPTH];

/// The children of one node that wait to be visited.
#[derive(Clone, Copy)]
struct PendingChildren {
    keys: OrderedKeys,
    node: u32,
}

impl PendingChildren {
    const NONE: Self = Self { keys: OrderedKeys::MAX, node: 0 };
}

/// The state of one ray's traversal, apart from its stack.
struct Traversal {
    slabs: Slabs,
    shear: Shear,
    t_min: f64,
    best: Hit,
    /// The parameter before which boxes must be entered.
    far: f32,
    /// The key of `far`.
    far_key: u32,
    /// The child to visit next.
    child: Child,
    /// Number of levels that have pending children.
    height: usize,
}

impl Traversal {
    /// A traversal that begins at the root.
    #[inline]
    fn new(bvh: &Bvh<'_>, ray: &Ray) -> Self {
        let slabs = Slabs::new(ray, &bvh.frame);
        let far = slabs.last(ray.t_max);
        Self {
            far_key: slabs.key(far),
            far,
            slabs,
            shear: Shear::new(ray),
            t_min: ray.t_min,
            best: Hit { triangle: u32::MAX, t: ray.t_max, front: false },
            child: Child::ROOT,
            height: 0,
        }
    }

    /// The nearest hit so far.
    #[inline]
    fn hit(&self) -> Option<Hit> {
        (self.best.triangle != u32::MAX).then_some(self.best)
    }

    /// Visits the present child and chooses the next; false if none is left.
    #[inline]
    fn step(&mut self, bvh: &Bvh<'_>, levels: &mut TraversalStack, accept: &mut impl FnMut(&Hit) -> bool) -> bool {
        if self.child.count() == 0 {
            let index = self.child.index();
            let node = bvh.node(index);
            let (key, keys) = self.slabs.keys(node, self.far).take_min();
            if key != u32::MAX {
                if let Some(level) = levels.get_mut(self.height) {
                    *level = PendingChildren { keys, node: index as u32 };
                }
                self.height += usize::from(keys != OrderedKeys::MAX);
                self.child = node.children[key as usize % WIDTH];
                return true;
            }
        } else if let Some(leaf) = Leaf::new(bvh.corners, self.child) {
            let Self { shear, slabs, t_min, best, far, far_key, .. } = self;
            shear.intersect(leaf, |hit| {
                if hit.precedes(best) && hit.t >= *t_min && accept(&hit) {
                    *best = hit;
                    *far = slabs.last(hit.t);
                    *far_key = slabs.key(*far);
                }
            });
        }
        self.pop(bvh, levels)
    }

    /// Chooses the nearest pending child of the lowest level that has one before `far`; false if there is none.
    #[inline]
    fn pop(&mut self, bvh: &Bvh<'_>, levels: &mut TraversalStack) -> bool {
        while let Some(PendingChildren { keys, node }) = self.height.checked_sub(1).and_then(|top| levels.get_mut(top))
        {
            let (key, others) = keys.take_min();
            if key <= self.far_key {
                *keys = others;
                self.child = bvh.node(*node as usize).children[key as usize % WIDTH];
                self.height -= usize::from(others == OrderedKeys::MAX);
                return true;
            }
            self.height -= 1;
        }
        false
    }

    /// Prefetches the memory of the child to visit next.
    #[inline]
    fn prefetch(&self, bvh: &Bvh<'_>) {
        let index = self.child.index();
        if self.child.count() == 0 {
            let node = bvh.node(index);
            node.bounds.iter().for_each(prefetch);
            prefetch(&node.children);
        } else if let Some(lines) = bvh.corners.get(index * TERMS..).and_then(<[f64]>::first_chunk) {
            let lines: &[f64; PREFETCHED_LINES * LINE] = lines;
            // A fixed number of lines: a loop over the leaf's own count would mispredict.
            lines.iter().step_by(LINE).for_each(prefetch);
        }
    }
}

/// A ray in flight: its index, its traversal and its stack.
struct InFlight {
    ray: usize,
    traversal: Traversal,
    levels: TraversalStack,
}

impl Bvh<'_> {
    /// The nearest hit of each of many rays, as [`Bvh::intersect_nearest`] finds it, by interleaved traversal.
    ///
    /// While the memory of one ray's next node is fetched, other rays go on. This pays for incoherent rays, and most on
    /// meshes larger than the caches; coherent rays are faster one by one. It takes some 20 KiB of stack.
    ///
    /// `accept` is given the index of the ray and a hit; it may be asked about any hit of that ray, in any order. Rays
    /// beyond the end of `hits` are left out; hits beyond the end of `rays` become `None`.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>], mut accept: impl FnMut(usize, &Hit) -> bool) {
        hits.fill(None);
        let prefetches = size_of_val(self.nodes) + size_of_val(self.corners) > MAX_NEAR_CACHE;
        let mut coming = rays.iter().enumerate().take(hits.len()).filter(|(_, ray)| ray.has_direction());
        let mut slots: [InFlight; IN_FLIGHT] = core::array::from_fn(|_| {
            let traversal = Traversal::new(self, &NO_RAY);
            InFlight { ray: 0, traversal, levels: [PendingChildren::NONE; MAX_DEPTH] }
        });
        let mut live = 0;
        for (slot, (i, ray)) in slots.iter_mut().zip(coming.by_ref()) {
            (slot.ray, slot.traversal) = (i, Traversal::new(self, ray));
            live += 1;
        }
        while live > 0 {
            let mut place = 0;
            while place < live {
                let slot = &mut slots[place % IN_FLIGHT];
                if slot.traversal.step(self, &mut slot.levels, &mut |hit| accept(slot.ray, hit)) {
                    if prefetches {
                        slot.traversal.prefetch(self);
                    }
                    place += 1;
                    continue;
                }
                if let Some(hit) = hits.get_mut(slot.ray) {
                    *hit = slot.traversal.hit();
                }
                if let Some((i, ray)) = coming.next() {
                    (slot.ray, slot.traversal) = (i, Traversal::new(self, ray));
                    place += 1;
                } else {
                    live -= 1;
                    slots.swap(place % IN_FLIGHT, live % IN_FLIGHT);
                }
            }
        }
    }
}
