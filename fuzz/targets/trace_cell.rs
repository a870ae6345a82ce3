//! Fuzz target: the tracers on any cell of one to three bumpy sheets.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::trace_cell::check(bytes));
