use std::path::Path;

use super::*;

const SIZE: [usize; 2] = [12, 9];

/// Bytes and name of each file that NumPy, Pillow, pypng, tifffile and OpenEXR wrote.
fn files() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds/grey_map");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), std::fs::read(path).unwrap())).collect()
}

/// The map that files named `map-…` hold: integers of 8 bits, as parts of 255 or, in floating point, as they are.
fn expected(integer: bool) -> impl Iterator<Item = f32> {
    (0..SIZE[0] * SIZE[1]).map(move |k| {
        let (row, column) = (k / SIZE[0], k % SIZE[0]);
        let value = (37 * row * row + 11 * column * column + 5 * row * column + 3) % 256;
        value as f32 / if integer { 255.0 } else { 1.0 }
    })
}

#[test]
fn files_of_other_programs_hold_the_map_that_was_written() {
    let mut count = 0;
    for (name, bytes) in files().iter().filter(|(name, _)| name.starts_with("map-")) {
        let map = decode(name, bytes).unwrap();
        assert_eq!(map.size, SIZE, "{name}");
        // What these two compressions of OpenEXR lose of 255; others lose nothing but the rounding of a quotient.
        let tolerance = match name.as_str() {
            "map-openexr-pxr24.exr" => 2.0_f32.powi(-8),
            _ if map.integer => f32::EPSILON,
            _ => 0.0,
        };
        for (k, (value, expected)) in map.values.iter().zip(expected(map.integer)).enumerate() {
            assert!((value - expected).abs() <= tolerance, "{name} {k}: {value} {expected}");
        }
        count += 1;
    }
    assert!(count >= 40, "{count}");
}

#[test]
fn files_that_hold_no_map_are_refused_in_one_line() {
    let colours = "its pixels have colour or alpha; a map has one channel: export it in grey";
    let reasons = [
        ("numpy-beyond-single.npy", "1 of 108 pixels are not finite, the first in row 3, column 4"),
        ("numpy-bool.npy", "its numbers are of type \"|b1\"; save them as float32"),
        ("numpy-colours.npy", "its array has the shape (9, 12, 3); a map has two dimensions"),
        ("numpy-complex.npy", "its numbers are of type \"<c8\""),
        ("numpy-empty.npy", "the map is empty; export it anew"),
        ("numpy-flat.npy", "its array has the shape (108,)"),
        ("numpy-holes.npy", "2 of 108 pixels are not finite, the first in row 3, column 4; fill the holes"),
        ("numpy-huge.npy", "1099511627776 × 1099511627776 pixels; at most 4096 a side; scale the map down"),
        ("numpy-npz.npz", "neither PNG, OpenEXR, TIFF nor NPY"),
        ("numpy-object.npy", "its numbers are of type \"|O\""),
        ("numpy-record.npy", "its array holds records; save one of their fields"),
        ("openexr-colours.exr", "it has 3 channels; a map has one"),
        ("pillow-alpha.png", colours),
        ("pillow-bilevel.tif", "its pixels are Gray(1); a map is grey of 8, 16, 32 or 64 bits"),
        ("pillow-colours.png", colours),
        ("pillow-colours.tif", "its pixels are RGB(8)"),
        ("pillow-jpeg.jpg", "neither PNG, OpenEXR, TIFF nor NPY"),
        ("pillow-palette.png", colours),
        ("pillow-palette.tif", "export it in grey"),
        ("pypng-transparent.png", colours),
        ("tifffile-colours.tif", "its pixels are RGB(8)"),
        ("tifffile-complex.tif", "export it in grey"),
        ("tifffile-zstd.tif", "ZSTD is unsupported; export it in grey, with LZW, deflate or no compression"),
    ];
    let files = files();
    let refused: Vec<_> = files.iter().filter(|(name, _)| name.starts_with("not-")).collect();
    assert_eq!(refused.len(), reasons.len());
    for (name, bytes) in refused {
        let message = decode(name, bytes).unwrap_err().to_string();
        let (_, reason) = reasons.iter().find(|(file, _)| name.ends_with(file)).unwrap();
        assert!(message.contains(reason) && !message.contains('\n'), "{message}");
    }
}

#[test]
fn signed_integers_are_parts_of_the_largest() {
    let (_, bytes) = files().into_iter().find(|(name, _)| name == "tifffile-signed.tif").unwrap();
    let map = decode("signed", &bytes).unwrap();
    let eighths = expected(true).map(|part| (part * 255.0).round() * 128.0 / 32767.0);
    assert!(map.integer && map.values.iter().zip(eighths).all(|(a, b)| (a - b).abs() <= f32::EPSILON));
}
