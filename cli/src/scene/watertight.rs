//! Cells of tilted facets: the check that they divide space cleanly, so that no ray can leak from one medium into
//! another.
//!
//! The facets at each edge, taken modulo the period, are sorted by angle; neighbours must agree on the medium between
//! them. An edge with one facet is a hole, unless the facet has one medium on both sides. Facets connected by edges
//! form a sheet or a closed body. A vertical line through each body checks that it agrees with what lies above and
//! below it.

use std::collections::HashMap;
use std::fmt::Display;

use glam::DVec3;
use goniochrome::geometry::mesh_cell::{RESOLUTION, snap_to_border};
use goniochrome::optics::interface::Below;

use super::mesh::{Mesh, Triangle};
use super::parts::{MAX_LENGTH_NM, NamedInterface, NamedMedium};
use crate::support::error::{Error, Result};

/// Angle in radians below which two facets at one edge overlap, unless rounding is larger.
const OVERLAP: f64 = 1e-6;

/// Maximum number of faults that are kept: more say nothing new.
const MAX_FAULTS: usize = 10_000;

/// Maximum number of tests of a vertical line against a facet: some seconds.
const MAX_PROBED: usize = 1 << 30;

/// Cell of polygons that divide space cleanly: every boundary between two media is closed over the period.
#[derive(Clone, Debug)]
pub struct ClosedCell {
    mesh: Mesh,
    period_nm: [f64; 2],
    interfaces: Vec<NamedInterface>,
}

impl ClosedCell {
    /// Checks a mesh: inside its period, without holes, overlaps or facets that disagree about a medium, and spanning
    /// the whole period. Triangles without area and vertices without triangles are skipped. Surfaces that intersect
    /// away from their edges are not found.
    ///
    /// Vertices beside the border of the period are put onto it, since light would fall through between copies of the
    /// mesh that miss each other.
    ///
    /// # Errors
    /// One line that names the first facet at fault, the place in nanometres and the remedy.
    pub(super) fn new(
        mut mesh: Mesh,
        period_nm: [f64; 2],
        interfaces: Vec<NamedInterface>,
        media: &[NamedMedium],
    ) -> Result<Self> {
        check_closed(&mesh, period_nm, &interfaces, media)?;
        let mut vertices: Vec<DVec3> = mesh.vertices.into_iter().map(DVec3::from).collect();
        snap_to_border(&mut vertices, period_nm);
        mesh.vertices = vertices.iter().map(DVec3::to_array).collect();
        Ok(Self { mesh, period_nm, interfaces })
    }

    /// Cell of stacked rectangles over the period, which the caller has checked.
    pub(super) fn of_sheets(mesh: Mesh, period_nm: [f64; 2], interfaces: Vec<NamedInterface>) -> Self {
        Self { mesh, period_nm, interfaces }
    }

    /// Facets of the cell.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Period in x and in y.
    #[must_use]
    pub fn period_nm(&self) -> [f64; 2] {
        self.period_nm
    }

    /// Interfaces, which a triangle's `interface` counts.
    #[must_use]
    pub fn interfaces(&self) -> &[NamedInterface] {
        &self.interfaces
    }
}

fn check_closed(mesh: &Mesh, period_nm: [f64; 2], interfaces: &[NamedInterface], media: &[NamedMedium]) -> Result<()> {
    let check = WatertightCheck { mesh, period_nm, interfaces, media, resolution_nm: resolution_nm(mesh, period_nm) };
    check.check_inside()?;
    let edges = check.edges();
    let mut bodies = Bodies((0..mesh.triangles.len()).collect());
    check.check_edges(&edges, &mut bodies)?;
    check.check_bodies(&edges, &mut bodies)
}

/// Resolution of coordinates, which modelling programs keep in single precision: vertices nearer than this are one
/// vertex, and may lie outside the period by as much.
fn resolution_nm(mesh: &Mesh, period_nm: [f64; 2]) -> f64 {
    RESOLUTION * mesh.vertices.iter().flatten().chain(&period_nm).fold(0.0, |max: f64, x| max.max(x.abs()))
}

/// Vertex modulo the period.
#[derive(Clone, Copy, PartialEq, Eq)]
struct PeriodicCorner {
    number: u32,
    tile: [i8; 2],
}

/// Edge of a triangle. Equal keys are one edge modulo the period.
#[derive(Clone, Copy)]
struct HalfEdge {
    key: (u32, u32, [i8; 2]),
    triangle: u32,
    /// Corner at which it starts, going round the triangle.
    corner: u8,
    /// Whether the triangle runs along it in the direction of the key.
    forward: bool,
}

/// Sets of connected triangles: a union–find structure.
struct Bodies(Vec<usize>);

impl Bodies {
    /// Representative of the set of a triangle.
    fn find(&mut self, mut triangle: usize) -> usize {
        while self.0[triangle] != triangle {
            self.0[triangle] = self.0[self.0[triangle]];
            triangle = self.0[triangle];
        }
        triangle
    }

    fn union(&mut self, a: usize, b: usize) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// Fault at an edge; the worst first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fault {
    Overlap,
    Hole,
    Media,
}

struct WatertightCheck<'a> {
    mesh: &'a Mesh,
    period_nm: [f64; 2],
    interfaces: &'a [NamedInterface],
    media: &'a [NamedMedium],
    resolution_nm: f64,
}

/// Place, for a message.
fn at(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|x| (x * 1000.0).round() / 1000.0 + 0.0);
    format!("({x}, {y}, {z})")
}

impl WatertightCheck<'_> {
    fn refuse(&self, line: u32, message: impl Display) -> Error {
        Error::failed(format_args!("{}:{line}: {message}", self.mesh.path.display()))
    }

    fn points(&self, triangle: &Triangle) -> [DVec3; 3] {
        triangle.vertices.map(|index| DVec3::from(self.mesh.vertices[index as usize]))
    }

    /// Media on the side of the normal and behind.
    fn sides(&self, triangle: &Triangle) -> [Below; 2] {
        let interface = self.interfaces[usize::from(triangle.interface)].interface;
        [Below::Medium(interface.above), interface.below]
    }

    fn name(&self, medium: Below) -> String {
        match medium {
            Below::Medium(index) => format!("{:?}", self.media[usize::from(index)].name),
            Below::Mirror => "the mirror".to_owned(),
        }
    }

    fn check_inside(&self) -> Result<()> {
        let [width, depth] = self.period_nm;
        let first = self.mesh.triangles.first().map_or(1, |triangle| triangle.line);
        if !(width > 0.0 && depth > 0.0 && width.max(depth) <= MAX_LENGTH_NM) {
            let message = format!("a period of {width} by {depth} nm; both must be more than 0 nm and at most a metre");
            return Err(self.refuse(first, message));
        }
        for triangle in &self.mesh.triangles {
            for point in self.points(triangle) {
                if !point.is_finite() || point.abs().max_element() > MAX_LENGTH_NM {
                    let message = format!("the facet reaches {}: more than a metre; units are nanometres", at(point));
                    return Err(self.refuse(triangle.line, message));
                }
                let out = |x: f64, period: f64| x < -self.resolution_nm || x > period + self.resolution_nm;
                if out(point.x, width) || out(point.y, depth) {
                    let message = format!(
                        "the facet leaves the period at {} nm; cut the mesh at x = 0 and {width}, y = 0 and {depth}",
                        at(point)
                    );
                    return Err(self.refuse(triangle.line, message));
                }
            }
        }
        Ok(())
    }

    /// Every vertex modulo the period; vertices nearer than the resolution share a number.
    fn corners(&self) -> Vec<PeriodicCorner> {
        /// Width of a bucket in resolutions: most vertices lie clear of its walls.
        const WIDTH: f64 = 16.0;
        let bucket_nm = WIDTH * self.resolution_nm;
        let mut buckets: HashMap<[i64; 3], Vec<u32>> = HashMap::with_capacity(self.mesh.vertices.len());
        let mut places: Vec<DVec3> = Vec::with_capacity(self.mesh.vertices.len());
        let mut corners = Vec::with_capacity(self.mesh.vertices.len());
        for vertex in &self.mesh.vertices {
            let mut place = DVec3::from(*vertex);
            let mut tile = [0; 2];
            for (axis, period) in self.period_nm.into_iter().enumerate() {
                if place[axis] >= period - self.resolution_nm {
                    place[axis] -= period;
                    tile[axis] = 1;
                }
            }
            let bucket = |x: f64| (x / bucket_nm).floor() as i64;
            let low = (place - self.resolution_nm).to_array().map(bucket);
            let high = (place + self.resolution_nm).to_array().map(bucket);
            let mut number = None;
            'search: for i in low[0]..=high[0] {
                for j in low[1]..=high[1] {
                    for k in low[2]..=high[2] {
                        let known = buckets.get(&[i, j, k]).map_or(&[][..], Vec::as_slice);
                        let near = |n: &&u32| (places[**n as usize] - place).abs().max_element() <= self.resolution_nm;
                        number = known.iter().find(near).copied();
                        if number.is_some() {
                            break 'search;
                        }
                    }
                }
            }
            let number = number.unwrap_or_else(|| {
                let number = places.len() as u32; // at most as many as the mesh has vertices
                buckets.entry(place.to_array().map(bucket)).or_default().push(number);
                places.push(place);
                number
            });
            corners.push(PeriodicCorner { number, tile });
        }
        corners
    }

    /// The edges of every triangle with an area, equal keys together.
    fn edges(&self) -> Vec<HalfEdge> {
        let corners = self.corners();
        let mut edges = Vec::with_capacity(3 * self.mesh.triangles.len());
        for (number, triangle) in self.mesh.triangles.iter().enumerate() {
            let [a, b, c] = self.points(triangle);
            let [p, q, r] = triangle.vertices.map(|index| corners[index as usize]);
            if p == q || q == r || r == p || (b - a).cross(c - a) == DVec3::ZERO {
                continue;
            }
            for (corner, (from, to)) in (0u8..).zip([(p, q), (q, r), (r, p)]) {
                let step = |axis: usize| to.tile[axis] - from.tile[axis];
                let there = (from.number, to.number, [step(0), step(1)]);
                let back = (to.number, from.number, [-step(0), -step(1)]);
                let key = there.min(back);
                edges.push(HalfEdge { key, triangle: number as u32, corner, forward: key == there });
            }
        }
        edges.sort_unstable_by_key(|edge| (edge.key, edge.triangle, edge.corner));
        edges
    }

    fn triangle(&self, edge: &HalfEdge) -> &Triangle {
        &self.mesh.triangles[edge.triangle as usize]
    }

    /// Start and end of an edge in its key's direction, and the third corner of its triangle.
    fn ends(&self, edge: &HalfEdge) -> [DVec3; 3] {
        let points = self.points(self.triangle(edge));
        let [from, to, third] = [0, 1, 2].map(|i| points[(usize::from(edge.corner) + i) % 3]);
        if edge.forward { [from, to, third] } else { [to, from, third] }
    }

    /// Angle of the facet about the edge, counted from `reference`, and its extent across the edge.
    fn angle(&self, edge: &HalfEdge, reference: Option<DVec3>) -> (f64, DVec3) {
        let [from, to, third] = self.ends(edge);
        let along = (to - from).normalize_or_zero();
        let across = (third - from).reject_from(if along == DVec3::ZERO { DVec3::Z } else { along });
        let reference = reference.unwrap_or(across);
        let angle = across.dot(along.cross(reference)).atan2(across.dot(reference));
        (angle, across)
    }

    /// Media on the two sides of a facet, by increasing angle: behind it, then in front of it.
    fn media_by_angle(&self, edge: &HalfEdge) -> [Below; 2] {
        let [above, below] = self.sides(self.triangle(edge));
        if edge.forward { [below, above] } else { [above, below] }
    }

    fn check_edges(&self, edges: &[HalfEdge], bodies: &mut Bodies) -> Result<()> {
        let mut faults: Vec<(Fault, HalfEdge, HalfEdge)> = Vec::new();
        let mut facets: Vec<(f64, f64, HalfEdge)> = Vec::new();
        for group in edges.chunk_by(|a, b| a.key == b.key) {
            let (_, reference) = self.angle(&group[0], None);
            facets.clear();
            facets.extend(group.iter().map(|edge| {
                let (angle, across) = self.angle(edge, Some(reference));
                (angle, across.length(), *edge)
            }));
            facets.sort_by(|(a, ..), (b, ..)| a.total_cmp(b));
            for (i, &(angle, height, edge)) in facets.iter().enumerate() {
                bodies.union(edge.triangle as usize, group[0].triangle as usize);
                let (next_angle, next_height, next) = facets[(i + 1) % facets.len()];
                let rounding = 2.0 * self.resolution_nm * (1.0 / height + 1.0 / next_height);
                let mut turn = (next_angle - angle).abs();
                turn = turn.min(std::f64::consts::TAU - turn);
                let fault = if facets.len() > 1 && turn < OVERLAP + rounding && rounding < 0.1 {
                    Fault::Overlap
                } else if self.media_by_angle(&edge)[1] == self.media_by_angle(&next)[0] {
                    continue;
                } else if facets.len() == 1 {
                    Fault::Hole
                } else {
                    Fault::Media
                };
                if faults.len() < MAX_FAULTS {
                    faults.push((fault, edge, next));
                }
            }
        }
        self.report(&faults)
    }

    /// Reports the worst fault; among equals, the one at the facet with most of them, in the first line.
    fn report(&self, faults: &[(Fault, HalfEdge, HalfEdge)]) -> Result<()> {
        let mut counts: HashMap<u32, usize> = HashMap::new();
        for (_, edge, next) in faults {
            *counts.entry(edge.triangle).or_default() += 1;
            *counts.entry(next.triangle).or_default() += 1;
        }
        let both =
            faults.iter().flat_map(|&(fault, edge, next)| [(fault, edge, next, true), (fault, next, edge, false)]);
        let worst = both.min_by_key(|(fault, edge, next, _)| {
            let count = counts[&edge.triangle];
            (*fault, usize::MAX - count, self.triangle(edge).line, edge.triangle, next.triangle, edge.key)
        });
        let Some((fault, edge, other, before)) = worst else { return Ok(()) };
        let (line, other_line) = (self.triangle(&edge).line, self.triangle(&other).line);
        let [from, to, _] = self.ends(&edge);
        let place = format!("the edge from {} to {} nm", at(from), at(to));
        Err(self.refuse(
            line,
            match fault {
                Fault::Overlap => {
                    format!("the facet overlaps that of line {other_line} beside {place}; remove one")
                }
                Fault::Hole => format!("{place} has no partner; fill the hole or share the edge"),
                Fault::Media => {
                    let side = usize::from(before);
                    let here = self.name(self.media_by_angle(&edge)[side]);
                    let there = self.name(self.media_by_angle(&other)[1 - side]);
                    format!(
                        "at {place} the facet has {here} where the facet of line {other_line} has {there}; turn its vertices around or correct its usemtl"
                    )
                }
            },
        ))
    }

    /// Follows a vertical line through each body; refuses media that differ, and bodies none of which spans the period.
    fn check_bodies(&self, edges: &[HalfEdge], bodies: &mut Bodies) -> Result<()> {
        let mut found: HashMap<usize, (f64, f64, usize)> = HashMap::new(); // net and largest area seen from above
        let mut solid: Vec<usize> = edges.iter().map(|edge| edge.triangle as usize).collect();
        solid.sort_unstable();
        solid.dedup();
        for &number in &solid {
            let [a, b, c] = self.points(&self.mesh.triangles[number]);
            let area = 0.5 * (b - a).cross(c - a).z;
            let body = found.entry(bodies.find(number)).or_insert((0.0, 0.0, number));
            body.0 += area;
            if area.abs() > body.1 {
                (body.1, body.2) = (area.abs(), number);
            }
        }
        let [width, depth] = self.period_nm;
        let first = self.mesh.triangles.first().map_or(1, |triangle| triangle.line);
        if !found.values().any(|(net, ..)| net.abs() > 0.5 * width * depth) {
            let message = "no surface spans the period, so light falls through between the facets; add a plane";
            return Err(self.refuse(first, message));
        }
        let mut probes: Vec<usize> = found.values().filter(|body| body.1 > 0.0).map(|body| body.2).collect();
        probes.sort_unstable();
        let step = 1 + probes.len() * solid.len() / MAX_PROBED;
        probes.into_iter().step_by(step).try_for_each(|number| self.probe(number, &solid))
    }

    /// Follows the vertical line through a point of a triangle.
    fn probe(&self, number: usize, solid: &[usize]) -> Result<()> {
        // A place in the triangle that no regular mesh has an edge over.
        let [a, b, c] = self.points(&self.mesh.triangles[number]);
        let through = a + 0.3819660 * (b - a) + 0.2679492 * (c - a);
        let mut hits: Vec<(f64, [Below; 2], u32)> = Vec::new();
        for &other in solid {
            let triangle = &self.mesh.triangles[other];
            let area =
                |p: DVec3, q: DVec3| (p.x - through.x) * (q.y - through.y) - (q.x - through.x) * (p.y - through.y);
            let [a, b, c] = self.points(triangle);
            let [u, v, w] = [area(b, c), area(c, a), area(a, b)];
            let up = u > 0.0 && v > 0.0 && w > 0.0;
            if up || (u < 0.0 && v < 0.0 && w < 0.0) {
                let z = (u * a.z + v * b.z + w * c.z) / (u + v + w);
                let [above, below] = self.sides(triangle);
                hits.push((z, if up { [above, below] } else { [below, above] }, triangle.line));
            }
        }
        hits.sort_by(|(a, ..), (b, ..)| b.total_cmp(a));
        let place = |z: f64| at(DVec3::new(through.x, through.y, z));
        if let Some(&(z, [top, _], line)) = hits.first() {
            let absorbs = match top {
                Below::Medium(index) => self.media[usize::from(index)].medium.always_absorbs(),
                Below::Mirror => true,
            };
            if absorbs {
                let top = self.name(top);
                let message =
                    format!("light cannot arrive at {} nm through {top}, which absorbs; use k <= 0.001", place(z));
                return Err(self.refuse(line, message));
            }
        }
        for pair in hits.windows(2) {
            let [(upper_z, [_, below], upper_line), (z, [above, _], line)] = [pair[0], pair[1]];
            if below != above {
                let (below, above) = (self.name(below), self.name(above));
                let message = format!(
                    "the facet has {above} over it at {} nm but the facet of line {upper_line}, at {} nm, has {below} under it; make them equal",
                    place(z),
                    place(upper_z)
                );
                return Err(self.refuse(line, message));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "watertight_tests.rs"]
mod tests;
