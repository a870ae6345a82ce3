//! Any text as a scene file. A scene that is read can be laid out and traced.
#![no_main]

#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::scene_file::check(bytes));
