//! Tests of the direction of flow in the core, its C interface, the solvers of waves and the command line: a module
//! uses only modules declared above it.
//!
//! The order is that of the `mod` lines in `lib.rs` and in each `mod.rs`. A module may use all modules inside it, or be
//! used by them, but not both at once. Tests and documentation may use everything.

mod analyser_tests;
mod source;
mod uses;

use std::fs;
use std::path::Path;

use uses::Crate;

const CRATES: [&str; 4] = ["core", "core/capi", "cli", "cli/waves"];

/// The only module of the command line's library that may use its arguments.
const COMMANDS: &str = "crate::commands";

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace holds this package")
}

fn read(package: &str) -> Crate {
    let root = Path::new(package).join("src/lib.rs");
    Crate::read(&root, &|file| fs::read_to_string(workspace().join(file)).ok())
}

#[test]
fn modules_use_only_those_declared_above_them() {
    let faults: Vec<String> = CRATES.iter().flat_map(|package| read(package).faults()).collect();
    assert!(faults.is_empty(), "{} uses against the flow:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn only_commands_know_the_command_line() {
    let faults = read("cli").users_of(COMMANDS, &["clap"]);
    assert!(faults.is_empty(), "{} uses of the command line:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn the_core_depends_on_few_packages() {
    /// Largest number of direct dependencies: as many as a reader can check in an afternoon.
    const MAX: usize = 6;
    let manifest = fs::read_to_string(workspace().join("core/Cargo.toml")).expect("the core has a manifest");
    let (_, rest) = manifest.split_once("\n[dependencies]\n").expect("a list of dependencies");
    let direct = rest.lines().take_while(|line| !line.starts_with('[')).filter(|line| line.contains('=')).count();
    println!("the core has {direct} direct dependencies");
    assert!((1..=MAX).contains(&direct), "{direct}");
    assert!(!manifest.contains("build-dependencies") && !manifest.contains("build ="), "no build script");
}
