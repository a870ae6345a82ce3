//! Boxes of a node's children, and rays made ready to be tested against them.

use super::{Child, Entry, Frame, Ray, Stack, WIDTH};
use crate::simd::lanes::{BoxLanes, OrderedKeys};
use glam::DVec3;

/// Half the distance from 1 to the next number in single precision.
const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Widening of the boxes: of single precision, in units of its roundoff and of what is at hand in the frame's units (the mesh,
/// 1, plus the ray's nearest approach), the ray's nearest approach is rounded by 1, its components and their inverses by 2,
/// the products by 1, which are of the bound and of the approach, and their difference by 1, on either side; together 10,
/// held by 16.
const BOX_SLACK: f64 = 16.0 * ROUNDOFF;
/// The same for the parameter, where a ray has crossed the mesh at the latest.
const PARAMETER_SLACK: f64 = 64.0 * ROUNDOFF;
/// Of double precision, which carries the origin to the nearest approach: in units of the distance from there.
const ORIGIN_SLACK: f64 = 8.0 * f64::EPSILON;
/// Components below this, of a direction whose largest is 1, are raised to it: within the mesh the ray moves by less than the
/// slack.
const MIN_COMPONENT: f64 = 1e-20;
/// Parameters below this lie before the mesh: its points are within √3 of the middle, and the direction is no shorter than 1. Keys
/// count from a ray's first parameter, which must be finite for that.
const BEFORE_MESH: f32 = -2.0;

/// Boxes of the children, in single precision and units of the frame.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Node {
    /// Of each axis, the lower and the upper bounds of the children.
    pub(super) bounds: [[[f32; WIDTH]; 2]; 3],
    pub(super) children: [Child; WIDTH],
}

impl Node {
    /// A node without children: no ray enters an inverted box.
    pub const EMPTY: Self =
        Self { bounds: [[[f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]]; 3], children: [Child::ROOT; WIDTH] };

    /// Single precision, one step outwards: at least half a step more than the rounding.
    pub(super) fn store(&mut self, i: usize, low: DVec3, high: DVec3, frame: &Frame) {
        let (low, high) = (frame.place(low).to_array(), frame.place(high).to_array());
        for (axis, [lower, upper]) in self.bounds.iter_mut().enumerate() {
            if let (Some(lower), Some(upper)) = (lower.get_mut(i), upper.get_mut(i)) {
                *lower = (low[axis] as f32).next_down();
                *upper = (high[axis] as f32).next_up();
            }
        }
    }
}

impl Default for Node {
    fn default() -> Self {
        Self::EMPTY
    }
}

/// A ray made ready for box tests: in units of the frame, from where it is nearest to the middle of the mesh, its direction
/// scaled to a largest component of 1.
pub(super) struct Slabs {
    first: f32,
    /// 1/direction.
    inverse: [f32; 3],
    /// Parameters of the planes through the middle of the mesh, of a ray moved forwards and backwards by the slack.
    middle_near: [f32; 3],
    middle_far: [f32; 3],
    /// Of each axis, which of the bounds the ray meets first: 1, the upper, if it runs downwards.
    near_side: [usize; 3],
    /// Parameter of the box tests per t, and where the former is 0.
    scale: f64,
    shift: f64,
}

impl Slabs {
    #[inline(always)] // Called in several places; apart, a ray would take some 4 % longer.
    pub(super) fn new(ray: &Ray, frame: &Frame) -> Self {
        let length = ray.direction.abs().max_element();
        let direction = ray.direction * (1.0 / length);
        let origin = frame.place(ray.origin);
        let shift = -origin.dot(direction) / direction.dot(direction);
        let nearest = origin + shift * direction;
        let slack = BOX_SLACK * (1.0 + nearest.abs().max_element()) + ORIGIN_SLACK * origin.abs().max_element();
        let component = |d: f64| if d.abs() < MIN_COMPONENT { MIN_COMPONENT.copysign(d) } else { d };
        let direction = direction.to_array().map(component);
        let forwards = direction.map(|d| slack.copysign(d));
        let inverse = direction.map(|d| 1.0 / d as f32);
        let nearest = nearest.to_array();
        let middle = |axis: usize, by: f64| -(nearest[axis] + by) as f32 * inverse[axis];
        let slabs = Self {
            first: 0.0,
            inverse,
            middle_near: core::array::from_fn(|axis| middle(axis, forwards[axis])),
            middle_far: core::array::from_fn(|axis| middle(axis, -forwards[axis])),
            near_side: direction.map(|d| usize::from(d < 0.0)),
            scale: length * frame.scale,
            shift,
        };
        Self { first: slabs.parameter(ray.t_min, -1.0).max(BEFORE_MESH), ..slabs }
    }

    /// Parameter of the box tests at t, moved by the slack.
    #[inline]
    fn parameter(&self, t: f64, side: f64) -> f32 {
        let at = t * self.scale - self.shift;
        let slack = PARAMETER_SLACK * (1.0 + at.abs()) + ORIGIN_SLACK * self.shift.abs();
        (if at.is_finite() { at + side * slack } else { at }) as f32
    }

    /// The parameter at which boxes must be entered for a hit before t.
    #[inline]
    pub(super) fn last(&self, t: f64) -> f32 {
        self.parameter(t, 1.0)
    }

    /// Where the ray enters the children of `node`, and a mask of those that it enters before `far`.
    #[inline]
    fn intersect(&self, node: &Node, far: f32) -> (BoxLanes, BoxLanes) {
        let mut near = BoxLanes::splat(self.first);
        let mut last = BoxLanes::splat(far);
        for axis in 0..3 {
            let side = self.near_side[axis] & 1;
            let plane = |side: usize| BoxLanes::new(node.bounds[axis][side]);
            // Empty boxes are infinite and stay so along the axis where the ray is longest, whose inverse is ±1.
            let inverse = BoxLanes::splat(self.inverse[axis]);
            near = near.fast_max(plane(side).mul_add(inverse, BoxLanes::splat(self.middle_near[axis])));
            last = last.fast_min(plane(1 - side).mul_add(inverse, BoxLanes::splat(self.middle_far[axis])));
        }
        (near, near.simd_le(last))
    }

    /// The children of `node` that the ray enters before `far`.
    #[inline]
    pub(super) fn keys(&self, node: &Node, far: f32) -> OrderedKeys {
        let (near, entered) = self.intersect(node, far);
        OrderedKeys::new(near - BoxLanes::splat(self.first), entered)
    }

    /// The key of children that are entered at `far`, or more.
    ///
    /// Differences round monotonically, and what a key leaves of them is no more than they are.
    #[inline]
    pub(super) fn key(&self, far: f32) -> u32 {
        OrderedKeys::key(far - self.first)
    }

    /// The child of `node` that the ray enters first, before `far`; the others that it enters go to the stack, the nearest last.
    #[inline]
    pub(super) fn enter(&self, node: &Node, far: f32, stack: &mut Stack) -> Option<Child> {
        let (near, entered) = self.intersect(node, far);
        let mut entered = entered.to_bitmask();
        if entered == 0 {
            return None;
        }
        let near = near.to_array();
        let mut next = || {
            let i = entered.trailing_zeros() as usize % WIDTH;
            entered &= entered - 1;
            (Entry { near: near[i], child: node.children[i] }, entered != 0)
        };
        let (mut nearest, mut more) = next();
        let base = stack.height;
        while more {
            let (entry, after) = next();
            let (closer, farther) = if entry.near < nearest.near { (entry, nearest) } else { (nearest, entry) };
            nearest = closer;
            stack.push(farther);
            stack.sink(base);
            more = after;
        }
        Some(nearest.child)
    }
}
