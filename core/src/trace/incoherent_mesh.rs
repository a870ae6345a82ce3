//! Geometric optics in a polygon mesh: paths that do not interfere, for unpolarised incident light.
//!
//! A path has a direction in each lane, or one for all ([`RayLanes`]), and carries power and polarisation but no phase:
//! the coherency matrix of its light (Born & Wolf, "Principles of Optics", section 10.9.1). All directions are real, so
//! a path costs a fraction of a wave of [`crate::trace::coherent_mesh`]. One hero lane decides which facet it meets.
//!
//! Power is conserved at facets. With exact amplitudes it is not, in absorbing media: there the incident and the
//! reflected wave exchange power, so that R + T ≠ 1, and a refracted wave decays across its direction. A path that is
//! followed alone would gain or lose power by this. Here it reflects no more than its power, transmits the remainder,
//! and decays along its direction. Snell's law takes the real part of the tangential wavevector, as if planes of equal
//! phase and of equal amplitude were parallel to the facet. With the complex one no wave beyond a facet could travel in
//! a lossless medium, and the faintest absorption would keep all light inside.

use crate::geometry::mesh_cell::{FacetHit, MeshCell, NextEvent, Sides};
use crate::geometry::side::Side;
use crate::optics::coating::coated;
use crate::optics::interface::{Below, Wave, fresnel};
use crate::optics::medium::{MediaLanes, MediumIndex};
use crate::optics::stack::Response;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::attenuation;
use crate::simd::ray_lanes::RayLanes;
use crate::simd::vector::{RealLanes, VectorLanes};
use crate::trace::coherent_mesh::{CoherentMesh, IncidentWave, WaveField, WaveState, hero, is_evanescent};
use crate::trace::paths::{AsPath, Paths};
use crate::trace::plane_of_incidence::s_axis_of_path;
use crate::trace::waves::{Propagated, Slot, Target};
use glam::DVec3;
use num_complex::Complex64;

/// Coherency matrix of a path's light: ⟨|E_s|²⟩, ⟨|E_p|²⟩ and ⟨E_s E_p*⟩ along the path's ŝ and p̂ = ŝ × d, in units of
/// the incident power.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coherency<V> {
    /// Power along ŝ, ⟨|E_s|²⟩.
    pub s: V,
    /// Power along p̂, ⟨|E_p|²⟩.
    pub p: V,
    /// Correlation of s and p, ⟨E_s E_p*⟩.
    pub cross: ComplexLanes<V>,
}

impl<V: Lanes> Coherency<V> {
    /// Total power.
    #[inline]
    pub fn power(&self) -> V {
        self.s + self.p
    }

    /// Light with its power multiplied by `factor`.
    #[inline]
    pub fn scale(self, factor: V) -> Self {
        Self { s: self.s * factor, p: self.p * factor, cross: self.cross.scale(factor) }
    }

    /// Light of this polarisation and the given power; dark if this light is dark.
    #[inline]
    fn with_power(self, power: V) -> Self {
        let present = self.power();
        self.scale(V::zero().select_lt(present, power / present, V::zero()))
    }

    /// Light after a facet that multiplies the amplitudes by `s` and `p`.
    #[inline]
    fn after(self, s: ComplexLanes<V>, p: ComplexLanes<V>) -> Self {
        Self { s: self.s * s.norm_sqr(), p: self.p * p.norm_sqr(), cross: self.cross * (s * p.conj()) }
    }

    /// Light in the frame rotated to ŝ' = cos·ŝ + sin·p̂. The power is kept, even if cos² + sin² is not exactly 1 due
    /// to rounding.
    #[inline]
    fn rotated(self, cos: V, sin: V) -> Self {
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

/// Path that is about to be split at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path<V: RayLanes> {
    at: FacetHit,
    /// Unit direction d.
    direction: RealLanes<V::Direction>,
    /// Unit vector ŝ, perpendicular to d.
    s_axis: RealLanes<V::Direction>,
}

impl<V: RayLanes> Path<V> {
    /// Facet that the path meets, with the side and the point.
    pub fn at(&self) -> FacetHit {
        self.at
    }
}

/// Path that leaves the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitPath<V: RayLanes> {
    /// Side on which the path leaves.
    pub side: Side,
    /// Unit direction of the path.
    pub direction: RealLanes<V::Direction>,
}

/// Polygon mesh in which paths do not interfere, at one group of wavelengths and one direction of the light.
#[derive(Clone, Copy, Debug)]
pub struct IncoherentMesh<'a, V: RayLanes> {
    cell: MeshCell<'a>,
    media: MediaLanes<'a, V>,
    incident: IncidentWave<V>,
    lost: V::Light,
    absorbed: V::Light,
}

/// Largest normal component of a wavevector beyond a facet, relative to its length, of a wave that only decays.
const MAX_EVANESCENT_COSINE: f64 = 1e-9;

impl<'a, V: RayLanes> IncoherentMesh<'a, V> {
    /// Mesh of a cell, with its media and the incident light.
    pub fn new(cell: MeshCell<'a>, media: MediaLanes<'a, V>, incident: IncidentWave<V>) -> Self {
        Self { cell, media, incident, lost: V::Light::zero(), absorbed: V::Light::zero() }
    }

    /// Path that starts over the point (u, v) of the period, in [0, 1)², and its light. `None` if the path meets no
    /// facet.
    pub fn start(&self, u: f64, v: f64) -> Option<(Path<V>, Coherency<V::Light>)> {
        let IncidentWave { wi, s_axis, .. } = self.incident;
        let at = self.cell.first_hit(u, v, -wi)?;
        let half = V::Light::splat(0.5);
        let path = Path {
            at,
            direction: RealLanes::<V::Direction>::splat(-wi),
            s_axis: RealLanes::<V::Direction>::splat(s_axis),
        };
        Some((path, Coherency { s: half, p: half, cross: ComplexLanes::zero() }))
    }

    /// Power of paths that were lost in holes of the mesh or after too many periods. It adds up over calls of
    /// `propagate`.
    pub fn lost(&self) -> V::Light {
        self.lost
    }

    /// Power that media between facets, and films on facets, have absorbed. It adds up over calls of `split` and
    /// `propagate`.
    pub fn absorbed(&self) -> V::Light {
        self.absorbed
    }

    /// Takes back what was lost and absorbed since `before` in lanes in which `kept` is 0.
    pub fn keep_lanes(&mut self, kept: V::Light, before: &Self) {
        let zero = V::Light::zero();
        self.lost = zero.select_lt(kept, self.lost, before.lost);
        self.absorbed = zero.select_lt(kept, self.absorbed, before.absorbed);
    }

    /// Fresnel coefficients of a facet with films.
    fn coated(
        &self,
        path: &Path<V>,
        near: MediumIndex,
        far: Option<&Far<V::Direction>>,
        tangential_squared: V::Direction,
    ) -> Response<V::Light> {
        let films = self.cell.films(&path.at);
        let tangential_squared = ComplexLanes::real(V::precise(tangential_squared.widen()));
        let wave = |medium| Wave::<V>::new(self.media.eta_of(medium), tangential_squared);
        let (near, far) = (wave(near), far.map(|far| wave(far.medium)));
        let response = coated(&near, films, far.as_ref(), &self.media, tangential_squared);
        let light = |x: Polarised<ComplexLanes<V>>| x.map(|c| c.map(V::light));
        Response { reflection: light(response.reflection), transmission: light(response.transmission) }
    }

    /// Light after a path of this length through a medium.
    fn absorb(&mut self, medium: MediumIndex, length_nm: f64, light: Coherency<V::Light>) -> Coherency<V::Light> {
        let k = self.media.eta_of(medium).im;
        if !k.any_above(0.0) {
            return light;
        }
        let attenuation_turns = k * V::Precise::splat(length_nm) / self.media.wavelength_nm();
        let amplitude = V::light(attenuation(ComplexLanes::new(V::Precise::zero(), attenuation_turns)));
        let remaining = light.scale(amplitude * amplitude);
        self.absorbed += light.power() - remaining.power();
        remaining
    }
}

/// Medium beyond a facet, and the wave there.
struct Far<V: Lanes> {
    medium: MediumIndex,
    eta: ComplexLanes<V>,
    /// q_n, the normal component of the wavevector, as in [`Wave::normal`].
    normal: ComplexLanes<V>,
}

impl<V: Lanes> Far<V> {
    /// Whether the hero lane's wave is evanescent beyond the facet.
    #[inline]
    fn is_evanescent(&self) -> bool {
        if !self.normal.im.any_above(0.0) {
            return false;
        }
        let Complex64 { re, im } = self.normal.lane(hero::<V>());
        im > 0.0 && re.abs() <= MAX_EVANESCENT_COSINE * self.eta.lane(hero::<V>()).norm()
    }
}

/// Admittances κ of s and p of a wave whose wavevector has the normal component q_n: q_n and q_n/η².
#[inline]
fn admittance<V: Lanes>(normal: ComplexLanes<V>, eta: ComplexLanes<V>) -> Polarised<ComplexLanes<V>> {
    Polarised { s: normal, p: normal.div_or_zero(eta).div_or_zero(eta) }
}

/// Direction, ŝ and medium of light that leaves a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch<V: RayLanes> {
    direction: RealLanes<V::Direction>,
    s_axis: RealLanes<V::Direction>,
    medium: MediumIndex,
}

impl<V: RayLanes> Paths<V::Light> for IncoherentMesh<'_, V> {
    type State = Path<V>;
    type Branch = Branch<V>;
    type Light = Coherency<V::Light>;
    type Exit = ExitPath<V>;

    fn power(light: &Coherency<V::Light>) -> V::Light {
        light.power()
    }

    fn scale_power(light: &Coherency<V::Light>, factor: f64) -> Coherency<V::Light> {
        light.scale(V::Light::splat(factor))
    }

    fn propagate(
        &mut self,
        from: &Path<V>,
        &Branch { direction, s_axis, medium }: &Branch<V>,
        &light: &Coherency<V::Light>,
    ) -> Propagated<Path<V>, ExitPath<V>, Coherency<V::Light>> {
        let leave = |side| Some((Target::Exit(ExitPath { side, direction }), light));
        match self.cell.next_event(
            from.at.point_nm,
            direction.lane(hero::<V::Direction>()),
            medium,
            Some(from.at.facet),
        ) {
            NextEvent::Facet(at) => {
                let light = self.absorb(medium, at.point_nm.distance(from.at.point_nm), light);
                Some((Target::State(Path { at, direction, s_axis }), light))
            }
            NextEvent::Above => leave(Side::Above),
            NextEvent::Below => leave(Side::Below),
            NextEvent::Lost => {
                self.lost += light.power();
                None
            }
        }
    }

    fn split(&mut self, path: &Path<V>, light: &Coherency<V::Light>) -> [Option<(Branch<V>, Coherency<V::Light>)>; 2] {
        let Some(Sides { normal, near, far }) = self.cell.sides(&path.at) else { return [None, None] };
        let films = self.cell.coating(path.at.facet);
        let (zero, one) = (V::Light::zero(), ComplexLanes::one());
        let index_of = |medium| ComplexLanes::<V::Direction>::narrow(self.media.eta_of(medium).map(V::wavevector));

        let n = RealLanes::<V::Direction>::splat(normal);
        let cos = (-path.direction.dot(n)).max(V::Direction::zero());
        let (s, sin_squared) = s_axis_of_path(normal, path.direction);
        let turned = [path.s_axis.dot(s), path.s_axis.cross(path.direction).dot(s)].map(V::spread);
        let light = light.rotated(turned[0], turned[1]);

        let near_eta = index_of(near);
        let tangential_squared = near_eta.re * near_eta.re * sin_squared;
        let near_normal = if near_eta.im.any_above(0.0) {
            (near_eta.square() - ComplexLanes::real(tangential_squared)).sqrt_upper()
        } else {
            ComplexLanes::real(near_eta.re * cos)
        };
        let far = match far {
            Below::Medium(medium) => {
                let eta = index_of(medium);
                let normal = (eta.square() - ComplexLanes::real(tangential_squared)).sqrt_outgoing();
                Some(Far { medium, eta, normal })
            }
            Below::Mirror => None,
        };
        let Response { reflection: r, transmission: t } = if films.is_empty() {
            let beyond = far.as_ref().map(|far| admittance(far.normal, far.eta));
            let r = fresnel(admittance(near_normal, near_eta), beyond);
            let spread = |x: Polarised<ComplexLanes<V::Direction>>| x.map(|c| c.map(V::spread));
            Response { reflection: spread(r), transmission: spread(r.map(|r| one + r)) }
        } else {
            self.coated(path, near, far.as_ref(), tangential_squared)
        };

        let arrived = light.power();
        let reflected = light.after(r.s, r.p);
        let passes = far.as_ref().filter(|far| !far.is_evanescent());
        // Total reflection reflects all power, although |r| may differ from 1 in an absorbing medium.
        let total = films.is_empty() && passes.is_none();
        let reflected_power = if total { arrived } else { reflected.power().min(arrived) };
        let remainder = (arrived - reflected_power).max(zero);
        let refracted = passes.map(|far| {
            let through = if films.is_empty() {
                remainder
            } else {
                // |t|² Re κ of each part, divided by the κ of the light that arrives.
                let there = admittance(far.normal, far.eta).map(|k| k.re);
                let s = t.s.norm_sqr() * V::spread(there.s) * light.s;
                let p = t.p.norm_sqr() * V::spread(there.p * near_eta.norm_sqr()) * light.p;
                let here = V::spread(near_eta.re * (near_normal.norm_sqr() / near_eta.norm_sqr()).sqrt());
                zero.select_lt(here, (s + p) / here, zero).max(zero).min(remainder)
            };
            // t_p relates magnetic fields; for electric ones it has the further factor η_near/η_far.
            let light = light.after(t.s, t.p * near_eta.div_or_zero(far.eta).map(V::spread));
            let tangential = path.direction.add_scaled(n, cos).scale(near_eta.re);
            let direction = tangential.add_scaled(n, -far.normal.re).normalize_or_zero();
            let branch = Branch { direction, s_axis: s, medium: far.medium };
            (branch, light.with_power(through))
        });
        if !films.is_empty() {
            let through = refracted.as_ref().map_or(zero, |(_, light)| light.power());
            self.absorbed += remainder - through;
        }
        let mirrored = path.direction.add_scaled(n, cos + cos);
        let branch = Branch { direction: mirrored, s_axis: s, medium: near };
        [Some((branch, reflected.with_power(reflected_power))), refracted]
    }
}

impl<V: RayLanes> AsPath<V::Light, CoherentMesh<'_, V>> for IncoherentMesh<'_, V> {
    fn path(&self, state: &WaveState<V>, field: &WaveField<V::Light>) -> Option<(Path<V>, Coherency<V::Light>)> {
        let Sides { normal, near, .. } = self.cell.sides(&state.at)?;
        if is_evanescent(&state.wavevector, normal) {
            return None;
        }
        let direction = state.wavevector.map(|q| V::Direction::narrow(q.re)).normalize_or_zero();
        let (s, _) = s_axis_of_path(normal, direction);
        let [s_lanes, p_lanes] = [s, s.cross(direction)].map(|axis| axis.map(V::spread));
        let light = |e: VectorLanes<V::Light>| {
            let (along_s, along_p) = (e.dot_lanes(s_lanes), e.dot_lanes(p_lanes));
            Coherency { s: along_s.norm_sqr(), p: along_p.norm_sqr(), cross: along_s * along_p.conj() }
        };
        let (of_s, of_p) = (light(field.s), light(field.p));
        let both = Coherency { s: of_s.s + of_p.s, p: of_s.p + of_p.p, cross: of_s.cross + of_p.cross };
        // In an absorbing medium a field has a component along its direction, outside s and p: the power is that of all
        // three components.
        let whole = self.incident.tube_power(field, state.tube_area, self.media.eta_of(near).map(V::wavevector));
        let mut power = (whole.s + whole.p) * V::Light::splat(0.5);
        if V::IS_ALIKE {
            power = power * V::Light::splat(state.least_decay(self.media.wavelength_nm()));
        }
        let path = Path { at: state.at, direction, s_axis: s };
        Some((path, both.with_power(power)))
    }
}

/// Slot in which no path waits.
#[must_use]
pub fn free_slot<V: RayLanes>() -> Slot<Path<V>, Coherency<V::Light>> {
    let zero = RealLanes::<V::Direction>::splat(DVec3::ZERO);
    let path = Path { at: FacetHit::NONE, direction: zero, s_axis: zero };
    Slot::free(path, Coherency { s: V::Light::zero(), p: V::Light::zero(), cross: ComplexLanes::zero() })
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

    /// Error of some ten roundings of numbers near 1.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn light_keeps_its_power_and_its_degree_of_polarisation_in_any_frame() {
        let one = <F64 as Lanes>::splat;
        let light = Coherency { s: one(0.7), p: one(0.2), cross: ComplexLanes::new(one(0.1), one(-0.25)) };
        for angle in [0.0, 0.3, 1.0, 2.5, 4.0] {
            let rotated = light.rotated(one(libm::cos(angle)), one(libm::sin(angle)));
            // Trace and determinant of the coherency matrix.
            let of = |light: Coherency<F64>| (light.power(), light.s * light.p - light.cross.norm_sqr());
            let ((power, area), (power_before, area_before)) = (of(rotated), of(light));
            assert!(Lanes::lane(power - power_before, 0).abs() < ROUNDING);
            assert!(Lanes::lane(area - area_before, 0).abs() < ROUNDING);
        }
        let crossed = light.rotated(one(0.0), one(1.0));
        assert_eq!((crossed.s, crossed.p), (light.p, light.s));
    }

    #[test]
    fn a_path_is_its_wave_without_the_phase() {
        // The mesh is a film: two horizontal squares.
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
        let mut inside = None;
        waves.split(&state, &field, &mut |_, target, field| {
            if let Target::State(state) = target {
                inside = Some((state, *field));
            }
        });
        let (state, field) = inside.expect("it refracts");
        let [Some((_, reflected)), Some((branch, refracted))] = paths.split(&path, &light) else { panic!("it splits") };
        let Some((Target::State(path), light)) = paths.propagate(&path, &branch, &refracted) else {
            panic!("it goes on")
        };
        let near = |a: F64, b: F64| assert!(Lanes::lane(a - b, 0).abs() < ROUNDING, "{a:?} {b:?}");
        near(reflected.power() + light.power(), F64::one());
        let (as_wave, from_wave) = paths.path(&state, &field).unwrap();
        assert!((as_wave.at.point_nm - path.at.point_nm).length() < 1e-9 && as_wave.at.facet == path.at.facet);
        let rotated = from_wave
            .rotated(as_wave.s_axis.dot(path.s_axis), as_wave.s_axis.cross(as_wave.direction).dot(path.s_axis));
        for (a, b) in [
            (rotated.s, light.s),
            (rotated.p, light.p),
            (rotated.cross.re, light.cross.re),
            (rotated.cross.im, light.cross.im),
        ] {
            near(a, b);
        }
    }
}
