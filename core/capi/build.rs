//! Gives the dynamic library the name under which programs ask for it: libgoniochrome.so.0, whatever its file is
//! called.
//!
//! The number counts incompatible changes of the interface.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let of_target = |name: &str| std::env::var(name).unwrap_or_default();
    // Elsewhere linkers have no such option.
    if of_target("CARGO_CFG_TARGET_OS") == "linux" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libgoniochrome.so.0");
    }
}
