//! Fuzz target: any text as a scene file.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::scene_file::check(bytes));
