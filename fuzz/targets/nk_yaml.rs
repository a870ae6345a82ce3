//! Any text as a refractive index file. What is read is passive wherever it can be evaluated.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::nk_yaml::check(bytes));
