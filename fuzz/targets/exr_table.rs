//! Any bytes as a table. What is read is a sound table, and survives being written and read again.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::exr_table::check(bytes));
