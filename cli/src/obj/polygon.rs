//! Triangulation of polygons in space.
//!
//! A polygon of n corners becomes n − 2 triangles of these corners, and no other point. Every side of the polygon stays
//! a side of one triangle, also where corners lie on a straight line, so a closed mesh of polygons becomes a closed
//! mesh of triangles. Corners are projected along Newell's normal, the mean normal of the polygon; how far they lie off
//! that plane is for the caller to judge by [`Triangulator::off_plane`].
//!
//! A fan from the first corner is kept where it is right, as it is for every convex polygon. Other polygons lose one
//! ear after the other (Meisters 1975): a convex corner whose triangle holds no other corner. Slivers are cut only
//! where nothing else is left.

use glam::{DVec2, DVec3};

/// Maximum number of corners of a polygon that no fan triangulates. Time grows with the square of their number: this
/// many take 0.2 s at worst.
pub(crate) const MAX_CORNERS: usize = 4096;

/// Fraction of the largest coordinate within which a corner lies on a line: files hold single precision.
const ON_LINE: f64 = 4.0 * f32::EPSILON as f64;

/// Fraction of the squared extent below which an area, or a width times the extent, is rounding.
const NOTHING: f64 = 64.0 * f64::EPSILON;

/// Reason why a polygon has no triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TriangulationError {
    /// All corners lie on a line.
    NoArea,
    /// Sides of the polygon cross or touch.
    SelfIntersection,
    /// The polygon is concave and has more than [`MAX_CORNERS`].
    TooManyCorners,
}

impl TriangulationError {
    /// Message with the remedy, in one phrase.
    pub fn message(self) -> String {
        match self {
            Self::NoArea => "the polygon has no area; remove it".to_owned(),
            Self::SelfIntersection => "the polygon crosses or touches itself; split it into triangles".to_owned(),
            Self::TooManyCorners => {
                format!("a concave polygon of more than {MAX_CORNERS} corners; split it into triangles")
            }
        }
    }
}

/// Last triangulation, and memory for the next.
#[derive(Default)]
pub(crate) struct Triangulator {
    /// Indices into the polygon's corners, counter-clockwise as the polygon itself.
    pub triangles: Vec<[usize; 3]>,
    /// Largest distance of a corner from the plane through the first corner, perpendicular to the mean normal.
    pub off_plane: f64,
    /// Largest distance from the first corner.
    pub extent: f64,
    /// Indices and projections of the corners that are left.
    ring: Vec<(usize, DVec2)>,
    is_ear: Vec<bool>,
}

impl Triangulator {
    /// Triangulates a polygon; a triangle is returned as it stands. Equal neighbours count as one corner.
    ///
    /// # Errors
    /// The reason if there is no triangulation: no area, sides that cross or touch, too many corners.
    pub fn triangulate(&mut self, corners: &[DVec3]) -> Result<(), TriangulationError> {
        self.triangles.clear();
        (self.off_plane, self.extent) = (0.0, 0.0);
        if corners.len() == 3 {
            self.triangles.push([0, 1, 2]);
            return Ok(());
        }
        self.ring.clear();
        for (number, corner) in corners.iter().enumerate() {
            let before = if number == 0 { corners.len() - 1 } else { number - 1 };
            if *corner != corners[before] {
                self.ring.push((number, DVec2::ZERO));
            }
        }
        let on_line = ON_LINE * corners.iter().map(|c| c.abs().max_element()).fold(0.0, f64::max);
        self.project(corners)?;
        // A disc of thousands of corners turns so little at each that rounding alone makes it concave.
        if self.is_fan(on_line) || self.ring.len() > MAX_CORNERS && self.is_fan(-on_line) {
            let first = self.ring[0].0;
            let fan = self.ring[1..].windows(2).map(|pair| [first, pair[0].0, pair[1].0]);
            self.triangles.extend(fan);
            return Ok(());
        }
        if self.ring.len() > MAX_CORNERS {
            return Err(TriangulationError::TooManyCorners);
        }
        if is_self_intersecting(&self.ring) {
            return Err(TriangulationError::SelfIntersection);
        }
        self.clip_ears(on_line)
    }

    /// Projects the ring along Newell's normal, so that it runs counter-clockwise.
    fn project(&mut self, corners: &[DVec3]) -> Result<(), TriangulationError> {
        let Some(&(first, _)) = self.ring.first() else { return Err(TriangulationError::NoArea) };
        let origin = corners[first];
        let from = |number: usize| corners[number] - origin;
        let newell: DVec3 = self.ring.windows(2).map(|pair| from(pair[0].0).cross(from(pair[1].0))).sum();
        let farthest = self.ring.iter().map(|&(number, _)| from(number)).max_by(|a, b| {
            // Corners are finite.
            a.length_squared().total_cmp(&b.length_squared())
        });
        let farthest = farthest.unwrap_or_default();
        self.extent = farthest.length();
        if newell.length() <= NOTHING * self.extent * self.extent {
            let width = self.ring.iter().map(|&(number, _)| from(number).cross(farthest).length()).fold(0.0, f64::max);
            let flat = width <= NOTHING * self.extent * self.extent;
            return Err(if flat { TriangulationError::NoArea } else { TriangulationError::SelfIntersection });
        }
        let normal = newell.normalize();
        let (right, up) = normal.any_orthonormal_pair();
        for (number, place) in &mut self.ring {
            let p = from(*number);
            *place = DVec2::new(p.dot(right), p.dot(up));
            self.off_plane = self.off_plane.max(p.dot(normal).abs());
        }
        Ok(())
    }

    /// Whether all triangles of the fan from the first corner are higher than `min`, and it turns less than once: then
    /// no two overlap.
    fn is_fan(&self, min: f64) -> bool {
        let first = self.ring[0].1;
        let mut turned = 0.0;
        for pair in self.ring[1..].windows(2) {
            let [a, b] = [pair[0].1, pair[1].1];
            if height(first, a, b) <= min {
                return false;
            }
            turned += (a - first).angle_to(b - first);
        }
        turned < std::f64::consts::TAU
    }

    /// Cuts ears until one triangle is left.
    fn clip_ears(&mut self, on_line: f64) -> Result<(), TriangulationError> {
        // First clear ears; then those that only rounding tells from a straight line; then what rounding has turned
        // over.
        for (min, clear) in [(on_line, on_line), (0.0, 0.0), (-on_line, -on_line)] {
            self.is_ear.clear();
            let ears = (0..self.ring.len()).map(|place| is_ear(&self.ring, place, min, clear));
            self.is_ear.extend(ears);
            let mut place = 0;
            let mut tried = 0;
            while self.ring.len() > 3 && tried < self.ring.len() {
                let count = self.ring.len();
                place %= count;
                if !self.is_ear[place] {
                    (place, tried) = (place + 1, tried + 1);
                    continue;
                }
                let [before, after] = around(place, count);
                self.triangles.push([self.ring[before].0, self.ring[place].0, self.ring[after].0]);
                self.ring.remove(place);
                self.is_ear.remove(place);
                tried = 0;
                let count = self.ring.len();
                for changed in [(place + count - 1) % count, place % count] {
                    self.is_ear[changed] = is_ear(&self.ring, changed, min, clear);
                }
                // From the corner after the next: else one corner would collect a fan of ever slimmer triangles.
                place += 1;
            }
        }
        let last: [(usize, DVec2); 3] =
            self.ring.as_slice().try_into().map_err(|_| TriangulationError::SelfIntersection)?;
        if height(last[0].1, last[1].1, last[2].1) < -on_line {
            return Err(TriangulationError::SelfIntersection);
        }
        self.triangles.push(last.map(|(number, _)| number));
        Ok(())
    }
}

/// Twice the area of a triangle, positive if it is counter-clockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Height of a triangle over its longest side, with the sign of its area.
fn height(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared()).sqrt();
    if longest > 0.0 { area(a, b, c) / longest } else { 0.0 }
}

/// Positions before and after a position in a ring.
fn around(place: usize, count: usize) -> [usize; 2] {
    [(place + count - 1) % count, (place + 1) % count]
}

/// Whether the triangle at a corner is higher than `min` and no other corner lies in it or within `clear` of it.
fn is_ear(ring: &[(usize, DVec2)], place: usize, min: f64, clear: f64) -> bool {
    let [before, after] = around(place, ring.len());
    let [a, b, c] = [ring[before].1, ring[place].1, ring[after].1];
    if height(a, b, c) <= min {
        return false;
    }
    let sides = [(a, b), (b, c), (c, a)];
    let lengths = sides.map(|(p, q)| p.distance(q));
    let inside = |p: DVec2| sides.iter().zip(lengths).all(|(&(from, to), length)| area(from, to, p) >= -clear * length);
    !ring.iter().enumerate().any(|(other, &(_, p))| other != before && other != place && other != after && inside(p))
}

/// Whether two points lie on the same side of the line from `a` to `b`, and not on it.
fn is_one_side(a: DVec2, b: DVec2, p: DVec2, q: DVec2) -> bool {
    let (p, q) = (area(a, b, p), area(a, b, q));
    (p > 0.0 && q > 0.0) || (p < 0.0 && q < 0.0)
}

/// Whether two sides that are not neighbours have a point in common.
fn is_self_intersecting(ring: &[(usize, DVec2)]) -> bool {
    let count = ring.len();
    let side = |i: usize| (ring[i].1, ring[(i + 1) % count].1);
    (0..count).any(|i| {
        let (a, b) = side(i);
        let (low, high) = (a.min(b), a.max(b));
        (i + 2..count).any(|j| {
            let (c, d) = side(j);
            let apart = c.max(d).cmplt(low).any() || c.min(d).cmpgt(high).any();
            let is_next = i == 0 && j == count - 1;
            !apart && !is_next && !is_one_side(a, b, c, d) && !is_one_side(c, d, a, b)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The triangles of a polygon in the plane z = 0, and the sum of their areas.
    fn cut(corners: &[[f64; 2]]) -> Result<(Vec<[usize; 3]>, f64), TriangulationError> {
        let corners: Vec<DVec3> = corners.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
        let mut cut = Triangulator::default();
        cut.triangulate(&corners)?;
        let areas = cut.triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| corners[i]);
            0.5 * (b - a).cross(c - a).length()
        });
        let sum = areas.sum();
        Ok((cut.triangles, sum))
    }

    /// Every side of the polygon is passed once in its own direction, every cut once in each.
    fn keeps_sides(count: usize, triangles: &[[usize; 3]]) -> bool {
        let mut sides: Vec<(usize, usize)> = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        let all = sides.clone();
        sides.retain(|&(a, b)| !all.contains(&(b, a)));
        sides.sort_unstable();
        let mut wanted: Vec<_> = (0..count).map(|i| (i, (i + 1) % count)).collect();
        wanted.sort_unstable();
        triangles.len() == count - 2 && sides == wanted
    }

    const L: [[f64; 2]; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    #[test]
    fn an_l_is_covered_once_from_every_first_corner() {
        for first in 0..6 {
            let mut corners = L;
            corners.rotate_left(first);
            let (triangles, area) = cut(&corners).unwrap();
            assert!((area - 3.0).abs() < 1e-12 && keeps_sides(6, &triangles), "{first}: {area} {triangles:?}");
        }
    }

    #[test]
    fn convex_polygons_stay_fans() {
        let (triangles, _) = cut(&[[0.0, 0.0], [1.0, 0.0], [1.5, 1.0], [0.5, 2.0], [-0.5, 1.0]]).unwrap();
        assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(cut(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]).unwrap().0, [[0, 1, 2]]);
    }

    #[test]
    fn corners_on_straight_sides_stay_corners_of_triangles_with_area() {
        for first in 0..8 {
            let mut corners =
                [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
            corners.rotate_left(first);
            let (triangles, area) = cut(&corners).unwrap();
            assert!((area - 4.0).abs() < 1e-12 && keeps_sides(8, &triangles));
            let place = |i: usize| DVec2::from(corners[i]);
            assert!(
                triangles.iter().all(|t| super::area(place(t[0]), place(t[1]), place(t[2])) > 0.5),
                "{triangles:?}"
            );
        }
    }

    #[test]
    fn random_simple_polygons_are_covered_once() {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for count in [4usize, 5, 7, 12, 40, 300] {
            for spiral in [0.0, 0.0, 0.7, 3.0] {
                // Star-shaped around a middle that is not a corner; then twisted, which keeps it simple and takes that
                // away.
                let corners: Vec<[f64; 2]> = (0..count)
                    .map(|i| {
                        let (radius, angle) =
                            (0.2 + random(), std::f64::consts::TAU * (i as f64 + 0.8 * random()) / count as f64);
                        let angle = angle + spiral * radius;
                        [radius * angle.cos(), radius * angle.sin()]
                    })
                    .collect();
                let shoelace: f64 = (0..count)
                    .map(|i| 0.5 * DVec2::from(corners[i]).perp_dot(DVec2::from(corners[(i + 1) % count])))
                    .sum();
                match cut(&corners) {
                    Ok((triangles, area)) => {
                        assert!((area / shoelace - 1.0).abs() < 1e-9, "{count}: {area} {shoelace}");
                        assert!(keeps_sides(count, &triangles));
                    }
                    // Sides are chords: a twist of few corners may bring them across each other.
                    Err(error) => assert!(spiral > 0.0 && error == TriangulationError::SelfIntersection, "{count}"),
                }
            }
        }
    }

    #[test]
    fn polygons_in_space_are_cut_in_their_own_plane() {
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0);
        let corners: Vec<DVec3> = L.iter().map(|&[x, y]| turn * DVec3::new(x, y, 5.0)).collect();
        let mut cut = Triangulator::default();
        cut.triangulate(&corners).unwrap();
        assert_eq!(cut.triangles.len(), 4);
        assert!(cut.off_plane < 1e-12 && (cut.extent - 5.0f64.sqrt()).abs() < 1e-12, "{}", cut.off_plane);
        for t in &cut.triangles {
            let [a, b, c] = t.map(|i| corners[i]);
            assert!((b - a).cross(c - a).dot(turn * DVec3::Z) > 0.1);
        }
    }

    #[test]
    fn what_covers_nothing_or_twice_is_refused() {
        assert_eq!(cut(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), Err(TriangulationError::SelfIntersection));
        assert_eq!(cut(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 3.0]]), Err(TriangulationError::SelfIntersection));
        assert_eq!(cut(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]), Err(TriangulationError::NoArea));
        assert_eq!(cut(&[[1.0, 1.0]; 5]), Err(TriangulationError::NoArea));
        // Once around more than once: all triangles of the fan are convex.
        let pentagram = [0, 2, 4, 1, 3].map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 5.0).sin_cos();
            [cos, sin]
        });
        assert_eq!(cut(&pentagram), Err(TriangulationError::SelfIntersection));
        let comb: Vec<[f64; 2]> = (0..=MAX_CORNERS)
            .map(|i| [i as f64, if i % 2 == 0 { 0.0 } else { 1.0 }])
            .chain([[MAX_CORNERS as f64, -1.0], [0.0, -1.0]])
            .rev()
            .collect();
        assert_eq!(cut(&comb), Err(TriangulationError::TooManyCorners));
    }

    #[test]
    fn discs_of_many_corners_written_in_single_precision_are_covered_once() {
        for count in [1000, 4000, 50_000] {
            let corner = |i: usize| {
                let (sin, cos) = (std::f64::consts::TAU * i as f64 / count as f64).sin_cos();
                [f64::from(cos as f32), f64::from(sin as f32)]
            };
            let corners: Vec<[f64; 2]> = (0..count).map(corner).collect();
            let (triangles, area) = cut(&corners).unwrap();
            // A polygon in the unit circle lacks 2π³/3n² of its area; rounding adds less than a millionth.
            let lacks = 2.0 * std::f64::consts::PI.powi(3) / (3.0 * (count * count) as f64);
            assert!(triangles.len() == count - 2 && (area - std::f64::consts::PI + lacks).abs() < 1e-6, "{count}");
        }
    }
}
