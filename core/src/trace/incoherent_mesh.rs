//! Geometric optics of a polygon cell: paths that do not interfere, for light that arrives unpolarised.
//!
//! A path has a direction in each lane and carries power and polarisation but no phase: the coherency matrix of its light (Born &
//! Wolf, "Principles of Optics", section 10.9.1). All directions are real, so one path costs a fraction of a wave of
//! [`crate::trace::coherent_mesh`]; one hero lane decides which facet it meets.
//!
//! Power is handed on whole. Exact amplitudes do not do that in absorbing media: there the incident and the reflected wave
//! exchange power, so that R + T ≠ 1, and a refracted wave decays across its direction. A path followed by itself would gain or
//! lose by that; here it reflects no more than it brings, passes on the rest, and decays along its way. Snell's law takes
//! the real part of its tangential wavevector, as for planes of equal phase and amplitude that are parallel to the facet: by the complex
//! one no wave beyond could travel in a lossless medium, and the faintest absorption would keep all light inside.

use crate::geometry::mesh_cell::{FacetHit, MeshCell, NextEvent, Sides};
use crate::geometry::side::Side;
use crate::optics::coating::coated;
use crate::optics::interface::{Below, Wave, fresnel};
use crate::optics::medium::{MediaLanes, MediumIndex};
use crate::optics::stack::Response;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::attenuation;
use crate::simd::vector::{RealLanes, VectorLanes};
use crate::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, hero, is_evanescent};
use crate::trace::paths::{AsPath, Paths};
use crate::trace::waves::{Propagated, Slot, Target};
use glam::DVec3;
use num_complex::Complex64;

/// The light of a path: ⟨|E_s|²⟩, ⟨|E_p|²⟩ and ⟨E_s E_p*⟩ along a ŝ of the path and p̂ = ŝ × d, in units of the incident power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coherency<V> {
    /// Power along ŝ.
    pub s: V,
    /// Power along p̂.
    pub p: V,
    /// What s and p have in common.
    pub cross: ComplexLanes<V>,
}

impl<V: Lanes> Coherency<V> {
    /// Power.
    #[inline]
    pub fn power(&self) -> V {
        self.s + self.p
    }

    #[inline]
    fn scale(self, by: V) -> Self {
        Self { s: self.s * by, p: self.p * by, cross: self.cross.scale(by) }
    }

    /// The same light at another power, or none if it had none.
    #[inline]
    fn with_power(self, power: V) -> Self {
        let had = self.power();
        self.scale(V::zero().select_lt(had, power / had, V::zero()))
    }

    /// The light where it leaves a facet that multiplies its amplitudes.
    #[inline]
    fn after(self, s: ComplexLanes<V>, p: ComplexLanes<V>) -> Self {
        Self { s: self.s * s.norm_sqr(), p: self.p * p.norm_sqr(), cross: self.cross * (s * p.conj()) }
    }

    /// The same light along ŝ' = cos·ŝ + sin·p̂ and its p̂'. What rounding has left of cos² + sin² = 1 changes no power.
    #[inline]
    fn turned(self, cos: V, sin: V) -> Self {
        let (zero, power) = (V::zero(), self.power());
        let (cos2, sin2) = (cos * cos, sin * sin);
        let unit = V::one() / (cos2 + sin2).max(V::splat(f64::from(f32::MIN_POSITIVE)));
        let both = cos * sin;
        let shared = both * self.cross.re;
        let s = (cos2 * self.s + sin2 * self.p + shared + shared) * unit;
        let s = s.max(zero).min(power);
        let cross = ((cos2 - sin2) * self.cross.re + both * (self.p - self.s)) * unit;
        Self { s, p: power - s, cross: ComplexLanes::new(cross, self.cross.im) }
    }
}

/// A path about to be split at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<V> {
    at: FacetHit,
    /// d, unit.
    direction: RealLanes<V>,
    /// ŝ, unit and across d.
    across: RealLanes<V>,
}

impl<V> Path<V> {
    /// The facet that it meets, and where.
    pub fn at(&self) -> FacetHit {
        self.at
    }
}

/// How a path leaves the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitPath<V> {
    /// Upwards or downwards.
    pub side: Side,
    /// Unit.
    pub direction: RealLanes<V>,
}

/// A polygon cell at one group of wavelengths, as light that does not interfere sees it.
#[derive(Clone, Copy, Debug)]
pub struct IncoherentMesh<'a, V: Lanes> {
    cell: MeshCell<'a>,
    media: MediaLanes<'a, V>,
    incident: IncidentWave<V>,
    lost: V,
    absorbed: V,
}

/// Below this sine of the angle of incidence, in unit roundoffs, s and p are alike and the plane of incidence is arbitrary.
const NORMAL_INCIDENCE: f64 = 64.0;
/// A wave beyond a facet travels unless its normal part, relative to its length, is below this.
const GRAZING: f64 = 1e-9;

impl<'a, V: Lanes> IncoherentMesh<'a, V> {
    /// A cell, its media and the light.
    pub fn new(cell: MeshCell<'a>, media: MediaLanes<'a, V>, incident: IncidentWave<V>) -> Self {
        Self { cell, media, incident, lost: V::zero(), absorbed: V::zero() }
    }

    /// Starts a path over a point of the period, (u, v) in [0, 1)². `None` if it meets nothing.
    pub fn start(&self, u: f64, v: f64) -> Option<(Path<V>, Coherency<V>)> {
        let IncidentWave { wi, across, .. } = self.incident;
        let at = self.cell.first_hit(u, v, -wi)?;
        let half = V::splat(0.5);
        let path = Path { at, direction: RealLanes::<V>::splat(-wi), across: RealLanes::<V>::splat(across) };
        Some((path, Coherency { s: half, p: half, cross: ComplexLanes::zero() }))
    }

    /// Power of paths that were lost: in holes of the mesh, or after too many periods. Adds up over calls of `split`.
    pub fn lost(&self) -> V {
        self.lost
    }

    /// Power that media absorbed between facets, and films on them. Adds up over calls of `split`.
    pub fn absorbed(&self) -> V {
        self.absorbed
    }

    /// Response of a facet with films.
    fn coated(&self, path: &Path<V>, near: MediumIndex, far: Option<&Far<V>>, tangential_squared: V) -> Response<V> {
        let films = self.cell.films(&path.at);
        let tangential_squared = ComplexLanes::real(tangential_squared.widen());
        let wave = |medium| Wave::<V>::new(self.media.eta_of(medium), tangential_squared);
        let (near, far) = (wave(near), far.map(|far| wave(far.medium)));
        coated(&near, films, far.as_ref(), &self.media, tangential_squared)
    }

    /// What is left of light after a way through a medium.
    fn absorb(&mut self, medium: MediumIndex, length_nm: f64, light: Coherency<V>) -> Coherency<V> {
        let k = self.media.eta_of(medium).im;
        if !k.any_above(0.0) {
            return light;
        }
        let turns = k * V::Precise::splat(length_nm) / self.media.wavelength_nm();
        let amplitude = attenuation::<V>(ComplexLanes::new(V::Precise::zero(), turns));
        let left = light.scale(amplitude * amplitude);
        self.absorbed += light.power() - left.power();
        left
    }
}

/// The unit vector across the plane of incidence, N × d, and the square of the sine of the angle of incidence.
#[inline]
fn s_axis<V: Lanes>(normal: DVec3, direction: RealLanes<V>) -> (RealLanes<V>, V) {
    let s = RealLanes::<V>::splat(normal).cross(direction);
    let sin_squared = s.dot(s);
    let small = NORMAL_INCIDENCE * V::UNIT_ROUNDOFF;
    let small = V::splat(small * small);
    let unit = s.scale(V::one() / sin_squared.max(small).sqrt());
    let tangent = RealLanes::<V>::splat(normal.any_orthonormal_vector());
    (unit.zip(tangent, |unit, tangent| sin_squared.select_lt(small, tangent, unit)), sin_squared)
}

/// A medium beyond a facet as a path sees it.
struct Far<V: Lanes> {
    medium: MediumIndex,
    eta: ComplexLanes<V>,
    /// q_n, as [`Wave::normal`].
    normal: ComplexLanes<V>,
}

impl<V: Lanes> Far<V> {
    /// Whether the hero lane's wave decays beyond the facet instead of travelling.
    #[inline]
    fn is_evanescent(&self) -> bool {
        if !self.normal.im.any_above(0.0) {
            return false;
        }
        let Complex64 { re, im } = self.normal.lane(hero::<V>());
        im > 0.0 && re.abs() <= GRAZING * self.eta.lane(hero::<V>()).norm()
    }
}

/// κ of s and p for a wave of normal wavevector q_n: q_n, and q_n/η².
#[inline]
fn admittance<V: Lanes>(normal: ComplexLanes<V>, eta: ComplexLanes<V>) -> Polarised<ComplexLanes<V>> {
    Polarised { s: normal, p: normal.div_or_zero(eta).div_or_zero(eta) }
}

/// Which way light leaves a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<V> {
    direction: RealLanes<V>,
    across: RealLanes<V>,
    medium: MediumIndex,
}

impl<V: Lanes> Paths<V> for IncoherentMesh<'_, V> {
    type State = Path<V>;
    type Branch = Branch<V>;
    type Light = Coherency<V>;
    type Exit = ExitPath<V>;

    fn power(light: &Coherency<V>) -> V {
        light.power()
    }

    fn scale_power(light: &Coherency<V>, by: f64) -> Coherency<V> {
        light.scale(V::splat(by))
    }

    fn propagate(
        &mut self,
        from: &Path<V>,
        &Branch { direction, across, medium }: &Branch<V>,
        &light: &Coherency<V>,
    ) -> Propagated<Path<V>, ExitPath<V>, Coherency<V>> {
        let leave = |side| Some((Target::Exit(ExitPath { side, direction }), light));
        match self.cell.next_event(from.at.point_nm, direction.lane(hero::<V>()), medium, Some(from.at.facet)) {
            NextEvent::Facet(at) => {
                let light = self.absorb(medium, at.point_nm.distance(from.at.point_nm), light);
                Some((Target::State(Path { at, direction, across }), light))
            }
            NextEvent::Above => leave(Side::Above),
            NextEvent::Below => leave(Side::Below),
            NextEvent::Lost => {
                self.lost += light.power();
                None
            }
        }
    }

    fn split(&mut self, path: &Path<V>, light: &Coherency<V>) -> [Option<(Branch<V>, Coherency<V>)>; 2] {
        let Some(Sides { normal, near, far }) = self.cell.sides(&path.at) else { return [None, None] };
        let films = self.cell.coating(path.at.facet);
        let (zero, one) = (V::zero(), ComplexLanes::<V>::one());

        let n = RealLanes::<V>::splat(normal);
        let cos = (-path.direction.dot(n)).max(zero);
        let (s, sin_squared) = s_axis(normal, path.direction);
        let light = light.turned(path.across.dot(s), path.across.cross(path.direction).dot(s));

        let near_eta = ComplexLanes::<V>::narrow(self.media.eta_of(near));
        let tangential_squared = near_eta.re * near_eta.re * sin_squared;
        let near_normal = if near_eta.im.any_above(0.0) {
            (near_eta.square() - ComplexLanes::real(tangential_squared)).sqrt_upper()
        } else {
            ComplexLanes::real(near_eta.re * cos)
        };
        let far = match far {
            Below::Medium(medium) => {
                let eta = ComplexLanes::<V>::narrow(self.media.eta_of(medium));
                let normal = (eta.square() - ComplexLanes::real(tangential_squared)).sqrt_outgoing();
                Some(Far { medium, eta, normal })
            }
            Below::Mirror => None,
        };
        let Response { reflection: r, transmission: t } = if films.is_empty() {
            let beyond = far.as_ref().map(|far| admittance(far.normal, far.eta));
            let r = fresnel(admittance(near_normal, near_eta), beyond);
            Response { reflection: r, transmission: r.map(|r| one + r) }
        } else {
            self.coated(path, near, far.as_ref(), tangential_squared)
        };

        let arrived = light.power();
        let reflected = light.after(r.s, r.p);
        let passes = far.as_ref().filter(|far| !far.is_evanescent());
        // What cannot pass is reflected whole: from an absorbing medium |r| may differ from 1 then.
        let whole = films.is_empty() && passes.is_none();
        let back = if whole { arrived } else { reflected.power().min(arrived) };
        let rest = (arrived - back).max(zero);
        let refracted = passes.map(|far| {
            let through = if films.is_empty() {
                rest
            } else {
                // |t|² Re κ of each part, over that of the light that arrives.
                let there = admittance(far.normal, far.eta).map(|k| k.re);
                let s = t.s.norm_sqr() * there.s * light.s;
                let p = t.p.norm_sqr() * there.p * light.p * near_eta.norm_sqr();
                let here = near_eta.re * (near_normal.norm_sqr() / near_eta.norm_sqr()).sqrt();
                zero.select_lt(here, (s + p) / here, zero).max(zero).min(rest)
            };
            // t_p is of magnetic fields; electric ones change by η_near/η_far besides.
            let light = light.after(t.s, t.p * near_eta.div_or_zero(far.eta));
            let tangential = path.direction.add_scaled(n, cos).scale(near_eta.re);
            let direction = tangential.add_scaled(n, -far.normal.re).normalize_or_zero();
            let branch = Branch { direction, across: s, medium: far.medium };
            (branch, light.with_power(through))
        });
        if !films.is_empty() {
            let through = refracted.as_ref().map_or(zero, |(_, light)| light.power());
            self.absorbed += rest - through;
        }
        let mirrored = path.direction.add_scaled(n, cos + cos);
        let branch = Branch { direction: mirrored, across: s, medium: near };
        [Some((branch, reflected.with_power(back))), refracted]
    }
}

impl<V: Lanes> AsPath<V, CoherentMesh<'_, V>> for IncoherentMesh<'_, V> {
    fn path(&self, state: &WaveState<V>, field: &WaveField<V>) -> Option<(Path<V>, Coherency<V>)> {
        let Sides { normal, near, .. } = self.cell.sides(&state.at)?;
        if is_evanescent(&state.wavevector, normal) {
            return None;
        }
        let direction = state.wavevector.map(|q| V::narrow(q.re)).normalize_or_zero();
        let (s, _) = s_axis(normal, direction);
        let p = s.cross(direction);
        let light = |e: VectorLanes<V>| {
            let (along_s, along_p) = (e.dot_lanes(s), e.dot_lanes(p));
            Coherency { s: along_s.norm_sqr(), p: along_p.norm_sqr(), cross: along_s * along_p.conj() }
        };
        let (of_s, of_p) = (light(field.s), light(field.p));
        let both = Coherency { s: of_s.s + of_p.s, p: of_s.p + of_p.p, cross: of_s.cross + of_p.cross };
        // A field in an absorbing medium has a part along its way, which neither s nor p holds: power is that of the whole.
        let whole = self.incident.tube_power(field, state.tube_area, self.media.eta_of(near));
        let power = (whole.s + whole.p) * V::splat(0.5);
        let path = Path { at: state.at, direction, across: s };
        Some((path, both.with_power(power)))
    }
}

/// A slot in which no path waits.
#[must_use]
pub fn free_slot<V: Lanes>() -> Slot<Path<V>, Coherency<V>> {
    let nothing = RealLanes::<V>::splat(DVec3::ZERO);
    let path = Path { at: FacetHit::NONE, direction: nothing, across: nothing };
    Slot::free(path, Coherency { s: V::zero(), p: V::zero(), cross: ComplexLanes::zero() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::bvh::{Bvh, Node};
    use crate::geometry::facet::Facet;
    use crate::optics::interface::Interface;
    use crate::optics::medium::Medium;
    use crate::simd::lanes::F64;
    use crate::trace::waves::Waves;

    /// Some ten roundings of numbers near 1.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn light_keeps_its_power_and_its_degree_of_polarisation_in_any_frame() {
        let one = <F64 as Lanes>::splat;
        let light = Coherency { s: one(0.7), p: one(0.2), cross: ComplexLanes::new(one(0.1), one(-0.25)) };
        for angle in [0.0, 0.3, 1.0, 2.5, 4.0] {
            let turned = light.turned(one(libm::cos(angle)), one(libm::sin(angle)));
            // Trace and determinant.
            let of = |light: Coherency<F64>| (light.power(), light.s * light.p - light.cross.norm_sqr());
            let ((power, area), (power_before, area_before)) = (of(turned), of(light));
            assert!(Lanes::lane(power - power_before, 0).abs() < ROUNDING);
            assert!(Lanes::lane(area - area_before, 0).abs() < ROUNDING);
        }
        let crossed = light.turned(one(0.0), one(1.0));
        assert_eq!((crossed.s, crossed.p), (light.p, light.s));
    }

    #[test]
    fn a_path_is_its_wave_without_the_phase() {
        // A film of two planes over a square.
        let square =
            |z: f64| [[0.0, 0.0], [900.0, 0.0], [900.0, 700.0], [0.0, 700.0]].map(|[x, y]| DVec3::new(x, y, z));
        let vertices: [DVec3; 8] = core::array::from_fn(|i| square(if i < 4 { 0.0 } else { -300.0 })[i % 4]);
        let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
        let mut nodes = [Node::EMPTY; Bvh::required_nodes(4)];
        let (mut order, mut corners) = ([0; 4], [0.0; Bvh::required_corners(4)]);
        let bvh = Bvh::build(&vertices, &triangles, &mut nodes, &mut order, &mut corners).unwrap();
        let facets = [Facet::horizontal(0.0, 0), Facet::horizontal(-300.0, 1)];
        let interfaces =
            [Interface { above: 0, below: Below::Medium(1) }, Interface { above: 1, below: Below::Medium(2) }];
        let cell = MeshCell::new(bvh, &[0, 0, 1, 1], &facets, &interfaces, [900.0, 700.0], 0).unwrap();
        let media = [1.0, 1.7, 1.2].map(|n| Medium::constant(n.into()).unwrap());
        let mut eta = [ComplexLanes::zero(); 3];
        let media = MediaLanes::<F64>::evaluate(&media, &[550.0], &mut eta).unwrap();
        let incident = IncidentWave::new(DVec3::new(0.6, 0.48, 0.64), media.eta_of(0));
        let (mut waves, mut paths) =
            (CoherentMesh::new(cell, media, incident), IncoherentMesh::new(cell, media, incident));

        let (state, field) = waves.start(0.4, 0.3).unwrap();
        let (path, light) = paths.start(0.4, 0.3).unwrap();
        let [_, Some((Target::State(state), field))] = waves.split(&state, &field) else { panic!("it refracts") };
        let [Some((_, reflected)), Some((branch, refracted))] = paths.split(&path, &light) else { panic!("it splits") };
        let Some((Target::State(path), light)) = paths.propagate(&path, &branch, &refracted) else {
            panic!("it goes on")
        };
        let near = |a: F64, b: F64| assert!(Lanes::lane(a - b, 0).abs() < ROUNDING, "{a:?} {b:?}");
        near(reflected.power() + light.power(), F64::one());
        let (as_wave, from_wave) = paths.path(&state, &field).unwrap();
        assert!((as_wave.at.point_nm - path.at.point_nm).length() < 1e-9 && as_wave.at.facet == path.at.facet);
        let turned =
            from_wave.turned(as_wave.across.dot(path.across), as_wave.across.cross(as_wave.direction).dot(path.across));
        for (a, b) in [
            (turned.s, light.s),
            (turned.p, light.p),
            (turned.cross.re, light.cross.re),
            (turned.cross.im, light.cross.im),
        ] {
            near(a, b);
        }
    }
}
