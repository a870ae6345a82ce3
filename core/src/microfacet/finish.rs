//! A distribution of microfacets with Smith's masking.

use super::beckmann;
use super::compensation::Compensation;
use super::error::FinishError;
use super::roughness::Roughness;
use super::table::{FacetTable, Pair};
use crate::simd::lanes::sqrtf;
use core::f32::consts::{FRAC_1_PI, TAU};
use glam::Vec3;
use libm::{cosf, sinf};
use wide::f32x4;

/// Smallest cosine of a direction above the horizon. Below, the end of Beckmann's exponential over cos⁴θ_m would be no
/// small number, and G₂'s denominator would leave single precision.
const LEAST_COS: f32 = 1e-6;

/// Distribution of the normals of microfacets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distribution {
    /// D = 1/(π α_x α_y cos⁴θ_m (1 + s²)²), with s² = tan²θ_m (cos²φ_m/α_x² + sin²φ_m/α_y²): long tails (Trowbridge &
    /// Reitz 1975; Walter et al. 2007).
    #[default]
    Ggx,
    /// D = exp(−s²)/(π α_x α_y cos⁴θ_m): Gaussian slopes of variance α²/2 along each axis (Beckmann & Spizzichino
    /// 1963).
    Beckmann,
}

/// Which facets both directions see, given which each sees: Smith's Λ of either, G₁ = 1/(1 + Λ).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Masking {
    /// Heights of facets are seen by both or by neither: G₂ = 1/(1 + Λ_i + Λ_o).
    #[default]
    Correlated,
    /// Both are independent: G₂ = G₁(wi) G₁(wo), as in Mitsuba's `roughconductor`. It is darker at grazing angles.
    Separable,
}

/// Finish of a mirror-like surface: what its microfacets make of one reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish<'a> {
    facets: Facets<'a>,
    masking: Masking,
    compensation: Option<Compensation<'a>>,
}

/// Distribution of facets, with what it needs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Facets<'a> {
    Ggx(Roughness),
    Beckmann(Roughness),
    Tabulated(FacetTable<'a>),
}

/// A pair of directions on a finished surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Cosine of the angle θ_d between either direction and the half vector, in (0, 1]. The facets reflect ρ(θ_d).
    pub cos_d: f32,
    /// f/ρ(θ_d) = D G₂/(4 cos θ_i cos θ_o), in 1/sr.
    pub value: f32,
    /// Density per solid angle with which [`Finish::sample`] draws wo for wi.
    pub pdf: f32,
    /// (1 − E(cos θ_i)) (1 − E(cos θ_o)), what both directions lose to further facets; 0 without a [`Compensation`].
    /// Times [`Compensation::returned`], it is f of the light that several bounces return.
    pub multiple: f32,
}

impl Finish<'static> {
    /// Finish of a roughness α along x and y, each from [`MIN_ROUGHNESS`](super::MIN_ROUGHNESS) to 1.
    ///
    /// # Errors
    /// [`FinishError::Roughness`] for a roughness beyond.
    pub fn new(distribution: Distribution, masking: Masking, alpha: [f32; 2]) -> Result<Self, FinishError> {
        let roughness = Roughness::new(alpha).ok_or(FinishError::Roughness)?;
        let facets = match distribution {
            Distribution::Ggx => Facets::Ggx(roughness),
            Distribution::Beckmann => Facets::Beckmann(roughness),
        };
        Ok(Self { facets, masking, compensation: None })
    }
}

impl<'a> Finish<'a> {
    /// Finish of a tabulated distribution of normals.
    #[must_use]
    pub fn tabulated(table: FacetTable<'a>, masking: Masking) -> Self {
        Self { facets: Facets::Tabulated(table), masking, compensation: None }
    }

    /// The finish with energy compensation, of losses that [`Finish::compensated`] computes.
    #[must_use]
    pub fn with_compensation(self, compensation: Compensation<'a>) -> Self {
        Self { compensation: Some(compensation), ..self }
    }

    /// The energy compensation; `None` if light that meets a second facet is left out.
    #[must_use]
    pub fn compensation(&self) -> Option<Compensation<'a>> {
        self.compensation
    }

    /// Whether it has energy compensation.
    #[inline]
    pub(crate) fn is_compensated(&self) -> bool {
        self.compensation.is_some()
    }

    /// The distribution; `None` if it is tabulated.
    #[must_use]
    pub fn distribution(&self) -> Option<Distribution> {
        match self.facets {
            Facets::Ggx(_) => Some(Distribution::Ggx),
            Facets::Beckmann(_) => Some(Distribution::Beckmann),
            Facets::Tabulated(_) => None,
        }
    }

    /// The tabulated distribution; `None` if it is not tabulated.
    #[must_use]
    pub fn facets(&self) -> Option<FacetTable<'a>> {
        match self.facets {
            Facets::Ggx(_) | Facets::Beckmann(_) => None,
            Facets::Tabulated(table) => Some(table),
        }
    }

    /// The masking.
    #[must_use]
    pub fn masking(&self) -> Masking {
        self.masking
    }

    /// Roughness α along x and y; `None` for tabulated facets.
    #[must_use]
    pub fn alpha(&self) -> Option<[f32; 2]> {
        match self.facets {
            Facets::Ggx(roughness) | Facets::Beckmann(roughness) => Some(roughness.alpha()),
            Facets::Tabulated(_) => None,
        }
    }

    /// Whether the facets are equally rough in all directions.
    #[must_use]
    pub fn is_isotropic(&self) -> bool {
        match self.facets {
            Facets::Ggx(roughness) | Facets::Beckmann(roughness) => {
                let [x, y] = roughness.alpha();
                x.to_bits() == y.to_bits()
            }
            Facets::Tabulated(table) => table.size()[1] == 1,
        }
    }

    /// Density D of facet normals per solid angle and area of the surface, at a unit vector `m`; 0 below the horizon.
    #[must_use]
    #[inline]
    pub fn density(&self, m: Vec3) -> f32 {
        self.density_along(m, 1.0)
    }

    /// [`Finish::density`] along a vector whose squared length is known.
    #[inline]
    fn density_along(&self, m: Vec3, length_square: f32) -> f32 {
        let above = m.z > 0.0;
        if !above {
            return 0.0;
        }
        let square = m.z * m.z;
        match &self.facets {
            Facets::Ggx(roughness) => {
                let over = length_square / (roughness.stretched_slope(m) + square);
                roughness.peak() * over * over
            }
            Facets::Beckmann(roughness) => {
                let shape = beckmann::density(roughness.stretched_slope(m), square);
                roughness.peak() * shape * (length_square * length_square)
            }
            Facets::Tabulated(table) => table.density_along(m),
        }
    }

    /// Area of the facets that the direction `w` above the horizon sees, per area of the surface and projected along
    /// `w`: cos θ/G₁ = cos θ (1 + Λ) = ∫ D (w·m)⁺ dω_m.
    #[must_use]
    #[inline]
    pub fn visible_area(&self, w: Vec3) -> f32 {
        self.visible_areas([w, w])[0]
    }

    /// [`Finish::visible_area`] of two directions.
    #[inline]
    fn visible_areas(&self, w: [Vec3; 2]) -> [f32; 2] {
        match &self.facets {
            Facets::Ggx(roughness) => w.map(|w| 0.5 * (w.z + sqrtf(w.z * w.z + roughness.projected_square(w)))),
            Facets::Beckmann(roughness) => {
                let lanes = |of: [f32; 2]| f32x4::new([of[0], of[1], of[0], of[1]]);
                let squares = w.map(|w| roughness.projected_square(w));
                let [first, second, ..] = beckmann::visible_areas(lanes(w.map(|w| w.z)), lanes(squares)).to_array();
                [first, second]
            }
            Facets::Tabulated(table) => w.map(|w| table.visible_area(w)),
        }
    }

    /// G₂/(4 cos θ_i cos θ_o) of two directions above the horizon, finite where only one of them is near it.
    #[must_use]
    #[inline]
    pub fn shadowing(&self, wi: Vec3, wo: Vec3) -> f32 {
        self.shadowing_of(wi, wo, self.visible_areas([wi, wo]))
    }

    /// [`Finish::shadowing`] of two directions whose visible areas are known.
    #[inline]
    fn shadowing_of(&self, wi: Vec3, wo: Vec3, [area_i, area_o]: [f32; 2]) -> f32 {
        0.25 / match self.masking {
            // cos_i cos_o (1 + Λ_i + Λ_o).
            Masking::Correlated => area_i * wo.z + area_o * wi.z - wi.z * wo.z,
            Masking::Separable => area_i * area_o,
        }
    }

    /// Evaluates a pair of directions; `None` if either is below the horizon, or within 1e-6 of it.
    #[must_use]
    #[inline]
    pub fn lobe(&self, wi: Vec3, wo: Vec3) -> Option<Lobe> {
        let lobe = self.lobe_of_facets(wi, wo)?;
        if !self.is_compensated() {
            return Some(lobe);
        }
        let (multiple, pdf) = self.several(wi.z, wo.z, lobe.pdf);
        Some(Lobe { pdf, multiple, ..lobe })
    }

    /// [`Lobe::multiple`], and [`Lobe::pdf`] by that of the facets alone, of directions of these cosines.
    #[inline(never)]
    pub(crate) fn several(&self, cos_i: f32, cos_o: f32, pdf: f32) -> (f32, f32) {
        match &self.compensation {
            Some(compensation) if cos_i > LEAST_COS && cos_o > LEAST_COS => {
                let (loss_i, loss_o) = (compensation.loss(cos_i), compensation.loss(cos_o));
                (loss_i * loss_o, (1.0 - loss_i) * pdf + loss_i * FRAC_1_PI * cos_o)
            }
            _ => (0.0, pdf),
        }
    }

    /// [`Finish::lobe`] without compensation.
    #[inline]
    pub(crate) fn lobe_of_facets(&self, wi: Vec3, wo: Vec3) -> Option<Lobe> {
        let above = wi.z > LEAST_COS && wo.z > LEAST_COS;
        if !above {
            return None;
        }
        let sum = wi + wo;
        // |wi + wo| = 2 cos θ_d for unit vectors, without the cancellation of wi·wo near grazing.
        let (cos_d, density, areas, pdf) = match &self.facets {
            Facets::Ggx(_) | Facets::Beckmann(_) => {
                let square = sum.length_squared();
                let (density, areas) = (self.density_along(sum, square), self.visible_areas([wi, wo]));
                ((0.5 * sqrtf(square)).min(1.0), density, areas, 0.25 * density / areas[0])
            }
            Facets::Tabulated(table) => {
                let Pair { cos_d, density, pdf, areas } = table.pair([wi, wo], sum);
                (cos_d, density, areas, pdf)
            }
        };
        Some(Lobe { cos_d, value: density * self.shadowing_of(wi, wo, areas), pdf, multiple: 0.0 })
    }

    /// Draws wo for light from `wi` by `u` uniform in [0, 1)²: the mirror direction at a facet from
    /// [`Finish::draw_normal`]. With compensation, it is instead drawn in proportion to cos θ_o with the probability
    /// 1 − E(cos θ_i). `None` if `wi` is below the horizon, or wo is: that is a sample without light, and counts.
    #[must_use]
    pub fn sample(&self, wi: Vec3, u: [f32; 2]) -> Option<Vec3> {
        let above = wi.z > 0.0;
        if !above {
            return None;
        }
        let loss = self.compensation.map_or(0.0, |compensation| compensation.loss(wi.z));
        let wo = if u[0] < loss {
            around_normal([u[0] / loss, u[1]])
        } else {
            let u = if loss > 0.0 { [(u[0] - loss) / (1.0 - loss), u[1]] } else { u };
            let m = self.draw_normal(wi, u);
            (2.0 * wi.dot(m) * m - wi).normalize()
        };
        (wo.z > 0.0).then_some(wo)
    }

    /// Draws a normal that `wi` above the horizon sees, by `u` in [0, 1)².
    ///
    /// GGX and Beckmann facets are drawn as often as they are seen, with density D (wi·m)⁺ over
    /// [`Finish::visible_area`] (Heitz & d'Eon 2014). Tabulated facets are drawn by D cos θ_m, and turned by half a
    /// turn about z if `wi` does not see them.
    #[must_use]
    pub fn draw_normal(&self, wi: Vec3, u: [f32; 2]) -> Vec3 {
        let u = u.map(|u| u.clamp(0.0, 1.0 - f32::EPSILON / 2.0));
        match &self.facets {
            Facets::Ggx(roughness) => {
                roughness.squeezed(visible_cap(roughness.squeezed(wi).normalize(), u)).normalize()
            }
            Facets::Beckmann(roughness) => {
                // As the surface of roughness 1 sees it.
                let squeezed = roughness.squeezed(wi);
                let sin = sqrtf(squeezed.x * squeezed.x + squeezed.y * squeezed.y);
                let [cos_phi, sin_phi] = if sin > 0.0 { [squeezed.x / sin, squeezed.y / sin] } else { [1.0, 0.0] };
                let [along, across] = beckmann::visible_slope(squeezed.z / sin.max(f32::MIN_POSITIVE), u);
                let m = Vec3::new(sin_phi * across - cos_phi * along, -sin_phi * along - cos_phi * across, 1.0);
                roughness.squeezed(m).normalize()
            }
            Facets::Tabulated(table) => table.draw(wi, u),
        }
    }
}

/// Draws a direction above the horizon in proportion to its cosine.
fn around_normal(u: [f32; 2]) -> Vec3 {
    let (square, phi) = (u[0].min(1.0), TAU * u[1]);
    let sin = sqrtf(square);
    Vec3::new(sin * cosf(phi), sin * sinf(phi), sqrtf(1.0 - square))
}

/// Draws a normal of the GGX surface of roughness 1, a hemisphere, as `wi` sees it: the mirror directions of `wi` at
/// them fill the cap above −wi·z evenly (Dupuy & Benyoub, "Sampling visible GGX normals with spherical caps", 2023).
fn visible_cap(wi: Vec3, u: [f32; 2]) -> Vec3 {
    let phi = TAU * u[0];
    let z = (1.0 - u[1]) * (1.0 + wi.z) - wi.z;
    let sin = sqrtf((1.0 - z * z).max(0.0));
    Vec3::new(sin * cosf(phi), sin * sinf(phi), z) + wi
}
