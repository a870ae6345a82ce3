//! Cross-sections of periodic cells: horizontal layers whose media change along x, or along x and y.
//!
//! A layer lies between two heights at which horizontal facets, or the ends of vertical ones, stand. Where other facets
//! slope through it, it is divided into thinner layers; each takes its media from its middle height. Media come from
//! lines along x: the facets that a line crosses say where the medium changes, and to which.

use std::fmt::Display;

use glam::DVec3;
use goniochrome::optics::interface::Below;
use goniochrome::optics::medium::MediumIndex;
use goniochrome::table::Periodicity;

use crate::scene::{Plane, Scene, Shape};
use crate::support::error::{Error, Result};

/// Sine of the angle below which a facet counts as horizontal or vertical: rounding of coordinates in single precision.
const PARALLEL: f64 = 1e-6;
/// Place of a generic line, as a fraction of an interval: no vertex lies there by design.
const GENERIC: f64 = 0.487_132_561;
/// Share of the cell's extent below which two coordinates are equal: rounding of single precision.
const EQUAL: f64 = 1e-7;

/// Number of layers of the period's size, or of the depth, in which slopes are compared with their mirror image.
const SYMMETRY_LAYERS: f64 = 64.0;

/// Media along a line, as the solvers take them.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct LineMedia {
    /// Positions where the medium changes, ascending, in [0, period), as bits of `f64`.
    pub edges: Vec<u64>,
    /// Medium from each edge to the next, the last over the period's end; one medium where there is no edge.
    pub media: Vec<MediumIndex>,
}

impl LineMedia {
    /// Positions where the medium changes.
    pub fn edges_nm(&self) -> Vec<f64> {
        self.edges.iter().map(|bits| f64::from_bits(*bits)).collect()
    }

    /// Whether the line is its own mirror image about a position.
    fn mirrors_about(&self, plane: f64, period: f64) -> bool {
        mirrored(&self.edges_nm(), &self.media, plane, period)
    }
}

/// Planes about which a pattern with these edges may be its own mirror image: in the middle of the first edge and
/// another one, or half a period from there.
fn planes(edges: &[f64], period: f64) -> impl Iterator<Item = f64> {
    edges.iter().map(|edge| 0.5 * (edges[0] + edge)).flat_map(move |plane| [plane, plane + 0.5 * period])
}

/// Whether a periodic pattern is its own mirror image about `plane`: `parts[i]` lies from edge i to the next.
fn mirrored<T: PartialEq>(edges: &[f64], parts: &[T], plane: f64, period: f64) -> bool {
    let count = edges.len();
    (0..count).all(|i| {
        let image = (2.0 * plane - edges[i]).rem_euclid(period);
        let apart = |edge: f64| (edge - image).abs().min(period - (edge - image).abs());
        // What follows an edge comes before its image.
        (0..count).any(|j| apart(edges[j]) <= EQUAL * period && parts[i] == parts[(j + count - 1) % count])
    })
}

/// Horizontal layer of a cell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SectionLayer {
    pub thickness_nm: f64,
    /// Positions along the second axis where strips meet, ascending, in [0, period); empty for one strip.
    pub strip_edges_nm: Vec<f64>,
    /// Media of each strip along the first axis.
    pub strips: Vec<LineMedia>,
}

/// Facet between two media, in the axes of the solver.
#[derive(Clone, Copy, Debug)]
struct Wall {
    corners: [DVec3; 3],
    normal: DVec3,
    /// Media on the side of the normal and behind.
    sides: [MediumIndex; 2],
}

impl Wall {
    fn is_horizontal(&self) -> bool {
        self.normal.x.hypot(self.normal.y) < PARALLEL
    }

    fn is_vertical(&self) -> bool {
        self.normal.z.abs() < PARALLEL
    }

    /// Least and greatest value of one coordinate.
    fn range(&self, axis: usize) -> [f64; 2] {
        let values = self.corners.map(|corner| corner[axis]);
        [values[0].min(values[1]).min(values[2]), values[0].max(values[1]).max(values[2])]
    }

    /// Coordinate `axis` of the point where a line along that axis meets the wall, if it does. The other coordinates of
    /// the line are those of `through`.
    fn meets(&self, axis: usize, through: DVec3) -> Option<f64> {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let [a, b, c] = self.corners.map(|corner| [corner[u] - through[u], corner[v] - through[v]]);
        let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
        let weights = [cross(b, c), cross(c, a), cross(a, b)];
        let area: f64 = weights.iter().sum();
        let inside = area != 0.0 && weights.iter().all(|weight| weight * area >= 0.0);
        inside.then(|| (0..3).map(|i| self.corners[i][axis] * weights[i]).sum::<f64>() / area)
    }
}

/// Cross-sections of a cell that is periodic along its first axis, or along both. For [`Periodicity::Y`] the axes are
/// exchanged, so that the media change along the first axis of the solver.
#[derive(Clone, Debug)]
pub(crate) struct Sections {
    pub periodicity: Periodicity,
    /// Periods along the solver's axes.
    pub period_nm: [f64; 2],
    pub above: MediumIndex,
    pub below: MediumIndex,
    walls: Vec<Wall>,
    /// Heights that bound layers, from the top.
    levels_nm: Vec<f64>,
    /// Layers of a cell of horizontal planes.
    flat: Option<Vec<SectionLayer>>,
}

impl Sections {
    /// Cross-sections of a scene's cell.
    ///
    /// # Errors
    /// One line that says why waves cannot be computed: a stack of layers, a perfect mirror, a coating of tilted
    /// facets.
    pub fn new(scene: &Scene) -> Result<Self> {
        let refuse = |what: &dyn Display| Error::failed(format_args!("{}: {what}", scene.name));
        let medium = |below: Below| match below {
            Below::Medium(medium) => Ok(medium),
            Below::Mirror => {
                Err(refuse(&"waves meet no perfect mirror; give it the n and k of a metal, such as \"Ag\""))
            }
        };
        let cell = match &scene.shape {
            Shape::Stack { .. } => return Err(refuse(&"a [stack] has no diffraction orders; describe a [cell]")),
            Shape::Planes(flat) => return Self::of_planes(flat.planes(), flat.polygons().period_nm(), medium),
            Shape::Mesh(cell) => cell,
        };
        let mesh = cell.mesh();
        let mut walls = Vec::with_capacity(mesh.triangles.len());
        for triangle in &mesh.triangles {
            let named = &cell.interfaces()[usize::from(triangle.interface)];
            if !named.coating.is_empty() {
                return Err(refuse(&format_args!(
                    "waves take no coating on tilted facets; describe the films of [interface.{}] as surfaces of the mesh",
                    named.name
                )));
            }
            let sides = [named.interface.above, medium(named.interface.below)?];
            let corners = triangle.vertices.map(|vertex| DVec3::from(mesh.vertices[vertex as usize]));
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if sides[0] != sides[1] && normal.length() > 0.0 {
                walls.push(Wall { corners, normal: normal.normalize(), sides });
            }
        }
        let along = |axis: usize| walls.iter().any(|wall| wall.normal[axis].abs() > PARALLEL);
        let periodicity = match (along(0), along(1)) {
            (true, true) => Periodicity::Both,
            (false, true) => Periodicity::Y,
            _ => Periodicity::X,
        };
        let mut period_nm = cell.period_nm();
        if periodicity == Periodicity::Y {
            period_nm.swap(0, 1);
            let exchange = |v: DVec3| DVec3::new(v.y, v.x, v.z);
            for wall in &mut walls {
                wall.corners = wall.corners.map(exchange);
                wall.normal = exchange(wall.normal);
            }
        }
        let highest = |wall: &&Wall| if wall.is_vertical() { f64::NEG_INFINITY } else { wall.range(2)[1] };
        let lowest = |wall: &&Wall| if wall.is_vertical() { f64::INFINITY } else { wall.range(2)[0] };
        let by = |of: &dyn Fn(&&Wall) -> f64, a: &&Wall, b: &&Wall| of(a).total_cmp(&of(b));
        let top = walls.iter().max_by(|a, b| by(&highest, a, b));
        let bottom = walls.iter().min_by(|a, b| by(&lowest, a, b));
        let (Some(top), Some(bottom)) = (top, bottom) else {
            return Err(refuse(&"its facets have one medium on both sides; nothing reflects"));
        };
        let (above, below) =
            (top.sides[usize::from(top.normal.z < 0.0)], bottom.sides[usize::from(bottom.normal.z > 0.0)]);
        let mut sections = Self { periodicity, period_nm, above, below, walls, levels_nm: Vec::new(), flat: None };
        sections.levels_nm = sections.levels();
        Ok(sections)
    }

    /// Layers of horizontal planes.
    fn of_planes(planes: &[Plane], period_nm: [f64; 2], medium: impl Fn(Below) -> Result<MediumIndex>) -> Result<Self> {
        let mut flat = Vec::new();
        for pair in planes.windows(2) {
            let media = vec![medium(pair[0].interface.below)?];
            let thickness_nm = pair[0].z_nm - pair[1].z_nm;
            if thickness_nm > 0.0 {
                let strips = vec![LineMedia { edges: Vec::new(), media }];
                flat.push(SectionLayer { thickness_nm, strip_edges_nm: Vec::new(), strips });
            }
        }
        let above = planes.first().map_or(0, |plane| plane.interface.above);
        let below = planes.last().map_or(Ok(above), |plane| medium(plane.interface.below))?;
        let (periodicity, walls) = (Periodicity::X, Vec::new());
        Ok(Self { periodicity, period_nm, above, below, walls, levels_nm: Vec::new(), flat: Some(flat) })
    }

    /// Heights of horizontal facets, of the ends of vertical ones, and of the highest and the lowest vertex, from the
    /// top.
    fn levels(&self) -> Vec<f64> {
        let mut levels = Vec::new();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for wall in &self.walls {
            let [bottom, top] = wall.range(2);
            (low, high) = (low.min(bottom), high.max(top));
            if wall.is_horizontal() || wall.is_vertical() {
                levels.extend([bottom, top]);
            }
        }
        levels.extend([low, high]);
        levels.sort_by(|a, b| b.total_cmp(a));
        let least = EQUAL * self.period_nm[0].max(high - low);
        levels.dedup_by(|next, kept| (*next - *kept).abs() <= least);
        levels
    }

    /// Height from the lowest to the highest facet.
    pub fn depth_nm(&self) -> f64 {
        match (&self.flat, self.levels_nm.first(), self.levels_nm.last()) {
            (Some(flat), ..) => flat.iter().map(|layer| layer.thickness_nm).sum(),
            (None, Some(top), Some(bottom)) => top - bottom,
            _ => 0.0,
        }
    }

    /// Whether some facet is neither horizontal nor vertical, or some column is not a rectangle: then layers and strips
    /// are a model of the surface, which gets better as they get thinner.
    pub fn is_stepped(&self) -> bool {
        self.walls.iter().any(|wall| {
            let slopes = !wall.is_horizontal() && !wall.is_vertical();
            slopes || (wall.is_vertical() && wall.normal.x.abs() > PARALLEL && wall.normal.y.abs() > PARALLEL)
        })
    }

    /// The layers from the top. Sloping facets are divided into layers, and slanted columns into strips, of at most
    /// `step_nm`.
    ///
    /// # Errors
    /// Facets that disagree about the medium between them, since bodies overlap.
    pub fn layers(&self, scene: &Scene, step_nm: f64) -> Result<Vec<SectionLayer>> {
        if let Some(flat) = &self.flat {
            return Ok(flat.clone());
        }
        let mut layers = Vec::new();
        for pair in self.levels_nm.windows(2) {
            let [top, bottom] = [pair[0], pair[1]];
            let crossing: Vec<Wall> = self
                .walls
                .iter()
                .filter(|wall| {
                    let [low, high] = wall.range(2);
                    !wall.is_horizontal() && low < top && high > bottom
                })
                .copied()
                .collect();
            let slopes = crossing.iter().any(|wall| !wall.is_vertical());
            let parts = if slopes { ((top - bottom) / step_nm).ceil().max(1.0) as usize } else { 1 };
            let thickness_nm = (top - bottom) / parts as f64;
            for part in 0..parts {
                let z = top - thickness_nm * (part as f64 + 0.5);
                layers.push(self.layer(scene, &crossing, z, thickness_nm, step_nm)?);
            }
        }
        Ok(layers)
    }

    /// The layer around the height z, through which the walls `crossing` pass.
    fn layer(&self, scene: &Scene, crossing: &[Wall], z: f64, thickness_nm: f64, step_nm: f64) -> Result<SectionLayer> {
        let period = self.period_nm[1];
        let mut bounds =
            if self.periodicity == Periodicity::Both { self.strip_bounds(crossing, z, step_nm) } else { Vec::new() };
        if bounds.is_empty() {
            let strips = vec![self.line(scene, crossing, GENERIC * period, z)?];
            return Ok(SectionLayer { thickness_nm, strip_edges_nm: Vec::new(), strips });
        }
        let mut strips = Vec::with_capacity(bounds.len());
        for (i, &from) in bounds.iter().enumerate() {
            let to = bounds.get(i + 1).copied().unwrap_or(bounds[0] + period);
            strips.push(self.line(scene, crossing, (from + GENERIC * (to - from)).rem_euclid(period), z)?);
        }
        // Equal neighbours are one strip.
        let count = strips.len();
        let mut keep = (0..count).map(|i| strips[i] != strips[(i + count - 1) % count]).collect::<Vec<_>>();
        if !keep.contains(&true) {
            return Ok(SectionLayer { thickness_nm, strip_edges_nm: Vec::new(), strips: vec![strips.swap_remove(0)] });
        }
        let mut kept = keep.iter();
        bounds.retain(|_| *kept.next().unwrap_or(&true));
        strips.retain(|_| keep.remove(0));
        Ok(SectionLayer { thickness_nm, strip_edges_nm: bounds, strips })
    }

    /// Positions along the second axis at which strips meet at the height z, in [0, period).
    fn strip_bounds(&self, crossing: &[Wall], z: f64, step_nm: f64) -> Vec<f64> {
        let period = self.period_nm[1];
        let segments: Vec<[f64; 2]> = crossing.iter().filter_map(|wall| cut(wall, z)).collect();
        let mut bounds: Vec<f64> = segments.iter().flatten().map(|y| y.rem_euclid(period)).collect();
        bounds.sort_by(f64::total_cmp);
        let least = EQUAL * period;
        bounds.dedup_by(|next, kept| *next - *kept <= least);
        if bounds.len() > 1 && bounds[0] + period - bounds[bounds.len() - 1] <= least {
            bounds.pop();
        }
        // Slanted walls are divided.
        let slanted: Vec<[f64; 2]> = crossing
            .iter()
            .filter(|wall| wall.normal.x.abs() > PARALLEL && wall.normal.y.abs() > PARALLEL)
            .filter_map(|wall| cut(wall, z))
            .collect();
        let mut divided = Vec::with_capacity(bounds.len());
        for (i, &from) in bounds.iter().enumerate() {
            let to = bounds.get(i + 1).copied().unwrap_or(bounds[0] + period);
            let middle = (0.5 * (from + to)).rem_euclid(period);
            let passes = slanted.iter().any(|[low, high]| *low < middle && middle < *high);
            let parts = if passes { ((to - from) / step_nm).ceil().max(1.0) as usize } else { 1 };
            divided.extend((0..parts).map(|part| (from + (to - from) * part as f64 / parts as f64).rem_euclid(period)));
        }
        divided.sort_by(f64::total_cmp);
        divided
    }

    /// The media along the line through y and z.
    fn line(&self, scene: &Scene, crossing: &[Wall], y: f64, z: f64) -> Result<LineMedia> {
        let period = self.period_nm[0];
        let through = DVec3::new(0.0, y, z);
        // Position, and the media before and after it.
        let mut crossings: Vec<(f64, [MediumIndex; 2])> = crossing
            .iter()
            .filter(|wall| wall.normal.x.abs() > PARALLEL * PARALLEL)
            .filter_map(|wall| {
                let x = wall.meets(0, through)?;
                let [ahead, behind] = wall.sides;
                Some((x.rem_euclid(period), if wall.normal.x > 0.0 { [behind, ahead] } else { [ahead, behind] }))
            })
            .collect();
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The two triangles of a quadrilateral may both hold a line through their common edge.
        let least = EQUAL * period;
        crossings.dedup_by(|next, kept| next.1 == kept.1 && next.0 - kept.0 <= least);
        if crossings.len() > 1 {
            let (first, last) = (crossings[0], crossings[crossings.len() - 1]);
            if first.1 == last.1 && first.0 + period - last.0 <= least {
                crossings.pop();
            }
        }
        if crossings.is_empty() {
            let x = GENERIC * period;
            return Ok(LineMedia { edges: Vec::new(), media: vec![self.medium_at(DVec3::new(x, y, z))] });
        }
        let count = crossings.len();
        for i in 0..count {
            let (next, (x, [_, after])) = (crossings[(i + 1) % count], crossings[i]);
            let to = if next.0 > x { next.0 } else { next.0 + period };
            let inside = DVec3::new((x + GENERIC * (to - x)).rem_euclid(period), y, z);
            // The next facet along the line and the next one above agree, unless surfaces cut through one another.
            let others = [next.1[0], self.medium_at(inside)];
            if let Some(&other) = others.iter().find(|&&other| other != after) {
                let [one, other] = [after, other].map(|medium| &scene.media[usize::from(medium)].name);
                return Err(Error::failed(format_args!(
                    "{}: bodies overlap near ({x:.3}, {y:.3}, {z:.3}): one facet says {one:?}, the next {other:?}; correct \
                     the mesh",
                    scene.name
                )));
            }
        }
        Ok(LineMedia {
            edges: crossings.iter().map(|(x, _)| x.to_bits()).collect(),
            media: crossings.iter().map(|(_, [_, after])| *after).collect(),
        })
    }

    /// The medium at a point: that under the nearest wall above it.
    fn medium_at(&self, point: DVec3) -> MediumIndex {
        let above = self.walls.iter().filter_map(|wall| {
            let z = wall.meets(2, point)?;
            (z > point.z).then_some((z, wall.sides[usize::from(wall.normal.z > 0.0)]))
        });
        above.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(self.above, |(_, medium)| medium)
    }

    /// Whether the cell is its own mirror image about some plane across the first axis, and across the second.
    ///
    /// # Errors
    /// Facets that disagree about the medium between them, since bodies overlap.
    pub fn mirrors(&self, scene: &Scene) -> Result<[bool; 2]> {
        let layers = self.layers(scene, self.depth_nm().max(self.period_nm[0]) / SYMMETRY_LAYERS)?;
        let lines: Vec<&LineMedia> =
            layers.iter().flat_map(|layer| &layer.strips).filter(|line| !line.edges.is_empty()).collect();
        let edges = lines.first().map_or_else(Vec::new, |line| line.edges_nm());
        let first = edges.is_empty()
            || planes(&edges, self.period_nm[0])
                .any(|plane| lines.iter().all(|line| line.mirrors_about(plane, self.period_nm[0])));
        let crossed: Vec<&SectionLayer> = layers.iter().filter(|layer| !layer.strip_edges_nm.is_empty()).collect();
        let edges = crossed.first().map_or_else(Vec::new, |layer| layer.strip_edges_nm.clone());
        let second = edges.is_empty()
            || planes(&edges, self.period_nm[1]).any(|plane| {
                let mirrors =
                    |layer: &&SectionLayer| mirrored(&layer.strip_edges_nm, &layer.strips, plane, self.period_nm[1]);
                crossed.iter().all(mirrors)
            });
        Ok([first, second])
    }

    /// The surface as one interface z = h(x): its corners over one period, x ascending from 0; two of one x are a
    /// vertical wall. `None` if it is none: several media or sheets, overhangs, two periods.
    pub fn graph(&self) -> Option<Vec<[f64; 2]>> {
        if self.periodicity == Periodicity::Both || self.walls.is_empty() {
            return None;
        }
        let first = self.walls[0].sides;
        let one_pair = self.walls.iter().all(|wall| {
            let [up, down] = if wall.normal.z < -PARALLEL { [wall.sides[1], wall.sides[0]] } else { wall.sides };
            wall.normal.z > -PARALLEL && [up, down] == first
        });
        if !one_pair || first != [self.above, self.below] {
            return None;
        }
        // Segments of the outline, from left to right or along a vertical wall; triangles of one facet share them.
        let least = EQUAL * self.period_nm[0].max(self.depth_nm());
        let key = |p: [f64; 2]| p.map(|x| (x / least).round() as i64);
        let mut segments: Vec<[[f64; 2]; 2]> = Vec::new();
        for wall in &self.walls {
            let points = wall.corners.map(|corner| [corner.x, corner.z]);
            let longest =
                [(0, 1), (1, 2), (2, 0)].map(|(i, j)| [points[i], points[j]]).into_iter().max_by(|a, b| {
                    let length = |[p, q]: &[[f64; 2]; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
                    length(a).total_cmp(&length(b))
                })?;
            // The medium above lies to the left of the direction of travel.
            let [p, q] = longest;
            let direction = [q[0] - p[0], q[1] - p[1]];
            let left = wall.normal.z * direction[0] - wall.normal.x * direction[1];
            segments.push(if left > 0.0 { [p, q] } else { [q, p] });
        }
        let mut next: std::collections::HashMap<[i64; 2], [f64; 2]> = std::collections::HashMap::new();
        let mut ends = std::collections::HashSet::new();
        for [from, to] in &segments {
            if let Some(known) = next.insert(key(*from), *to)
                && key(known) != key(*to)
            {
                return None;
            }
            ends.insert(key(*to));
        }
        let start = segments.iter().map(|[from, _]| *from).find(|from| !ends.contains(&key(*from)))?;
        let mut points = vec![start];
        while let Some(to) = next.remove(&key(points[points.len() - 1])) {
            points.push(to);
        }
        let whole = next.is_empty() && (points[points.len() - 1][0] - start[0] - self.period_nm[0]).abs() <= least;
        let ascends = points.windows(2).all(|pair| pair[1][0] - pair[0][0] >= -least);
        if !(whole && ascends && start[0].abs() <= least) {
            return None;
        }
        // The last corner is the first of the next period, unless a wall stands there.
        let last = points.pop()?;
        if (last[1] - start[1]).abs() > least {
            points.insert(0, [0.0, last[1]]);
        }
        let mut x = 0.0_f64;
        points.iter_mut().for_each(|point| {
            x = x.max(point[0]);
            point[0] = x;
        });
        Some(points)
    }
}

/// Range along the second axis of the line in which a wall meets the height z; `None` if it does not, or in a point.
fn cut(wall: &Wall, z: f64) -> Option<[f64; 2]> {
    let mut found: Vec<f64> = Vec::with_capacity(2);
    for i in 0..3 {
        let (a, b) = (wall.corners[i], wall.corners[(i + 1) % 3]);
        if (a.z > z) != (b.z > z) {
            found.push(a.y + (b.y - a.y) * (z - a.z) / (b.z - a.z));
        }
    }
    match found[..] {
        [p, q] => Some([p.min(q), p.max(q)]),
        _ => None,
    }
}

#[cfg(test)]
#[path = "sections_tests.rs"]
mod tests;
