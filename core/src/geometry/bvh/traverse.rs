//! Traversal of the hierarchy by a single ray.

use super::boxes::Slabs;
use super::leaf::{Leaf, Shear};
use super::node::Child;
use super::ray::{Hit, Ray};
use super::stack::EntryStack;
use super::tree::Bvh;

impl Bvh<'_> {
    /// The nearest hit with t in \[`t_min`, `t_max`\] among those that `accept` admits; of equally near ones, that of
    /// the lowest index.
    ///
    /// `accept` may be asked about any hit, in any order. A ray that is not finite (`t_max` apart) or has no direction
    /// hits nothing. The t of a hit lies between those of the triangle's vertices, to rounding. It is no better than
    /// that where the triangle, as seen along the ray, is thinner than the rounding of its vertices.
    #[must_use]
    pub fn intersect_nearest(&self, ray: &Ray, accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        if ray.has_direction() { self.traverse(ray, accept) } else { None }
    }

    /// [`Bvh::intersect_nearest`] for a ray that has a direction.
    #[inline]
    fn traverse(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let slabs = Slabs::new(ray, &self.frame);
        let shear = Shear::new(ray);
        let mut entries = EntryStack::EMPTY;
        let mut stack = EntryStack::new(&mut entries);
        let mut best = Hit { triangle: u32::MAX, t: ray.t_max, front: false };
        let mut far = slabs.last(best.t);
        let mut child = Child::ROOT;
        loop {
            if child.count() == 0 {
                let node = self.node(child.index());
                if let Some(nearest) = slabs.enter(node, far, &mut stack) {
                    child = nearest;
                    continue;
                }
            } else {
                if let Some(leaf) = Leaf::new(self.corners, child) {
                    shear.intersect(leaf, |hit| {
                        if hit.precedes(&best) && hit.t >= ray.t_min && accept(&hit) {
                            best = hit;
                            far = slabs.last(hit.t);
                        }
                    });
                }
            }
            match stack.pop_before(far) {
                Some(waiting) => child = waiting,
                None => return (best.triangle != u32::MAX).then_some(best),
            }
        }
    }
}
