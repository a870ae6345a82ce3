//! Energy compensation of finishes: what several bounces return.

use glam::Vec3;
use goniochrome::microfacet::{Compensation, Distribution, Finish, Masking, mean_reflectance};
use goniochrome::table::{FilmArrays, FilmTable, TableError};
use std::f64::consts::{FRAC_PI_2, TAU};

use crate::finish::{Rough, analytic, check_samples, direction, tabulated_finishes};
use crate::random::Random;

/// A finish with compensation, in memory that stays for the rest of the test.
fn compensated(finish: Finish<'static>) -> Finish<'static> {
    finish.compensated(vec![0.0; Compensation::LEN].leak()).unwrap()
}

/// A white surface of a finish, with what it returns.
fn white(finish: Finish<'static>) -> FilmTable<'static> {
    let arrays = FilmArrays { reflectance: &[1.0; 2], transmittance: &[], thickness_nm: &[0.0] };
    let returned = finish.compensation().map(|compensation| vec![compensation.returned(1.0)]);
    let table = FilmTable::new(&arrays, 1, 1.5, Some(finish)).unwrap();
    table.with_returned(returned.unwrap().leak()).unwrap()
}

/// Fraction of the light from `wi` that a surface reflects, by midpoints over θ_o and φ_o.
fn albedo(table: &FilmTable<'_>, wi: Vec3) -> f64 {
    const STEPS: [u32; 2] = [400, 400];
    let mut sum = 0.0;
    for i in 0..STEPS[0] {
        let theta = (f64::from(i) + 0.5) / f64::from(STEPS[0]) * FRAC_PI_2;
        for j in 0..STEPS[1] {
            let wo = direction(theta, (f64::from(j) + 0.5) / f64::from(STEPS[1]) * TAU);
            sum += theta.sin() * theta.cos() * f64::from(table.eval(wi, wo, 0.0)[0]);
        }
    }
    sum * FRAC_PI_2 * TAU / f64::from(STEPS[0] * STEPS[1])
}

const ANGLES: [f64; 5] = [0.0, 0.7, 1.1, 1.35, 1.5];

#[test]
fn white_facets_reflect_all_light() {
    /// Asked of the strong white furnace.
    const FURNACE: f64 = 1e-3;
    let both = [Distribution::Ggx, Distribution::Beckmann];
    let maskings = [Masking::Correlated, Masking::Separable];
    let analytic = both.into_iter().flat_map(|distribution| {
        maskings.into_iter().flat_map(move |masking| {
            [0.1, 0.5, 1.0].map(|alpha| Rough {
                finish: Finish::new(distribution, masking, [alpha; 2]).unwrap(),
                alpha: [alpha; 2],
            })
        })
    });
    for Rough { finish, alpha } in analytic.chain(tabulated_finishes().filter(|rough| rough.finish.is_isotropic())) {
        let table = white(compensated(finish));
        // Narrow lobes beside the horizon fall between the steps of the sum.
        for theta in ANGLES.into_iter().filter(|theta| alpha[0] >= 0.3 || *theta < 1.4) {
            let albedo = albedo(&table, direction(theta, 0.3));
            let which = (finish.distribution(), finish.masking());
            println!("{which:?} {alpha:?} {theta}: {:.1e}", albedo - 1.0);
            assert!((albedo - 1.0).abs() < FURNACE, "{which:?} {alpha:?} {theta}: {albedo}");
        }
    }
}

#[test]
fn facets_that_differ_along_x_and_y_reflect_all_light_on_average() {
    const FURNACE: f64 = 1e-3;
    const AZIMUTHS: u32 = 12;
    for finish in [analytic(Distribution::Ggx, [0.2, 0.6]), analytic(Distribution::Beckmann, [0.7, 0.3])] {
        let table = white(compensated(finish));
        for theta in ANGLES {
            let of = |i: u32| albedo(&table, direction(theta, (f64::from(i) + 0.5) / f64::from(AZIMUTHS) * 0.25 * TAU));
            let albedos: Vec<f64> = (0..AZIMUTHS).map(of).collect();
            let mean = albedos.iter().sum::<f64>() / f64::from(AZIMUTHS);
            println!("{theta}: {mean} {albedos:.3?}");
            assert!((mean - 1.0).abs() < FURNACE, "{theta}: {mean}");
        }
    }
}

#[test]
fn samples_are_as_dense_as_evaluation_says() {
    let rough = |distribution, alpha| Rough { finish: compensated(analytic(distribution, alpha)), alpha };
    let tabulated = tabulated_finishes().nth(2).unwrap();
    check_samples(
        [
            rough(Distribution::Ggx, [1.0; 2]),
            rough(Distribution::Beckmann, [0.7, 0.15]),
            Rough { finish: compensated(tabulated.finish), ..tabulated },
        ]
        .into_iter(),
    );
}

#[test]
fn directions_may_be_exchanged_and_weights_are_those_of_evaluation() {
    /// Rounding of some twenty operations in single precision.
    const ROUNDING: f32 = 1e-5;
    let reflectance: Vec<f32> = (0..12).map(|i| 0.08 * i as f32).collect();
    let arrays = FilmArrays { reflectance: &reflectance, transmittance: &[], thickness_nm: &[100.0, 300.0] };
    let returned = [0.1, 0.2, 0.3, 0.5, 0.7, 0.9];
    let mut random = Random(11);
    for finish in [analytic(Distribution::Ggx, [0.4, 0.8]), tabulated_finishes().next().unwrap().finish] {
        let finish = compensated(finish);
        let losses = finish.compensation().unwrap();
        let table = FilmTable::new(&arrays, 3, 1.5, Some(finish)).unwrap().with_returned(&returned).unwrap();
        for _ in 0..500 {
            let mut any = || direction(random.between(0.0, 1.0).acos(), random.between(0.0, TAU));
            let (wi, wo) = (any(), any());
            let lobe = finish.lobe(wi, wo).unwrap();
            assert_eq!(lobe.multiple, losses.loss(wi.z) * losses.loss(wo.z));
            assert_eq!(lobe.multiple, finish.lobe(wo, wi).unwrap().multiple);
            // A quarter of the way between the thicknesses.
            let rho = table.reflectance(lobe.cos_d, 150.0);
            let expected = [0.2, 0.325, 0.45].map(|returned| returned * lobe.multiple);
            for ((f, rho), expected) in table.eval(wi, wo, 150.0).into_iter().zip(rho).zip(expected) {
                assert!((f - rho * lobe.value - expected).abs() <= ROUNDING * f, "{f} {rho} {expected}");
            }
            let u = [random.between(0.0, 1.0), random.between(0.0, 1.0)].map(|u| u as f32);
            let Some(drawn) = table.sample(wi, u, 150.0) else { continue };
            let (f, pdf) = table.eval_and_pdf(wi, drawn.wo, 150.0);
            assert_eq!(drawn.pdf, Some(pdf));
            for (f, weight) in f.into_iter().zip(drawn.weight) {
                assert!((f * drawn.wo.z / pdf - weight).abs() <= ROUNDING * weight, "{f} {weight}");
            }
        }
        assert!(finish.lobe(Vec3::X, Vec3::Z).is_none());
    }
}

#[test]
fn what_cannot_be_returned_is_refused() {
    let arrays = FilmArrays { reflectance: &[0.5; 6], transmittance: &[], thickness_nm: &[0.0] };
    let ggx = analytic(Distribution::Ggx, [0.5; 2]);
    let table = |finish| FilmTable::new(&arrays, 3, 1.0, finish).unwrap();
    let refusal = |finish, returned| table(finish).with_returned(returned).map(drop);
    assert_eq!(refusal(None, &[0.1; 3]), Err(TableError::Finish));
    assert_eq!(refusal(Some(ggx), &[0.1; 3]), Err(TableError::Finish));
    let finish = Some(compensated(ggx));
    assert_eq!(refusal(finish, &[0.1; 2]), Err(TableError::Shape));
    assert_eq!(refusal(finish, &[0.1, f32::NAN, 0.1]), Err(TableError::NotFinite { index: 1 }));
    assert_eq!(refusal(finish, &[0.1; 3]), Ok(()));
    // Without what several bounces return, they return nothing.
    let (wi, wo) = (direction(0.5, 0.1), direction(0.9, 2.0));
    let plain = table(Some(ggx)).eval(wi, wo, 0.0);
    assert_eq!(table(finish).eval(wi, wo, 0.0), plain);
    assert_eq!(mean_reflectance([[0.0, 0.5], [1.0, 0.5]]), 0.5);
}
