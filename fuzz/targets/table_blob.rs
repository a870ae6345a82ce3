//! Any bytes as a table blob. What is read gives numbers wherever it may be asked.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::table_blob::check(bytes));
