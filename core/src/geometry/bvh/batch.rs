//! Interleaved traversal of 16 rays: each step prefetches the ray's next node or leaf, so that its latency overlaps the
//! other rays' work. Successive rays that are alike form beams, and begin at an entry of their own.

use super::beam::{Beam, common_entry};
use super::boxes::Slabs;
use super::keys::OrderedKeys;
use super::leaf::{Leaf, Shear, TERMS};
use super::node::{COUNTS, Child, Frame, MAX_DEPTH, Node, WIDTH};
use super::ray::{Hit, Ray};
use super::tree::Bvh;
use crate::simd::lanes::prefetch;
use core::ops::Range;
use glam::DVec3;

/// Number of rays that are traversed at once.
const IN_FLIGHT: usize = 16;
const _: () = assert!(IN_FLIGHT.is_power_of_two());

/// Maximum size in bytes of a hierarchy that is taken to lie in a near cache, where a prefetch costs more than it
/// gains.
const MAX_NEAR_CACHE: usize = 1 << 20;

/// Number of successive rays that may share a beam.
const BEAM: usize = 32;

/// How far ahead of the next ray rays are prefetched.
const RAYS_AHEAD: usize = 16;

/// Number of doubles in a line of the cache.
const LINE: usize = 64 / size_of::<f64>();
/// Number of a leaf's lines that are prefetched. They hold 5.6 triangles, as many as most leaves have.
const PREFETCHED_LINES: usize = 7;

/// The hierarchy as rays enter it: at the root, or at the common entry of a beam.
#[derive(Clone, Copy)]
struct Tree<'b> {
    nodes: &'b [Node],
    corners: &'b [f64],
    frame: Frame,
    entry: &'b Node,
    prefetches: bool,
}

impl<'b> Tree<'b> {
    /// Refers to the entry, by an index beyond those of all nodes.
    const ENTRY: Child = Child::node(u32::MAX as usize / COUNTS as usize);

    /// The node of an index.
    #[inline]
    fn node(&self, index: usize) -> &'b Node {
        self.nodes.get(index).unwrap_or(self.entry)
    }
}

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
    /// Begins at the entry with `ray`. Fields are set in place: a copy would wait until all of them are stored.
    #[inline(always)]
    fn start(&mut self, tree: &Tree<'_>, ray: &Ray) {
        self.slabs = Slabs::new(ray, &tree.frame);
        self.shear = Shear::new(ray);
        self.t_min = ray.t_min;
        self.best = Hit { triangle: u32::MAX, t: ray.t_max, front: false };
        self.far = self.slabs.last(ray.t_max);
        self.far_key = self.slabs.key(self.far);
        self.child = Tree::ENTRY;
        self.height = 0;
    }

    /// The nearest hit so far.
    #[inline]
    fn hit(&self) -> Option<Hit> {
        (self.best.triangle != u32::MAX).then_some(self.best)
    }

    /// Visits the present child and chooses the next; false if none is left.
    #[inline]
    fn step(&mut self, tree: &Tree<'_>, levels: &mut TraversalStack, accept: &mut impl FnMut(&Hit) -> bool) -> bool {
        if self.child.count() == 0 {
            let index = self.child.index();
            let node = tree.node(index);
            let (key, keys) = self.slabs.keys(node, self.far).take_min();
            if key != u32::MAX {
                if let Some(level) = levels.get_mut(self.height) {
                    *level = PendingChildren { keys, node: index as u32 };
                }
                self.height += usize::from(keys != OrderedKeys::MAX);
                self.child = node.children[key as usize % WIDTH];
                return true;
            }
        } else if let Some(leaf) = Leaf::new(tree.corners, self.child) {
            let Self { shear, slabs, t_min, best, far, far_key, .. } = self;
            shear.intersect(leaf, |hit| {
                if hit.precedes(best) && hit.t >= *t_min && accept(&hit) {
                    *best = hit;
                    *far = slabs.last(hit.t);
                    *far_key = slabs.key(*far);
                }
            });
        }
        self.pop(tree, levels)
    }

    /// Chooses the nearest pending child of the lowest level that has one before `far`; false if there is none.
    #[inline]
    fn pop(&mut self, tree: &Tree<'_>, levels: &mut TraversalStack) -> bool {
        while let Some(PendingChildren { keys, node }) = self.height.checked_sub(1).and_then(|top| levels.get_mut(top))
        {
            let (key, others) = keys.take_min();
            if key <= self.far_key {
                *keys = others;
                self.child = tree.node(*node as usize).children[key as usize % WIDTH];
                self.height -= usize::from(others == OrderedKeys::MAX);
                return true;
            }
            self.height -= 1;
        }
        false
    }

    /// Prefetches the memory of the child to visit next.
    #[inline]
    fn prefetch(&self, tree: &Tree<'_>) {
        let index = self.child.index();
        if self.child.count() == 0 {
            let node = tree.node(index);
            node.bounds.iter().for_each(prefetch);
            prefetch(&node.children);
        } else if let Some(lines) = tree.corners.get(index * TERMS..).and_then(<[f64]>::first_chunk) {
            let lines: &[f64; PREFETCHED_LINES * LINE] = lines;
            // A fixed number of lines: a loop over the leaf's own count would mispredict.
            lines.iter().step_by(LINE).for_each(prefetch);
        }
    }
}

/// A ray in flight: its index, its traversal and its stack.
struct InFlight {
    ray: usize,
    /// Whether the traversal has ended, and no other ray took its place.
    has_ended: bool,
    traversal: Traversal,
    levels: TraversalStack,
}

impl InFlight {
    /// A place that holds no ray yet.
    fn new(frame: &Frame) -> Self {
        let (slabs, shear) = (Slabs::new(&NO_RAY, frame), Shear::new(&NO_RAY));
        let best = Hit { triangle: u32::MAX, t: 0.0, front: false };
        let child = Child::ROOT;
        let traversal = Traversal { slabs, shear, t_min: 0.0, best, far: 0.0, far_key: 0, child, height: 0 };
        Self { ray: 0, has_ended: true, traversal, levels: [PendingChildren::NONE; MAX_DEPTH] }
    }
}

/// Rays and the places for their hits, which are as many.
struct Batch<'r> {
    rays: &'r [Ray],
    hits: &'r mut [Option<Hit>],
    slots: [InFlight; IN_FLIGHT],
}

impl Batch<'_> {
    /// Starts the next ray of `range` that has a direction; false if there is none. Others hit nothing.
    #[inline(always)] // It is in the innermost loop, and where that begins.
    fn start_next(
        rays: &[Ray],
        hits: &mut [Option<Hit>],
        range: &mut Range<usize>,
        slot: &mut InFlight,
        tree: &Tree<'_>,
    ) -> bool {
        for i in range {
            if let Some(later) = rays.get(i + RAYS_AHEAD) {
                prefetch(later);
            }
            match (rays.get(i), hits.get_mut(i)) {
                (Some(ray), _) if ray.has_direction() => {
                    (slot.ray, slot.has_ended) = (i, false);
                    slot.traversal.start(tree, ray);
                    return true;
                }
                (_, Some(hit)) => *hit = None,
                (_, None) => {}
            }
        }
        false
    }

    /// Finds the nearest hits of a range of rays.
    fn traverse(&mut self, mut range: Range<usize>, tree: &Tree<'_>, accept: &mut impl FnMut(usize, &Hit) -> bool) {
        let Self { rays, hits, slots } = self;
        let mut live = 0;
        for slot in &mut *slots {
            live += usize::from(Self::start_next(rays, hits, &mut range, slot, tree));
        }
        while live > 0 {
            let mut any_ended = false;
            for slot in slots.iter_mut().take(live) {
                if slot.traversal.step(tree, &mut slot.levels, &mut |hit| accept(slot.ray, hit)) {
                    if tree.prefetches {
                        slot.traversal.prefetch(tree);
                    }
                    continue;
                }
                if let Some(hit) = hits.get_mut(slot.ray) {
                    *hit = slot.traversal.hit();
                }
                if !Self::start_next(rays, hits, &mut range, slot, tree) {
                    (slot.has_ended, any_ended) = (true, true);
                }
            }
            let mut place = 0;
            while any_ended && place < live {
                if slots[place % IN_FLIGHT].has_ended {
                    live -= 1;
                    slots.swap(place % IN_FLIGHT, live % IN_FLIGHT);
                } else {
                    place += 1;
                }
            }
        }
    }
}

impl Bvh<'_> {
    /// The nearest hit of each of many rays, as [`Bvh::intersect_nearest`] finds it, by interleaved traversal.
    ///
    /// While the memory of one ray's next node is fetched, other rays go on: this pays most on meshes larger than the
    /// caches. Successive rays that are much alike, such as those of neighbouring pixels, share the way to the part of
    /// the mesh that they may meet; if that is none, they end there. It takes some 20 KiB of stack.
    ///
    /// `accept` is given the index of the ray and a hit; it may be asked about any hit of that ray, in any order. Rays
    /// beyond the end of `hits` are left out; hits beyond the end of `rays` become `None`.
    pub fn intersect_batch(&self, rays: &[Ray], hits: &mut [Option<Hit>], mut accept: impl FnMut(usize, &Hit) -> bool) {
        let count = rays.len().min(hits.len());
        if let Some(beyond) = hits.get_mut(count..) {
            beyond.fill(None);
        }
        let prefetches = size_of_val(self.nodes) + size_of_val(self.corners) > MAX_NEAR_CACHE;
        let whole =
            Tree { nodes: self.nodes, corners: self.corners, frame: self.frame, entry: self.node(0), prefetches };
        let mut batch = Batch { rays, hits, slots: core::array::from_fn(|_| InFlight::new(&self.frame)) };
        let (mut begin, mut place) = (0, 0);
        while place < count {
            let end = (place + BEAM).min(count);
            // Where rays are incoherent, the first two say so.
            rays.iter().skip(end + BEAM).take(2).for_each(prefetch);
            if let Some(beam) = rays.get(place..end).and_then(|rays| Beam::new(rays, &self.frame)) {
                batch.traverse(begin..place, &whole, &mut accept);
                if let Some(entry) = common_entry(self, &beam) {
                    // What one ray of a beam fetches is near for the others.
                    batch.traverse(place..end, &Tree { entry: &entry, prefetches: false, ..whole }, &mut accept);
                } else if let Some(hits) = batch.hits.get_mut(place..end) {
                    hits.fill(None);
                }
                begin = end;
            }
            place = end;
        }
        batch.traverse(begin..count, &whole, &mut accept);
    }
}
