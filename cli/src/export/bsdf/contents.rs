//! What a tensor file holds, and its bytes.

use std::f64::consts::FRAC_PI_2;

use super::tensor::{self, Field, Values};

/// Number of samples of D and σ over u: interpolation of D at α = 0.001 errs by 1e-4.
const FACET_SAMPLES: usize = 4096;
/// Smallest density of samples over its mean, so that samples reach every place where interpolation leaves reflection.
const MIN_LUMINANCE: f32 = 1e-4;

/// Numbers of a tensor file.
#[derive(Clone, Debug)]
pub struct Contents {
    /// Incident angles θ_i in radians, increasing.
    pub theta: Vec<f64>,
    /// Incident azimuths φ_i in radians, from −π to π; one of them for isotropic tables.
    pub phi: Vec<f64>,
    /// Densities over u and over v, whose product is the warp's density.
    pub densities: [Vec<f32>; 2],
    /// Number of samples along each side of the square.
    pub side: usize,
    /// Density of samples, `[φ_i][θ_i][v][u]`, not normalised.
    pub luminance: Vec<f32>,
    /// Values, `[φ_i][θ_i][channel][v][u]`.
    pub values: Vec<f32>,
    /// D over u, from [`over_u`].
    pub density_of_facets: Vec<f32>,
    /// σ over u, from [`over_u`].
    pub visible_area: Vec<f32>,
}

/// A function of θ at equally spaced u = sqrt(2θ/π).
pub(super) fn over_u(of: impl Fn(f64) -> f64) -> Vec<f32> {
    let theta = |i: usize| (i as f64 / (FACET_SAMPLES - 1) as f64).powi(2) * FRAC_PI_2;
    (0..FACET_SAMPLES).map(|i| of(theta(i)) as f32).collect()
}

/// Raises the density of samples of one incident direction to its least. A black direction gets an even one.
pub(super) fn raise(luminance: &mut [f32]) {
    let mean = luminance.iter().sum::<f32>() / luminance.len() as f32;
    let min = if mean > 0.0 { MIN_LUMINANCE * mean } else { 1.0 };
    luminance.iter_mut().for_each(|value| *value = value.max(min));
}

impl Contents {
    /// The bytes of the file, with a description. Channels are wavelengths in nm, or RGB if there are none.
    #[must_use]
    pub fn encode(self, description: String, wavelength_nm: &[f64]) -> Vec<u8> {
        let singles = |name, shape: Vec<usize>, values| Field { name, shape, values: Values::Singles(values) };
        let narrow = |values: &[f64]| values.iter().map(|x| *x as f32).collect::<Vec<f32>>();
        let (rgb, channels) = if wavelength_nm.is_empty() { (true, 3) } else { (false, wavelength_nm.len()) };
        let directions = [self.phi.len(), self.theta.len()];
        let shape = |rest: &[usize]| [&directions[..], rest].concat();
        let [u, v] = &self.densities;
        let warp: Vec<f32> = v.iter().flat_map(|v| u.iter().map(move |u| u * v)).collect();
        // Neither D nor σ depends on φ: both rows are equal.
        let rows = |row: Vec<f32>| (vec![2, row.len()], row.repeat(2));
        let ((ndf_shape, ndf), (sigma_shape, sigma)) = (rows(self.density_of_facets), rows(self.visible_area));
        let description = description.into_bytes();
        let mut fields = vec![
            Field { name: "description", shape: vec![description.len()], values: Values::Bytes(description) },
            Field { name: "jacobian", shape: vec![1], values: Values::Bytes(vec![1]) },
            singles("theta_i", vec![self.theta.len()], narrow(&self.theta)),
            singles("phi_i", vec![self.phi.len()], narrow(&self.phi)),
            singles("ndf", ndf_shape, ndf),
            singles("sigma", sigma_shape, sigma),
            singles("vndf", shape(&[v.len(), u.len()]), warp.repeat(self.phi.len() * self.theta.len())),
            singles("luminance", shape(&[self.side, self.side]), self.luminance),
            singles(if rgb { "rgb" } else { "spectra" }, shape(&[channels, self.side, self.side]), self.values),
        ];
        if !rgb {
            fields.push(singles("wavelengths", vec![channels], narrow(wavelength_nm)));
        }
        tensor::encode(&fields)
    }
}
