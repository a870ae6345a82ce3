//! The scalar twin of the library: a solver of planar stacks in scalar double precision that shares no method with it,
//! with bounds of rounding.
//!
//! It carries the fields through the planes: E (for p the magnetic field), and H, the difference of the two waves
//! weighted by κ. Across a film, (H, E) above = [[1 + f, κ(1 − f)], [(1 − f)/κ, 1 + f]] (H, E) below / 2e, with f = e².
//! Unlike sums of rays this stays well-conditioned where a film's wave runs along the film, κ → 0.
//!
//! **How errors travel.** Let a plane send out a wave with an error ε. To first order, the wave that returns at the top
//! is wrong by ε κ/κ₀ a, where a is the amplitude of the wave that runs the opposite way there when light falls on the
//! stack (reciprocity). Every rounding is such an ε:
//!
//! - a few unit roundoffs of the waves at the plane, weighted by (1 + |r|)², since |k₁| + |k₂| ≤ (1 + |r|)|k₁ + k₂|
//!   bounds
//!   the digits that r = (k₁ − k₂)/(k₁ + k₂) may lose;
//! - where numerator and denominator are carried separately, a few of the incident wave over |1 − g|, with g the gain
//!   of
//!   the loop in the film below.
//!
//! The sum of all is the condition number of the stack: about 1 for ordinary films, the stored energy for resonances,
//! 1/κ near the critical angle of a film.

#![allow(clippy::needless_range_loop, reason = "one index runs through several arrays")]

use num_complex::Complex64;
use std::f64::consts::TAU;

/// Unit roundoffs of one plane: ≤ 5 in r, ≤ 3 for each of two complex products and a sum, ≤ 8 in a complex division.
const ROUNDINGS_OF_A_PLANE: f64 = 20.0;

/// Unit roundoffs of e: 4√2 of the phase and 4 of the attenuation. That of its exponent is counted separately.
const ROUNDINGS_OF_A_FILM: f64 = 10.0;

/// Unit roundoffs of q_n² = η² − q_t² in double precision, relative to |η|² + q_t²: squares, a difference, the angle.
const ROUNDINGS_OF_A_NORMAL: f64 = 8.0;

/// Half the distance from 1 to the next double.
const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// A stack at one angle and wavelength.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// Indices n + ik of the ambient medium, each layer and the substrate. Without a substrate the stack lies on a
    /// perfect mirror.
    pub eta: &'a [Complex64],
    /// Thicknesses of the layers.
    pub thickness_nm: &'a [f64],
    pub sin_theta: f64,
    pub wavelength_nm: f64,
}

/// Reflectance and transmittance of a stack in one polarisation, and their sensitivity to rounding.
#[derive(Clone, Copy, Debug)]
pub struct Twin {
    pub reflectance: f64,
    pub transmittance: f64,
    /// |ρ| of the stack.
    reflection: f64,
    /// |t| √(κ_substrate/κ₀): its square is the transmittance.
    transmission: f64,
    /// Error of ρ, and of t weighted like `transmission`, for each unit roundoff of the lanes.
    lanes: [f64; 2],
    /// Error of ρ and of the weighted t for a relative error of 1 in every η.
    media: [f64; 2],
    /// Sums of the waves that arrive at planes, weighted by κ/κ₀: the change that rays in flight can still make to ρ
    /// and t.
    stored: [f64; 2],
    /// Rounding of the flux through the faces of absorbing films.
    flux: f64,
    /// T |κ|/Re κ of the substrate, since κ may be almost imaginary, and the loss of digits in κ.
    passed: [f64; 2],
}

/// The waves that arrive at a plane and leave it.
#[derive(Clone, Copy, Debug)]
struct Plane {
    down_in: Complex64,
    up_out: Complex64,
    down_out: Complex64,
    up_in: Complex64,
    /// Amplitude that returns of a unit wave that leaves the plane downwards.
    returned: Complex64,
    /// Amplitude that returns of a unit wave that arrives at the plane from above: ρ of the plane and all below it.
    rho_below: Complex64,
}

/// A medium as the wave sees it.
#[derive(Clone, Copy, Debug)]
struct Wave {
    kappa: Complex64,
    /// 1 for s, η² for p: κ = q_n/weight.
    weight: Complex64,
    /// 2π q_n d/λ of a film.
    phase: Complex64,
    /// 2π d/λ, the film's phase for q_n = 1.
    unit_phase: f64,
    /// Relative error of q_n for relative errors of 1 in η and q_t.
    loss: f64,
}

impl Wave {
    /// Coefficients 1 + f, κ(1 − f), (1 − f)/κ and 2e of a film.
    fn film(&self) -> [Complex64; 4] {
        let i = Complex64::I;
        let e = (i * self.phase).exp();
        // 1 − f over κ, without cancellation where the phase is small.
        let per_kappa = if self.phase.norm() < 1e-3 {
            -2.0 * i * self.unit_phase * self.weight * (1.0 - self.phase * self.phase / 6.0) * e
        } else {
            (1.0 - e * e) / self.kappa
        };
        [1.0 + e * e, per_kappa * self.kappa * self.kappa, per_kappa, 2.0 * e]
    }
}

/// The waves at every plane for a unit wave from the first medium; `end` is (H, E) below the last plane.
fn solve(waves: &[Wave], films: usize, end: [Complex64; 2]) -> Vec<Plane> {
    let unit = |[h, e]: [Complex64; 2]| {
        let norm = h.norm() + e.norm();
        ([h / norm, e / norm], norm)
    };
    let mut fields = vec![(unit(end).0, Complex64::ONE)];
    for film in waves[1..=films].iter().rev() {
        let [diagonal, up, low, twice] = film.film();
        let [h, e] = fields.last().expect("the end").0;
        let (field, norm) = unit([diagonal * h + up * e, low * h + diagonal * e]);
        fields.push((field, twice / norm));
    }
    fields.reverse();
    let kappa = waves[0].kappa;
    let [h, e] = fields[0].0;
    let mut scale = 2.0 * kappa / (kappa * e + h);
    let split = |kappa: Complex64, [h, e]: [Complex64; 2]| [(e + h / kappa) / 2.0, (e - h / kappa) / 2.0];
    let mut planes = Vec::with_capacity(fields.len());
    for (j, &(field, step)) in fields.iter().enumerate() {
        let here = field.map(|x| x * scale);
        let [down_in, up_out] = split(waves[j].kappa, here);
        let rho = |k: Complex64| (k * field[1] - field[0]) / (k * field[1] + field[0]);
        let ([down_out, up_in], returned) = match waves.get(j + 1) {
            None => ([Complex64::ZERO; 2], Complex64::ZERO),
            Some(_) if j == films => ([here[1], Complex64::ZERO], Complex64::ZERO),
            Some(below) => {
                let k = below.kappa;
                (split(k, here), rho(k))
            }
        };
        planes.push(Plane { down_in, up_out, down_out, up_in, returned, rho_below: rho(waves[j].kappa) });
        scale *= step;
    }
    planes
}

impl Problem<'_> {
    /// Solves the stack in both polarisations, s first.
    pub fn solve(&self) -> [Twin; 2] {
        [false, true].map(|p| self.polarised(p))
    }

    /// Relative change of a film's η by which lanes of this roundoff keep its wave off the critical angle
    /// (`Wave::in_film`).
    pub fn kept_off(&self, roundoff: f64) -> f64 {
        let q_t = self.eta[0].re * self.sin_theta;
        let films = &self.eta[1..=self.thickness_nm.len()];
        let near = films.iter().any(|eta| (eta * eta - q_t * q_t).norm() < 2.0 * roundoff * eta.norm_sqr());
        if near { roundoff } else { 0.0 }
    }

    fn waves(&self, p: bool) -> Vec<Wave> {
        let q_t = self.eta[0].re * self.sin_theta;
        let wave = |(j, eta): (usize, &Complex64)| {
            let squared = eta * eta;
            let normal_squared = squared - q_t * q_t;
            let mut normal = normal_squared.sqrt();
            if normal.im < 0.0 {
                normal = -normal;
            }
            let weight = if p { squared } else { Complex64::ONE };
            let thickness_nm = j.checked_sub(1).and_then(|j| self.thickness_nm.get(j)).copied().unwrap_or(0.0);
            let unit_phase = TAU * (thickness_nm / self.wavelength_nm);
            let loss = (squared.norm() + q_t * q_t) / normal_squared.norm();
            Wave { kappa: normal / weight, weight, phase: normal * unit_phase, unit_phase, loss }
        };
        self.eta.iter().enumerate().map(wave).collect()
    }

    fn polarised(&self, p: bool) -> Twin {
        let mut waves = self.waves(p);
        let films = self.thickness_nm.len();
        let substrate = waves.get(films + 1).map(|wave| wave.kappa);
        let end = match (substrate, p) {
            (Some(kappa), _) => [kappa, Complex64::ONE],
            (None, false) => [Complex64::ONE, Complex64::ZERO],
            (None, true) => [Complex64::ZERO, Complex64::ONE],
        };
        let from_above = solve(&waves, films, end);
        let incident = waves[0].kappa.norm();
        let moduli = |waves: [Complex64; 4], weight: f64| waves.map(|a| a.norm() * weight);
        let up = |p: &Plane| moduli([p.down_in, p.up_in, p.up_out, p.down_out], 1.0 / incident);
        let top: Vec<_> = from_above.iter().map(up).collect();
        let reflection = from_above[0].up_out.norm();
        let power = substrate.map_or(0.0, |kappa| kappa.re / waves[0].kappa.re);
        let transmission = from_above[films].down_out.norm() * power.sqrt();

        // The same waves with light from below give the sensitivity of t.
        let below = substrate.filter(|_| power > 0.0).map(|kappa| {
            let mut turned = waves.clone();
            turned.reverse();
            let planes = solve(&turned, films, [waves[0].kappa, Complex64::ONE]);
            let weight = power.sqrt() / kappa.norm();
            let down = |p: &Plane| moduli([p.up_in, p.down_in, p.down_out, p.up_out], weight);
            planes.iter().rev().map(down).collect::<Vec<_>>()
        });
        let bottom = below.unwrap_or_else(|| vec![[0.0; 4]; films + 1]);
        if waves.len() == films + 1 {
            // A mirror stands for a medium without waves.
            waves.push(Wave { kappa: Complex64::ZERO, phase: Complex64::ZERO, loss: 0.0, ..waves[0] });
        }
        let adjoint = [&top, &bottom];

        let mut twin = Twin {
            reflectance: reflection * reflection,
            transmittance: transmission * transmission,
            reflection,
            transmission,
            lanes: [0.0; 2],
            media: [0.0; 2],
            stored: [0.0; 2],
            flux: 0.0,
            passed: [0.0; 2],
        };
        if let Some(kappa) = substrate {
            let passed = from_above[films].down_out.norm_sqr() * kappa.norm() / waves[0].kappa.re;
            twin.passed = [passed, passed * (waves[0].loss + waves[films + 1].loss)];
        }
        let mut resonance = 0.0;
        for (j, plane) in from_above.iter().enumerate() {
            let (k1, k2) = (waves[j].kappa, waves[j + 1].kappa);
            let r = ((k1 - k2) / (k1 + k2)).norm();
            let r = if r.is_nan() { 0.0 } else { r };
            let gain = plane.returned.norm() * r;
            let closing = (1.0 + (k1 - k2) / (k1 + k2) * plane.returned).norm();
            let arriving = plane.down_in.norm() + plane.up_in.norm();
            let all = arriving + plane.down_out.norm() + plane.up_out.norm();
            let rho = plane.rho_below.norm();
            let fraction = (r + plane.returned.norm() + rho * (1.0 + gain)) / closing;
            resonance += (1.0 + gain) / closing;
            let weight = (1.0 + r).powi(2);
            // A perfect mirror does not depend on the media beside it.
            let loss = if substrate.is_none() && j == films { 0.0 } else { waves[j].loss + waves[j + 1].loss };
            for side in 0..2 {
                let [above, under, above_back, under_back] = adjoint[side][j];
                let reach = k1.norm() * above + k2.norm() * under;
                let source = weight * all + plane.down_in.norm() * fraction;
                twin.lanes[side] += ROUNDINGS_OF_A_PLANE * reach * source;
                twin.media[side] += reach * weight * arriving * loss;
                twin.stored[side] += k1.norm() * above_back.powi(2) + k2.norm() * under_back.powi(2);
            }
            if j < films {
                let film = waves[j + 1];
                let depth = film.phase.im;
                for side in 0..2 {
                    // Each of the film's two waves crosses it with an error.
                    let [_, up_in, _, down_out] = adjoint[side][j];
                    let arrives = film.kappa.norm() * (plane.down_out.norm() * up_in + plane.up_in.norm() * down_out);
                    twin.lanes[side] += arrives * (ROUNDINGS_OF_A_FILM + depth);
                    twin.media[side] += arrives * film.phase.norm() * film.loss;
                }
                if self.eta[j + 1].im > 0.0 {
                    twin.flux += film.kappa.norm() / incident * (plane.down_out.norm() + plane.up_in.norm()).powi(2);
                }
            }
        }
        let absorbing = self.eta[1..=films].iter().filter(|eta| eta.im > 0.0).count() as f64;
        twin.lanes[1] += ROUNDINGS_OF_A_PLANE * transmission * resonance;
        twin.flux = ROUNDINGS_OF_A_PLANE * (twin.flux + resonance) + absorbing * twin.lanes[0];
        twin.stored = twin.stored.map(|sum| (sum * incident).sqrt());
        twin
    }
}

/// Bound of |δ(a²)| for |δa| ≤ error; infinite where it is not a number.
fn squared(a: f64, error: f64) -> f64 {
    let error = 2.0 * a * error + error * error;
    if error.is_nan() { f64::INFINITY } else { error }
}

impl Twin {
    /// Bounds of the errors of R and T in lanes of this roundoff, where every η is relatively off by `media`.
    fn errors(&self, roundoff: f64, media: f64) -> [f64; 2] {
        let precise = ROUNDINGS_OF_A_NORMAL * UNIT_ROUNDOFF + media;
        let of = |side: usize, a: f64, [passed, lost]: [f64; 2]| {
            let error = self.lanes[side] * (roundoff + UNIT_ROUNDOFF) + self.media[side] * precise;
            let tiny = if roundoff > UNIT_ROUNDOFF { f64::from(f32::MIN_POSITIVE) } else { f64::MIN_POSITIVE };
            // A power below the smallest normal number loses its digits, and then itself.
            let sum = squared(a, error) + ROUNDINGS_OF_A_PLANE * (roundoff * passed + tiny) + precise * lost;
            if sum.is_nan() { f64::INFINITY } else { sum }
        };
        [of(0, self.reflection, [self.reflectance, 0.0]), of(1, self.transmission, self.passed)]
    }

    /// Bounds of |δR| and |δT| in lanes of this roundoff.
    pub fn rounding(&self, roundoff: f64) -> [f64; 2] {
        self.errors(roundoff, 0.0)
    }

    /// Bounds of |δR| and |δT| where every η is relatively off by `media`, besides rounding.
    pub fn perturbed(&self, roundoff: f64, media: f64) -> [f64; 2] {
        self.errors(roundoff, media)
    }

    /// Bound of the ledger's imbalance.
    pub fn imbalance(&self, roundoff: f64) -> f64 {
        let [r, t] = self.errors(roundoff, 0.0);
        let sum = r + t + self.flux * (roundoff + UNIT_ROUNDOFF);
        if sum.is_nan() { f64::INFINITY } else { sum }
    }

    /// Bounds of |δR| and |δT| by rays of the power `truncated` that were dropped in so many generations
    /// (Cauchy–Schwarz over the states, and over those generations).
    #[allow(dead_code, reason = "stacks know their error better; flat cells, which are fuzzed, do not")]
    pub fn truncation(&self, truncated: f64, generations: f64) -> [f64; 2] {
        let error = (truncated * generations).sqrt();
        [squared(self.reflection, error * self.stored[0]), squared(self.transmission, error * self.stored[1])]
    }
}
