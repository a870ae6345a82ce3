//! A mesh cell: a periodic cell of triangles, and the search for the facet that a ray meets next.
//!
//! A facet is a plane polygon of one interface: all coplanar triangles that touch count as one. The mesh covers one
//! period, [0, Λx] × [0, Λy], and repeats. It is open above, and open or closed below. Rays keep their unwrapped
//! positions, so that phases are right whatever the number of periods crossed.

use crate::geometry::bvh::{Bvh, Hit, Ray};
use crate::geometry::facet::{CellError, Facet};
use crate::optics::interface::{Below, Interface};
use crate::optics::medium::MediumIndex;
use crate::optics::stack::Film;
use glam::DVec3;

/// A checked periodic mesh: its facets and interfaces are in range, its vertices within the period.
#[derive(Clone, Copy, Debug)]
pub struct MeshCell<'a> {
    bvh: Bvh<'a>,
    facet_of: &'a [u32],
    facets: &'a [Facet],
    interfaces: &'a [Interface],
    /// Films on each interface, from above; empty for none.
    coatings: &'a [&'a [Film]],
    period_nm: [f64; 2],
    bottom_nm: f64,
    top_nm: f64,
    /// Slack along a ray at the border between periods, where two copies of a vertex may differ by rounding.
    slack_nm: f64,
    above: MediumIndex,
    /// The medium under the whole cell; `None` under a mirror.
    below: Option<MediumIndex>,
}

/// The hit of a ray on a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetHit {
    /// Index of the facet.
    pub facet: u32,
    /// True if the ray comes from the side to which the normal points.
    pub front: bool,
    /// The point that is hit, unwrapped.
    pub point_nm: DVec3,
}

impl FacetHit {
    /// A hit to fill memory that is written before it is read.
    pub(crate) const NONE: Self = Self { facet: 0, front: false, point_nm: DVec3::ZERO };
}

/// A facet as seen from the side of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Unit normal, which points to the side from which the ray comes.
    pub normal: DVec3,
    /// The medium on the side from which the ray comes.
    pub near: MediumIndex,
    /// The medium or mirror on the other side.
    pub far: Below,
}

/// The next event of a ray in the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NextEvent {
    /// The ray meets a facet.
    Facet(FacetHit),
    /// The ray leaves the cell upwards.
    Above,
    /// The ray leaves the cell downwards, into the medium under it.
    Below,
    /// The ray crosses more periods than are followed, or leaves the cell through a hole, in a medium that is not open
    /// there.
    Lost,
}

/// Maximum number of periods that a ray may cross between two hits. In a cell as high as it is wide, only rays within
/// 1e-3 radians of the horizontal cross more.
const MAX_PERIODS: u32 = 4096;

/// Facet that stands for those beyond the last; `new` makes sure that no triangle has one.
const NO_FACET: Facet = Facet { normal: DVec3::Z, anchor_nm: DVec3::ZERO, interface: u16::MAX };
/// Interface that stands for those beyond the last; `new` makes sure that no facet has one.
const NO_INTERFACE: Interface = Interface { above: MediumIndex::MAX, below: Below::Mirror };

/// Rounding of coordinates in single-precision files, as a fraction of the largest coordinate or period. Vertices may
/// lie outside the period by this fraction of it.
pub const RESOLUTION: f64 = 4.0 * f32::EPSILON as f64;

/// Moves vertices near the border of the period, x = 0 or Λx and y = 0 or Λy, onto it. Near means no further than
/// [`RESOLUTION`] times the largest coordinate or period.
///
/// The mesh repeats: where its border is off by rounding, neighbouring copies leave a gap, and light falls through.
pub fn snap_to_border(vertices: &mut [DVec3], period_nm: [f64; 2]) {
    let [width, depth] = period_nm;
    let largest = vertices.iter().fold(width.max(depth), |largest, v| largest.max(v.abs().max_element()));
    let snapped = |x: f64, period: f64| {
        let near = |border: &f64| libm::fabs(x - border) <= RESOLUTION * largest;
        [0.0, period].into_iter().find(near).unwrap_or(x)
    };
    for v in vertices {
        *v = DVec3::new(snapped(v.x, width), snapped(v.y, depth), v.z);
    }
}

impl<'a> MeshCell<'a> {
    /// Checks a periodic mesh and its facets. `facet_of` holds the index of the facet of each triangle of `bvh`;
    /// `above` is the medium open to the light. Vertices on the border must lie exactly there ([`snap_to_border`]). The
    /// medium under the cell is the one under its lowest surface.
    ///
    /// # Errors
    /// [`CellError::Empty`] without facets or if `facet_of` differs in length from the triangles;
    /// [`CellError::NotFinite`] and [`CellError::NoInterface`] with the first offending facet; [`CellError::Period`]
    /// for a period that is not positive or is left by the mesh.
    pub fn new(
        bvh: Bvh<'a>,
        facet_of: &'a [u32],
        facets: &'a [Facet],
        interfaces: &'a [Interface],
        period_nm: [f64; 2],
        above: MediumIndex,
    ) -> Result<Self, CellError> {
        if facets.is_empty() || facet_of.len() != bvh.triangles().len() {
            return Err(CellError::Empty);
        }
        if !period_nm.iter().all(|p| *p > 0.0 && p.is_finite()) {
            return Err(CellError::Period);
        }
        for (facet, f) in facets.iter().enumerate() {
            if !(f.normal.is_finite() && f.anchor_nm.is_finite()) {
                return Err(CellError::NotFinite { facet });
            }
            if usize::from(f.interface) >= interfaces.len() {
                return Err(CellError::NoInterface { facet });
            }
        }
        if let Some(&facet) = facet_of.iter().find(|&&facet| facet as usize >= facets.len()) {
            return Err(CellError::NotFinite { facet: facet as usize });
        }
        let slack = [RESOLUTION * period_nm[0], RESOLUTION * period_nm[1]];
        let inside = |v: &DVec3| {
            (-slack[0]..=period_nm[0] + slack[0]).contains(&v.x) && (-slack[1]..=period_nm[1] + slack[1]).contains(&v.y)
        };
        if !bvh.vertices().iter().all(inside) {
            return Err(CellError::Period);
        }
        let (bottom_nm, top_nm) = bvh
            .vertices()
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v.z), high.max(v.z)));
        let slack_nm = slack[0].max(slack[1]);
        let (coatings, below) = (&[][..], None);
        let cell =
            Self { bvh, facet_of, facets, interfaces, coatings, period_nm, bottom_nm, top_nm, slack_nm, above, below };
        Ok(Self { below: cell.lowest_medium(), ..cell })
    }

    /// The medium under the lowest of some points of the surface, seen from below. A closed cell has the same medium
    /// under each.
    fn lowest_medium(&self) -> Option<MediumIndex> {
        /// Points of the period: several, for a cell with holes, and none on an edge of a regular mesh.
        const PROBES: [[f64; 2]; 4] = [[0.382, 0.268], [0.854, 0.732], [0.146, 0.618], [0.618, 0.414]];
        let [px, py] = self.period_nm;
        let hit = |[u, v]: [f64; 2]| {
            let origin = DVec3::new(u * px, v * py, self.bottom_nm - self.slack_nm);
            self.intersect(&Ray { origin, direction: DVec3::Z, t_min: 0.0, t_max: f64::INFINITY }, None, None)
        };
        let lowest = PROBES.into_iter().filter_map(hit).reduce(|a, b| if b.t < a.t { b } else { a })?;
        let Interface { above, below } = self.interface(self.facet_of(&lowest));
        match (lowest.front, below) {
            (true, _) => Some(above),
            (false, Below::Medium(below)) => Some(below),
            (false, Below::Mirror) => None,
        }
    }

    /// Adds films to the facets of the mesh: one list for each interface, from the upper side. Interfaces with an empty
    /// list, and those beyond the lists, are bare.
    ///
    /// # Errors
    /// [`CellError::Coating`] for a thickness that is negative or not finite, with the index of the interface.
    pub fn with_coatings(self, coatings: &'a [&'a [Film]]) -> Result<Self, CellError> {
        let bad = |film: &Film| !(film.thickness_nm >= 0.0 && film.thickness_nm.is_finite());
        match coatings.iter().position(|films| films.iter().any(bad)) {
            Some(interface) => Err(CellError::Coating { interface }),
            None => Ok(Self { coatings, ..self }),
        }
    }

    /// The films on a facet, from the side to which its normal points.
    #[must_use]
    pub fn coating(&self, facet: u32) -> &'a [Film] {
        self.coatings.get(usize::from(self.facet(facet).interface)).copied().unwrap_or(&[])
    }

    /// The films on a facet that a ray meets, from the far side to the near side.
    pub(crate) fn films(&self, at: &FacetHit) -> impl Iterator<Item = &'a Film> + use<'a> {
        let (films, front) = (self.coating(at.facet), at.front);
        // One type of iterator for both ways, so that a coating's response is compiled once.
        (1..=films.len()).filter_map(move |i| films.get(if front { films.len() - i } else { i - 1 }))
    }

    /// The medium above the cell, which is open to the light.
    #[must_use]
    pub fn above(&self) -> MediumIndex {
        self.above
    }

    /// The periods Λx and Λy along x and y.
    #[must_use]
    pub fn period_nm(&self) -> [f64; 2] {
        self.period_nm
    }

    /// Height z of the highest vertex.
    #[must_use]
    pub fn top_nm(&self) -> f64 {
        self.top_nm
    }

    /// The facet at an index.
    #[must_use]
    pub fn facet(&self, facet: u32) -> &'a Facet {
        self.facets.get(facet as usize).unwrap_or(&NO_FACET)
    }

    /// The facet of the triangle that is hit.
    fn facet_of(&self, hit: &Hit) -> u32 {
        self.facet_of.get(hit.triangle as usize).copied().unwrap_or(u32::MAX)
    }

    /// The media that a facet divides.
    #[must_use]
    pub fn interface(&self, facet: u32) -> Interface {
        self.interfaces.get(usize::from(self.facet(facet).interface)).copied().unwrap_or(NO_INTERFACE)
    }

    /// The first hit of light of a unit direction that passes over a point of the period, (u, v) in [0, 1)²; `None` if
    /// the light hits nothing.
    #[must_use]
    pub fn first_hit(&self, u: f64, v: f64, direction: DVec3) -> Option<FacetHit> {
        let [px, py] = self.period_nm;
        match self.next_event(DVec3::new(u * px, v * py, self.top_nm), direction, self.above, None) {
            NextEvent::Facet(hit) => Some(hit),
            _ => None,
        }
    }

    /// The facet of a hit as the ray sees it; `None` where the ray would travel inside a mirror.
    #[must_use]
    pub fn sides(&self, at: &FacetHit) -> Option<Sides> {
        let Interface { above, below } = self.interface(at.facet);
        let normal = self.facet(at.facet).normal;
        match (at.front, below) {
            (true, far) => Some(Sides { normal, near: above, far }),
            (false, Below::Medium(near)) => Some(Sides { normal: -normal, near, far: Below::Medium(above) }),
            (false, Below::Mirror) => None,
        }
    }

    /// Follows a ray in `medium` from an unwrapped point to the next facet that has this medium on the near side. The
    /// facet `leaving` is passed over: a ray that leaves its plane cannot meet it again.
    #[must_use]
    pub fn next_event(
        &self,
        point_nm: DVec3,
        direction: DVec3,
        medium: MediumIndex,
        leaving: Option<u32>,
    ) -> NextEvent {
        let [px, py] = self.period_nm;
        let direction = direction.normalize_or_zero();
        let tile = (libm::floor(point_nm.x / px), libm::floor(point_nm.y / py));
        let mut origin = DVec3::new(point_nm.x - tile.0 * px, point_nm.y - tile.1 * py, point_nm.z);
        // The distance at which the ray leaves the slab that holds the mesh.
        let last = match direction.z {
            z if z > 0.0 => (self.top_nm - origin.z) / z,
            z if z < 0.0 => (self.bottom_nm - origin.z) / z,
            _ => f64::INFINITY,
        } + self.slack_nm;
        // The distance at which the ray crosses into the next period of each axis.
        let crossing = |origin: f64, direction: f64, period: f64| match direction {
            d if d > 0.0 => (period - origin) / d,
            d if d < 0.0 => -origin / d,
            _ => f64::INFINITY,
        };
        let mut entered = 0.0;
        for _ in 0..MAX_PERIODS {
            let (cross_x, cross_y) = (crossing(origin.x, direction.x, px), crossing(origin.y, direction.y, py));
            let leaves = cross_x.min(cross_y);
            let ray =
                Ray { origin, direction, t_min: entered - self.slack_nm, t_max: leaves.min(last) + self.slack_nm };
            let mut hit = self.intersect(&ray, Some(medium), leaving);
            if hit.is_none() {
                let steps = self.beside(&ray, [entered == 0.0, leaves >= last]).into_iter();
                let mut moved =
                    steps.filter(|step| *step != DVec3::ZERO).map(|step| Ray { origin: origin + step, ..ray });
                hit = moved.find_map(|ray| self.intersect(&ray, Some(medium), leaving));
            }
            if let Some(hit) = hit {
                return NextEvent::Facet(FacetHit {
                    facet: self.facet_of(&hit),
                    front: hit.front,
                    point_nm: point_nm + direction * hit.t,
                });
            }
            if leaves >= last {
                return match direction.z {
                    z if z > 0.0 && medium == self.above => NextEvent::Above,
                    z if z < 0.0 && Some(medium) == self.below => NextEvent::Below,
                    _ => NextEvent::Lost,
                };
            }
            if cross_x <= cross_y {
                origin.x -= px.copysign(direction.x);
            }
            if cross_y <= cross_x {
                origin.y -= py.copysign(direction.y);
            }
            entered = leaves;
        }
        NextEvent::Lost
    }

    /// The next hit in one period on a facet that has `medium` on the near side, or on any facet if `medium` is `None`.
    #[inline(never)] // A traversal is long, and has three callers.
    fn intersect(&self, ray: &Ray, medium: Option<MediumIndex>, leaving: Option<u32>) -> Option<Hit> {
        self.bvh.intersect_nearest(ray, |hit| {
            let facet = self.facet_of(hit);
            let interface = self.interface(facet);
            let near = if hit.front { Below::Medium(interface.above) } else { interface.below };
            Some(facet) != leaving && medium.is_none_or(|medium| near == Below::Medium(medium))
        })
    }

    /// Steps to the neighbouring periods of a ray that runs along the border of its own: because of rounding it may
    /// miss its own half of what it meets. In the `first` period a ray that begins on the border counts too, and in the
    /// `last` period one that ends there.
    fn beside(&self, ray: &Ray, [first, last]: [bool; 2]) -> [DVec3; 3] {
        let Ray { origin, direction, t_min, t_max } = *ray;
        let (begin, end) = (origin + direction * t_min, origin + direction * t_max);
        let step = |begin: f64, end: f64, period: f64| {
            let on = |begins: bool, ends: bool| begins && (first || ends) || ends && last;
            let [low, high] = [2.0 * self.slack_nm, period - 2.0 * self.slack_nm];
            if on(begin <= low, end <= low) {
                period
            } else if on(begin >= high, end >= high) {
                -period
            } else {
                0.0
            }
        };
        let [px, py] = self.period_nm;
        let (x, y) = (step(begin.x, end.x, px), step(begin.y, end.y, py));
        let corner = if x * y == 0.0 { DVec3::ZERO } else { DVec3::new(x, y, 0.0) };
        [DVec3::new(x, 0.0, 0.0), DVec3::new(0.0, y, 0.0), corner]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bvh::Node;

    const PERIOD_NM: [f64; 2] = [10.0, 8.0];

    /// Calls `work` with a cell of two horizontal sheets, air over film over glass; the lower one spans x up to
    /// `width`.
    fn film_over_glass(width: f64, work: impl FnOnce(MeshCell<'_>)) {
        let sheet = |z: f64, x: f64| [[0.0, 0.0], [x, 0.0], [x, 8.0], [0.0, 8.0]].map(|[x, y]| DVec3::new(x, y, z));
        let [a, b, c, d] = sheet(0.0, 10.0);
        let [e, f, g, h] = sheet(-3.0, width);
        let vertices = [a, b, c, d, e, f, g, h];
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let (mut nodes, mut order) = ([Node::EMPTY; Bvh::required_nodes(4)], [0; 4]);
        let mut corners = [0.0; Bvh::required_corners(4)];
        let bvh = Bvh::build(&vertices, &triangles, &mut nodes, &mut order, &mut corners).unwrap();
        let facets = [Facet::horizontal(0.0, 0), Facet::horizontal(-3.0, 1)];
        let interfaces = [(0, 1), (1, 2)].map(|(above, below)| Interface { above, below: Below::Medium(below) });
        work(MeshCell::new(bvh, &[0, 0, 1, 1], &facets, &interfaces, PERIOD_NM, 0).unwrap());
    }

    #[test]
    fn light_leaves_downwards_only_in_the_medium_under_the_cell() {
        let down = |cell: &MeshCell<'_>, x: f64, z: f64, medium| {
            cell.next_event(DVec3::new(x, 4.0, z), -DVec3::Z, medium, None)
        };
        film_over_glass(10.0, |cell| {
            assert!(matches!(down(&cell, 9.0, 0.0, 1), NextEvent::Facet(FacetHit { facet: 1, .. })));
            assert_eq!(down(&cell, 9.0, -3.0, 2), NextEvent::Below);
        });
        film_over_glass(6.0, |cell| {
            assert_eq!(down(&cell, 9.0, 0.0, 1), NextEvent::Lost, "in the film through a hole");
            assert_eq!(down(&cell, 5.0, -3.0, 2), NextEvent::Below);
        });
    }

    #[test]
    fn vertices_beside_the_border_are_put_onto_it() {
        let mut vertices = [[-1e-9, 8.000_001, 1.0], [9.999_999_9, 1e-7, -1e-9], [0.001, 7.999, 3.0]].map(DVec3::from);
        snap_to_border(&mut vertices, PERIOD_NM);
        assert_eq!(vertices, [[0.0, 8.0, 1.0], [10.0, 0.0, -1e-9], [0.001, 7.999, 3.0]].map(DVec3::from));
    }
}
