//! Tests of `plot` with files that are not tables, and with damaged ones.

use std::io::Cursor;

use exr::prelude::{AnyChannel, AnyChannels, FlatSamples, Image, WritableImage};

use crate::user::User;

const REMEDY: &str = "`goniochrome estimate` writes";

#[test]
fn what_is_no_table_is_refused_with_the_remedy() {
    let user = User::with(&[("text.exr", "theta_deg,R\n0,1\n"), ("empty.exr", "")]);
    std::fs::create_dir(user.at("folder.exr")).unwrap();
    let channels = AnyChannels::sort([AnyChannel::new("R", FlatSamples::F32(vec![0.5; 4]))].into_iter().collect());
    let mut bytes = Cursor::new(Vec::new());
    Image::from_channels((2, 2), channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
    user.write("photo.exr", bytes.into_inner());
    for (table, says) in [
        ("missing.exr", "cannot read"),
        ("folder.exr", "cannot read"),
        ("text.exr", "not a readable EXR file"),
        ("empty.exr", "not a readable EXR file"),
        ("photo.exr", "not a goniochrome table"),
    ] {
        for kind in ["disc", "spectrum", "map", "chromaticity"] {
            user.refused(&format!("plot {table} --kind {kind} -o a.png"), 1, &[table, says, REMEDY]);
        }
    }
}

#[test]
fn pictures_of_cells_are_refused_for_planes() {
    let user = User::new();
    user.ok("estimate paper-fig4 -o t.exr --angles 8 --wavelengths 400:700:20 --quiet");
    user.refused("plot t.exr --kind lobes -o a.png", 2, &["t.exr", "no lobes", "chromaticity"]);
    user.refused("plot t.exr --kind spectrum --phi-out 3 -o a.png", 2, &["t.exr", "--phi-out", "leave them out"]);
}

#[test]
fn damaged_tables_are_refused() {
    let user = User::new();
    user.ok("estimate paper-fig4 -o t.exr --angles 8 --wavelengths 400:700:20 --quiet");
    let good = user.read("t.exr");
    for length in [4, good.len() / 4, good.len() / 2, good.len() - 1] {
        user.write("cut.exr", &good[..length]);
        user.refused("plot cut.exr -o a.png", 1, &["cut.exr", "not a readable EXR file", REMEDY]);
    }
    let at = good.windows(6).position(|bytes| bytes == b"mirror").expect("the kind of the table");
    let mut foreign = good.clone();
    foreign[at..at + 6].copy_from_slice(b"volume");
    user.write("foreign.exr", foreign);
    user.refused("plot foreign.exr -o a.png", 1, &["foreign.exr", "\"volume\"", "reads \"mirror\""]);
}
