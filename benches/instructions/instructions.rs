//! `instructions`: runs each stage's work once to warm up and once inside `counted`, where callgrind counts. Prints the
//! names of the work in order.

use std::hint::black_box;

use goniochrome::simd::lanes::{F32, F64};
use goniochrome_benches::stages::{Stage, Work, bvh, cell, coherence, colour, interface, phase, planar, stack, table};

/// Runs what callgrind counts, which knows this function by its name.
#[inline(never)]
fn counted(run: &mut dyn FnMut()) {
    run();
    black_box(());
}

fn main() {
    let stages: [(&str, Stage); 15] = [
        ("f32", phase::<F32>),
        ("f32", interface::<F32>),
        ("f32", stack::<F32>),
        ("f32", planar::<F32>),
        ("f32", coherence::<F32>),
        ("f32", cell::<F32>),
        ("f64", phase::<F64>),
        ("f64", interface::<F64>),
        ("f64", stack::<F64>),
        ("f64", planar::<F64>),
        ("f64", coherence::<F64>),
        ("f64", cell::<F64>),
        ("", bvh),
        ("", table),
        ("", colour),
    ];
    for (lanes, stage) in stages {
        stage(&mut |work: &Work, run: &mut dyn FnMut()| {
            run();
            counted(run);
            println!("{}/{}{}{lanes}", work.stage, work.name, if lanes.is_empty() { "" } else { "/" });
        });
    }
}
