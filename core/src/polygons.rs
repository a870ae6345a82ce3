//! The tracer's view of a polygon cell: tilted facets, polarisation in three dimensions, dispersion per lane.
//!
//! A ray is a plane wave with its own wavevector in each lane; one hero lane decides which facet it meets. Its payload is
//! the electric field, a complex vector for each incident polarisation, at the ray's own point of the facet. Two rays of one
//! facet, side and wavevector are one plane wave: the second is carried to the first one's point by exp(i k₀ q·Δx) and
//! added. Referring the field to a point of the path instead of one far anchor keeps strongly absorbing waves, which grow
//! as fast sideways as they decay, within range.
//!
//! At a facet the field splits along ŝ = N × q/|q_t| and p̂ = ŝ × q/η, Fresnel's formulas act on each, and the tube of light that the
//! ray stands for changes its cross-section by |cos θ_t/cos θ_i|.

use crate::coating::coated;
use crate::coherence::Side;
use crate::complex::{ComplexLanes, Polarised};
use crate::interface::{Below, Wave};
use crate::lanes::Lanes;
use crate::medium::{MediaLanes, MediumIndex};
use crate::mesh::{MeshCell, Next};
use crate::stack::Response;
use crate::trace::{Facets, Slot, Split, Target};
use crate::turns::propagate;
use crate::vector::VectorLanes;
use glam::DVec3;

/// The electric field of a ray, for light that arrives in s and in p.
pub type Field<V> = Polarised<VectorLanes<V>>;

/// A ray about to be split at a facet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<V: Lanes> {
    facet: u32,
    front: bool,
    /// Unwrapped: where the ray meets the facet and its field is taken.
    point_nm: DVec3,
    /// In units of k₀.
    wavevector: VectorLanes<V::Precise>,
    /// J: cross-section of the ray's tube in units of the incident one.
    spread: V,
}

/// A ray that leaves the cell; its field is taken at `point_nm`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Departure<V: Lanes> {
    /// Upwards or downwards.
    pub side: Side,
    /// In units of k₀.
    pub wavevector: VectorLanes<V::Precise>,
    /// Where it last met the surface, unwrapped.
    pub point_nm: DVec3,
    /// The unit normal of the facet there, towards the side on which the ray leaves it; +z if it met none.
    pub normal: DVec3,
    /// J: cross-section of the tube in units of the incident one.
    pub spread: V,
    /// Index of the medium it leaves in.
    pub medium: MediumIndex,
    /// Power that it carries, per incident polarisation, in units of the incident one.
    pub power: Polarised<V>,
}

/// A polygon cell at one group of wavelengths and one direction of the light.
#[derive(Clone, Copy, Debug)]
pub struct Polygons<'a, V: Lanes> {
    cell: MeshCell<'a>,
    media: MediaLanes<'a, V>,
    per_wavelength: V::Precise,
    incident: Incident<V>,
    hero: usize,
    merging: bool,
    lost: V,
    absorbed: Polarised<V>,
}

/// The light: a plane wave of unit amplitude in each polarisation.
#[derive(Clone, Copy, Debug)]
pub struct Incident<V: Lanes> {
    wavevector: VectorLanes<V::Precise>,
    field: Field<V>,
    index: V,
}

impl<V: Lanes> Incident<V> {
    /// Light from the unit direction `wi` (towards the light, z > 0) in a medium of index `eta`, which must not absorb.
    ///
    /// s is across the macroscopic plane of incidence, z × wi, and y at normal incidence.
    #[must_use]
    pub fn new(wi: DVec3, eta: ComplexLanes<V::Precise>) -> Self {
        let across = DVec3::Z.cross(wi);
        let s = across.try_normalize().unwrap_or(DVec3::Y);
        let p = s.cross(-wi);
        let wavevector = VectorLanes::<V::Precise>::splat(-wi).scale(ComplexLanes::real(eta.re));
        Self {
            wavevector,
            field: Polarised { s: VectorLanes::splat(s), p: VectorLanes::splat(p) },
            index: V::narrow(eta.re),
        }
    }

    /// The light's wavevector in units of k₀.
    #[must_use]
    pub fn wavevector(&self) -> VectorLanes<V::Precise> {
        self.wavevector
    }
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

impl<'a, V: Lanes> Polygons<'a, V> {
    /// A cell, its media and the light. `merging` adds rays of equal state as amplitudes; without it each path is its own.
    pub fn new(cell: MeshCell<'a>, media: MediaLanes<'a, V>, incident: Incident<V>, merging: bool) -> Self {
        let per_wavelength = V::Precise::one() / media.wavelength_nm();
        let hero = V::WIDTH / 2;
        let none = Polarised::both(V::zero());
        Self { cell, media, per_wavelength, incident, hero, merging, lost: V::zero(), absorbed: none }
    }

    /// Starts a ray over a point of the period, (u, v) in [0, 1)²: its first facet and its field there, referred to that
    /// point itself. `None` if it meets nothing.
    pub fn start(&self, u: f64, v: f64) -> Option<(State<V>, Field<V>)> {
        let [px, py] = self.cell.period_nm();
        let direction = self.incident.wavevector.direction(self.hero);
        let above = DVec3::new(u * px, v * py, self.cell.top_nm());
        let Next::Facet(meeting) = self.cell.next(above, direction, self.cell.above(), None) else { return None };
        let state = State {
            facet: meeting.facet,
            front: meeting.front,
            point_nm: meeting.point_nm,
            wavevector: self.incident.wavevector,
            spread: V::one(),
        };
        Some((state, self.incident.field))
    }

    /// Power of rays that were lost: in holes of the mesh, or after too many periods. Adds up over calls of `split`.
    pub fn lost(&self) -> V {
        self.lost
    }

    /// Power that media absorbed between facets. Adds up over calls of `split`.
    pub fn absorbed(&self) -> Polarised<V> {
        self.absorbed
    }

    fn eta(&self, medium: MediumIndex) -> ComplexLanes<V::Precise> {
        self.media.eta().get(usize::from(medium)).copied().unwrap_or_else(ComplexLanes::one)
    }

    /// exp(i k₀ q·Δx).
    #[inline]
    fn carry(&self, wavevector: &VectorLanes<V::Precise>, step_nm: DVec3) -> ComplexLanes<V> {
        propagate(wavevector.dot_real(step_nm).scale(self.per_wavelength))
    }

    /// Power of a field in a tube, per polarisation: |E|² J n/n_in for a travelling wave.
    pub fn tube_power(&self, field: &Field<V>, spread: V, medium: MediumIndex) -> Polarised<V> {
        let per = spread * V::narrow(self.eta(medium).re) / self.incident.index;
        field.map(|e| e.norm_sqr() * per)
    }

    /// Geometric optics without interference: power is handed on whole, and waves in absorbing media decay along their way.
    ///
    /// Exact amplitudes do neither there: in an absorbing medium the incident and the reflected wave exchange power, so that
    /// R + T ≠ 1, and a refracted wave decays across its direction. A path followed by itself would gain or lose by that.
    fn conserve(
        &self,
        arrived: Polarised<V>,
        reflected: &mut Leaving<V>,
        refracted: Option<&mut Leaving<V>>,
        bare: bool,
    ) {
        let zero = V::zero();
        let least = |a: V, b: V| a.select_lt(b, a, b);
        let limit = |leaving: &mut Leaving<V>, power: Polarised<V>| {
            let scale = leaving.power.zip(power, |had, has| zero.select_lt(had, (has / had).sqrt(), zero));
            leaving.field = leaving.field.zip(scale, |e, by| e.scale(ComplexLanes::real(by)));
            leaving.power = power;
        };
        // What cannot pass is reflected whole; from an absorbing medium |r| may differ from 1 then, and the field have a part
        // along its way, which neither s nor p holds. A bare mirror lets nothing pass.
        let total = refracted
            .as_ref()
            .map_or(bare, |refracted| is_evanescent(&refracted.wavevector, refracted.normal, self.hero));
        let back = if total { arrived } else { reflected.power.zip(arrived, least) };
        limit(reflected, back);
        let Some(refracted) = refracted else { return };
        let rest = arrived.zip(reflected.power, |a, b| (a - b).max(zero));
        let through = if bare { rest } else { refracted.power.zip(rest, |t, rest| least(t.max(zero), rest)) };
        // The ray's power is that of its tube from here on.
        refracted.power = self.tube_power(&refracted.field, refracted.spread, refracted.medium);
        limit(refracted, through);
        let eta = self.eta(refracted.medium);
        if eta.im.any_above(0.0) {
            let lane = |i: usize| refracted.wavevector.direction(i).normalize_or_zero();
            let component = |of: fn(DVec3) -> f64| ComplexLanes::real(V::Precise::from_fn(|i| of(lane(i)))) * eta;
            refracted.wavevector = VectorLanes { x: component(|v| v.x), y: component(|v| v.y), z: component(|v| v.z) };
        }
    }

    /// Sends a ray from a facet into `medium` and says where it goes, with its field there.
    fn send(&mut self, from: &State<V>, leaving: Leaving<V>) -> Sent<V> {
        let Leaving { wavevector, field, medium, normal, spread, power } = leaving;
        let evanescent = is_evanescent(&wavevector, normal, self.hero);
        if evanescent && !self.merging {
            return None; // alone it carries no power, and without interference it is alone
        }
        let direction = if evanescent { normal } else { wavevector.direction(self.hero) };
        match self.cell.next(from.point_nm, direction, medium, Some(from.facet)) {
            Next::Facet(meeting) => {
                let factor = self.carry(&wavevector, meeting.point_nm - from.point_nm);
                // Across a gap between parallel facets; on a tilted one a wave that only decays would be a growing one.
                let parallel = self.cell.facet(meeting.facet).normal.dot(normal).abs() > PARALLEL;
                if evanescent && !(parallel && factor.norm_sqr().any_above(EVANESCENT * EVANESCENT)) {
                    return None;
                }
                let factor = if self.merging { factor } else { without_gain(factor) };
                let arriving = field.map(|e| e.scale(factor));
                if !evanescent {
                    let left = power.zip(factor_power(factor), |power, factor| power * factor);
                    self.absorbed = self.absorbed.zip(power.zip(left, |a, b| a - b), |sum, lost| sum + lost);
                }
                let state = State {
                    facet: meeting.facet,
                    front: meeting.front,
                    point_nm: meeting.point_nm,
                    wavevector,
                    spread,
                };
                Some((Target::State(state), arriving))
            }
            _ if evanescent => None,
            Next::Lost => {
                // A wave that decays across its way may carry power backwards: an error bar all the same.
                self.lost += (power.s.abs() + power.p.abs()) * V::splat(0.5);
                None
            }
            up_or_down => {
                let side = if up_or_down == Next::Above { Side::Above } else { Side::Below };
                let departure = Departure { side, wavevector, point_nm: from.point_nm, normal, spread, medium, power };
                Some((Target::Exit(departure), field))
            }
        }
    }
}

/// Where a ray goes that leaves a facet, and its field there; nothing if it is lost or fades away.
type Sent<V> = Option<(Target<State<V>, Departure<V>>, Field<V>)>;

/// A ray as it leaves a facet.
struct Leaving<V: Lanes> {
    wavevector: VectorLanes<V::Precise>,
    field: Field<V>,
    medium: MediumIndex,
    /// Of the facet, towards the side on which the ray leaves.
    normal: DVec3,
    spread: V,
    power: Polarised<V>,
}

/// A factor of modulus 1 where it was larger. No passive medium amplifies a ray, but a lane whose wave decays across its own way may
/// grow along that of the hero, and a path followed by itself meets nothing that takes back what it gains.
fn without_gain<V: Lanes>(factor: ComplexLanes<V>) -> ComplexLanes<V> {
    /// Of |e^iφ|² in single precision.
    const ROUNDING: f64 = 1e-6;
    let gain = factor.norm_sqr();
    if !gain.any_above(1.0 + ROUNDING) {
        return factor;
    }
    factor.scale(V::one() / gain.max(V::one()).sqrt())
}

/// |factor|² for both polarisations.
fn factor_power<V: Lanes>(factor: ComplexLanes<V>) -> Polarised<V> {
    Polarised::both(factor.norm_sqr())
}

/// A unit ŝ with ŝ·N = ŝ·q = 0; any tangent at normal incidence.
#[inline]
fn across<V: Lanes>(normal: DVec3, wavevector: &VectorLanes<V>) -> VectorLanes<V> {
    let n = VectorLanes::splat(normal);
    let s = n.cross(*wavevector);
    let length_squared = s.dot(s);
    let tangent = VectorLanes::splat(normal.any_orthonormal_vector());
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

impl<V: Lanes> Facets<V> for Polygons<'_, V> {
    type State = State<V>;
    type Field = Field<V>;
    type Exit = Departure<V>;
    const PROBES: usize = usize::MAX;

    fn home(&self, state: &State<V>) -> usize {
        2 * state.facet as usize + usize::from(state.front)
    }

    fn same(&self, a: &State<V>, b: &State<V>) -> bool {
        let apart = a.wavevector.direction(self.hero) - b.wavevector.direction(self.hero);
        let plane = self.cell.facet(a.facet).normal.dot(a.point_nm - b.point_nm);
        self.merging
            && a.facet == b.facet
            && a.front == b.front
            && apart.length_squared() < SAME_WAVEVECTOR * SAME_WAVEVECTOR
            && plane.abs() < SAME_PLANE_NM
    }

    fn merge(&self, into: &State<V>, field: Field<V>, from: &State<V>, more: Field<V>) -> Field<V> {
        let factor = self.carry(&into.wavevector, into.point_nm - from.point_nm);
        field.zip(more, |a, b| a + b.scale(factor))
    }

    fn exit_power(&self, departure: &Departure<V>, _: &Field<V>) -> V {
        (departure.power.s + departure.power.p) * V::splat(0.5)
    }

    fn strengthen(
        &self,
        target: Target<State<V>, Departure<V>>,
        field: &Field<V>,
        by: f64,
    ) -> (Target<State<V>, Departure<V>>, Field<V>) {
        let amplitude = ComplexLanes::real(V::splat(by).sqrt());
        let target = match target {
            Target::Exit(departure) => {
                Target::Exit(Departure { power: departure.power.map(|power| power * V::splat(by)), ..departure })
            }
            waiting @ Target::State(_) => waiting,
        };
        (target, field.map(|e| e.scale(amplitude)))
    }

    fn power(&self, state: &State<V>, field: &Field<V>) -> V {
        let interface = self.cell.interface(state.facet);
        let medium = match (state.front, interface.below) {
            (true, _) => interface.above,
            (false, Below::Medium(below)) => below,
            (false, Below::Mirror) => return V::zero(),
        };
        let Polarised { s, p } = self.tube_power(field, state.spread, medium);
        (s + p) * V::splat(0.5)
    }

    fn apart(&mut self, apart: bool) {
        self.merging = !apart;
    }

    fn split(&mut self, state: &State<V>, field: &Field<V>) -> Split<State<V>, Departure<V>, Field<V>> {
        let facet = self.cell.facet(state.facet);
        let interface = self.cell.interface(state.facet);
        // N points to the side the ray comes from; `near` is that side's medium.
        let (normal, near, far) = if state.front {
            (facet.normal, Below::Medium(interface.above), interface.below)
        } else {
            (-facet.normal, interface.below, Below::Medium(interface.above))
        };
        let Below::Medium(near) = near else { return [None, None] }; // no ray travels inside a mirror

        let q = state.wavevector;
        let q_n = -q.dot_real(normal);
        let tangential = q.add_scaled(normal, q_n);
        let near_eta = self.eta(near);
        // A wave followed by itself decays along its way, so q_t is complex in an absorbing medium. Snell's law takes its real
        // part, as for planes of equal phase and amplitude that are parallel to the facet: by the complex one no wave beyond
        // could travel in a lossless medium, and the faintest absorption would keep all light inside.
        let alone = !self.merging && near_eta.im.any_above(0.0);
        let across_facet = if alone { real(&tangential) } else { tangential };
        let tangential_squared = across_facet.dot(across_facet);
        let normal_part = if alone { (near_eta * near_eta - tangential_squared).sqrt_upper() } else { q_n };
        let near_wave = Wave::<V>::with_normal(near_eta, normal_part);

        let s = across(normal, &q);
        let s_hat = VectorLanes::<V>::narrow(s);
        let p_of = |q: VectorLanes<V::Precise>, eta: ComplexLanes<V::Precise>| {
            VectorLanes::<V>::narrow(s.cross(q).scale(ComplexLanes::one().div_or_zero(eta)))
        };
        let p_in = p_of(q, near_eta);
        let parts = field.map(|e| (e.dot(s_hat), e.dot(p_in)));

        let far_wave = match far {
            Below::Medium(far) => Some((far, Wave::<V>::new(self.eta(far), tangential_squared))),
            Below::Mirror => None,
        };
        let films = self.cell.coating(state.facet);
        let far_side = far_wave.as_ref().map(|(_, wave)| wave);
        let Response { reflection: r, transmission: t } = if state.front {
            coated(&near_wave, films.iter().rev(), far_side, &self.media, tangential_squared)
        } else {
            coated(&near_wave, films.iter(), far_side, &self.media, tangential_squared)
        };

        let mirrored = tangential.add_scaled(normal, q_n);
        let p_out = p_of(mirrored, near_eta);
        let field_out = parts.map(|(along_s, along_p)| s_hat.scale(r.s * along_s) + p_out.scale(r.p * along_p));
        let reflected = Leaving {
            wavevector: mirrored,
            field: field_out,
            medium: near,
            normal,
            spread: state.spread,
            power: self.tube_power(&field_out, state.spread, near),
        };
        let refracted = far_wave.map(|(far, wave)| {
            let far_eta = self.eta(far);
            let wavevector = across_facet.add_scaled(normal, -wave.normal);
            let p_through = p_of(wavevector, far_eta);
            // t_p is of magnetic fields; electric ones change by η_near/η_far besides.
            let (t_s, t_p) = (t.s, t.p * ComplexLanes::<V>::narrow(near_eta.div_or_zero(far_eta)));
            // |cos θ_t / cos θ_i| with cos θ = q_n/η, in moduli so that it returns to 1 behind an evanescent gap.
            let cosine = |normal: ComplexLanes<V::Precise>, eta: ComplexLanes<V::Precise>| {
                V::narrow((normal.norm_sqr() / eta.norm_sqr()).sqrt())
            };
            // |t|² Re κ of each part, over the area of facet that the tube covers.
            let area = state.spread / (cosine(q_n, near_eta) * self.incident.index);
            let power = parts.map(|(along_s, along_p)| {
                let through = t.s.norm_sqr() * along_s.norm_sqr() * wave.admittance.s.re
                    + t.p.norm_sqr() * along_p.norm_sqr() * wave.admittance.p.re * V::narrow(near_eta.norm_sqr());
                through * area
            });
            Leaving {
                wavevector,
                field: parts.map(|(along_s, along_p)| s_hat.scale(t_s * along_s) + p_through.scale(t_p * along_p)),
                medium: far,
                normal: -normal,
                spread: state.spread * cosine(wave.normal, far_eta) / cosine(q_n, near_eta),
                power,
            }
        });
        let arrived = self.tube_power(field, state.spread, near);
        let (mut reflected, mut refracted) = (reflected, refracted);
        if !self.merging {
            self.conserve(arrived, &mut reflected, refracted.as_mut(), films.is_empty());
        }
        if !films.is_empty() && !is_evanescent(&q, normal, self.hero) {
            let through = refracted.as_ref().map_or(Polarised::both(V::zero()), |refracted| refracted.power);
            let kept = arrived.zip(reflected.power, |a, b| a - b).zip(through, |a, b| a - b);
            self.absorbed = self.absorbed.zip(kept, |sum, kept| sum + kept);
        }
        [self.send(state, reflected), refracted.and_then(|refracted| self.send(state, refracted))]
    }
}

/// The real part of each component.
fn real<V: Lanes>(vector: &VectorLanes<V>) -> VectorLanes<V> {
    let [x, y, z] = [vector.x, vector.y, vector.z].map(|component| ComplexLanes::real(component.re));
    VectorLanes { x, y, z }
}

/// Whether the hero lane's wave decays faster along the normal than it travels: a total reflection's far side. In an
/// absorbing medium waves travel, and so does light from an absorbing body that meets a tilted facet, although its amplitude varies
/// across its way.
#[inline]
fn is_evanescent<V: Lanes>(wavevector: &VectorLanes<V>, normal: DVec3, hero: usize) -> bool {
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

impl<V: Lanes> State<V> {
    /// Where the ray meets its facet, unwrapped.
    pub fn point_nm(&self) -> DVec3 {
        self.point_nm
    }
}

/// A slot in which no ray waits.
#[must_use]
pub fn free_slot<V: Lanes>() -> Slot<State<V>, Field<V>> {
    let state =
        State { facet: 0, front: false, point_nm: DVec3::ZERO, wavevector: VectorLanes::zero(), spread: V::zero() };
    Slot::free(state, Polarised::both(VectorLanes::zero()))
}
