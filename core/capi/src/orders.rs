//! Diffraction orders of a periodic surface: the light that reaches a viewer by each order at each wavelength.

use crate::memory::{Results, Tagged};
use crate::status::{Status, status_of};
use crate::table::{Table, direction, view};
use goniochrome::table::blob::Contents;
use goniochrome::table::{OrderTable, OrderView as CoreView};

/// Size of a gonio_order_view in bytes.
pub const GONIO_ORDER_VIEW_SIZE: usize = 8 * 32;
/// Alignment of a gonio_order_view in bytes.
pub const GONIO_ORDER_VIEW_ALIGN: usize = 8;

const _: () = assert!(size_of::<OrderView>() == GONIO_ORDER_VIEW_SIZE);
const _: () = assert!(align_of::<OrderView>() == GONIO_ORDER_VIEW_ALIGN);

/// Table of diffraction orders seen from one direction; made by gonio_orders_view. It may be moved, and shared between
/// threads. It refers to the bytes of the table's blob, not to the gonio_table.
#[repr(C)]
#[derive(Debug)]
pub struct OrderView {
    opaque: [u64; 32],
}

/// Numbers of orders and of wavelengths of a table.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OrderCounts {
    /// Number of orders.
    pub orders: u32,
    /// Number of wavelengths.
    pub wavelengths: u32,
}

/// Wavelength of a table of orders.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Wavelength {
    /// Vacuum wavelength in nanometres.
    pub nm: f32,
    /// Linear RGB that a reflectance of 1 at this wavelength adds to a colour. Over all wavelengths they add up to
    /// white.
    pub rgb: [f32; 3],
}

/// Light that reaches the viewer by one order.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct DiffractedLight {
    /// Direction towards the light, a unit vector; zero if the order is evanescent.
    pub direction: [f32; 3],
    /// Share of that light's radiance which the viewer receives, unpolarised; 0 if the order is evanescent.
    pub efficiency: f32,
}

/// Order that was drawn, its light, and the probability of the draw.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OrderSample {
    /// Index of the order.
    pub order: u32,
    /// Light that reaches the viewer by the order.
    pub light: DiffractedLight,
    /// Probability of the draw; 0 if no light reaches the viewer.
    pub probability: f32,
}

/// Light of no order.
const DARK: DiffractedLight = DiffractedLight { direction: [0.0; 3], efficiency: 0.0 };

/// Reads the numbers of orders and of wavelengths of a table of orders.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_count(table: *const Table, counts: *mut OrderCounts) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (table, counts) = unsafe { (orders(table)?, Results::new(counts, 1)?) };
        let (orders, wavelengths) = (table.order_count() as u32, table.wavelength_count() as u32);
        counts.write([OrderCounts { orders, wavelengths }]);
        Ok(())
    })
}

/// Reads the numbers m and n of an order, along x and y.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `numbers` to two integers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_numbers(table: *const Table, order: u32, numbers: *mut i32) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (table, numbers) = unsafe { (orders(table)?, Results::new(numbers, 2)?) };
        numbers.write(table.order(within(order, table.order_count())?));
        Ok(())
    })
}

/// Reads a wavelength and its RGB weight.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_wavelength(
    table: *const Table,
    wavelength: u32,
    result: *mut Wavelength,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (table, result) = unsafe { (orders(table)?, Results::new(result, 1)?) };
        let wavelength = within(wavelength, table.wavelength_count())?;
        result.write([Wavelength { nm: table.wavelength_nm(wavelength), rgb: table.rgb_weight(wavelength) }]);
        Ok(())
    })
}

/// Makes the view of a table of orders from `wo`, the direction towards the viewer in the surface's frame, which lies
/// above the surface and need not be of unit length.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types; `wo` to three floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_view(view: *mut OrderView, table: *const Table, wo: *const f32) -> Status {
    let object = || {
        // SAFETY: the caller's promises.
        let (table, wo) = unsafe { (orders(table)?, direction(wo)?) };
        wo.try_normalize().and_then(|wo| table.view(wo)).ok_or(Status::Direction)
    };
    // SAFETY: the caller's promise.
    status_of(|| unsafe { Tagged::<CoreView<'static>>::write(view, object) })
}

/// Looks up the light that reaches the viewer by an order, at the share `t` in [0, 1] of the way from a wavelength to
/// the next. The radiance that the viewer receives is the sum of efficiency times radiance from each order's direction.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_light(
    view: *const OrderView,
    wavelength: u32,
    t: f32,
    order: u32,
    light: *mut DiffractedLight,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (view, light) = unsafe { (Tagged::<CoreView<'static>>::get(view)?, Results::new(light, 1)?) };
        let (wavelength, order) =
            (within(wavelength, view.table().wavelength_count())?, within(order, view.table().order_count())?);
        if !(0.0..=1.0).contains(&t) {
            return Err(Status::Argument);
        }
        let found = view.light_between(wavelength, t, order);
        light.write([
            found.map_or(DARK, |l| DiffractedLight { direction: l.direction.to_array(), efficiency: l.efficiency })
        ]);
        Ok(())
    })
}

/// Draws an order at a wavelength in proportion to its efficiency, by a number `u` in [0, 1). The estimate of the
/// radiance is efficiency/probability times the radiance from the order's direction.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_sample(
    view: *const OrderView,
    wavelength: u32,
    u: f32,
    sample: *mut OrderSample,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (view, sample) = unsafe { (Tagged::<CoreView<'static>>::get(view)?, Results::new(sample, 1)?) };
        let wavelength = within(wavelength, view.table().wavelength_count())?;
        if !(0.0..1.0).contains(&u) {
            return Err(Status::Argument);
        }
        let none = OrderSample { order: 0, light: DARK, probability: 0.0 };
        sample.write([view.sample(wavelength, u).map_or(none, |drawn| OrderSample {
            order: drawn.order as u32,
            light: DiffractedLight { direction: drawn.direction.to_array(), efficiency: drawn.efficiency },
            probability: drawn.probability,
        })]);
        Ok(())
    })
}

/// Looks up the probability with which gonio_orders_sample draws an order.
///
/// # Safety
/// Pointers that are neither NULL nor misaligned point to objects of their types.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gonio_orders_probability(
    view: *const OrderView,
    wavelength: u32,
    order: u32,
    probability: *mut f32,
) -> Status {
    status_of(|| {
        // SAFETY: the caller's promises.
        let (view, probability) = unsafe { (Tagged::<CoreView<'static>>::get(view)?, Results::new(probability, 1)?) };
        let (wavelength, order) =
            (within(wavelength, view.table().wavelength_count())?, within(order, view.table().order_count())?);
        probability.write([view.probability(wavelength, order)]);
        Ok(())
    })
}

/// Table of orders that a view has been made of.
///
/// # Safety
/// A pointer that is neither null nor misaligned points to a readable table that nobody changes meanwhile.
unsafe fn orders<'a>(table: *const Table) -> Result<&'a OrderTable<'static>, Status> {
    // SAFETY: the caller's promise.
    match unsafe { &view(table)?.contents } {
        Contents::Orders(orders) => Ok(orders),
        _ => Err(Status::WrongKind),
    }
}

/// Index that is below a count.
fn within(index: u32, count: usize) -> Result<usize, Status> {
    let index = index as usize;
    if index < count { Ok(index) } else { Err(Status::Index) }
}
