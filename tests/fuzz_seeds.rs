//! Every seed of the fuzz targets, and every input that once made one fail, replayed without a fuzzer.

#[path = "../fuzz/checks/mod.rs"]
mod checks;

/// Runs `check` on every file of a target's seeds, which must be some.
fn replay(target: &str, check: fn(&[u8])) {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds").join(target);
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

#[test]
fn seeds_of_exr_table_hold() {
    replay("exr_table", checks::exr_table::check);
}

#[test]
fn seeds_of_nk_yaml_hold() {
    replay("nk_yaml", checks::nk_yaml::check);
}

#[test]
fn seeds_of_obj_hold() {
    replay("obj", checks::obj::check);
}

#[test]
fn seeds_of_scene_file_hold() {
    replay("scene_file", checks::scene_file::check);
}

#[test]
fn seeds_of_trace_cell_hold() {
    replay("trace_cell", checks::trace_cell::check);
}

#[test]
fn seeds_of_trace_stack_hold() {
    replay("trace_stack", checks::trace_stack::check);
}
