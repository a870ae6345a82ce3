//! Any sequence of calls of the C interface: a status for each, and results that obey the laws.
#![no_main]

#[path = "../checks/capi/mod.rs"]
mod capi;
#[path = "../../tests/scalar.rs"]
#[allow(dead_code, reason = "transmission is not in the C interface")]
mod scalar;
#[path = "../checks/table_blob.rs"]
#[allow(dead_code, reason = "only what makes blobs is used here")]
mod table_blob;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| capi::check(bytes));
