//! Fuzzing of the C interface with any sequence of calls, among them NULL and misaligned pointers, numbers out of range
//! and too little memory. Each call returns a status. Results are written only on success, and obey the laws of
//! physics.

mod cells;
mod films;
mod media;
mod orders;
mod out;
mod program;
mod surfaces;
mod tables;

use goniochrome_capi::status::gonio_status_text;
use program::Program;
use std::ffi::CStr;

/// Largest number of calls in one sequence.
const MAX_CALLS: usize = 24;

/// Checks any bytes as a program of letters, each with its arguments.
pub fn check(bytes: &[u8]) {
    let mut program = Program(bytes);
    let (mut films, mut colours, mut cell, mut table, mut seen) = (None, None, None, None, None);
    for _ in 0..MAX_CALLS {
        let Some(operation) = program.next() else { return };
        let program = &mut program;
        match operation {
            b'S' => films::make_films(program, &mut films),
            b'R' => films::reflectance(program, films.as_ref()),
            b'C' => films::make_colours(program, &mut colours),
            b'G' => films::rgb(program, films.as_ref(), colours.as_ref()),
            b'M' => cells::make(program, &mut cell),
            b'T' => cells::trace(program, cell.as_ref()),
            b'B' => tables::view(program, &mut table),
            b'd' => tables::describe(program, table.as_ref()),
            b'm' => tables::reflectance(program, table.as_ref()),
            b'f' => tables::rgb(program, table.as_ref()),
            b'p' => tables::pdf(program, table.as_ref()),
            b's' => tables::sample(program, table.as_ref()),
            b'a' => tables::albedo(program, table.as_ref()),
            b'L' => tables::lobe(program, table.as_ref()),
            b'F' => surfaces::describe(program, table.as_ref()),
            b'r' => surfaces::at_angle(program, table.as_ref()),
            b'b' => surfaces::rgb(program, table.as_ref()),
            b'u' => surfaces::sample(program, table.as_ref()),
            b'o' => orders::describe(program, table.as_ref()),
            b'V' => orders::view(program, table.as_ref(), &mut seen),
            b'l' => orders::light(program, seen.as_ref()),
            b'q' => orders::sample(program, seen.as_ref()),
            b'x' => status_text(i32::from(program.byte() as i8)),
            _ => {}
        }
    }
}

fn status_text(status: i32) {
    // SAFETY: the interface returns a text for any number.
    let text = unsafe { CStr::from_ptr(gonio_status_text(status)) };
    assert!(text.to_str().is_ok_and(|text| !text.is_empty() && !text.contains('\n')));
}
