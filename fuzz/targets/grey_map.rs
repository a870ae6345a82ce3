//! Fuzz target: any bytes as a map of heights.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::grey_map::check(bytes));
