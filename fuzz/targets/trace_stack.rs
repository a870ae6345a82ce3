//! Any planar stack: the closed form and both sums of rays hold to the scalar twin, and the ledger to energy.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::trace_stack::check(bytes));
