//! Any text as a mesh, and then as a cell of horizontal planes.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::obj::check(bytes));
