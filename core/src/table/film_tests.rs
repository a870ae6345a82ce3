//! Tests of tables of mirror-like surfaces with all that they may hold.

use super::*;
use crate::microfacet::{Distribution, Masking};

/// Three thicknesses, two angles, RGB: values that tell their places.
fn arrays() -> ([f32; 18], [f32; 18]) {
    let reflectance = core::array::from_fn(|i| 0.01 * (1 + i * i) as f32);
    (reflectance, reflectance.map(|rho| 4.0 - rho))
}

fn finish() -> Finish<'static> {
    Finish::new(Distribution::Beckmann, Masking::Correlated, [0.2, 0.5]).unwrap()
}

fn table<'a>(reflectance: &'a [f32], transmittance: &'a [f32], finish: Option<Finish<'a>>) -> FilmTable<'a> {
    let arrays = FilmArrays { reflectance, transmittance, thickness_nm: &[100.0, 150.0, 400.0] };
    FilmTable::new(&arrays, 3, 1.5, finish).unwrap()
}

/// Rounding of two interpolations, of values up to 4.
const ROUNDING: f32 = 8.0 * 4.0 * f32::EPSILON;

#[test]
fn values_are_linear_in_angle_and_thickness_and_held_beyond() {
    let (reflectance, transmittance) = arrays();
    let film = table(&reflectance, &transmittance, None);
    assert_eq!((film.angles(), film.thicknesses(), film.range_nm()), (2, 3, [100.0, 400.0]));
    let at = |thickness: usize, angle: usize, c: usize| reflectance[6 * thickness + 3 * angle + c];
    for (nm, [thin, thick], across) in [
        (0.0, [0, 0], 0.0),
        (100.0, [0, 1], 0.0),
        (110.0, [0, 1], 0.2),
        (150.0, [1, 2], 0.0),
        (275.0, [1, 2], 0.5),
        (1e20, [2, 2], 0.0),
        (f32::NAN, [0, 0], 0.0),
    ] {
        for (cos, along) in [(1.0, 0.0), (0.0, 1.0), (libm::cosf(0.75), 0.5), (2.0, 0.0), (f32::NAN, 1.0)] {
            let (rho, tau) = (film.reflectance(cos, nm), film.transmittance(cos, nm));
            for c in 0..3 {
                let of = |k| at(k, 0, c) + along * (at(k, 1, c) - at(k, 0, c));
                let want = of(thin) + across * (of(thick) - of(thin));
                // acos near 0.75 rounds too, by 1e-7 of a step of 1.5.
                assert!((rho[c] - want).abs() <= ROUNDING, "{nm} {cos}: {rho:?} for {want}");
                assert!((rho[c] + tau[c] - 4.0).abs() <= 2.0 * ROUNDING, "{nm} {cos}: {rho:?} {tau:?}");
            }
        }
    }
}

#[test]
fn a_finish_spreads_what_the_facets_reflect() {
    let (reflectance, _) = arrays();
    let film = table(&reflectance, &[], Some(finish()));
    let (wi, wo) = (Vec3::new(0.48, 0.36, 0.8), Vec3::new(-0.6, 0.0, 0.8));
    let lobe = finish().lobe(wi, wo).unwrap();
    let rho = film.reflectance(lobe.cos_d, 200.0);
    for (f, rho) in film.eval(wi, wo, 200.0).into_iter().zip(rho) {
        // θ_d and its cosine round, each by some 1e-7.
        assert!((f / (rho * lobe.value) - 1.0).abs() < 1e-5, "{f} {rho}");
    }
    assert_eq!(film.pdf(wi, wo), lobe.pdf);
    for u in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.7]] {
        let FilmSample { wo, pdf, weight } = film.sample(wi, u, 200.0).unwrap();
        assert_eq!(pdf, Some(film.pdf(wi, wo)));
        let f = film.eval(wi, wo, 200.0);
        for (c, weight) in weight.into_iter().enumerate() {
            // Rounding of some twenty products.
            assert!((f[c] * wo.z / film.pdf(wi, wo) / weight - 1.0).abs() < 1e-5, "{u:?} {c}");
        }
    }
    assert_eq!(
        (film.eval(-wi, wo, 200.0), film.pdf(wi, -wo), film.sample(-wi, [0.5; 2], 200.0)),
        ([0.0; 3], 0.0, None)
    );
    assert_eq!(film.transmittance(0.5, 200.0), [0.0; 3]);
}

#[test]
fn directions_at_the_horizon_give_numbers() {
    let (reflectance, _) = arrays();
    for distribution in [Distribution::Ggx, Distribution::Beckmann] {
        for masking in [Masking::Correlated, Masking::Separable] {
            let finish = Finish::new(distribution, masking, [1e-3, 1.0]).unwrap();
            let film = table(&reflectance, &[], Some(finish));
            for z in [f32::MIN_POSITIVE, 1e-20, 1e-6, 2e-6, 1e-4] {
                for wo in [Vec3::new(1.0, 0.0, z), Vec3::new(-1.0, 0.0, z), Vec3::Z, Vec3::new(0.0, 1.0, z)] {
                    let wi = Vec3::new(1.0, 0.0, z);
                    let (f, pdf) = (film.eval(wi, wo, 0.0), film.pdf(wi, wo));
                    assert!(f.iter().all(|f| f.is_finite()) && pdf.is_finite(), "{finish:?} {wi} {wo}: {f:?} {pdf}");
                    if let Some(drawn) = film.sample(wi, [0.3, 0.9], 0.0) {
                        assert!(drawn.weight.iter().all(|w| w.is_finite()), "{finish:?} {z} {drawn:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_smooth_surface_reflects_into_the_mirror_direction_alone() {
    let mirror = MirrorTable::new(&[0.25, 0.75], 1, 1.0).unwrap();
    let film = FilmTable::from(mirror);
    let wi = Vec3::new(0.6, 0.0, 0.8);
    let drawn = film.sample(wi, [0.5; 2], 7.0).unwrap();
    assert_eq!((drawn.wo, drawn.pdf), (Vec3::new(-0.6, 0.0, 0.8), None));
    for (weight, rho) in drawn.weight.into_iter().zip(mirror.rgb(libm::acosf(0.8))) {
        // The angle errs by 4e-7, over a table that rises by 1/2.
        assert!((weight - rho).abs() < 4e-7, "{weight} for {rho}");
    }
    assert_eq!((film.eval(wi, drawn.wo, 7.0), film.pdf(wi, drawn.wo)), ([0.0; 3], 0.0));
    assert_eq!(film.sample(-wi, [0.5; 2], 7.0), None);
}

#[test]
fn bad_tables_are_refused() {
    let values = [0.5; 12];
    fn refusal(
        reflectance: &[f32],
        transmittance: &[f32],
        thickness_nm: &[f32],
        channels: usize,
    ) -> Result<(), TableError> {
        FilmTable::new(&FilmArrays { reflectance, transmittance, thickness_nm }, channels, 1.0, None).map(drop)
    }
    assert_eq!(refusal(&values, &values, &[1.0, 2.0], 3), Ok(()));
    assert_eq!(refusal(&values, &values[1..], &[1.0, 2.0], 3), Err(TableError::Shape));
    assert_eq!(refusal(&values, &[], &[], 3), Err(TableError::Shape));
    assert_eq!(refusal(&values, &[], &[1.0], 0), Err(TableError::Shape));
    assert_eq!(refusal(&values, &[], &[1.0, 2.0, 3.0, 4.0], 3), Err(TableError::Shape));
    for thickness in [[1.0, 1.0], [2.0, 1.0], [-1.0, 1.0], [0.0, f32::NAN], [f32::NAN, 1.0], [0.0, 2e9]] {
        assert_eq!(refusal(&values, &[], &thickness, 3), Err(TableError::Thickness), "{thickness:?}");
    }
    let mut beyond = values;
    beyond[7] = f32::INFINITY;
    assert_eq!(refusal(&beyond, &[], &[0.0], 3), Err(TableError::NotFinite { index: 7 }));
    assert_eq!(refusal(&values, &beyond, &[0.0], 3), Err(TableError::NotFinite { index: 19 }));
}
