//! Replays the seeds of the fuzz target `capi`, among them every input that once made it fail, without a fuzzer.

#[path = "../../../fuzz/checks/capi/mod.rs"]
mod capi;
#[path = "../../replay.rs"]
mod replay;
#[path = "../../scalar.rs"]
#[allow(dead_code, reason = "transmission is not in the C interface")]
mod scalar;
#[path = "../../../fuzz/checks/table_blob.rs"]
#[allow(dead_code, reason = "only blobs are made here")]
mod table_blob;

#[test]
fn seeds_of_capi_hold() {
    replay::replay("capi", capi::check);
}
