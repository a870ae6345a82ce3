use std::hint::black_box;

use goniochrome::optics::interface::{Model, Wave, reflection};
use goniochrome::simd::complex::ComplexLanes;
use goniochrome::simd::lanes::Lanes;

use super::{Visit, Work};

/// An interface: a plane wave's normal component in a medium, and Fresnel's coefficients between two media.
///
/// # Panics
/// If a result is wrong.
pub fn interface<V: Lanes>(visit: Visit<'_>) {
    let work = |name| Work { stage: "interface", name, unit: "wavelengths", amount: V::WIDTH as f64 };
    let eta = |re: f64, im: f64| ComplexLanes::new(V::Precise::splat(re), V::Precise::splat(im));
    let tangential = eta(0.25, 0.0);
    let (above, below) =
        (Wave::<V>::in_film(eta(1.0, 0.0), tangential), Wave::<V>::in_film(eta(1.5, 0.01), tangential));
    let r = reflection(Model::Physical, &above, Some(&below));
    // At 30 degrees s reflects more than p, and both near 0.04.
    let (s, p) = (r.s.norm_sqr().lane(0), r.p.norm_sqr().lane(0));
    assert!(p < s && 0.02 < p && s < 0.06, "{s} {p}");
    visit(&work("wave"), &mut || {
        black_box(Wave::<V>::in_film(black_box(eta(1.5, 0.01)), black_box(tangential)));
    });
    visit(&work("fresnel"), &mut || {
        black_box(reflection(Model::Physical, black_box(&above), Some(black_box(&below))));
    });
}
