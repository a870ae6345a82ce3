//! The `goniochrome` command.
fn main() {}
