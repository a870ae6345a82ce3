//! Waves in a polygon mesh, which interfere: tilted facets, polarisation in three dimensions, dispersion in each lane.
//! [`crate::trace::incoherent_mesh`] has the paths that do not interfere.
//!
//! A ray is a plane wave with its own wavevector in each lane, or with one for all where no medium disperses
//! ([`RayLanes`]); one hero lane decides which facet it meets. It carries the electric field, a complex vector for each
//! incident polarisation, at the ray's own point of the facet. Where all wavelengths have one amplitude, the field
//! lacks the phase, and the ray carries its optical path instead. Two rays of one facet, side and wavevector are one
//! plane wave: the field of the second is propagated to the point of the first by exp(i k₀ q·Δx) and added. The field
//! is referred to a point of the path and not to a distant anchor: this keeps strongly absorbing waves, which grow
//! sideways as fast as they decay, within range.
//!
//! At a facet the field is split along ŝ = N × q/|q_t| and p̂ = ŝ × q/η. Fresnel's formulas act on each part, and the
//! cross-section of the tube of light that the ray represents changes by |cos θ_t/cos θ_i|.

use crate::geometry::mesh_cell::{FacetHit, MeshCell, NextEvent, Sides};
use crate::geometry::side::Side;
use crate::optics::coating::coated;
use crate::optics::interface::{Below, Wave, fresnel};
use crate::optics::medium::{MediaLanes, MediumIndex};
use crate::optics::stack::Response;
use crate::simd::common::Common;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::{attenuation, propagate, propagate_real};
use crate::simd::ray_lanes::RayLanes;
use crate::simd::vector::VectorLanes;
use crate::trace::field_axes::Axes;
use crate::trace::plane_of_incidence::s_axis_of_wave;
use crate::trace::waves::{Slot, Target, Waves};
use glam::DVec3;
use num_complex::Complex64;

/// Electric field of a ray, for incident light polarised in s and in p.
pub type WaveField<V> = Polarised<VectorLanes<V>>;

/// State of a ray that is about to be split at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveState<V: RayLanes> {
    /// Facet, side, and the point to which the field is referred.
    pub(crate) at: FacetHit,
    /// Wavevector in units of k₀.
    pub(crate) wavevector: VectorLanes<V::Wavevector>,
    /// J, cross-section of the ray's tube in units of the incident one.
    pub(crate) tube_area: V::Direction,
    /// Optical path from the first facet, where the field does not have its phase.
    pub(crate) path_nm: Complex64,
}

/// Ray that leaves the cell. Its field is referred to `point_nm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitWave<V: RayLanes> {
    /// Side on which the ray leaves.
    pub side: Side,
    /// Wavevector in units of k₀.
    pub wavevector: VectorLanes<V::Wavevector>,
    /// Point where the ray last met the surface, not wrapped into the period.
    pub point_nm: DVec3,
    /// Unit normal of the facet there, towards the side on which the ray leaves it; +z if it met none.
    pub normal: DVec3,
    /// J, cross-section of the ray's tube in units of the incident one.
    pub tube_area: V::Direction,
    /// Index of the medium in which the ray leaves.
    pub medium: MediumIndex,
    /// Power of the ray for each incident polarisation, in units of the incident power.
    pub power: Polarised<V::Light>,
    /// Optical path from the first facet where all wavelengths have one field, which does not have its phase; else 0.
    pub path_nm: Complex64,
}

/// Polygon mesh in which waves interfere, at one group of wavelengths and one direction of the light.
#[derive(Clone, Copy, Debug)]
pub struct CoherentMesh<'a, V: RayLanes> {
    cell: MeshCell<'a>,
    media: MediaLanes<'a, V>,
    per_wavelength: V::Precise,
    incident: IncidentWave<V>,
    lost: V::Light,
    absorbed: Polarised<V::Light>,
}

/// Incident light: a plane wave of unit amplitude in each polarisation.
#[derive(Clone, Copy, Debug)]
pub struct IncidentWave<V: RayLanes> {
    /// Unit vector towards the light.
    pub(crate) wi: DVec3,
    /// ŝ, the normal of the macroscopic plane of incidence.
    pub(crate) s_axis: DVec3,
    wavevector: VectorLanes<V::Wavevector>,
    field: WaveField<V::Light>,
    index: V::Direction,
}

impl<V: RayLanes> IncidentWave<V> {
    /// Light that comes from the unit direction `wi` (towards the light, z > 0) in a medium of index `eta`, whose k is
    /// at most [`crate::optics::medium::MAX_AMBIENT_K`].
    ///
    /// ŝ is normal to the macroscopic plane of incidence, along z × wi; at normal incidence it is y. As on planes, the
    /// component of the wavevector along the macroscopic surface is real, n sin θ. The amplitude is 1 wherever the
    /// light first meets the cell: absorption in the medium counts between facets, but not before the first facet or
    /// after the last.
    #[must_use]
    pub fn new(wi: DVec3, eta: ComplexLanes<V::Precise>) -> Self {
        let eta = eta.map(V::wavevector);
        let s = DVec3::Z.cross(wi).try_normalize().unwrap_or(DVec3::Y);
        let mut wavevector = VectorLanes::<V::Wavevector>::splat(-wi).scale(ComplexLanes::real(eta.re));
        let mut p = VectorLanes::<V::Light>::splat(s.cross(-wi));
        if eta.im.any_above(0.0) {
            let tangential = eta.re * V::Wavevector::splat(wi.truncate().length());
            wavevector.z = -(eta.square() - ComplexLanes::real(tangential * tangential)).sqrt_outgoing();
            let along = VectorLanes::<V::Wavevector>::splat(s).cross(wavevector);
            let length = ComplexLanes::real(along.norm_sqr().sqrt());
            p = along.scale(ComplexLanes::one().div_or_zero(length)).map(|c| c.map(V::narrowed));
        }
        Self {
            wi,
            s_axis: s,
            wavevector,
            field: Polarised { s: VectorLanes::splat(s), p },
            index: V::Direction::narrow(eta.re),
        }
    }

    /// Power of a field in a tube for each polarisation: |E|² J n/n_in for a travelling wave in a medium of index
    /// `eta`.
    pub fn tube_power(
        &self,
        field: &WaveField<V::Light>,
        tube_area: V::Direction,
        eta: ComplexLanes<V::Wavevector>,
    ) -> Polarised<V::Light> {
        let per = V::spread(tube_area * V::Direction::narrow(eta.re) / self.index);
        field.map(|e| e.norm_sqr() * per)
    }

    /// Real part of the light's wavevector in units of k₀. It gives the phase over the cell; the amplitude is 1 all
    /// over it.
    #[must_use]
    pub fn wavevector(&self) -> VectorLanes<V::Wavevector> {
        self.wavevector.map(|q| ComplexLanes::real(q.re))
    }
}

/// Lane that decides which facet a ray meets.
pub(crate) const fn hero<V: Lanes>() -> usize {
    V::WIDTH / 2
}

/// Largest difference, in the hero lane, of the wavevectors of two rays that are one wave: far above the rounding of a
/// hundred hits (1e-14), far below a difference that would show over a path of a millimetre (1e-3 turns of phase).
pub(crate) const MAX_WAVEVECTOR_DIFFERENCE: f64 = 1e-9;
/// Largest distance in nanometres, along the normal, of two points in one plane: the rounding of positions up to a
/// millimetre.
const MAX_PLANE_DISTANCE_NM: f64 = 1e-6;
/// Smallest factor of decay with which an evanescent wave is followed to the next facet.
const MIN_EVANESCENT_FACTOR: f64 = 1e-8;
/// Smallest |N·N'| of two facets that count as parallel, so that an evanescent wave is followed between them. Its
/// distance from 1 is about the square of the rounding of single-precision meshes.
const MIN_PARALLEL_COSINE: f64 = 1.0 - 1e-10;

impl<'a, V: RayLanes> CoherentMesh<'a, V> {
    /// Mesh of a cell, with its media and the incident light.
    pub fn new(cell: MeshCell<'a>, media: MediaLanes<'a, V>, incident: IncidentWave<V>) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let none = V::Light::zero();
        Self { cell, media, per_wavelength, incident, lost: none, absorbed: Polarised::both(none) }
    }

    /// State and field of a ray that starts over the point (u, v) of the period, in [0, 1)², where it meets its first
    /// facet. `None` if it meets none.
    pub fn start(&self, u: f64, v: f64) -> Option<(WaveState<V>, WaveField<V::Light>)> {
        self.cell.first_hit(u, v, -self.incident.wi).map(|at| self.start_at(at))
    }

    /// State and field of a ray whose first hit is known: see [`CoherentMesh::start`].
    pub fn start_at(&self, at: FacetHit) -> (WaveState<V>, WaveField<V::Light>) {
        let (wavevector, tube_area) = (self.incident.wavevector, V::Direction::one());
        (WaveState { at, wavevector, tube_area, path_nm: Complex64::ZERO }, self.incident.field)
    }

    /// Power of rays that were lost in holes of the mesh or after too many periods. It adds up over calls of `split`.
    pub fn lost(&self) -> V::Light {
        self.lost
    }

    /// Power that media between facets, and films on facets, have absorbed. It adds up over calls of `split`.
    pub fn absorbed(&self) -> Polarised<V::Light> {
        self.absorbed
    }

    /// Takes back what was lost and absorbed since `before` in lanes in which `kept` is 0.
    pub fn keep_lanes(&mut self, kept: V::Light, before: &Self) {
        let zero = V::Light::zero();
        self.lost = zero.select_lt(kept, self.lost, before.lost);
        self.absorbed = self.absorbed.zip(before.absorbed, |now, before| zero.select_lt(kept, now, before));
    }

    /// Phase factor exp(i k₀ q·Δx) of an optical path q·Δx.
    #[inline]
    fn phase_factor(&self, path: ComplexLanes<V::Wavevector>) -> ComplexLanes<V::Light> {
        let factor: ComplexLanes<V> = if path.im.any_above(0.0) {
            propagate(path.map(V::precise).scale(self.per_wavelength))
        } else {
            propagate_real(V::precise(path.re) * self.per_wavelength)
        };
        factor.map(V::light)
    }

    /// Power of a field in a tube in a medium, for each polarisation.
    fn tube_power(
        &self,
        field: &WaveField<V::Light>,
        tube_area: V::Direction,
        medium: MediumIndex,
    ) -> Polarised<V::Light> {
        self.incident.tube_power(field, tube_area, self.index_of(medium))
    }

    /// Index of a medium, in the lanes of wavevectors.
    #[inline]
    fn index_of(&self, medium: MediumIndex) -> ComplexLanes<V::Wavevector> {
        self.media.eta_of(medium).map(V::wavevector)
    }

    /// Fresnel coefficients of a facet with films, of its waves on either side.
    fn coated(
        &self,
        at: &FacetHit,
        near: (MediumIndex, ComplexLanes<V::Wavevector>),
        far: Option<(MediumIndex, ComplexLanes<V::Wavevector>)>,
        tangential_squared: ComplexLanes<V::Wavevector>,
    ) -> Response<V::Light> {
        let wave = |(medium, normal): (MediumIndex, ComplexLanes<V::Wavevector>)| {
            Wave::<V>::with_normal(self.media.eta_of(medium), normal.map(V::precise))
        };
        let (near, far) = (wave(near), far.map(wave));
        let tangential_squared = tangential_squared.map(V::precise);
        let response = coated(&near, self.cell.films(at), far.as_ref(), &self.media, tangential_squared);
        let light = |x: Polarised<ComplexLanes<V>>| x.map(|c| c.map(V::light));
        Response { reflection: light(response.reflection), transmission: light(response.transmission) }
    }

    /// Propagates a ray from a facet to the next one, or out of the cell, and passes it on there.
    fn propagate(
        &mut self,
        from: &WaveState<V>,
        outgoing: &Outgoing<V>,
        emit: &mut impl FnMut(&Self, Target<WaveState<V>, ExitWave<V>>, &WaveField<V::Light>),
    ) {
        let &Outgoing { wavevector, ref field, medium, normal, tube_area, power } = outgoing;
        let (point_nm, mut path_nm) = (from.at.point_nm, from.path_nm);
        let evanescent = is_evanescent(&wavevector, normal);
        let direction = if evanescent { normal } else { wavevector.direction(hero::<V::Wavevector>()) };
        match self.cell.next_event(point_nm, direction, medium, Some(from.at.facet)) {
            NextEvent::Facet(at) => {
                let step_nm = at.point_nm - point_nm;
                let path = wavevector.dot_real(step_nm);
                // Without loss all wavelengths of one amplitude keep it.
                let factor = (evanescent || !V::IS_ALIKE).then(|| self.phase_factor(path));
                // An evanescent wave crosses only gaps between parallel facets: towards a tilted one it might grow.
                let crosses = |factor: ComplexLanes<V::Light>| {
                    self.cell.facet(at.facet).normal.dot(normal).abs() > MIN_PARALLEL_COSINE
                        && factor.norm_sqr().any_above(MIN_EVANESCENT_FACTOR * MIN_EVANESCENT_FACTOR)
                };
                if evanescent && !factor.is_some_and(crosses) {
                    return;
                }
                if V::IS_ALIKE {
                    path_nm += path.lane(0);
                    emit(self, Target::State(WaveState { at, wavevector, tube_area, path_nm }), field);
                } else if let Some(factor) = factor {
                    let arriving = field.map(|e| e.times(factor));
                    if !evanescent && path.im.any_above(0.0) {
                        let left = power.map(|power| power * factor.norm_sqr());
                        self.absorbed = self.absorbed.zip(power.zip(left, |a, b| a - b), |sum, lost| sum + lost);
                    }
                    emit(self, Target::State(WaveState { at, wavevector, tube_area, path_nm }), &arriving);
                }
            }
            _ if evanescent => {}
            NextEvent::Lost => {
                // A wave that decays across its direction may carry power backwards; it is an error bar all the same.
                self.lost += (power.s.abs() + power.p.abs()) * V::Light::splat(0.5);
            }
            up_or_down => {
                let side = if up_or_down == NextEvent::Above { Side::Above } else { Side::Below };
                let wave = ExitWave { side, wavevector, point_nm, normal, tube_area, medium, power, path_nm };
                emit(self, Target::Exit(wave), field);
            }
        }
    }
}

/// Ray that leaves a facet.
struct Outgoing<V: RayLanes> {
    wavevector: VectorLanes<V::Wavevector>,
    field: WaveField<V::Light>,
    medium: MediumIndex,
    /// Normal of the facet, towards the side on which the ray leaves.
    normal: DVec3,
    tube_area: V::Direction,
    power: Polarised<V::Light>,
}

impl<V: RayLanes> Waves<V::Light> for CoherentMesh<'_, V> {
    type State = WaveState<V>;
    type Field = WaveField<V::Light>;
    type Exit = ExitWave<V>;
    const MAX_PROBES: usize = usize::MAX;

    fn bucket(&self, state: &WaveState<V>) -> usize {
        2 * state.at.facet as usize + usize::from(state.at.front)
    }

    fn is_same_wave(&self, a: &WaveState<V>, b: &WaveState<V>) -> bool {
        let difference =
            a.wavevector.direction(hero::<V::Wavevector>()) - b.wavevector.direction(hero::<V::Wavevector>());
        let distance = self.cell.facet(a.at.facet).normal.dot(a.at.point_nm - b.at.point_nm);
        a.at.facet == b.at.facet
            && a.at.front == b.at.front
            && difference.length_squared() < MAX_WAVEVECTOR_DIFFERENCE * MAX_WAVEVECTOR_DIFFERENCE
            && distance.abs() < MAX_PLANE_DISTANCE_NM
            && (!V::IS_ALIKE || has_same_path(a, b))
    }

    fn merge(
        &self,
        into: &WaveState<V>,
        field: &mut WaveField<V::Light>,
        from: &WaveState<V>,
        more: &WaveField<V::Light>,
    ) {
        if V::IS_ALIKE {
            *field = field.zip(*more, |a, b| a + b);
            return;
        }
        let factor = self.phase_factor(into.wavevector.dot_real(into.at.point_nm - from.at.point_nm));
        *field = field.zip(*more, |a, b| a + b.times(factor));
    }

    fn power(&self, state: &WaveState<V>, field: &WaveField<V::Light>) -> V::Light {
        let Some(Sides { near, .. }) = self.cell.sides(&state.at) else { return V::Light::zero() };
        let Polarised { s, p } = self.tube_power(field, state.tube_area, near);
        let power = (s + p) * V::Light::splat(0.5);
        if V::IS_ALIKE { power * V::Light::splat(state.least_decay(self.media.wavelength_nm())) } else { power }
    }

    fn split(
        &mut self,
        state: &WaveState<V>,
        field: &WaveField<V::Light>,
        emit: &mut impl FnMut(&Self, Target<WaveState<V>, ExitWave<V>>, &WaveField<V::Light>),
    ) {
        let Some(Sides { normal, near, far }) = self.cell.sides(&state.at) else { return };

        let q = state.wavevector;
        let q_n = -q.dot_real(normal);
        let tangential = q.add_scaled(normal, q_n);
        let near_eta = self.index_of(near);
        let tangential_squared = tangential.dot(tangential);
        let near_wave = Wave::<V::Direction>::with_normal(near_eta, q_n);

        let s = s_axis_of_wave(normal, &q);
        let axes_of = |q: VectorLanes<V::Wavevector>, eta: ComplexLanes<V::Wavevector>| {
            Axes::<V>::new(s, s.cross(q).scale(ComplexLanes::one().div_or_zero(eta)))
        };
        let axes = axes_of(q, near_eta);
        let parts = Polarised { s: axes.components(&field.s), p: axes.components(&field.p) };

        let far_wave = match far {
            Below::Medium(far) => Some((far, Wave::<V::Direction>::new(self.index_of(far), tangential_squared))),
            Below::Mirror => None,
        };
        let films = self.cell.coating(state.at.facet);
        let Response { reflection: r, transmission: t } = if films.is_empty() {
            let r = fresnel(near_wave.admittance, far_wave.as_ref().map(|(_, wave)| wave.admittance));
            let spread = |x: Polarised<ComplexLanes<V::Direction>>| x.map(|c| c.map(V::spread));
            Response { reflection: spread(r), transmission: spread(r.map(|r| ComplexLanes::one() + r)) }
        } else {
            let far = far_wave.as_ref().map(|(far, wave)| (*far, wave.normal));
            self.coated(&state.at, (near, q_n), far, tangential_squared)
        };

        let reflected_wavevector = tangential.add_scaled(normal, q_n);
        let axes = axes_of(reflected_wavevector, near_eta);
        let field_out = Polarised { s: axes.field(&parts.s, &r), p: axes.field(&parts.p, &r) };
        let reflected = Outgoing {
            wavevector: reflected_wavevector,
            field: field_out,
            medium: near,
            normal,
            tube_area: state.tube_area,
            power: self.tube_power(&field_out, state.tube_area, near),
        };
        let refracted = far_wave.map(|(far, wave)| {
            let far_eta = self.index_of(far);
            let wavevector = tangential.add_scaled(normal, -wave.normal);
            let axes = axes_of(wavevector, far_eta);
            // t_p relates magnetic fields; for electric ones it has the further factor η_near/η_far.
            let of_fields = Polarised { s: t.s, p: t.p * near_eta.div_or_zero(far_eta).map(V::narrowed) };
            // |cos θ_t/cos θ_i| with cos θ = q_n/η. Moduli make its product 1 again behind an evanescent gap.
            let cosine = |normal: ComplexLanes<V::Wavevector>, eta: ComplexLanes<V::Wavevector>| {
                V::Direction::narrow((normal.norm_sqr() / eta.norm_sqr()).sqrt())
            };
            // |t|² Re κ of each part, divided by the facet's area in the tube.
            let area = state.tube_area / (cosine(q_n, near_eta) * self.incident.index);
            let per_s = V::spread(wave.admittance.s.re * area);
            let per_p = V::spread(wave.admittance.p.re * V::Direction::narrow(near_eta.norm_sqr()) * area);
            let [per_s, per_p] = [t.s.norm_sqr() * per_s, t.p.norm_sqr() * per_p];
            let power = parts.map(|along| along.s.norm_sqr() * per_s + along.p.norm_sqr() * per_p);
            Outgoing {
                wavevector,
                field: Polarised { s: axes.field(&parts.s, &of_fields), p: axes.field(&parts.p, &of_fields) },
                medium: far,
                normal: -normal,
                tube_area: state.tube_area * cosine(wave.normal, far_eta) / cosine(q_n, near_eta),
                power,
            }
        });
        if !films.is_empty() && !is_evanescent(&q, normal) {
            let arrived = self.tube_power(field, state.tube_area, near);
            let through = refracted.as_ref().map_or(Polarised::both(V::Light::zero()), |refracted| refracted.power);
            let kept = arrived.zip(reflected.power, |a, b| a - b).zip(through, |a, b| a - b);
            self.absorbed = self.absorbed.zip(kept, |sum, kept| sum + kept);
        }
        self.propagate(state, &reflected, emit);
        if let Some(refracted) = &refracted {
            self.propagate(state, refracted, emit);
        }
    }
}

/// Whether two rays of one facet and wavevector have travelled as far.
fn has_same_path<V: RayLanes>(a: &WaveState<V>, b: &WaveState<V>) -> bool {
    let apart_nm = a.wavevector.dot_real(a.at.point_nm - b.at.point_nm).lane(0);
    (a.path_nm - b.path_nm - apart_nm).norm() < MAX_PLANE_DISTANCE_NM
}

/// Whether the hero lane's wave is evanescent: it decays faster along the normal than it travels, as beyond a facet
/// with total reflection. Waves in absorbing media travel. So does light from an absorbing body that meets a tilted
/// facet, although its amplitude varies across its direction.
#[inline]
pub(crate) fn is_evanescent<W: Lanes>(wavevector: &VectorLanes<W>, normal: DVec3) -> bool {
    let hero = hero::<W>();
    // Most waves travel without loss, and access to a single lane is slow.
    if !(wavevector.x.im.abs() + wavevector.y.im.abs() + wavevector.z.im.abs()).any_above(0.0) {
        return false;
    }
    let (re, im) = (
        wavevector.direction(hero),
        DVec3::new(wavevector.x.im.lane(hero), wavevector.y.im.lane(hero), wavevector.z.im.lane(hero)),
    );
    // q·q real and Im q ≠ 0 means Re q ⟂ Im q: no loss along the direction, only decay across it.
    const MAX_COSINE: f64 = 1e-9;
    let magnitudes = re.length() * im.length();
    let decays = re.dot(normal).abs() < im.dot(normal).abs();
    decays && re.dot(im).abs() <= MAX_COSINE * magnitudes
}

impl<V: RayLanes> WaveState<V> {
    /// Point where the ray meets its facet, not wrapped into the period.
    pub fn point_nm(&self) -> DVec3 {
        self.at.point_nm
    }

    /// Part of the power that is left behind evanescent gaps, whose decay the optical path holds, at the longest
    /// wavelength.
    pub(super) fn least_decay(&self, wavelength_nm: V::Precise) -> f64 {
        if self.path_nm.im > 0.0 {
            let longest = (0..V::WIDTH).map(|lane| wavelength_nm.lane(lane)).fold(0.0, f64::max);
            let turns = ComplexLanes { re: Common::zero(), im: Common::splat(self.path_nm.im / longest) };
            let amplitude = attenuation::<Common>(turns).lane(0);
            amplitude * amplitude
        } else {
            1.0
        }
    }
}

/// Slot in which no ray waits.
#[must_use]
pub fn free_slot<V: RayLanes>() -> Slot<WaveState<V>, WaveField<V::Light>> {
    let (wavevector, tube_area) = (VectorLanes::zero(), V::Direction::zero());
    let state = WaveState { at: FacetHit::NONE, wavevector, tube_area, path_nm: Complex64::ZERO };
    Slot::free(state, Polarised::both(VectorLanes::zero()))
}
