//! Fuzz target: any bytes as an environment map.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::environment::check(bytes));
