//! Cells of horizontal planes: whether a mesh is one, whether its planes are closed, and the planes from the top.
//!
//! A plane covers the period exactly once under three conditions:
//!
//! 1. Its facets are oriented alike.
//! 2. Every edge off the border of the period's rectangle is passed equally often in both directions. Hence the number
//!    of facets over a point is constant over the rectangle.
//! 3. The area of its facets is that of the rectangle. Hence that number is 1.

use std::collections::HashMap;
use std::fmt::Display;

use goniochrome::optics::interface::{Below, Interface};

use super::mesh::{Mesh, Triangle};
use super::parts::{Layer, NamedInterface, NamedMedium};
use super::watertight::ClosedCell;
use crate::support::error::{Error, Result};

/// Horizontal plane that covers the whole period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    /// Height of the plane.
    pub z_nm: f64,
    /// Media above and below the plane along z.
    pub interface: Interface,
}

/// Cell of horizontal planes. Each covers the period exactly once, and neighbours agree on the medium between them.
#[derive(Clone, Debug)]
pub struct FlatCell {
    planes: Vec<Plane>,
    polygons: ClosedCell,
}

impl FlatCell {
    /// Finds and checks the planes of a mesh; `None` if it has other facets than horizontal ones.
    ///
    /// # Errors
    /// One line that names the first plane that is open, or the two planes that disagree.
    pub(super) fn new(
        mesh: &Mesh,
        period_nm: [f64; 2],
        interfaces: &[NamedInterface],
        media: &[NamedMedium],
    ) -> Result<Option<Self>> {
        let check = PlaneCheck { mesh, period_nm, interfaces, media, resolution_nm: resolution_nm(mesh) };
        let Some(mut sheets) = check.sheets() else { return Ok(None) };
        for sheet in &mut sheets {
            check.orient(sheet)?;
            check.check_covers_once(sheet)?;
        }
        sheets.sort_by(|a, b| b.plane.z_nm.total_cmp(&a.plane.z_nm).then(a.facets[0].line.cmp(&b.facets[0].line)));
        for pair in sheets.windows(2) {
            check.check_neighbours(&pair[0], &pair[1])?;
        }
        if let Some(top) = sheets.first() {
            check.check_ambient(top)?;
        }
        let mut planes = Vec::with_capacity(sheets.len());
        let mut lowered_nm = 0.0;
        for sheet in &sheets {
            let coating = &interfaces[usize::from(sheet.facets[0].interface)].coating;
            lowered_nm += add_coated_plane(sheet, coating, lowered_nm, &mut planes);
        }
        let polygons = ClosedCell::of_sheets(check.rectangles(&sheets), period_nm, interfaces.to_vec());
        Ok(Some(Self { planes, polygons }))
    }

    /// Planes from the top, coatings written out.
    #[must_use]
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Planes as polygons: each one rectangle over the period, with coatings left to the interfaces.
    #[must_use]
    pub fn polygons(&self) -> &ClosedCell {
        &self.polygons
    }
}

/// Adds a plane with its coating written out, and returns the thickness of its films. The films take up no room in the
/// mesh, so everything below moves down by that thickness.
fn add_coated_plane(sheet: &Sheet, coating: &[Layer], lowered_nm: f64, planes: &mut Vec<Plane>) -> f64 {
    let Interface { mut above, below } = sheet.plane.interface;
    let mut thickness_nm = 0.0;
    let mut add = |film: &Layer| {
        let z_nm = sheet.plane.z_nm - lowered_nm - thickness_nm;
        planes.push(Plane { z_nm, interface: Interface { above, below: Below::Medium(film.medium) } });
        above = film.medium;
        thickness_nm += film.thickness_nm;
    };
    // From `above` to `below` of its interface, which a plane that faces down has the other way up.
    if sheet.faces_down {
        coating.iter().rev().for_each(&mut add);
    } else {
        coating.iter().for_each(&mut add);
    }
    planes.push(Plane { z_nm: sheet.plane.z_nm - lowered_nm - thickness_nm, interface: Interface { above, below } });
    thickness_nm
}

/// Resolution of coordinates. Modelling programs keep them in single precision, so heights or corners that are meant to
/// be equal may differ by the rounding of the largest coordinate.
fn resolution_nm(mesh: &Mesh) -> f64 {
    mesh.vertices.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs())) * f64::from(f32::EPSILON)
}

/// Facets of one interface at one height.
struct Sheet {
    plane: Plane,
    /// Whether its facets face down.
    faces_down: bool,
    facets: Vec<Triangle>,
}

struct PlaneCheck<'a> {
    mesh: &'a Mesh,
    period_nm: [f64; 2],
    interfaces: &'a [NamedInterface],
    media: &'a [NamedMedium],
    resolution_nm: f64,
}

impl PlaneCheck<'_> {
    fn refuse(&self, line: u32, message: impl Display) -> Error {
        Error::failed(format_args!("{}:{line}: {message}", self.mesh.path.display()))
    }

    fn corners(&self, facet: &Triangle) -> [[f64; 3]; 3] {
        facet.vertices.map(|index| self.mesh.vertices[index as usize])
    }

    /// Name of a sheet in messages.
    fn name(&self, sheet: &Sheet) -> String {
        format!("the plane {:?} at z = {} nm", self.usemtl(sheet), sheet.plane.z_nm)
    }

    fn usemtl(&self, sheet: &Sheet) -> &str {
        &self.interfaces[usize::from(sheet.facets[0].interface)].name
    }

    /// Groups facets by interface and height; `None` where they do not lie in horizontal planes.
    fn sheets(&self) -> Option<Vec<Sheet>> {
        struct Level {
            low: f64,
            high: f64,
            facet: Triangle,
        }
        let level = |facet: &Triangle| {
            let [a, b, c] = self.corners(facet).map(|corner| corner[2]);
            Level { low: a.min(b).min(c), high: a.max(b).max(c), facet: *facet }
        };
        let mut levels: Vec<Level> = self.mesh.triangles.iter().map(level).collect();
        levels.sort_by(|a, b| {
            let interfaces = a.facet.interface.cmp(&b.facet.interface);
            interfaces.then(a.low.total_cmp(&b.low)).then(a.facet.line.cmp(&b.facet.line))
        });
        let same = |a: &Level, b: &Level| a.facet.interface == b.facet.interface && b.low - a.low <= self.resolution_nm;
        let sheet = |group: &[Level]| {
            let (z_nm, high) = (group[0].low, group.iter().fold(f64::NEG_INFINITY, |max, level| max.max(level.high)));
            // The whole plane, not each facet alone: a fine mesh climbs by less than rounding from facet to facet.
            if high - z_nm > self.resolution_nm {
                return None;
            }
            let mut facets: Vec<Triangle> = group.iter().map(|level| level.facet).collect();
            facets.sort_by_key(|facet| facet.line);
            let interface = self.interfaces[usize::from(facets[0].interface)].interface;
            Some(Sheet { plane: Plane { z_nm, interface }, faces_down: false, facets })
        };
        levels.chunk_by(same).map(sheet).collect()
    }

    /// Each sheet as two triangles over the period, with the normal that its facets have.
    fn rectangles(&self, sheets: &[Sheet]) -> Mesh {
        let [x, y] = self.period_nm;
        let mut mesh = Mesh { vertices: Vec::new(), triangles: Vec::new(), path: self.mesh.path.clone() };
        for sheet in sheets {
            let first = mesh.vertices.len() as u32; // at most as many sheets as the mesh has triangles
            mesh.vertices.extend([[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]].map(|[x, y]| [x, y, sheet.plane.z_nm]));
            let Triangle { interface, line, .. } = sheet.facets[0];
            let halves = if sheet.faces_down { [[0, 2, 1], [0, 3, 2]] } else { [[0, 1, 2], [0, 2, 3]] };
            mesh.triangles.extend(halves.map(|corners| Triangle {
                vertices: corners.map(|corner| first + corner),
                interface,
                line,
            }));
        }
        mesh
    }

    /// Twice the area of a facet seen from above; positive if its normal points up.
    fn area(&self, facet: &Triangle) -> f64 {
        let [a, b, c] = self.corners(facet);
        (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    }

    /// Turns a plane that faces down; refuses one that faces both ways.
    fn orient(&self, sheet: &mut Sheet) -> Result<()> {
        let whole: f64 = sheet.facets.iter().map(|facet| self.area(facet)).sum();
        // Slivers turn over by the rounding of their corners; they may point either way.
        let rounding = self.resolution_nm * (self.period_nm[0] + self.period_nm[1]);
        let turned = |facet: &&Triangle| self.area(facet) * whole.signum() < -rounding;
        if let Some(facet) = sheet.facets.iter().find(turned) {
            let message = format!("facet of {} faces the other way; turn its vertices around", self.name(sheet));
            return Err(self.refuse(facet.line, message));
        }
        if whole < 0.0 {
            let Interface { above, below } = sheet.plane.interface;
            let Below::Medium(below) = below else {
                let message = format!("{} faces down, with its mirror on top; turn its faces around", self.name(sheet));
                return Err(self.refuse(sheet.facets[0].line, message));
            };
            sheet.plane.interface = Interface { above: below, below: Below::Medium(above) };
            sheet.faces_down = true;
        }
        Ok(())
    }

    /// Refuses a plane that does not cover the period exactly once.
    fn check_covers_once(&self, sheet: &Sheet) -> Result<()> {
        let corners = || sheet.facets.iter().flat_map(|facet| self.corners(facet));
        let first_line = sheet.facets[0].line;
        let mut border = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for corner in corners() {
            for (axis, [low, high]) in border.iter_mut().enumerate() {
                *low = low.min(corner[axis]);
                *high = high.max(corner[axis]);
            }
        }
        // Both ends of a span are rounded.
        let tolerance = 2.0 * self.resolution_nm;
        let [width, depth] = border.map(|[low, high]| high - low);
        let [x, y] = self.period_nm;
        if (width - x).abs() > tolerance || (depth - y).abs() > tolerance {
            let message = format!(
                "{} spans {width} by {depth} nm but the period is {x} by {y} nm; make them equal",
                self.name(sheet)
            );
            return Err(self.refuse(first_line, message));
        }
        if let Some((line, [a, b])) = self.open_edge(sheet, border, tolerance) {
            let message = format!(
                "{} is not closed: the edge from ({}, {}) to ({}, {}) has no partner; fill the hole or share the edge",
                self.name(sheet),
                a[0],
                a[1],
                b[0],
                b[1]
            );
            return Err(self.refuse(line, message));
        }
        // A whole number but for rounding, see the top of this file.
        let times = (sheet.facets.iter().map(|facet| self.area(facet)).sum::<f64>() / (2.0 * x * y)).abs().round();
        if (times - 1.0).abs() > 0.5 {
            let message = format!("{} covers the period {times} times; remove the copies", self.name(sheet));
            return Err(self.refuse(first_line, message));
        }
        Ok(())
    }

    /// The first edge inside the border that is not passed equally often in both directions.
    fn open_edge(&self, sheet: &Sheet, border: [[f64; 2]; 2], tolerance: f64) -> Option<(u32, [[f64; 2]; 2])> {
        // Vertices are compared by place, not by number: many programs write a vertex once for each face.
        let bits = |p: [f64; 2]| p.map(|x| (x + 0.0).to_bits());
        let mut passes = HashMap::new();
        for facet in &sheet.facets {
            let [a, b, c] = self.corners(facet).map(|corner| [corner[0], corner[1]]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let (key, step) =
                    if bits(from) < bits(to) { ((bits(from), bits(to)), 1) } else { ((bits(to), bits(from)), -1) };
                let entry = passes.entry(key).or_insert((0i32, facet.line, [from, to]));
                entry.0 += if bits(from) == bits(to) { 0 } else { step };
            }
        }
        let on_border = |ends: &[[f64; 2]; 2]| {
            let near = |axis: usize, at: f64| ends.iter().all(|end| (end[axis] - at).abs() <= tolerance);
            (0..2).any(|axis| border[axis].iter().any(|&at| near(axis, at)))
        };
        let open = passes.into_values().filter(|(net, _, ends)| *net != 0 && !on_border(ends));
        let open = open.map(|(_, line, ends)| (line, ends));
        open.min_by(|(a, p), (b, q)| a.cmp(b).then(bits(p[0]).cmp(&bits(q[0]))).then(bits(p[1]).cmp(&bits(q[1]))))
    }

    fn check_neighbours(&self, upper: &Sheet, lower: &Sheet) -> Result<()> {
        let line = lower.facets[0].line;
        if upper.plane.z_nm - lower.plane.z_nm <= self.resolution_nm {
            let message = format!("{} and {} coincide; move or remove one", self.name(upper), self.name(lower));
            return Err(self.refuse(line, message));
        }
        let Below::Medium(below) = upper.plane.interface.below else {
            let message = format!("{} lies below the mirror {}; remove it", self.name(lower), self.name(upper));
            return Err(self.refuse(line, message));
        };
        let above = lower.plane.interface.above;
        if below != above {
            let medium = |index: u16| &self.media[usize::from(index)].name;
            let (upper, lower) = (self.name(upper), self.name(lower));
            let (below, above) = (medium(below), medium(above));
            let message = format!("{lower} has {above:?} above it but {upper} has {below:?} below it; make them equal");
            return Err(self.refuse(line, message));
        }
        Ok(())
    }

    fn check_ambient(&self, top: &Sheet) -> Result<()> {
        let medium = &self.media[usize::from(top.plane.interface.above)];
        if medium.medium.always_absorbs() {
            let (top_name, medium) = (self.name(top), &medium.name);
            let message =
                format!("light cannot arrive at {top_name} through {medium:?}, which absorbs; use k <= 0.001");
            return Err(self.refuse(top.facets[0].line, message));
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "planes_tests.rs"]
mod tests;
