//! The direction of flow inside the core: a module uses only those to its left.

use std::fs;
use std::path::Path;

const FLOW: &[&str] = &[
    "lanes",
    "double_double",
    "sampling",
    "complex",
    "vector",
    "turns",
    "incidence",
    "medium",
    "interface",
    "stack",
    "rounding",
    "coating",
    "bvh",
    "cell",
    "mesh",
    "trace",
    "paths",
    "coherence",
    "layers",
    "polygons",
    "geometric",
    "bins",
    "orders",
    "table",
    "colour",
];

/// Every `crate::name` in the code of a source text; documentation may point anywhere.
fn uses(source: &str) -> impl Iterator<Item = &str> {
    let code = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.flat_map(|line| line.split("crate::").skip(1)).map(|rest| {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(rest.len());
        &rest[..end]
    })
}

fn source(module: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/src");
    fs::read_to_string(folder.join(format!("{module}.rs")))
        .or_else(|_| fs::read_to_string(folder.join(module).join("mod.rs")))
        .expect("every module of the flow has a file")
}

#[test]
fn modules_use_only_what_stands_to_their_left() {
    for (place, module) in FLOW.iter().enumerate() {
        for used in uses(&source(module)) {
            let from = FLOW.iter().position(|m| *m == used);
            assert!(from.is_some_and(|from| from < place), "core/src/{module}.rs uses crate::{used}");
        }
    }
}

#[test]
fn the_flow_names_every_module() {
    let lib = source("lib");
    let mut modules: Vec<&str> =
        lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    let mut flow = FLOW.to_vec();
    modules.sort_unstable();
    flow.sort_unstable();
    assert_eq!(modules, flow);
}

#[test]
fn the_core_depends_on_few_packages() {
    /// Fewer than a reader can check in an afternoon.
    const MAX: usize = 6;
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../core/Cargo.toml");
    let manifest = fs::read_to_string(manifest).expect("the core has a manifest");
    let (_, rest) = manifest.split_once("\n[dependencies]\n").expect("a list of dependencies");
    let direct = rest.lines().take_while(|line| !line.starts_with('[')).filter(|line| line.contains('=')).count();
    println!("the core has {direct} direct dependencies");
    assert!((1..=MAX).contains(&direct), "{direct}");
    assert!(!manifest.contains("build-dependencies") && !manifest.contains("build ="), "no build script");
}
