//! Fuzz target: the planar solvers on any stack.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::trace_stack::check(bytes));
