use std::io::Cursor;

use exr::prelude::{Image, SpecificChannels, WritableImage};
use tiff::encoder::{TiffEncoder, colortype};

use crate::scene::{Mesh, Scene, load, parse};
use crate::support::grey_map;

const SIZE: [usize; 2] = [32, 24];
const KEYS: &str = "edges = \"wrap\"";

fn sines() -> Mesh {
    let keys = "kind = \"sines\", waves = 8, highest = 3, rms_slope = 0.3, grid = [32, 24]";
    let text = format!(
        "[cell]\nperiod_nm = [8000, 6000]\nsurface = {{ {keys} }}\n[interface.upper]\nabove = 1\nbelow = 1.5\n"
    );
    parse("s.toml", &text).unwrap().shape.polygons().unwrap().mesh().clone()
}

/// Heights of a map, row by row from the top, whose samples are the vertices of a mesh of [`SIZE`] squares.
fn samples(mesh: &Mesh) -> Vec<f64> {
    let [nx, ny] = SIZE;
    // A mesh drops nothing here, but numbers its vertices by their first use.
    let mut heights = vec![0.0; nx * ny];
    for [x, y, z] in &mesh.vertices {
        let [i, j] = [(x / 250.0).round() as usize, (y / 250.0).round() as usize];
        if i < nx && j < ny {
            heights[(ny - 1 - j) * nx + i] = *z;
        }
    }
    heights
}

fn npy(heights: &[f64], [width, height]: [usize; 2]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({height}, {width}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(heights.iter().flat_map(|z| z.to_le_bytes()));
    bytes
}

fn png(samples: &[u16]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, SIZE[0] as u32, SIZE[1] as u32);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    let data: Vec<u8> = samples.iter().flat_map(|x| x.to_be_bytes()).collect();
    encoder.write_header().unwrap().write_image_data(&data).unwrap();
    bytes
}

/// Files of one map in every format, with the range of its heights.
fn files(heights: &[f64]) -> (Vec<(&'static str, Vec<u8>)>, f64) {
    let [nx, ny] = SIZE;
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let range = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low;
    let single: Vec<f32> = heights.iter().map(|&z| z as f32).collect();
    let words: Vec<u16> = heights.iter().map(|z| ((z - low) / range * 65535.0).round() as u16).collect();
    let (mut float, mut integer, mut openexr) = (Vec::new(), Vec::new(), Vec::new());
    let mut encoder = TiffEncoder::new(Cursor::new(&mut float)).unwrap();
    encoder.write_image::<colortype::Gray32Float>(nx as u32, ny as u32, &single).unwrap();
    let mut encoder = TiffEncoder::new(Cursor::new(&mut integer)).unwrap();
    encoder.write_image::<colortype::Gray16>(nx as u32, ny as u32, &words).unwrap();
    let pixel = |at: exr::math::Vec2<usize>| (single[at.1 * nx + at.0],);
    let channels = SpecificChannels::build().with_channel("Z").with_pixel_fn(pixel);
    Image::from_channels((nx, ny), channels).write().to_buffered(Cursor::new(&mut openexr)).unwrap();
    let files = vec![
        ("map.npy", npy(heights, SIZE)),
        ("map.exr", openexr),
        ("map.tif", float),
        ("words.tif", integer),
        ("words.png", png(&words)),
    ];
    (files, range)
}

/// Loads a scene with a map; `period` is a line of its cell.
fn scene(name: &str, bytes: &[u8], period: &str, keys: &str) -> Result<Scene, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let surface = format!("{{ kind = \"height_map\", file = \"{name}\", {keys} }}");
    let text = format!("[cell]\n{period}\nsurface = {surface}\n[interface.heights]\nabove = 1\nbelow = 1.5\n");
    let path = folder.path().join("s.toml");
    std::fs::write(&path, text).unwrap();
    let scene = load(path.to_str().unwrap()).map_err(|error| error.to_string())?;
    assert_eq!(scene.files.len(), 2);
    Ok(scene)
}

fn read(name: &str, bytes: &[u8], period: &str, keys: &str) -> Result<Mesh, String> {
    scene(name, bytes, &format!("period_nm = {period}"), keys)
        .map(|scene| scene.shape.polygons().unwrap().mesh().clone())
}

/// Heights of a mesh of equal squares, row by row from the bottom, without its right and upper border.
fn nodes(scene: &Scene, [nx, ny]: [usize; 2]) -> Vec<f64> {
    let cell = scene.shape.polygons().unwrap();
    let [x, y] = cell.period_nm();
    let mut nodes = vec![f64::NAN; nx * ny];
    for [at_x, at_y, z] in &cell.mesh().vertices {
        let [i, j] = [(at_x / x * nx as f64).round() as usize, (at_y / y * ny as f64).round() as usize];
        nodes[j % ny * nx + i % nx] = *z;
    }
    nodes
}

#[test]
fn every_format_gives_the_surface_that_was_sampled() {
    let sines = sines();
    let (files, range) = files(&samples(&sines));
    let low = sines.vertices.iter().map(|v| v[2]).fold(f64::INFINITY, f64::min);
    for (name, bytes) in files {
        let words = name.starts_with("words");
        let keys = if words { format!("{KEYS}, height_nm = {range}") } else { KEYS.to_owned() };
        let mesh = read(name, &bytes, "[8000, 6000]", &keys).unwrap();
        assert_eq!(mesh.triangles.len(), sines.triangles.len());
        // Half a step of 16 bits; else the rounding of single precision.
        let tolerance = range * if words { 0.51 / 65535.0 } else { f64::from(f32::EPSILON) };
        for (a, b) in mesh.vertices.iter().zip(&sines.vertices) {
            let expected = b[2] - if words { low } else { 0.0 };
            assert!(a[..2] == b[..2] && (a[2] - expected).abs() <= tolerance, "{name}: {a:?} {b:?}");
        }
    }
}

#[test]
fn mirrored_maps_are_levelled_and_join() {
    // A tilted map with a step of 6 nm in y between its halves; its mirrored mesh of 4 by 2 squares.
    let tilted: Vec<f64> = (0..32 * 24).map(|k| 5.0 * f64::from(k % 32) - 3.0 * f64::from(k / 32)).collect();
    let flat = read("m.npy", &npy(&tilted, SIZE), "[8000, 6000]", "edges = \"mirror\"").unwrap();
    assert!(flat.vertices.iter().all(|v| v[2].abs() < 1e-4));
    let steps: Vec<f64> = (0..32 * 24).map(|k| if k < 32 * 12 { 6.0 } else { 0.0 }).collect();
    let keys = "edges = \"mirror\", level = false, grid = [2, 4]";
    let mesh = read("m.npy", &npy(&steps, SIZE), "[8000, 6000]", keys).unwrap();
    for [_, y, z] in &mesh.vertices {
        let expected = if [1500.0, 3000.0].contains(y) { 6.0 } else { 0.0 };
        assert_eq!(*z, expected, "{y}");
    }
}

#[test]
fn blended_maps_join_and_keep_their_variance() {
    const SIDE: usize = 96;
    const PERIOD: usize = 84;
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let map: Vec<f64> = (0..SIDE * SIDE).map(|_| 100.0 * random()).collect();
    let mean = map.iter().sum::<f64>() / map.len() as f64;
    let keys = format!("edges = \"blend\", level = false, size_nm = 9600, grid = [{PERIOD}, {PERIOD}]");
    let scene = scene("m.npy", &npy(&map, [SIDE; 2]), "", &keys).unwrap();
    assert_eq!(scene.shape.polygons().unwrap().period_nm(), [8400.0; 2]);
    let nodes = nodes(&scene, [PERIOD; 2]);
    // The file's lowest row is its last.
    let pixel = |x: usize, y: usize| map[(SIDE - 1 - y) * SIDE + x] - mean;
    let along_x = |x: usize, y: usize| {
        let (near, far) = (std::f64::consts::FRAC_PI_2 * (x as f64 + 0.5) / 12.0).sin_cos();
        if x < 12 { near * pixel(x, y) + far * pixel(PERIOD + x, y) } else { pixel(x, y) }
    };
    let (mut square, mut count) = (0.0, 0.0);
    for (k, z) in nodes.iter().enumerate() {
        let (x, y) = (k % PERIOD, k / PERIOD);
        let (near, far) = (std::f64::consts::FRAC_PI_2 * (y as f64 + 0.5) / 12.0).sin_cos();
        let expected = if y < 12 { near * along_x(x, y) + far * along_x(x, PERIOD + y) } else { along_x(x, y) };
        assert!((z - expected).abs() < 1e-4, "{x} {y}: {z} {expected}");
        if x < 12 || y < 12 {
            square += z * z;
            count += 1.0;
        }
    }
    // Numbers even from 0 to 100 have a variance of 100²/12, here of 1872 numbers: four of its standard deviations.
    let variance = square / count / (100.0 * 100.0 / 12.0);
    assert!((variance - 1.0).abs() < 4.0 * (0.8_f64 / 1872.0).sqrt(), "{variance}");
}

#[test]
fn smoothing_lowers_each_wave_as_a_gaussian_does() {
    use std::f64::consts::{PI, TAU};
    let wave = |k: usize| 20.0 * (TAU * (k % 32) as f64 / 8.0).cos() + 30.0 * (TAU * (k / 32) as f64 / 6.0).cos();
    let map: Vec<f64> = (0..32 * 24).map(wave).collect();
    let keys = "edges = \"wrap\", smooth_nm = 300.0";
    let scene = scene("m.npy", &npy(&map, SIZE), "period_nm = [8000, 6000]", keys).unwrap();
    // Waves of 2000 and of 1500 nm; the Gaussian is cut where its weight is 1e-6.
    let left = |length: f64| (-2.0 * PI * PI * (300.0_f64 / length).powi(2)).exp();
    for (k, z) in nodes(&scene, SIZE).iter().enumerate() {
        let (x, y) = (k % 32, 23 - k / 32);
        let expected =
            20.0 * left(2000.0) * (TAU * x as f64 / 8.0).cos() + 30.0 * left(1500.0) * (TAU * y as f64 / 6.0).cos();
        assert!((z - expected).abs() < 1e-4, "{k}: {z} {expected}");
    }
}

#[test]
fn a_map_that_says_what_it_spans_gives_the_period_and_a_note() {
    // A plane of 1 nm a pixel along x and ripples of 6 nm along y, in pixels of 100 nm.
    let map: Vec<f64> = (0..32 * 24).map(|k| f64::from(k % 32) + if k / 32 % 2 == 0 { 6.0 } else { -6.0 }).collect();
    let bytes = npy(&map, SIZE);
    for (edges, period) in [("mirror", [6400.0, 4800.0]), ("blend", [2800.0, 2100.0]), ("wrap", [3200.0, 2400.0])] {
        for size in ["3200", "[3200, 2400]"] {
            let keys = format!("edges = \"{edges}\", size_nm = {size}");
            let scene = scene("m.npy", &bytes, "", &keys).unwrap();
            assert_eq!(scene.shape.polygons().unwrap().period_nm(), period, "{edges}");
        }
    }
    let keys = "edges = \"mirror\", size_nm = 3200";
    let scene = scene("m.npy", &bytes, "period_nm = [6400, 4800]", keys).unwrap();
    let [note] = scene.notes.as_slice() else { panic!("{:?}", scene.notes) };
    // Ripples of alternate rows have a slope of their own, 36/575 nm a row; atan(0.01) is 0.573°. A mesh of 64 × 48
    // squares has two flat rows of 48 where the map is reflected, and steps of 12 nm elsewhere: 0.12 (46/48)^½.
    assert!(
        note.starts_with("m.npy: a tilt of 0.574° is removed; 64 × 48 squares have an rms height of 5.9"),
        "{note}"
    );
    assert!(note.contains("an rms slope of 0.117"), "{note}");
}

#[test]
fn wrong_maps_are_refused_in_one_line() {
    let (files, range) = files(&samples(&sines()));
    let refusal = |bytes: &[u8], keys: &str| read("m", bytes, "[8000, 6000]", keys).unwrap_err();
    assert!(refusal(&files[4].1, "level = true").contains("write height_nm"));
    assert!(refusal(b"P5 3 3 255", "level = true").contains("neither PNG, OpenEXR, TIFF nor NPY"));
    assert!(refusal(&files[0].1, "edges = \"join\"").contains("write \"mirror\", \"blend\" or \"wrap\""));
    assert!(refusal(&files[0].1, "edges = \"wrap\", grid = [33, 2]").contains("than a period has pixels, 32 × 24"));
    assert!(refusal(&files[0].1, &format!("height_nm = {}", 1e4 * range)).contains("the rms slope is"));
    let mut holes = vec![0.0; 32 * 24];
    holes[33] = f64::NAN;
    assert!(
        refusal(&npy(&holes, SIZE), "level = true")
            .contains("1 of 768 pixels are not finite, the first in row 2, column 2")
    );
    assert!(refusal(&npy(&[], [5000, 2]), "level = true").contains("5000 × 2 pixels; at most 4096 a side"));
    let bytes = &files[0].1;
    let narrow = npy(&[0.0; 7 * 9], [7, 9]);
    assert!(refusal(&narrow, "edges = \"blend\"").contains("7 × 9 pixels has no margins to blend; at least 8"));
    assert!(refusal(bytes, "smooth_nm = 376").contains("376 nm is more than a sixteenth of the period"));
    assert!(refusal(bytes, "size_nm = 4001").contains("gives a period of [8002, 6001.5] nm; write that as period_nm"));
    assert!(refusal(bytes, "size_nm = [1, 2, 3]").contains("expected a list of 2, found a list of 3"));
    assert!(refusal(bytes, "size_nm = 1e9").contains("more than a metre"));
    let size = "edges = \"wrap\"";
    assert!(scene("m", bytes, "", size).unwrap_err().contains("\"period_nm\" is missing"));
    // A damaged file is refused or is a map of finite numbers; every length is tried.
    for (name, bytes) in &files {
        for length in 0..bytes.len() - 1 {
            if let Ok(map) = grey_map::decode(name, &bytes[..length]) {
                assert!(map.values.iter().all(|x| x.is_finite()) && length + 64 > bytes.len(), "{name} {length}");
            }
        }
        for at in 0..bytes.len().min(600) {
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[at] ^= flip;
                match grey_map::decode(name, &damaged) {
                    Ok(map) => assert!(map.values.iter().all(|x| x.is_finite())),
                    Err(error) => assert!(!error.to_string().contains('\n')),
                }
            }
        }
    }
}
