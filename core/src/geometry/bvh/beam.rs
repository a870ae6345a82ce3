//! Beams: coherent rays, such as those of neighbouring pixels, enter the hierarchy together.
//!
//! A beam holds rays that are longest along one axis, z. There the other coordinates of each are linear in z, with
//! slopes of no more than 1. The least of such lines is concave and the greatest convex, so the chords through their
//! values at z = ±1, between which the mesh lies, hold all rays in between. A box is met only if it overlaps the
//! chords. Rays of one beam skip the nodes that all of them would cross, and a beam that meets nothing is done.
//!
//! Source: Reshetov, Soupikov & Hurley, "Multi-level ray tracing algorithm" (2005), for the common entry.

use super::boxes::{BOX_SLACK, ORIGIN_SLACK};
use super::keys::BoxLanes;
use super::node::{Child, Frame, Node, WIDTH};
use super::ray::Ray;
use super::tree::Bvh;
use glam::DVec3;

/// Minimum number of rays for which a common entry pays.
const MIN_RAYS: usize = 8;
/// Maximum coordinate of a beam: sums and products must stay finite in single precision.
const MAX_COORDINATE: f64 = 1e30;

/// The line c + m z that bounds a beam on one side.
#[derive(Clone, Copy)]
struct Chord {
    c: f32,
    m: f32,
}

impl Chord {
    /// The chord through values at z = −1 and z = 1.
    fn new([before, after]: [f64; 2]) -> Self {
        Self { c: (0.5 * (before + after)) as f32, m: (0.5 * (after - before)) as f32 }
    }
}

/// Bounds of several rays, in the hierarchy's frame.
pub(super) struct Beam {
    /// The axis along which all rays are longest, z, and the two others.
    axes: [usize; 3],
    /// The lower and the upper bound of each of the others.
    sides: [[Chord; 2]; 2],
}

impl Beam {
    /// The beam that holds the rays; `None` for few of them, or if they are not longest along the same axis, or are
    /// not finite.
    pub(super) fn new(rays: &[Ray], frame: &Frame) -> Option<Self> {
        if rays.len() < MIN_RAYS {
            return None;
        }
        let longest = |direction: DVec3| direction.abs().max_position();
        let z = longest(rays.first()?.direction);
        let axes = [z, (z + 1) % 3, (z + 2) % 3];
        // Coordinates along the axes, in their order.
        let along = |v: DVec3| match z {
            0 => [v.x, v.y, v.z],
            1 => [v.y, v.z, v.x],
            _ => [v.z, v.x, v.y],
        };
        let (mut low, mut high) = ([[f64::INFINITY; 2]; 2], [[f64::NEG_INFINITY; 2]; 2]);
        let mut size: f64 = 0.0;
        for ray in rays {
            if longest(ray.direction) != z || !ray.has_direction() {
                return None;
            }
            let local = frame.to_local(ray.origin);
            size = size.max(local.abs().max_element());
            let ([height, origin @ ..], [length, direction @ ..]) = (along(local), along(ray.direction));
            for i in 0..2 {
                let slope = direction[i] / length;
                let middle = origin[i] - slope * height;
                for (end, x) in [middle - slope, middle + slope].into_iter().enumerate() {
                    low[i][end] = low[i][end].min(x);
                    high[i][end] = high[i][end].max(x);
                }
            }
        }
        let extent = low.iter().chain(&high).flatten().fold(0.0, |extent: f64, x| extent.max(x.abs()));
        if !(extent < MAX_COORDINATE && size < MAX_COORDINATE) {
            return None;
        }
        // In units of single precision's roundoff and of the extent: the chord's numbers 2, its product and sum 3, its
        // continuation to boxes that are one step larger than the mesh 4; held by 16. In double precision and of the
        // origin's size: moving it into the frame 2, slope, product and difference 2; held by 8.
        let slack = BOX_SLACK * (1.0 + extent) + ORIGIN_SLACK * size;
        let sides =
            core::array::from_fn(|i| [Chord::new(low[i].map(|x| x - slack)), Chord::new(high[i].map(|x| x + slack))]);
        Some(Self { axes, sides })
    }

    /// A mask of the children of `node` that the beam may meet.
    fn meets(&self, node: &Node) -> u32 {
        let [z, others @ ..] = self.axes;
        let plane = |axis: usize, side: usize| BoxLanes::new(node.bounds[axis % 3][side & 1]);
        // The end of the box at which the chord is least, or greatest. An empty box is infinite there, or NaN.
        let chord = |Chord { c, m }: Chord, end: bool| {
            plane(z, usize::from(end)).mul_add(BoxLanes::splat(m), BoxLanes::splat(c))
        };
        let mut met = u32::MAX;
        for (axis, [low, high]) in others.into_iter().zip(self.sides) {
            let below = chord(low, low.m < 0.0).simd_le(plane(axis, 1));
            let above = plane(axis, 0).simd_le(chord(high, high.m > 0.0));
            met &= (below & above).to_bitmask();
        }
        met
    }
}

/// The children of several nodes that the rays of a beam may meet, as one node; `None` if they meet nothing.
pub(super) fn common_entry(bvh: &Bvh<'_>, beam: &Beam) -> Option<Node> {
    let mut entry = Node::EMPTY;
    entry.children[0] = Child::ROOT;
    let (mut place, mut count) = (0, 1);
    while place < count {
        let child = entry.children[place % WIDTH];
        let node = bvh.node(child.index());
        let mut met = if child.count() == 0 { beam.meets(node) } else { 0 };
        // A leaf stays, and so does a node for whose children there is no room.
        if child.count() > 0 || count - 1 + met.count_ones() as usize > WIDTH {
            place += 1;
            continue;
        }
        // The last child takes the place of the node, whose own children follow at the end.
        count -= 1;
        let last = entry;
        entry.copy_child(place, &last, count);
        entry.copy_child(count, &Node::EMPTY, 0);
        while met != 0 {
            entry.copy_child(count, node, met.trailing_zeros() as usize);
            met &= met - 1;
            count += 1;
        }
    }
    (count > 0).then_some(entry)
}
