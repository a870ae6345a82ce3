//! Construction of the hierarchy: ranges of `order` are split in place until they are leaves.

use super::leaf::{TERMS, terms};
use super::node::{COUNTS, Child, Frame, MAX_DEPTH, MAX_LEAF_TRIANGLES, MAX_WAITING, MIN_CHILDREN, Node, WIDTH};
use super::tree::{Bvh, BvhError};
use core::cmp::Ordering;
use glam::DVec3;

/// Number of bins along each axis, one more than candidate planes; more gain little (Wald 2007, section 3.3).
const BINS: usize = 16;
/// Maximum absolute value of a coordinate: boxes and their areas must stay finite.
const MAX_COORDINATE: f64 = (1u128 << 120) as f64;

impl<'a> Bvh<'a> {
    /// Checks the mesh and builds the hierarchy over it.
    ///
    /// `triangles` hold indices of `vertices`. `nodes` must have [`Bvh::required_nodes`] elements, `order` one per
    /// triangle, `corners` [`Bvh::required_corners`]; what they hold does not matter, and `order` is free again
    /// afterwards. Triangles of zero area are left out, and so never hit.
    ///
    /// # Errors
    /// [`BvhError`]: the mesh is empty or too large, a vertex is not finite or too large, a triangle names a missing
    /// vertex, or the memory is too small. It holds the first offending index, or the memory needed.
    pub fn build(
        vertices: &'a [DVec3],
        triangles: &'a [[u32; 3]],
        nodes: &'a mut [Node],
        order: &mut [u32],
        corners: &'a mut [f64],
    ) -> Result<Self, BvhError> {
        check(vertices, triangles)?;
        let required = Self::required_nodes(triangles.len());
        let required_corners = Self::required_corners(triangles.len());
        let memory = BvhError::Memory { nodes: required, order: triangles.len(), corners: required_corners };
        if nodes.len() < required || order.len() < triangles.len() || corners.len() < required_corners {
            return Err(memory);
        }
        let mut kept = 0;
        for triangle in 0..triangles.len() as u32 {
            let [a, b, c] = vertices_of(vertices, triangles, triangle);
            // Scaled, so that the product of small edges does not underflow.
            let (ab, ac) = (b - a, c - a);
            let (length_ab, length_ac) = (ab.abs().max_element(), ac.abs().max_element());
            if length_ab > 0.0 && length_ac > 0.0 && (ab / length_ab).cross(ac / length_ac) != DVec3::ZERO {
                if let Some(place) = order.get_mut(kept) {
                    *place = triangle;
                }
                kept += 1;
            }
        }
        let order = order.get_mut(..kept).ok_or(memory)?;
        let frame = Frame { centre: DVec3::ZERO, scale: 1.0 };
        let mut builder = Builder { vertices, triangles, order: &mut *order, frame };
        let root = builder.measure(0, kept);
        let size = root.bounds.high - root.bounds.low;
        if kept > 0 {
            builder.frame = Frame { centre: root.bounds.low + 0.5 * size, scale: 2.0 / size.max_element() };
        }
        let frame = builder.frame;
        let used = builder.split_all(root, nodes);
        let nodes = nodes.get(..used).ok_or(memory)?;
        for leaf in nodes.iter().flat_map(|node| node.children).filter(|child| child.count() > 0) {
            for (place, &triangle) in order.iter().skip(leaf.index()).take(leaf.count()).enumerate() {
                let at = vertices_of(vertices, triangles, triangle);
                let rows = corners.iter_mut().skip(leaf.index() * TERMS + place).step_by(leaf.count());
                rows.zip(terms(at, triangle)).for_each(|(row, term)| *row = term);
            }
        }
        let corners = corners.get(..Self::required_corners(kept)).ok_or(memory)?;
        Ok(Self { vertices, triangles, nodes, corners, frame })
    }
}

fn check(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), BvhError> {
    if triangles.is_empty() {
        return Err(BvhError::Empty);
    }
    if triangles.len() > (u32::MAX / COUNTS) as usize {
        return Err(BvhError::TooMany);
    }
    // NaN is not in the range either.
    let valid = |x: &f64| (-MAX_COORDINATE..=MAX_COORDINATE).contains(x);
    if let Some(vertex) = vertices.iter().position(|v| !v.to_array().iter().all(valid)) {
        return Err(BvhError::NotFinite { vertex });
    }
    match triangles.iter().position(|t| t.iter().any(|&vertex| vertex as usize >= vertices.len())) {
        Some(triangle) => Err(BvhError::NoVertex { triangle }),
        None => Ok(()),
    }
}

/// The vertices of a triangle, all at the origin for one that `check` has not seen.
#[inline]
fn vertices_of(vertices: &[DVec3], triangles: &[[u32; 3]], triangle: u32) -> [DVec3; 3] {
    let triangle = triangles.get(triangle as usize).copied().unwrap_or_default();
    triangle.map(|vertex| vertices.get(vertex as usize).copied().unwrap_or_default())
}

/// An axis-aligned box.
#[derive(Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const NOTHING: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn join(&mut self, low: DVec3, high: DVec3) {
        self.low = smaller(low, self.low);
        self.high = larger(high, self.high);
    }

    /// Half the surface area, which is what the heuristic compares.
    fn area(&self) -> f64 {
        let size = self.high - self.low;
        size.x * size.y + size.y * size.z + size.z * size.x
    }

    /// The sum of opposite corners: twice the middle.
    fn sum(&self) -> DVec3 {
        self.low + self.high
    }
}

/// The smaller of each component. No NaN comes here, so one comparison per component is enough.
fn smaller(a: DVec3, b: DVec3) -> DVec3 {
    let less = |a: f64, b: f64| if a < b { a } else { b };
    DVec3::new(less(a.x, b.x), less(a.y, b.y), less(a.z, b.z))
}

/// The larger of each component.
fn larger(a: DVec3, b: DVec3) -> DVec3 {
    let more = |a: f64, b: f64| if a > b { a } else { b };
    DVec3::new(more(a.x, b.x), more(a.y, b.y), more(a.z, b.z))
}

/// A part of `order`, with the box of its triangles and the box of the doubled middles of their boxes.
#[derive(Clone, Copy)]
struct Range {
    begin: usize,
    end: usize,
    bounds: Bounds,
    middles: Bounds,
}

impl Range {
    const NOTHING: Self = Self { begin: 0, end: 0, bounds: Bounds::NOTHING, middles: Bounds::NOTHING };

    fn count(&self) -> usize {
        self.end - self.begin
    }

    fn add(&mut self, triangle: &Bounds) {
        self.bounds.join(triangle.low, triangle.high);
        self.middles.join(triangle.sum(), triangle.sum());
    }
}

/// A range of triangles that is to become a node.
#[derive(Clone, Copy)]
struct Task {
    range: Range,
    node: usize,
    depth: usize,
}

/// The mesh and the order of its triangles while they are divided among leaves.
struct Builder<'b> {
    vertices: &'b [DVec3],
    triangles: &'b [[u32; 3]],
    order: &'b mut [u32],
    frame: Frame,
}

impl Builder<'_> {
    /// Fills `nodes` from the root, depth first, and returns their number.
    fn split_all(&mut self, root: Range, nodes: &mut [Node]) -> usize {
        let mut tasks = [Task { range: root, node: 0, depth: 0 }; MAX_WAITING];
        let (mut waiting, mut used) = (1, 1);
        while waiting > 0 {
            waiting -= 1;
            let Some(&Task { range, node, depth }) = tasks.get(waiting) else { break };
            let mut children = [Range::NOTHING; WIDTH];
            self.split_into_children(range, depth, &mut children);
            let mut filled = Node::EMPTY;
            for (i, child) in (0..WIDTH).zip(&children).filter(|(_, child)| child.count() > 0) {
                filled.store(i, child.bounds.low, child.bounds.high, &self.frame);
                if child.count() <= MAX_LEAF_TRIANGLES {
                    filled.children[i] = Child::leaf(child.begin, child.count());
                } else if let Some(task) = tasks.get_mut(waiting) {
                    filled.children[i] = Child::node(used);
                    *task = Task { range: *child, node: used, depth: depth + 1 };
                    waiting += 1;
                    used += 1;
                }
            }
            if let Some(node) = nodes.get_mut(node) {
                *node = filled;
            }
        }
        used
    }

    /// Splits the child of largest area until there are `WIDTH` children, or `MIN_CHILDREN` that fit into leaves.
    ///
    /// Where the levels below have room for a balanced tree only, the child of most triangles is halved instead, so
    /// that each gets a `WIDTH`th of the triangles, rounded up.
    fn split_into_children(&mut self, range: Range, depth: usize, children: &mut [Range; WIDTH]) {
        let levels_below = (MAX_DEPTH - depth - 1) as u32;
        let balanced = range.count() as u64
            > (WIDTH as u64).saturating_pow(levels_below).saturating_mul(MAX_LEAF_TRIANGLES as u64);
        children[0] = range;
        for count in 1..WIDTH {
            let weight = |child: &Range| if balanced { child.count() as f64 } else { child.bounds.area() };
            let order = |a: &Range, b: &Range| weight(a).total_cmp(&weight(b)).then(a.count().cmp(&b.count()));
            let (present, coming) = children.split_at_mut(count);
            let large = present.iter().any(|child| child.count() > MAX_LEAF_TRIANGLES);
            if !large && count >= MIN_CHILDREN {
                return;
            }
            let candidates =
                present.iter_mut().filter(|child| child.count() > if large { MAX_LEAF_TRIANGLES } else { 1 });
            let Some(child) = candidates.max_by(|a, b| order(a, b)) else { return };
            let (left, right) = if balanced { self.halve(child) } else { self.split(child) };
            *child = left;
            if let Some(next) = coming.first_mut() {
                *next = right;
            }
        }
    }

    /// The box of a triangle.
    #[inline]
    fn bounds(&self, triangle: u32) -> Bounds {
        let [a, b, c] = vertices_of(self.vertices, self.triangles, triangle);
        Bounds { low: smaller(a, smaller(b, c)), high: larger(a, larger(b, c)) }
    }

    /// The range from `begin` to `end`, with its boxes.
    fn measure(&self, begin: usize, end: usize) -> Range {
        let mut range = Range { begin, end, ..Range::NOTHING };
        for &triangle in self.order.iter().take(end).skip(begin) {
            range.add(&self.bounds(triangle));
        }
        range
    }

    /// Divides the range at the median along its longest axis, or at half its count if the middles coincide.
    fn halve(&mut self, range: &Range) -> (Range, Range) {
        let middle = range.begin + range.count() / 2;
        let extent = range.middles.high - range.middles.low;
        if extent.max_element() > 0.0 {
            self.select(range, middle, extent.max_position());
        }
        (self.measure(range.begin, middle), self.measure(middle, range.end))
    }

    /// Partially sorts the range along an axis, so that no triangle before place `nth` lies beyond one after it.
    ///
    /// This is Hoare's selection with a three-way partition. The standard library's selection can panic, which would
    /// link panic code into programs that must have none.
    fn select(&mut self, range: &Range, nth: usize, axis: usize) {
        let (mut low, mut high) = (range.begin, range.end);
        while high - low > 1 {
            let key = |builder: &Self, place: usize| {
                let triangle = builder.order.get(place).copied().unwrap_or(0);
                along(builder.bounds(triangle).sum(), axis)
            };
            let pivot = key(self, low.midpoint(high));
            let (mut equal, mut place, mut greater) = (low, low, high);
            while place < greater {
                match key(self, place).total_cmp(&pivot) {
                    Ordering::Less => {
                        swap(self.order, equal, place);
                        equal += 1;
                        place += 1;
                    }
                    Ordering::Equal => place += 1,
                    Ordering::Greater => {
                        greater -= 1;
                        swap(self.order, place, greater);
                    }
                }
            }
            if nth < equal {
                high = equal;
            } else if nth >= greater {
                low = greater;
            } else {
                return;
            }
        }
    }

    /// Divides the range where the binned surface area heuristic is smallest: the sum of area · count over both parts.
    fn split(&mut self, range: &Range) -> (Range, Range) {
        let grid = Grid::new(range);
        let mut bins = [[(Bounds::NOTHING, 0usize); BINS]; 3];
        for &triangle in self.order.iter().take(range.end).skip(range.begin) {
            let bounds = self.bounds(triangle);
            for (bins, place) in bins.iter_mut().zip(grid.place(bounds.sum())) {
                if let Some((joined, count)) = bins.get_mut(place) {
                    joined.join(bounds.low, bounds.high);
                    *count += 1;
                }
            }
        }
        let Some((axis, last_left)) = grid.cheapest(&bins) else { return self.halve(range) };

        let mut left = Range { begin: range.begin, end: range.begin, ..Range::NOTHING };
        let mut right = Range { begin: range.end, end: range.end, ..Range::NOTHING };
        while left.end < right.begin {
            let bounds = self.bounds(self.order.get(left.end).copied().unwrap_or(0));
            if grid.place(bounds.sum()).get(axis).is_some_and(|&bin| bin <= last_left) {
                left.end += 1;
                left.add(&bounds);
            } else {
                right.begin -= 1;
                right.add(&bounds);
                swap(self.order, left.end, right.begin);
            }
        }
        (left, right)
    }
}

/// Swaps two elements of a list; does nothing for places beyond its end.
#[inline]
fn swap(list: &mut [u32], a: usize, b: usize) {
    if let Ok([a, b]) = list.get_disjoint_mut([a, b]) {
        core::mem::swap(a, b);
    }
}

/// A component of a vector.
#[inline]
fn along(v: DVec3, axis: usize) -> f64 {
    match axis {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}

/// Bins of equal width between the extreme middles of a range, along each axis.
struct Grid {
    bins: usize,
    low: [f64; 3],
    scale: [f64; 3],
}

impl Grid {
    fn new(range: &Range) -> Self {
        // Few triangles need few planes.
        let bins = (2 * range.count()).clamp(2, BINS);
        let extent = range.middles.high - range.middles.low;
        Self { bins, low: range.middles.low.to_array(), scale: extent.to_array().map(|length| bins as f64 / length) }
    }

    /// The bin of a triangle's middle along each axis; 0 along an axis without extent, where 0 · ∞ is NaN, which
    /// converts to 0.
    #[inline]
    fn place(&self, middle: DVec3) -> [usize; 3] {
        let middle = middle.to_array();
        core::array::from_fn(|axis| {
            let bin = (middle[axis] - self.low[axis]) * self.scale[axis];
            (bin as usize).min(self.bins - 1)
        })
    }

    /// The axis and the last bin of the left part of the cheapest division that leaves neither part empty.
    fn cheapest(&self, bins: &[[(Bounds, usize); BINS]; 3]) -> Option<(usize, usize)> {
        let count_bins = self.bins.clamp(1, BINS);
        let mut best = (f64::INFINITY, None);
        for (axis, bins) in bins.iter().enumerate() {
            let mut right_cost = [f64::INFINITY; BINS];
            let (mut bounds, mut count) = (Bounds::NOTHING, 0);
            for i in (1..count_bins).rev() {
                bounds.join(bins[i].0.low, bins[i].0.high);
                count += bins[i].1;
                if count > 0 {
                    right_cost[i - 1] = bounds.area() * count as f64;
                }
            }
            (bounds, count) = (Bounds::NOTHING, 0);
            for i in 0..count_bins - 1 {
                bounds.join(bins[i].0.low, bins[i].0.high);
                count += bins[i].1;
                if count > 0 {
                    let cost = bounds.area() * count as f64 + right_cost[i];
                    if cost < best.0 {
                        best = (cost, Some((axis, i)));
                    }
                }
            }
        }
        best.1
    }
}
