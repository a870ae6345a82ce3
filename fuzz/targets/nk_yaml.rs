//! Fuzz target: any text as a refractive index file.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::nk_yaml::check(bytes));
