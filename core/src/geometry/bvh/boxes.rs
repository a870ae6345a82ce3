//! The box test: a ray prepared for it, and the children of a node that the ray enters.

use super::keys::{BoxLanes, OrderedKeys};
use super::node::{Child, Frame, Node, WIDTH};
use super::ray::Ray;
use super::stack::{Entry, EntryStack};

/// Half the distance from 1 to the next number in single precision.
const ROUNDOFF: f64 = f32::EPSILON as f64 / 2.0;

/// Widening of the boxes against single precision, in units of the size of the numbers: that of the mesh, 1 in the
/// frame's units, plus the ray's nearest approach.
///
/// Terms, in unit roundoffs: the nearest approach is rounded by 1, the direction's components and their inverses by 2,
/// the products of the bound and of the approach by 1 each, and their difference by 1. Both sides together make 10,
/// held by 16.
pub(super) const BOX_SLACK: f64 = 16.0 * ROUNDOFF;
/// Widening of a ray's parameter against single precision, where the ray has crossed the mesh at the latest.
const PARAMETER_SLACK: f64 = 64.0 * ROUNDOFF;
/// Widening against double precision, which carries the origin to the nearest approach; in units of the distance
/// between the two.
pub(super) const ORIGIN_SLACK: f64 = 8.0 * f64::EPSILON;
/// Minimum component of a direction whose largest is 1; smaller ones are raised to it. Within the mesh this moves the
/// ray by less than the slack.
const MIN_COMPONENT: f64 = 1e-20;
/// A parameter before the mesh: the points of the mesh are within √3 of its middle, and the direction is no shorter
/// than 1. Keys count from a ray's first parameter, which must therefore be finite.
const BEFORE_MESH: f32 = -2.0;

/// A ray prepared for box tests: in the frame's units, from its nearest approach to the middle of the mesh, with its
/// direction scaled to a largest component of 1.
pub(super) struct Slabs {
    /// Parameter of the ray's `t_min`.
    first: f32,
    /// 1/direction.
    inverse: [f32; 3],
    /// Parameters of the planes through the middle of the mesh, for the ray moved forwards by the slack.
    middle_near: [f32; 3],
    /// Parameters of the planes through the middle of the mesh, for the ray moved backwards by the slack.
    middle_far: [f32; 3],
    /// The bound along each axis that the ray meets first: 1, the upper, if the ray runs downwards.
    near_side: [usize; 3],
    /// Parameter of the box tests per t.
    scale: f64,
    /// t · `scale` where the parameter of the box tests is 0.
    shift: f64,
}

impl Slabs {
    #[inline(always)] // It has several callers; as a call it would make a ray some 4 % slower.
    pub(super) fn new(ray: &Ray, frame: &Frame) -> Self {
        let length = ray.direction.abs().max_element();
        let direction = ray.direction * (1.0 / length);
        let origin = frame.to_local(ray.origin);
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

    /// Parameter of the box tests at t, moved by the slack towards `side`.
    #[inline]
    fn parameter(&self, t: f64, side: f64) -> f32 {
        let at = t * self.scale - self.shift;
        let slack = PARAMETER_SLACK * (1.0 + at.abs()) + ORIGIN_SLACK * self.shift.abs();
        (if at.is_finite() { at + side * slack } else { at }) as f32
    }

    /// The parameter before which a box must be entered for a hit before t.
    #[inline]
    pub(super) fn last(&self, t: f64) -> f32 {
        self.parameter(t, 1.0)
    }

    /// The parameters at which the ray enters the children of `node`, and a mask of those that it enters before `far`.
    #[inline]
    fn intersect(&self, node: &Node, far: f32) -> (BoxLanes, BoxLanes) {
        let mut near = BoxLanes::splat(self.first);
        let mut last = BoxLanes::splat(far);
        for axis in 0..3 {
            let side = self.near_side[axis] & 1;
            let plane = |side: usize| BoxLanes::new(node.bounds[axis][side]);
            // Empty boxes are infinite, and stay so along the axis where the ray is longest, whose inverse is ±1.
            let inverse = BoxLanes::splat(self.inverse[axis]);
            near = near.fast_max(plane(side).mul_add(inverse, BoxLanes::splat(self.middle_near[axis])));
            last = last.fast_min(plane(1 - side).mul_add(inverse, BoxLanes::splat(self.middle_far[axis])));
        }
        (near, near.simd_le(last))
    }

    /// The keys of the children of `node` that the ray enters before `far`.
    #[inline]
    pub(super) fn keys(&self, node: &Node, far: f32) -> OrderedKeys {
        let (near, entered) = self.intersect(node, far);
        OrderedKeys::new(near - BoxLanes::splat(self.first), entered)
    }

    /// The largest key of a child that is entered at `far`.
    ///
    /// Differences round monotonically, and truncation to a key makes none larger, so that no child entered before
    /// `far` has a larger key.
    #[inline]
    pub(super) fn key(&self, far: f32) -> u32 {
        OrderedKeys::key(far - self.first)
    }

    /// The child of `node` that the ray enters first, before `far`. The other children that it enters go to the stack,
    /// the nearest last.
    #[inline]
    pub(super) fn enter(&self, node: &Node, far: f32, stack: &mut EntryStack<'_>) -> Option<Child> {
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
        let base = stack.height();
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
