//! C interface of goniochrome. cbindgen generates `include/goniochrome.h` from this crate.
//!
//! Every function checks its pointers and then calls the core. All unsafe code of the project is in [`memory`], in the
//! functions that C calls, and in [`cell`], which divides the caller's memory. Nothing here keeps state, allocates or
//! panics: `tests/run` checks that the library contains no panic.
//!
//! The crate is `no_std` where panics abort. The workspace's development profiles unwind, which requires `std`.
#![cfg_attr(panic = "abort", no_std)]

pub mod status;
mod memory;
pub mod media;
pub mod colour;
pub mod stack;
pub mod cell;
pub mod table;
pub mod film;
pub mod orders;

use core::ffi::{CStr, c_char};
use goniochrome::simd::lanes::simd_level;

#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}

/// Copies a text into `N` bytes, with the NUL that ends it in C.
const fn c_text<const N: usize>(text: &str) -> [u8; N] {
    let mut bytes = [0; N];
    let (head, _) = bytes.split_at_mut(text.len());
    head.copy_from_slice(text.as_bytes());
    bytes
}

/// Version of the library, such as "0.1.0".
#[unsafe(no_mangle)]
pub extern "C" fn gonio_version() -> *const c_char {
    const VERSION: &[u8] = concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes();
    VERSION.as_ptr().cast()
}

/// Instruction set that the library was compiled for: "avx512", "avx2+fma", "avx", "sse2", "neon", "simd128" or
/// "scalar".
#[unsafe(no_mangle)]
pub extern "C" fn gonio_simd_level() -> *const c_char {
    static LEVEL: [u8; 16] = c_text(simd_level());
    LEVEL.as_ptr().cast()
}

const _: () = assert!(CStr::from_bytes_until_nul(&c_text::<16>(simd_level())).is_ok());
