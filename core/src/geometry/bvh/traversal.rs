//! A ray on its way through the hierarchy, one node or leaf at a time.

use super::{Bvh, Child, Hit, Leaf, MAX_DEPTH, Ray, Shear, Slabs, TERMS, WIDTH};
use crate::simd::lanes::{OrderedKeys, prefetch};

/// Numbers of double precision in a line of the cache.
const LINE: usize = 64 / size_of::<f64>();
/// Lines of a leaf that are fetched ahead: those of 5.6 triangles, as many as most leaves have.
const FETCHED_LINES: usize = 7;

/// Children that wait: of each level at most those of one node.
pub(super) type TraversalStack = [PendingChildren; MAX_DEPTH];

/// Children of a node that wait.
#[derive(Clone, Copy)]
pub(super) struct PendingChildren {
    keys: OrderedKeys,
    node: u32,
}

impl PendingChildren {
    pub(super) const NONE: Self = Self { keys: OrderedKeys::MAX, node: 0 };
}

/// A ray and what it has met.
pub(super) struct Traversal {
    slabs: Slabs,
    shear: Shear,
    t_min: f64,
    best: Hit,
    /// The parameter at which boxes must be entered, and the key of that.
    far: f32,
    far_key: u32,
    /// Entered next.
    child: Child,
    /// Levels that have children waiting.
    height: usize,
}

impl Traversal {
    /// Before the root.
    #[inline]
    pub(super) fn new(bvh: &Bvh<'_>, ray: &Ray) -> Self {
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
    pub(super) fn hit(&self) -> Option<Hit> {
        (self.best.triangle != u32::MAX).then_some(self.best)
    }

    /// Enters the child at hand and turns to the next; false if there is none.
    #[inline]
    pub(super) fn step(
        &mut self,
        bvh: &Bvh<'_>,
        levels: &mut TraversalStack,
        accept: &mut impl FnMut(&Hit) -> bool,
    ) -> bool {
        if self.child.count() == 0 {
            let place = self.child.place();
            let node = bvh.node(place);
            let (key, keys) = self.slabs.keys(node, self.far).take_min();
            if key != u32::MAX {
                if let Some(level) = levels.get_mut(self.height) {
                    *level = PendingChildren { keys, node: place as u32 };
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
        self.turn_back(bvh, levels)
    }

    /// Turns to the nearest waiting child of the lowest level that has one within reach.
    #[inline]
    fn turn_back(&mut self, bvh: &Bvh<'_>, levels: &mut TraversalStack) -> bool {
        while let Some(PendingChildren { keys, node }) = self.height.checked_sub(1).and_then(|top| levels.get_mut(top))
        {
            let (key, rest) = keys.take_min();
            if key <= self.far_key {
                *keys = rest;
                self.child = bvh.node(*node as usize).children[key as usize % WIDTH];
                self.height -= usize::from(rest == OrderedKeys::MAX);
                return true;
            }
            self.height -= 1;
        }
        false
    }

    /// Asks for the memory of the child at hand.
    #[inline]
    pub(super) fn fetch(&self, bvh: &Bvh<'_>) {
        let place = self.child.place();
        if self.child.count() == 0 {
            let node = bvh.node(place);
            node.bounds.iter().for_each(prefetch);
            prefetch(&node.children);
        } else if let Some(lines) = bvh.corners.get(place * TERMS..).and_then(<[f64]>::first_chunk) {
            let lines: &[f64; FETCHED_LINES * LINE] = lines;
            // A count that differs from leaf to leaf could not be foretold.
            lines.iter().step_by(LINE).for_each(prefetch);
        }
    }
}
