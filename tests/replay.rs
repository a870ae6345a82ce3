//! Replay of a fuzz target's seeds without a fuzzer.

use std::path::Path;

/// Runs `check` on every seed of a target, of which there must be one at least.
pub fn replay(target: &str, check: fn(&[u8])) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let seeds = root.ancestors().map(|folder| folder.join("fuzz/seeds")).find(|seeds| seeds.is_dir());
    let folder = seeds.expect("the package lies in the repository").join(target);
    let files = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut count = 0;
    for file in files {
        let path = file.expect("the folder is readable").path();
        println!("{}", path.display());
        check(&std::fs::read(&path).expect("the file is readable"));
        count += 1;
    }
    assert!(count > 0, "{target} has no seeds");
}
