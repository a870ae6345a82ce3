//! What a tensor file holds, and its bytes.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::tensor::{self, Field, Values};

/// Number of samples of D and σ over u: interpolation of D at α = 0.001 errs by 1e-4.
const FACET_SAMPLES: usize = 4096;
/// Largest relative error of D by interpolation over u and over v, each, where D depends on both.
const FACET_ERROR: f64 = 2e-4;
/// Largest number of samples of D, and of σ, where they depend on u and v: 32 MiB.
const MAX_FACET_SAMPLES: f64 = (8_u32 << 20) as f64;
/// Smallest density of samples over its mean, so that samples reach every place where interpolation leaves reflection.
const MIN_LUMINANCE: f32 = 1e-4;

/// Numbers of a tensor file.
#[derive(Clone, Debug)]
pub struct Contents {
    /// Incident angles θ_i in radians, increasing.
    pub theta: Vec<f64>,
    /// Incident azimuths φ_i in radians, from −π to π; one of them for isotropic tables.
    pub phi: Vec<f64>,
    /// Density over u, whose product with that over v is the warp's density.
    pub across: Vec<f32>,
    /// Density over v for each φ_i, all of one length.
    pub along: Vec<Vec<f32>>,
    /// Number of samples along each side of the square.
    pub side: usize,
    /// Density of samples, `[φ_i][θ_i][v][u]`, not normalised.
    pub luminance: Vec<f32>,
    /// Values, `[φ_i][θ_i][channel][v][u]`.
    pub values: Vec<f32>,
    /// D of facets.
    pub density_of_facets: OverSquare,
    /// σ of facets.
    pub visible_area: OverSquare,
}

/// A function of a direction at equally spaced u = sqrt(2θ/π) and v = (φ + π)/2π, both ends included.
#[derive(Clone, Debug)]
pub struct OverSquare {
    columns: usize,
    /// `[v][u]`
    values: Vec<f32>,
}

impl OverSquare {
    /// A function of θ alone.
    pub(super) fn isotropic(of: impl Fn(f64) -> f64) -> Self {
        // The format wants two rows at least.
        Self::new([FACET_SAMPLES, 2], |theta, _| of(theta))
    }

    /// A function of θ and φ that changes as D or σ of facets of a roughness along x and y.
    pub(super) fn of_facets(alpha: [f64; 2], of: impl Fn(f64, f64) -> f64) -> Self {
        let [least, most] = [alpha[0].min(alpha[1]), alpha[0].max(alpha[1])];
        // Linear interpolation over a step h errs by f″h²/8. D = exp(−s²) of Beckmann bends most: where it is 1 % of
        // its peak, s² = 4.6, f″/f = 4s²/α² over θ, where dθ = π u du and θ = s α, and at most s⁴ (most/least)² over φ.
        let square = 4.6_f64;
        let over_u = (PI * square.powf(1.5) / (FACET_ERROR * least)).sqrt();
        let over_v = TAU * square * most / least / (8.0 * FACET_ERROR).sqrt();
        let wanted = [over_u, over_v];
        let scale = (MAX_FACET_SAMPLES / (wanted[0] * wanted[1])).sqrt().min(1.0);
        Self::new(wanted.map(|count| (count * scale) as usize + 2), of)
    }

    fn new([columns, rows]: [usize; 2], of: impl Fn(f64, f64) -> f64) -> Self {
        let part = |i: usize, count: usize| i as f64 / (count - 1) as f64;
        let row = |j: usize| {
            let of = &of;
            let phi = TAU * part(j, rows) - PI;
            (0..columns).map(move |i| of(part(i, columns).powi(2) * FRAC_PI_2, phi) as f32)
        };
        Self { columns, values: (0..rows).flat_map(row).collect() }
    }

    fn shape(&self) -> Vec<usize> {
        vec![self.values.len() / self.columns, self.columns]
    }
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
        let product = |v: &Vec<f32>| v.iter().flat_map(|v| self.across.iter().map(move |u| u * v)).collect::<Vec<_>>();
        let warp = self.along.iter().flat_map(|v| product(v).repeat(self.theta.len())).collect();
        let warp_shape = shape(&[self.along[0].len(), self.across.len()]);
        let description = description.into_bytes();
        let mut fields = vec![
            Field { name: "description", shape: vec![description.len()], values: Values::Bytes(description) },
            Field { name: "jacobian", shape: vec![1], values: Values::Bytes(vec![1]) },
            singles("theta_i", vec![self.theta.len()], narrow(&self.theta)),
            singles("phi_i", vec![self.phi.len()], narrow(&self.phi)),
            singles("ndf", self.density_of_facets.shape(), self.density_of_facets.values),
            singles("sigma", self.visible_area.shape(), self.visible_area.values),
            singles("vndf", warp_shape, warp),
            singles("luminance", shape(&[self.side, self.side]), self.luminance),
            singles(if rgb { "rgb" } else { "spectra" }, shape(&[channels, self.side, self.side]), self.values),
        ];
        if !rgb {
            fields.push(singles("wavelengths", vec![channels], narrow(wavelength_nm)));
        }
        tensor::encode(&fields)
    }
}

#[cfg(test)]
mod tests {
    use goniochrome::microfacet::{Distribution, Finish, Masking};

    use super::*;
    use crate::support::direction::direction;

    #[test]
    fn facets_of_two_roughnesses_are_interpolated_within_the_error() {
        let alpha = [0.1_f32, 0.4];
        for distribution in [Distribution::Ggx, Distribution::Beckmann] {
            let finish = Finish::new(distribution, Masking::Correlated, alpha).unwrap();
            let at = |u: f64, v: f64| direction(u * u * FRAC_PI_2, TAU * v - PI).as_vec3();
            let density = |u, v| f64::from(finish.density(at(u, v)));
            let table = OverSquare::of_facets(alpha.map(f64::from), |theta, phi| {
                finish.density(direction(theta, phi).as_vec3()).into()
            });
            let [rows, columns] = [table.shape()[0], table.shape()[1]];
            let peak = density(0.0, 0.0);
            let mut compared = 0;
            for k in 0..20_000 {
                // In the middle of a cell, where interpolation is worst.
                let (row, column) = (k * 7919 % (rows - 1), k * 104_729 % (columns - 1));
                let [u, v] = [(column, columns), (row, rows)].map(|(i, n)| (i as f64 + 0.5) / (n - 1) as f64);
                let corner = |i: usize| f64::from(table.values[row * columns + column + i]);
                let mean = 0.25 * [0, 1, columns, columns + 1].map(corner).iter().sum::<f64>();
                let exact = density(u, v);
                if exact > 0.01 * peak {
                    // One error over u, one over v.
                    assert!((mean / exact - 1.0).abs() < 2.0 * FACET_ERROR, "{distribution:?} {u} {v}: {mean} {exact}");
                    compared += 1;
                }
            }
            assert!(compared > 1000, "{compared}");
        }
    }
}
