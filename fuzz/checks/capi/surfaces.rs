//! Calls that look up and sample mirror-like surfaces of any thickness and finish.

use super::program::Program;
use super::tables::{View, ask, check_sample, direction};
use goniochrome_capi::film::{
    FilmDescription, GONIO_FINISH_BECKMANN_SEPARABLE, GONIO_FINISH_NONE, gonio_film_describe, gonio_film_reflectance,
    gonio_film_rgb, gonio_film_sample, gonio_film_transmittance,
};
use goniochrome_capi::table::Sample;

pub fn describe(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    // SAFETY: pointers are NULL, misaligned, or to what they should be.
    let found = ask(table.map(|table| &table.object), &mut faults, 1, |_, table, place| unsafe {
        gonio_film_describe(table, place)
    });
    let Some(found) = found else { return };
    let FilmDescription { thicknesses, range_nm: [first, last], transparent, finish, roughness } = found.results()[0];
    assert!(thicknesses > 0 && transparent <= 1 && finish <= GONIO_FINISH_BECKMANN_SEPARABLE);
    assert!(if thicknesses == 1 { first == last } else { 0.0 <= first && first < last });
    let rough = roughness.iter().all(|alpha| (1e-3..=1.0).contains(alpha));
    assert!(if finish == GONIO_FINISH_NONE { roughness == [0.0; 2] } else { rough });
}

pub fn at_angle(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (cos_theta, nm) = (program.number(0.0, 1.0) as f32, program.number(0.0, 1000.0) as f32);
    let call = if program.byte() & 1 == 0 { gonio_film_reflectance } else { gonio_film_transmittance };
    // SAFETY: as above.
    let rgb = ask(table.map(|table| &table.object), &mut faults, 3, |_, table, place| unsafe {
        call(table, cos_theta, nm, place)
    });
    let Some(rgb) = rgb else { return };
    assert!((0.0..=1.0).contains(&cos_theta) && (0.0..=1e9).contains(&nm));
    assert!(rgb.results().iter().all(|x: &f32| x.is_finite()));
}

pub fn rgb(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (wi, wo, nm) = (direction(program), direction(program), program.number(0.0, 1000.0) as f32);
    let rgb = ask(table.map(|table| &table.object), &mut faults, 3, |faults, table, place| {
        let (wi, wo) = (faults.pass(wi.as_ptr()), faults.pass(wo.as_ptr()));
        // SAFETY: as above.
        unsafe { gonio_film_rgb(table, wi, wo, nm, place) }
    });
    let Some(rgb) = rgb else { return };
    assert!(rgb.results().iter().all(|x: &f32| x.is_finite()) && (0.0..=1e9).contains(&nm));
    assert!((wi[2] > 0.0 && wo[2] > 0.0) || rgb.results() == [0.0; 3]);
}

pub fn sample(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (wi, nm) = (direction(program), program.number(0.0, 1000.0) as f32);
    let u = [program.number(0.0, 1.0), program.number(0.0, 1.0)].map(|u| u as f32);
    let sample = ask(table.map(|table| &table.object), &mut faults, 1, |faults, table, place| {
        let (wi, u) = (faults.pass(wi.as_ptr()), faults.pass(u.as_ptr()));
        // SAFETY: as above.
        unsafe { gonio_film_sample(table, wi, u, nm, place) }
    });
    let Some(sample) = sample else { return };
    let sample: Sample = sample.results()[0];
    assert!((0.0..=1e9).contains(&nm));
    check_sample(wi, u, sample);
}
