//! Waves in a polygon cell, which interfere: tilted facets, polarisation in three dimensions, dispersion per lane.
//! Paths that do not interfere are in [`crate::trace::incoherent_mesh`].
//!
//! A ray is a plane wave with its own wavevector in each lane; one hero lane decides which facet it meets. Its payload is
//! the electric field, a complex vector for each incident polarisation, at the ray's own point of the facet. Two rays of one
//! facet, side and wavevector are one plane wave: the second is carried to the first one's point by exp(i k₀ q·Δx) and
//! added. Referring the field to a point of the path instead of one far anchor keeps strongly absorbing waves, which grow
//! as fast sideways as they decay, within range.
//!
//! At a facet the field splits along ŝ = N × q/|q_t| and p̂ = ŝ × q/η, Fresnel's formulas act on each, and the tube of light that the
//! ray stands for changes its cross-section by |cos θ_t/cos θ_i|.

use crate::geometry::mesh_cell::{FacetHit, MeshCell, NextEvent, Sides};
use crate::geometry::side::Side;
use crate::optics::coating::coated;
use crate::optics::interface::{Below, Wave};
use crate::optics::medium::{MediaLanes, MediumIndex};
use crate::optics::stack::Response;
use crate::simd::complex::{ComplexLanes, Polarised};
use crate::simd::lanes::Lanes;
use crate::simd::phase::propagate;
use crate::simd::vector::VectorLanes;
use crate::trace::waves::{Propagated, Slot, Split, Target, Waves};
use glam::DVec3;

/// The electric field of a ray, for light that arrives in s and in p.
pub type WaveField<V> = Polarised<VectorLanes<V>>;

/// A ray about to be split at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveState<V: Lanes> {
    /// The facet, and where the field is taken.
    pub(crate) at: FacetHit,
    /// In units of k₀.
    pub(crate) wavevector: VectorLanes<V::Precise>,
    /// J: cross-section of the ray's tube in units of the incident one.
    pub(crate) tube_area: V,
}

/// A ray that leaves the cell; its field is taken at `point_nm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExitWave<V: Lanes> {
    /// Upwards or downwards.
    pub side: Side,
    /// In units of k₀.
    pub wavevector: VectorLanes<V::Precise>,
    /// Where it last met the surface, unwrapped.
    pub point_nm: DVec3,
    /// The unit normal of the facet there, towards the side on which the ray leaves it; +z if it met none.
    pub normal: DVec3,
    /// J: cross-section of the tube in units of the incident one.
    pub tube_area: V,
    /// Index of the medium it leaves in.
    pub medium: MediumIndex,
    /// Power that it carries, per incident polarisation, in units of the incident one.
    pub power: Polarised<V>,
}

/// A polygon cell at one group of wavelengths and one direction of the light.
#[derive(Clone, Copy, Debug)]
pub struct CoherentMesh<'a, V: Lanes> {
    cell: MeshCell<'a>,
    media: MediaLanes<'a, V>,
    per_wavelength: V::Precise,
    incident: IncidentWave<V>,
    lost: V,
    absorbed: Polarised<V>,
}

/// The light: a plane wave of unit amplitude in each polarisation.
#[derive(Clone, Copy, Debug)]
pub struct IncidentWave<V: Lanes> {
    /// Unit, towards the light.
    pub(crate) wi: DVec3,
    /// ŝ, across the plane of incidence.
    pub(crate) across: DVec3,
    wavevector: VectorLanes<V::Precise>,
    field: WaveField<V>,
    index: V,
}

impl<V: Lanes> IncidentWave<V> {
    /// Light from the unit direction `wi` (towards the light, z > 0) in a medium of index `eta`, whose k is at most
    /// [`crate::optics::medium::MAX_AMBIENT_K`].
    ///
    /// s is across the macroscopic plane of incidence, z × wi, and y at normal incidence. As on planes, the part of the
    /// wavevector along the macroscopic surface is real, n sin θ. The amplitude is 1 wherever the light first meets the
    /// cell: what the medium absorbs before that, or after the last facet, is not counted; between facets it is.
    #[must_use]
    pub fn new(wi: DVec3, eta: ComplexLanes<V::Precise>) -> Self {
        let across = DVec3::Z.cross(wi);
        let s = across.try_normalize().unwrap_or(DVec3::Y);
        let mut wavevector = VectorLanes::<V::Precise>::splat(-wi).scale(ComplexLanes::real(eta.re));
        let mut p = VectorLanes::<V>::splat(s.cross(-wi));
        if eta.im.any_above(0.0) {
            let tangential = eta.re * V::Precise::splat(wi.truncate().length());
            wavevector.z = -(eta.square() - ComplexLanes::real(tangential * tangential)).sqrt_outgoing();
            let along = VectorLanes::<V::Precise>::splat(s).cross(wavevector);
            let length = ComplexLanes::real(along.norm_sqr().sqrt());
            p = VectorLanes::narrow(along.scale(ComplexLanes::one().div_or_zero(length)));
        }
        Self { wi, across: s, wavevector, field: Polarised { s: VectorLanes::splat(s), p }, index: V::narrow(eta.re) }
    }

    /// Power of a field in a tube, per polarisation: |E|² J n/n_in for a travelling wave in a medium of index `eta`.
    pub fn tube_power(&self, field: &WaveField<V>, tube_area: V, eta: ComplexLanes<V::Precise>) -> Polarised<V> {
        let per = tube_area * V::narrow(eta.re) / self.index;
        field.map(|e| e.norm_sqr() * per)
    }

    /// The real part of the light's wavevector, in units of k₀: its phase over the cell, for an amplitude of 1 all over
    /// it.
    #[must_use]
    pub fn wavevector(&self) -> VectorLanes<V::Precise> {
        self.wavevector.map(|q| ComplexLanes::real(q.re))
    }
}

/// The lane that decides which facet a ray meets.
pub(crate) const fn hero<V: Lanes>() -> usize {
    V::WIDTH / 2
}

/// Two wavevectors of one group are the same wave if they differ by less than this in the hero lane: far above the rounding of
/// a hundred hits (1e-14), far below a difference that a path of a millimetre could show (1e-3 turns).
const SAME_WAVEVECTOR: f64 = 1e-9;
/// Two points lie in one plane if they are this near to it, in nanometres: rounding of positions up to a millimetre.
const SAME_PLANE_NM: f64 = 1e-6;
/// Below this |q_t|² the plane of incidence is arbitrary.
const NORMAL_INCIDENCE: f64 = 1e-20;
/// An evanescent wave is followed to the next facet unless it falls below this amplitude on the way.
const EVANESCENT: f64 = 1e-8;
/// |N·N'| of facets between which it is followed: the rounding of single-precision meshes, squared.
const PARALLEL: f64 = 1.0 - 1e-10;

impl<'a, V: Lanes> CoherentMesh<'a, V> {
    /// A cell, its media and the light.
    pub fn new(cell: MeshCell<'a>, media: MediaLanes<'a, V>, incident: IncidentWave<V>) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let none = Polarised::both(V::zero());
        Self { cell, media, per_wavelength, incident, lost: V::zero(), absorbed: none }
    }

    /// Starts a ray over a point of the period, (u, v) in [0, 1)²: its first facet and its field there, referred to that
    /// point itself. `None` if it meets nothing.
    pub fn start(&self, u: f64, v: f64) -> Option<(WaveState<V>, WaveField<V>)> {
        self.cell.first_hit(u, v, -self.incident.wi).map(|at| self.start_at(at))
    }

    /// [`CoherentMesh::start`] of light that is known to meet this first.
    pub fn start_at(&self, at: FacetHit) -> (WaveState<V>, WaveField<V>) {
        (WaveState { at, wavevector: self.incident.wavevector, tube_area: V::one() }, self.incident.field)
    }

    /// Power of rays that were lost: in holes of the mesh, or after too many periods. Adds up over calls of `split`.
    pub fn lost(&self) -> V {
        self.lost
    }

    /// Power that media absorbed between facets. Adds up over calls of `split`.
    pub fn absorbed(&self) -> Polarised<V> {
        self.absorbed
    }

    /// exp(i k₀ q·Δx).
    #[inline]
    fn carry(&self, wavevector: &VectorLanes<V::Precise>, step_nm: DVec3) -> ComplexLanes<V> {
        propagate(wavevector.dot_real(step_nm).scale(self.per_wavelength))
    }

    fn tube_power(&self, field: &WaveField<V>, tube_area: V, medium: MediumIndex) -> Polarised<V> {
        self.incident.tube_power(field, tube_area, self.media.eta_of(medium))
    }

    /// Sends a ray from a facet into `medium` and says where it goes, with its field there.
    fn propagate(
        &mut self,
        from: &WaveState<V>,
        leaving: Outgoing<V>,
    ) -> Propagated<WaveState<V>, ExitWave<V>, WaveField<V>> {
        let Outgoing { wavevector, field, medium, normal, tube_area, power } = leaving;
        let evanescent = is_evanescent(&wavevector, normal);
        let direction = if evanescent { normal } else { wavevector.direction(hero::<V>()) };
        match self.cell.next_event(from.at.point_nm, direction, medium, Some(from.at.facet)) {
            NextEvent::Facet(at) => {
                let factor = self.carry(&wavevector, at.point_nm - from.at.point_nm);
                // Across a gap between parallel facets; on a tilted one a wave that only decays would be a growing one.
                let parallel = self.cell.facet(at.facet).normal.dot(normal).abs() > PARALLEL;
                if evanescent && !(parallel && factor.norm_sqr().any_above(EVANESCENT * EVANESCENT)) {
                    return None;
                }
                let arriving = field.map(|e| e.scale(factor));
                if !evanescent {
                    let left = power.zip(factor_power(factor), |power, factor| power * factor);
                    self.absorbed = self.absorbed.zip(power.zip(left, |a, b| a - b), |sum, lost| sum + lost);
                }
                Some((Target::State(WaveState { at, wavevector, tube_area }), arriving))
            }
            _ if evanescent => None,
            NextEvent::Lost => {
                // A wave that decays across its way may carry power backwards: an error bar all the same.
                self.lost += (power.s.abs() + power.p.abs()) * V::splat(0.5);
                None
            }
            up_or_down => {
                let side = if up_or_down == NextEvent::Above { Side::Above } else { Side::Below };
                let departure =
                    ExitWave { side, wavevector, point_nm: from.at.point_nm, normal, tube_area, medium, power };
                Some((Target::Exit(departure), field))
            }
        }
    }
}

/// A ray as it leaves a facet.
struct Outgoing<V: Lanes> {
    wavevector: VectorLanes<V::Precise>,
    field: WaveField<V>,
    medium: MediumIndex,
    /// Of the facet, towards the side on which the ray leaves.
    normal: DVec3,
    tube_area: V,
    power: Polarised<V>,
}

/// |factor|² for both polarisations.
fn factor_power<V: Lanes>(factor: ComplexLanes<V>) -> Polarised<V> {
    Polarised::both(factor.norm_sqr())
}

/// A unit ŝ with ŝ·N = ŝ·q = 0; any tangent at normal incidence.
#[inline]
fn s_axis<V: Lanes>(normal: DVec3, wavevector: &VectorLanes<V>) -> VectorLanes<V> {
    let n = VectorLanes::<V>::splat(normal);
    let s = n.cross(*wavevector);
    let length_squared = s.dot(s);
    let tangent = VectorLanes::<V>::splat(normal.any_orthonormal_vector());
    let small = V::splat(NORMAL_INCIDENCE);
    let magnitude = length_squared.norm_sqr();
    let root = length_squared.sqrt_upper();
    let unit = s.scale(ComplexLanes::one().div_or_zero(root));
    let select = |a: ComplexLanes<V>, b: ComplexLanes<V>| ComplexLanes {
        re: magnitude.select_lt(small * small, b.re, a.re),
        im: magnitude.select_lt(small * small, b.im, a.im),
    };
    unit.zip(tangent, select)
}

impl<V: Lanes> Waves<V> for CoherentMesh<'_, V> {
    type State = WaveState<V>;
    type Field = WaveField<V>;
    type Exit = ExitWave<V>;
    const MAX_PROBES: usize = usize::MAX;

    fn bucket(&self, state: &WaveState<V>) -> usize {
        2 * state.at.facet as usize + usize::from(state.at.front)
    }

    fn is_same_wave(&self, a: &WaveState<V>, b: &WaveState<V>) -> bool {
        let apart = a.wavevector.direction(hero::<V>()) - b.wavevector.direction(hero::<V>());
        let plane = self.cell.facet(a.at.facet).normal.dot(a.at.point_nm - b.at.point_nm);
        a.at.facet == b.at.facet
            && a.at.front == b.at.front
            && apart.length_squared() < SAME_WAVEVECTOR * SAME_WAVEVECTOR
            && plane.abs() < SAME_PLANE_NM
    }

    fn merge(&self, into: &WaveState<V>, field: WaveField<V>, from: &WaveState<V>, more: WaveField<V>) -> WaveField<V> {
        let factor = self.carry(&into.wavevector, into.at.point_nm - from.at.point_nm);
        field.zip(more, |a, b| a + b.scale(factor))
    }

    fn power(&self, state: &WaveState<V>, field: &WaveField<V>) -> V {
        let Some(Sides { near, .. }) = self.cell.sides(&state.at) else { return V::zero() };
        let Polarised { s, p } = self.tube_power(field, state.tube_area, near);
        (s + p) * V::splat(0.5)
    }

    fn split(&mut self, state: &WaveState<V>, field: &WaveField<V>) -> Split<WaveState<V>, ExitWave<V>, WaveField<V>> {
        let Some(Sides { normal, near, far }) = self.cell.sides(&state.at) else { return [None, None] };

        let q = state.wavevector;
        let q_n = -q.dot_real(normal);
        let tangential = q.add_scaled(normal, q_n);
        let near_eta = self.media.eta_of(near);
        let tangential_squared = tangential.dot(tangential);
        let near_wave = Wave::<V>::with_normal(near_eta, q_n);

        let s = s_axis(normal, &q);
        let s_hat = VectorLanes::<V>::narrow(s);
        let p_of = |q: VectorLanes<V::Precise>, eta: ComplexLanes<V::Precise>| {
            VectorLanes::<V>::narrow(s.cross(q).scale(ComplexLanes::one().div_or_zero(eta)))
        };
        let p_in = p_of(q, near_eta);
        let parts = field.map(|e| (e.dot(s_hat), e.dot(p_in)));

        let far_wave = match far {
            Below::Medium(far) => Some((far, Wave::<V>::new(self.media.eta_of(far), tangential_squared))),
            Below::Mirror => None,
        };
        let films = self.cell.coating(state.at.facet);
        let far_side = far_wave.as_ref().map(|(_, wave)| wave);
        let order = self.cell.films(&state.at);
        let Response { reflection: r, transmission: t } =
            coated(&near_wave, order, far_side, &self.media, tangential_squared);

        let mirrored = tangential.add_scaled(normal, q_n);
        let p_out = p_of(mirrored, near_eta);
        let field_out = parts.map(|(along_s, along_p)| s_hat.scale(r.s * along_s) + p_out.scale(r.p * along_p));
        let reflected = Outgoing {
            wavevector: mirrored,
            field: field_out,
            medium: near,
            normal,
            tube_area: state.tube_area,
            power: self.tube_power(&field_out, state.tube_area, near),
        };
        let refracted = far_wave.map(|(far, wave)| {
            let far_eta = self.media.eta_of(far);
            let wavevector = tangential.add_scaled(normal, -wave.normal);
            let p_through = p_of(wavevector, far_eta);
            // t_p is of magnetic fields; electric ones change by η_near/η_far besides.
            let (t_s, t_p) = (t.s, t.p * ComplexLanes::<V>::narrow(near_eta.div_or_zero(far_eta)));
            // |cos θ_t / cos θ_i| with cos θ = q_n/η, in moduli so that it returns to 1 behind an evanescent gap.
            let cosine = |normal: ComplexLanes<V::Precise>, eta: ComplexLanes<V::Precise>| {
                V::narrow((normal.norm_sqr() / eta.norm_sqr()).sqrt())
            };
            // |t|² Re κ of each part, over the area of facet that the tube covers.
            let area = state.tube_area / (cosine(q_n, near_eta) * self.incident.index);
            let power = parts.map(|(along_s, along_p)| {
                let through = t.s.norm_sqr() * along_s.norm_sqr() * wave.admittance.s.re
                    + t.p.norm_sqr() * along_p.norm_sqr() * wave.admittance.p.re * V::narrow(near_eta.norm_sqr());
                through * area
            });
            Outgoing {
                wavevector,
                field: parts.map(|(along_s, along_p)| s_hat.scale(t_s * along_s) + p_through.scale(t_p * along_p)),
                medium: far,
                normal: -normal,
                tube_area: state.tube_area * cosine(wave.normal, far_eta) / cosine(q_n, near_eta),
                power,
            }
        });
        if !films.is_empty() && !is_evanescent(&q, normal) {
            let arrived = self.tube_power(field, state.tube_area, near);
            let through = refracted.as_ref().map_or(Polarised::both(V::zero()), |refracted| refracted.power);
            let kept = arrived.zip(reflected.power, |a, b| a - b).zip(through, |a, b| a - b);
            self.absorbed = self.absorbed.zip(kept, |sum, kept| sum + kept);
        }
        [self.propagate(state, reflected), refracted.and_then(|refracted| self.propagate(state, refracted))]
    }
}

/// Whether the hero lane's wave decays faster along the normal than it travels: a total reflection's far side. In an
/// absorbing medium waves travel, and so does light from an absorbing body that meets a tilted facet, although its amplitude varies
/// across its way.
#[inline]
pub(crate) fn is_evanescent<V: Lanes>(wavevector: &VectorLanes<V>, normal: DVec3) -> bool {
    let hero = hero::<V>();
    // Most waves travel without loss; single lanes are slow to look at.
    if !(wavevector.x.im.abs() + wavevector.y.im.abs() + wavevector.z.im.abs()).any_above(0.0) {
        return false;
    }
    let (re, im) = (
        wavevector.direction(hero),
        DVec3::new(wavevector.x.im.lane(hero), wavevector.y.im.lane(hero), wavevector.z.im.lane(hero)),
    );
    // q·q real and Im q ≠ 0 means Re q ⟂ Im q: no loss along the way, only decay across it.
    const PERPENDICULAR: f64 = 1e-9;
    let magnitudes = re.length() * im.length();
    let decays = re.dot(normal).abs() < im.dot(normal).abs();
    decays && re.dot(im).abs() <= PERPENDICULAR * magnitudes
}

impl<V: Lanes> WaveState<V> {
    /// Where the ray meets its facet, unwrapped.
    pub fn point_nm(&self) -> DVec3 {
        self.at.point_nm
    }
}

/// A slot in which no ray waits.
#[must_use]
pub fn free_slot<V: Lanes>() -> Slot<WaveState<V>, WaveField<V>> {
    let state = WaveState { at: FacetHit::NONE, wavevector: VectorLanes::zero(), tube_area: V::zero() };
    Slot::free(state, Polarised::both(VectorLanes::zero()))
}
