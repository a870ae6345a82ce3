use std::hint::black_box;

use goniochrome::colour::{Illuminant, Quadrature, RgbSpace, xyz, xyz_weights};

use super::{Visit, Work};

/// Colour: the observer's weights on a grid of 81 wavelengths, and the RGB of a spectrum.
///
/// # Panics
/// If a result is wrong.
pub fn colour(visit: Visit<'_>) {
    let grid: Vec<f64> = (0..81).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let mut weights = vec![[0.0; 3]; grid.len()];
    let work = |name| Work { stage: "colour", name, unit: "wavelengths", amount: 81.0 };
    visit(&work("weights"), &mut || {
        let reduced = xyz_weights(black_box(&grid), Illuminant::D65, Quadrature::Interpolated, &mut weights);
        reduced.expect("a good grid");
    });
    let rho = vec![1.0; grid.len()];
    let rgb = RgbSpace::Srgb.from_xyz(xyz(&weights, rho.iter().copied()));
    assert!(rgb.iter().all(|c| (c - 1.0).abs() < 1e-3), "{rgb:?}");
    visit(&work("spectrum to RGB"), &mut || {
        black_box(RgbSpace::Srgb.from_xyz(xyz(&weights, black_box(&rho).iter().copied())));
    });
}
