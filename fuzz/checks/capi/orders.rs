//! Calls that look up and draw diffraction orders.

use super::out::Out;
use super::program::Program;
use super::tables::{View, ask, direction};
use goniochrome_capi::orders::{
    DiffractedLight, OrderCounts, OrderSample, OrderView, Wavelength, gonio_orders_count, gonio_orders_light,
    gonio_orders_numbers, gonio_orders_probability, gonio_orders_sample, gonio_orders_view, gonio_orders_wavelength,
};
use goniochrome_capi::status::Status;
use std::rc::Rc;

/// A view of orders, and the table's bytes.
pub struct Seen {
    object: Out<OrderView>,
    _bytes: Rc<[u8]>,
}

pub fn view(program: &mut Program<'_>, table: Option<&View>, seen: &mut Option<Seen>) {
    let mut faults = program.faults();
    let wo = direction(program);
    let nothing = Out::new(1);
    let mut object = Out::new(1);
    let place = faults.pass_mut(object.pointer());
    let from = faults.pass(table.map_or(&nothing, |table| &table.object).object());
    // SAFETY: pointers are NULL, misaligned, or to what they should be.
    let status = unsafe { gonio_orders_view(place, from, faults.pass(wo.as_ptr())) };
    assert!(!(faults.hit() && status == Status::Ok), "a bad pointer was taken");
    assert!(table.is_some() || status != Status::Ok, "nothing was made, and answered");
    if let (true, Some(table)) = (object.succeeded(status), table) {
        assert!(wo[2] > 0.0, "{wo:?} is below the surface");
        *seen = Some(Seen { object, _bytes: Rc::clone(&table.bytes) });
    }
}

/// Reads the counts, and the order and wavelength of an index, which may be beyond the last.
pub fn describe(program: &mut Program<'_>, table: Option<&View>) {
    let mut faults = program.faults();
    let index = u32::from(program.byte());
    let object = table.map(|table| &table.object);
    // SAFETY: as above.
    let counts = ask(object, &mut faults, 1, |_, table, place| unsafe { gonio_orders_count(table, place) });
    let numbers = ask(object, &mut faults, 2, |_, table, place| unsafe { gonio_orders_numbers(table, index, place) });
    let mut faults = program.faults();
    let wavelength =
        ask(object, &mut faults, 1, |_, table, place| unsafe { gonio_orders_wavelength(table, index, place) });
    let Some(counts) = counts else { return };
    let OrderCounts { orders, wavelengths } = counts.results()[0];
    assert!(orders > 0 && wavelengths > 0);
    assert!(numbers.is_none() || index < orders);
    if let Some(wavelength) = wavelength {
        let Wavelength { nm, rgb } = wavelength.results()[0];
        assert!(index < wavelengths && nm > 0.0 && rgb.iter().all(|c| c.is_finite()), "{nm} {rgb:?}");
    }
}

fn check(light: DiffractedLight) {
    /// Rounding of a unit vector's squared length.
    const ROUNDING: f32 = 8.0 * f32::EPSILON;
    let DiffractedLight { direction, efficiency } = light;
    let length: f32 = direction.iter().map(|x| x * x).sum();
    assert!(efficiency >= 0.0 && efficiency.is_finite(), "{light:?}");
    assert!(
        (length == 0.0 && efficiency == 0.0) || ((length - 1.0).abs() < ROUNDING && direction[2] > 0.0),
        "{light:?}"
    );
}

pub fn light(program: &mut Program<'_>, seen: Option<&Seen>) {
    let mut faults = program.faults();
    let (wavelength, order) = (u32::from(program.byte()), u32::from(program.byte()));
    let t = program.number(0.0, 1.0) as f32;
    let object = seen.map(|seen| &seen.object);
    let light = ask(object, &mut faults, 1, |_, view, place| {
        // SAFETY: as above.
        unsafe { gonio_orders_light(view, wavelength, t, order, place) }
    });
    if let Some(light) = light {
        assert!((0.0..=1.0).contains(&t));
        check(light.results()[0]);
    }
    let mut faults = program.faults();
    let probability = ask(object, &mut faults, 1, |_, view, place| {
        // SAFETY: as above.
        unsafe { gonio_orders_probability(view, wavelength, order, place) }
    });
    assert!(probability.is_none_or(|probability| (0.0..=1.0f32).contains(&probability.results()[0])));
}

pub fn sample(program: &mut Program<'_>, seen: Option<&Seen>) {
    let mut faults = program.faults();
    let wavelength = u32::from(program.byte());
    let u = program.number(0.0, 1.0) as f32;
    let sample = ask(seen.map(|seen| &seen.object), &mut faults, 1, |_, view, place| {
        // SAFETY: as above.
        unsafe { gonio_orders_sample(view, wavelength, u, place) }
    });
    let Some(sample) = sample else { return };
    let OrderSample { light, probability, .. } = sample.results()[0];
    assert!((0.0..1.0).contains(&u) && (0.0..=1.0).contains(&probability));
    assert_eq!(light.efficiency > 0.0, probability > 0.0, "{light:?}");
    check(light);
}
