//! Reference results in `data/`, computed by programs that share no code with this one.

use goniochrome::optics::incidence::Incidence;
use goniochrome::optics::interface::{Below, Model};
use goniochrome::optics::medium::{MediaLanes, Medium, MediumIndex};
use goniochrome::optics::stack::{Film, PreparedStack, PreparedStackArrays, Stack, StackArrays};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::{F64, Lanes};
use num_complex::Complex64;
use serde::Deserialize;

/// Number of planes of the largest test stack.
pub const MAX_PLANES: usize = 64;

/// Power reflectance and transmittance of planar stacks from an independent transfer-matrix program in float64.
#[derive(Deserialize)]
pub struct Planar {
    /// The cases, each a stack.
    pub cases: Vec<PlanarCase>,
}

/// A planar stack and its powers, in arrays [theta][wavelength].
#[derive(Deserialize)]
#[allow(non_snake_case, reason = "keys of the reference")]
pub struct PlanarCase {
    pub name: String,
    pub n: Vec<[f64; 2]>,
    pub thickness_nm: Vec<f64>,
    pub wavelength_nm: Vec<f64>,
    pub theta_deg: Vec<f64>,
    pub R_s: Vec<Vec<f64>>,
    pub R_p: Vec<Vec<f64>>,
    pub T_s: Vec<Vec<f64>>,
    pub T_p: Vec<Vec<f64>>,
}

/// Every planar case.
pub fn planar() -> Vec<PlanarCase> {
    serde_json::from_str::<Planar>(include_str!("data/planar.json")).expect("the reference is JSON").cases
}

/// Stacks whose ambient medium absorbs weakly: k up to 1e-3.
pub fn weak_ambient() -> Vec<PlanarCase> {
    serde_json::from_str::<Planar>(include_str!("data/weak_ambient.json")).expect("the reference is JSON").cases
}

/// A planar stack of constant indices.
pub struct Layered {
    /// Indices n + ik of the ambient medium, each layer and the substrate. Without a substrate the stack lies on a
    /// perfect mirror.
    pub eta: Vec<Complex64>,
    /// Thicknesses of the layers.
    pub thickness_nm: Vec<f64>,
}

impl From<&PlanarCase> for Layered {
    fn from(case: &PlanarCase) -> Self {
        Self {
            eta: case.n.iter().map(|&[n, k]| Complex64::new(n, k)).collect(),
            thickness_nm: case.thickness_nm.clone(),
        }
    }
}

impl Layered {
    /// Calls `f` with this stack, prepared for one angle and group of wavelengths. Equal indices share a medium.
    pub fn with_prepared<V: Lanes, R>(
        &self,
        theta_deg: f64,
        wavelengths_nm: &[f64],
        model: Model,
        f: impl FnOnce(&PreparedStack<'_, V>) -> R,
    ) -> R {
        self.with_prepared_at(theta_deg.to_radians().sin().into(), wavelengths_nm, model, f)
    }

    /// [`Layered::with_prepared`] with all digits of the angle.
    pub fn with_prepared_at<V: Lanes, R>(
        &self,
        incidence: Incidence<V::Precise>,
        wavelengths_nm: &[f64],
        model: Model,
        f: impl FnOnce(&PreparedStack<'_, V>) -> R,
    ) -> R {
        let mut media: Vec<Complex64> = Vec::new();
        let index: Vec<MediumIndex> = self
            .eta
            .iter()
            .map(|eta| {
                let place = media.iter().position(|m| m == eta).unwrap_or_else(|| {
                    media.push(*eta);
                    media.len() - 1
                });
                MediumIndex::try_from(place).expect("few media")
            })
            .collect();
        let media: Vec<Medium<'_>> =
            media.into_iter().map(|eta| Medium::constant(eta).expect("a passive medium")).collect();
        let mut eta = vec![ComplexLanes::zero(); media.len()];
        let lanes =
            MediaLanes::<V>::evaluate(&media, wavelengths_nm, &mut eta).expect("constant media hold everywhere");

        let layers =
            index[1..].iter().zip(&self.thickness_nm).map(|(&medium, &thickness_nm)| Film { medium, thickness_nm });
        let substrate = index.get(1 + self.thickness_nm.len()).map_or(Below::Mirror, |&medium| Below::Medium(medium));
        let mut arrays = StackArrays::<MAX_PLANES>::new();
        let stack = Stack::new(index[0], layers, substrate, arrays.memory()).expect("the stack fits");
        let mut memory = Box::new(PreparedStackArrays::<V, MAX_PLANES>::new());
        f(&PreparedStack::new(stack, &lanes, incidence, model, memory.memory()))
    }
}

/// Unpolarised reflectance of a stack in closed form.
pub fn reflectance(stack: &Layered, theta_deg: f64, wavelengths: &[f64], model: Model) -> Vec<f64> {
    wavelengths
        .chunks(F64::WIDTH)
        .flat_map(|group| {
            let r = stack.with_prepared::<F64, _>(theta_deg, group, model, |prepared| {
                prepared.reflectance(prepared.reflection())
            });
            (0..group.len()).map(move |lane| 0.5 * (Lanes::lane(r.s, lane) + Lanes::lane(r.p, lane)))
        })
        .collect()
}

/// The visible wavelengths, 380 to 780 nm, in steps.
pub fn visible(step_nm: f64) -> Vec<f64> {
    let count = (400.0 / step_nm).round() as u32;
    (0..=count).map(|i| 380.0 + f64::from(i) * step_nm).collect()
}
