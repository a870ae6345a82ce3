//! The Fresnel term of `KHR_materials_iridescence`, as shaders evaluate it: in single precision, without allocation.
//!
//! The formula is that of the extension's section "Iridescence Fresnel" and of `iridescence.glsl` in the glTF Sample
//! Viewer, after L. Belcour and P. Barla, "A practical extension to microfacet theory for the modeling of varying
//! iridescence" (2017). It takes Schlick's reflectance at both interfaces, phases of 0 or π, and the first two orders
//! of interference, integrated over the observer in closed form with Gaussian fits of the CIE curves.
//!
//! Results are linear sRGB, with negative components cut to 0. The part that does not interfere has R = G = B; the part
//! that does is seen in light of equal energy, whose white is (1.20, 0.95, 0.91) in sRGB. This flaw is the extension's
//! own, and kept.

use std::f32::consts::PI;

/// The matrix from XYZ to linear sRGB, row by row.
const XYZ_TO_RGB: [[f32; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266, 1.876_010_8, 0.041_556],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// The Fourier transform of a Gaussian fit to an observer's curve over wave numbers 1/λ.
struct Lobe {
    /// Amplitude, `val · sqrt(2π var) / 1.0685e-7` in the extension's words.
    amplitude: f32,
    /// Mean wave number, 1/m.
    mean: f32,
    /// Variance, 1/m².
    variance: f32,
}

impl Lobe {
    /// The value at a phase of 2π times the optical path difference in m, with a phase shift in radians.
    fn at(&self, phase: f32, shift: f32) -> f32 {
        self.amplitude * (self.mean * phase + shift).cos() * (-self.variance * phase * phase).exp()
    }
}

// Amplitudes are computed beforehand, as a shader compiler does; a test repeats the computation.
const X_LONG: Lobe = Lobe { amplitude: 0.846_59, mean: 1.6810e6, variance: 4.3278e9 };
const X_SHORT: Lobe = Lobe { amplitude: 0.153_868_3, mean: 2.2399e6, variance: 4.5282e9 };
const Y: Lobe = Lobe { amplitude: 1.000_221_9, mean: 1.7953e6, variance: 9.3046e9 };
const Z: Lobe = Lobe { amplitude: 1.001_122_5, mean: 2.2084e6, variance: 6.6121e9 };

/// The observer's response to a cosine in wave number, in linear sRGB: `evalSensitivity` in the extension.
///
/// `path_nm` is the optical path difference, `shift` the phase that reflection adds in each channel.
#[must_use]
pub fn eval_sensitivity(path_nm: f32, shift: [f32; 3]) -> [f32; 3] {
    let phase = 2.0 * PI * 1e-9 * path_nm;
    let x = X_LONG.at(phase, shift[0]) + X_SHORT.at(phase, shift[0]);
    let (y, z) = (Y.at(phase, shift[1]), Z.at(phase, shift[2]));
    XYZ_TO_RGB.map(|row| row[0] * x + row[1] * y + row[2] * z)
}

/// Schlick's reflectance at an angle, from that at normal incidence.
#[must_use]
pub fn schlick(f0: f32, cosine: f32) -> f32 {
    let grazing = (1.0 - cosine).clamp(0.0, 1.0);
    let squared = grazing * grazing;
    f0 + (1.0 - f0) * squared * squared * grazing
}

/// Reflectance at normal incidence between media of two real refractive indices.
fn ior_to_fresnel0(transmitted: f32, incident: f32) -> f32 {
    let r = (transmitted - incident) / (transmitted + incident);
    r * r
}

/// The real refractive index that has a reflectance `f0` under air at normal incidence.
fn fresnel0_to_ior(f0: f32) -> f32 {
    let r = f0.sqrt();
    (1.0 + r) / (1.0 - r)
}

/// GLSL's `smoothstep` from 0 to `edge`.
fn smoothstep(edge: f32, x: f32) -> f32 {
    let t = (x / edge).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Linear sRGB reflectance of a film: `evalIridescence` in the extension.
///
/// `outside_ior` and `film_ior` are real refractive indices of 1 or more, `cos_theta` in [0, 1] is the cosine of the
/// angle outside, and `base_f0` the base's reflectance under air at normal incidence, which is clamped to 0.9999. Each
/// result is 0 or more and may exceed 1 slightly. Arguments outside their domains give meaningless results, but no
/// panic.
#[must_use]
pub fn eval_iridescence(
    outside_ior: f32,
    film_ior: f32,
    cos_theta: f32,
    thickness_nm: f32,
    base_f0: [f32; 3],
) -> [f32; 3] {
    /// Below this thickness in nm, the film's index fades to that of the outside.
    const FADE_NM: f32 = 0.03;
    let film = outside_ior + (film_ior - outside_ior) * smoothstep(FADE_NM, thickness_nm);
    let sine_squared = (outside_ior / film).powi(2) * (1.0 - cos_theta * cos_theta);
    if sine_squared > 1.0 {
        return [1.0; 3];
    }
    let inner_cos = (1.0 - sine_squared).sqrt();

    let r12 = schlick(ior_to_fresnel0(film, outside_ior), cos_theta);
    let t121 = 1.0 - r12;
    let phi21 = if film < outside_ior { 0.0 } else { PI };

    let base = base_f0.map(|f0| fresnel0_to_ior(f0.clamp(0.0, 0.9999)));
    let r23 = base.map(|base| schlick(ior_to_fresnel0(base, film), inner_cos));
    let shift = base.map(|base| if base < film { phi21 + PI } else { phi21 });

    let r123_squared = r23.map(|r23| (r12 * r23).clamp(1e-5, 0.9999));
    let r123 = r123_squared.map(f32::sqrt);
    let rs: [f32; 3] = std::array::from_fn(|c| t121 * t121 * r23[c] / (1.0 - r123_squared[c]));

    let path_nm = 2.0 * film * thickness_nm * inner_cos;
    let first = eval_sensitivity(path_nm, shift);
    let second = eval_sensitivity(2.0 * path_nm, shift.map(|shift| 2.0 * shift));
    std::array::from_fn(|c| {
        let amplitude = (rs[c] - t121) * r123[c];
        let waves = 2.0 * amplitude * (first[c] + r123[c] * second[c]);
        (r12 + rs[c] + waves).max(0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The output of `tests/gltf/iridescence.py`: (outside, film, cos θ, nm), F0, RGB.
    const REFERENCE: [([f32; 4], [f32; 3], [f32; 3]); 9] = [
        ([1.0, 1.33, 1.0, 100.0], [0.04, 0.04, 0.04], [0.0056982, 0.0074831, 0.0111814]),
        ([1.0, 1.33, 0.5, 400.0], [0.04, 0.04, 0.04], [0.0462310, 0.0264626, 0.0638096]),
        ([1.0, 1.33, 0.0871557, 800.0], [0.04, 0.04, 0.04], [0.6099008, 0.6149207, 0.6704719]),
        ([1.0, 1.8, 0.9, 250.0], [0.04, 0.04, 0.04], [0.1462708, 0.120968, 0.0462126]),
        ([1.0, 1.3, 0.7, 320.0], [0.95, 0.64, 0.54], [0.9574331, 0.5455364, 0.3551059]),
        ([1.0, 2.0, 0.3, 550.0], [0.0, 0.5, 1.0], [0.4553415, 0.2421835, 0.9998032]),
        ([1.0, 1.5, 0.6, 0.01], [0.1, 0.2, 0.3], [0.1487132, 0.2401423, 0.338196]),
        ([1.5, 1.2, 0.8, 300.0], [0.04, 0.04, 0.04], [0.0311069, 0.0086170, 0.0046184]),
        ([1.5, 1.2, 0.2, 300.0], [0.04, 0.04, 0.04], [1.0000000, 1.0000000, 1.0000000]),
    ];

    /// Error bound of single precision. Phases reach 2 · 2.2e6 · 2π · 2.2e-6 = 61 rad, and r123 is at most 0.3 here, or
    /// 1 below half that phase: the error is 61 · 2⁻²⁴ · 2 in each wave, times 2 · 3.24 by the matrix.
    const SINGLE: f32 = 6e-5;

    #[test]
    fn it_is_the_extensions_formula() {
        for ([outside, film, cosine, nm], f0, want) in REFERENCE {
            let got = eval_iridescence(outside, film, cosine, nm, f0);
            for (got, want) in got.into_iter().zip(want) {
                assert!((got - want).abs() <= SINGLE, "{film} {cosine} {nm} {f0:?}: {got} for {want}");
            }
        }
    }

    #[test]
    fn the_amplitudes_are_those_of_the_fits() {
        for (lobe, value) in [(X_LONG, 5.4856e-13), (X_SHORT, 9.7470e-14), (Y, 4.4201e-13), (Z, 5.2481e-13)] {
            let want = value * (2.0 * std::f64::consts::PI * f64::from(lobe.variance)).sqrt() / 1.0685e-7;
            assert!((f64::from(lobe.amplitude) - want).abs() < 1e-6 * want, "{} for {want}", lobe.amplitude);
        }
    }
}
