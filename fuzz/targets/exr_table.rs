//! Fuzz target: any bytes as a table file.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::exr_table::check(bytes));
