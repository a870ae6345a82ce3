//! The core as a static library without `std`: what `run` looks through for symbols of an allocator and of panics. Its
//! functions take what only the caller knows, so that no path can be decided when it is compiled.
#![no_std]

mod cell;
mod film;
mod table;

use core::panic::PanicInfo;

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {}
}
