//! Calls that view, look up and sample tables.

use super::out::Out;
use super::program::{Faults, Program};
use crate::table_blob;
use goniochrome_capi::status::Status;
use goniochrome_capi::table::{
    FacetLobe, GONIO_KIND_FILM, GONIO_KIND_MIRROR, GONIO_KIND_ORDERS, GONIO_KIND_SCATTER, Sample, Table,
    TableDescription, gonio_table_albedo, gonio_table_describe, gonio_table_lobe, gonio_table_lobe_count,
    gonio_table_pdf, gonio_table_reflectance, gonio_table_rgb, gonio_table_sample, gonio_table_view,
};
use std::rc::Rc;

/// A view of a table, and the table's bytes.
pub struct View {
    pub object: Out<Table>,
    pub bytes: Rc<[u8]>,
}

pub fn view(program: &mut Program<'_>, table: &mut Option<View>) {
    let mut faults = program.faults();
    let how = program.byte();
    let count = 8 * usize::from(program.byte());
    let given = program.bytes(count);
    let bytes = match how % 3 {
        0 => table_blob::made(given),
        1 => table_blob::mended(given),
        _ => None,
    };
    // At any alignment.
    let shift = usize::from(how >> 6);
    let mut memory = vec![0; shift];
    memory.extend(bytes.as_deref().unwrap_or(given));
    let memory: Rc<[u8]> = memory.into();
    let mut object = Out::new(1);
    // SAFETY: pointers are NULL, misaligned, to memory for an object, or to as many bytes as stated. The bytes are kept
    // with the object.
    let status = unsafe {
        gonio_table_view(faults.pass_mut(object.pointer()), faults.list(&memory[shift..]), memory.len() - shift)
    };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    if object.succeeded(status) {
        *table = Some(View { object, bytes: memory });
    }
}

/// Calls `call` with an object, or with memory that holds none, and with memory for `count` results. Returns the
/// results if it succeeded.
pub fn ask<O, T>(
    made: Option<&Out<O>>,
    faults: &mut Faults,
    count: usize,
    call: impl FnOnce(&mut Faults, *const O, *mut T) -> Status,
) -> Option<Out<T>> {
    let (nothing, mut results) = (Out::new(1), Out::new(count));
    let object = faults.pass(made.unwrap_or(&nothing).object());
    let place = faults.pass_mut(results.pointer());
    let status = call(faults, object, place);
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    assert!(made.is_some() || status != Status::Ok, "nothing was made, and answered");
    results.succeeded(status).then_some(results)
}

/// A direction, of unit length or of any other.
pub fn direction(program: &mut Program<'_>) -> [f32; 3] {
    let unit = program.byte() & 1 == 0;
    let v = [-1.0, -1.0, -0.2].map(|low| program.number(low, 1.0));
    let length = if unit { v.iter().map(|x| x * x).sum::<f64>().sqrt() } else { 1.0 };
    v.map(|x| (x / length) as f32)
}

pub fn describe(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    // SAFETY: pointers are NULL, misaligned, or to what they should be.
    let found = ask(table.map(|table| &table.object), &mut faults, 1, |_, table, place| unsafe {
        gonio_table_describe(table, place)
    });
    let Some(found) = found else { return };
    let TableDescription { kind, channels, space } = found.results()[0];
    let kinds = [GONIO_KIND_MIRROR, GONIO_KIND_SCATTER, GONIO_KIND_ORDERS, GONIO_KIND_FILM];
    assert!(kinds.contains(&kind) && channels > 0 && space <= 4);
}

pub fn reflectance(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let cos_theta = program.number(0.0, 1.0) as f32;
    // SAFETY: as above.
    let rgb = ask(table.map(|table| &table.object), &mut faults, 3, |_, table, place| unsafe {
        gonio_table_reflectance(table, cos_theta, place)
    });
    assert!(
        rgb.is_none_or(|rgb| (0.0..=1.0).contains(&cos_theta) && rgb.results().iter().all(|x: &f32| x.is_finite()))
    );
}

pub fn rgb(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (wi, wo) = (direction(program), direction(program));
    let rgb = ask(table.map(|table| &table.object), &mut faults, 3, |faults, table, place| {
        let (wi, wo) = (faults.pass(wi.as_ptr()), faults.pass(wo.as_ptr()));
        // SAFETY: as above.
        unsafe { gonio_table_rgb(table, wi, wo, place) }
    });
    let Some(rgb) = rgb else { return };
    assert!(rgb.results().iter().all(|x: &f32| x.is_finite()));
    assert!((wi[2] > 0.0 && wo[2] > 0.0) || rgb.results() == [0.0; 3]);
}

pub fn pdf(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (wi, wo) = (direction(program), direction(program));
    let pdf = ask(table.map(|table| &table.object), &mut faults, 1, |faults, table, place| {
        let (wi, wo) = (faults.pass(wi.as_ptr()), faults.pass(wo.as_ptr()));
        // SAFETY: as above.
        unsafe { gonio_table_pdf(table, wi, wo, place) }
    });
    assert!(pdf.is_none_or(|pdf| pdf.results()[0] >= 0.0f32 && pdf.results()[0].is_finite()));
}

pub fn albedo(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let wi = direction(program);
    let rgb = ask(table.map(|table| &table.object), &mut faults, 3, |faults, table, place| {
        let wi = faults.pass(wi.as_ptr());
        // SAFETY: as above.
        unsafe { gonio_table_albedo(table, wi, place) }
    });
    let Some(rgb) = rgb else { return };
    assert!(rgb.results().iter().all(|x: &f32| x.is_finite()));
    assert!(wi[2] > 0.0 || rgb.results() == [0.0; 3]);
}

pub fn lobe(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let (wi, index) = (direction(program), u32::from(program.byte() & 3));
    let mut none = Faults::none();
    // SAFETY: as above.
    let count = ask(table.map(|table| &table.object), &mut none, 1, |_, table, place| unsafe {
        gonio_table_lobe_count(table, place)
    });
    let lobe = ask(table.map(|table| &table.object), &mut faults, 1, |faults, table, place| {
        let wi = faults.pass(wi.as_ptr());
        // SAFETY: as above.
        unsafe { gonio_table_lobe(table, wi, index, place) }
    });
    let Some(lobe) = lobe else { return };
    assert!(count.is_some_and(|count| index < count.results()[0]), "a lobe that is not there");
    let FacetLobe { direction, reflectance } = lobe.results()[0];
    assert!(direction.iter().chain(&reflectance).all(|x| x.is_finite()));
    assert!(direction[2] > 0.0 || (direction, reflectance) == ([0.0; 3], [0.0; 3]));
}

pub fn sample(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let wi = direction(program);
    let u = [program.number(0.0, 1.0), program.number(0.0, 1.0)].map(|u| u as f32);
    let sample = ask(table.map(|table| &table.object), &mut faults, 1, |faults, table, place| {
        let (wi, u) = (faults.pass(wi.as_ptr()), faults.pass(u.as_ptr()));
        // SAFETY: as above.
        unsafe { gonio_table_sample(table, wi, u, place) }
    });
    let Some(sample) = sample else { return };
    check_sample(wi, u, sample.results()[0]);
}

/// Checks a sample that was drawn.
pub fn check_sample(wi: [f32; 3], u: [f32; 2], sample: Sample) {
    let Sample { wo, pdf, weight } = sample;
    assert!(wi[2] > 0.0 && u.iter().all(|u| (0.0..1.0).contains(u)));
    assert!(wo.iter().all(|x| x.is_finite()) && wo[2] > 0.0, "{wo:?}");
    // If a blob's sampler does not belong to its table, a weight may exceed single precision, but it is never NaN.
    assert!(pdf >= 0.0 && pdf.is_finite() && !weight.iter().any(|w| w.is_nan()), "{pdf} {weight:?}");
}
