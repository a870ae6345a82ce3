//! Fuzz target: any bytes as a table blob.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::table_blob::check(bytes));
