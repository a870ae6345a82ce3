//! Fuzz target: any sequence of calls of the C interface.
#![no_main]

#[path = "../checks/capi/mod.rs"]
mod capi;
#[path = "../../tests/scalar.rs"]
#[allow(dead_code, reason = "transmission is not in the C interface")]
mod scalar;
#[path = "../checks/table_blob.rs"]
#[allow(dead_code, reason = "only blobs are made here")]
mod table_blob;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| capi::check(bytes));
