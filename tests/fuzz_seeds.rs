//! Replays the seeds of the fuzz targets, among them every input that once made one fail, without a fuzzer.

#[path = "../fuzz/checks/mod.rs"]
mod checks;

mod replay;

use replay::replay;

#[test]
fn seeds_of_environment_hold() {
    replay("environment", checks::environment::check);
}

#[test]
fn seeds_of_exr_table_hold() {
    replay("exr_table", checks::exr_table::check);
}

#[test]
fn seeds_of_grey_map_hold() {
    replay("grey_map", checks::grey_map::check);
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
fn seeds_of_table_blob_hold() {
    replay("table_blob", checks::table_blob::check);
}

#[test]
fn seeds_of_trace_cell_hold() {
    replay("trace_cell", checks::trace_cell::check);
}

#[test]
fn seeds_of_trace_stack_hold() {
    replay("trace_stack", checks::trace_stack::check);
}
