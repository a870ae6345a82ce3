//! Tests that inputs which ask for too much memory or time are refused with a number, within little memory and time.
#![cfg(unix)]

use std::process::Command;

use crate::user::User;

/// Address space in KiB within which inputs must be refused: enough for the program itself with its threads.
const LITTLE: u32 = 1 << 20;

/// Runs the program within an address space of so many KiB. Returns its exit code and what it wrote to standard error.
fn run_within(user: &User, kib: u32, line: &str) -> (Option<i32>, String) {
    let program = user.program().get_program().to_string_lossy().into_owned();
    // The C library would set 64 MiB of addresses aside for each thread.
    let script = format!("ulimit -v {kib}; export MALLOC_ARENA_MAX=1; exec '{program}' {line}");
    let output = Command::new("sh").args(["-c", &script]).current_dir(user.at("")).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Runs what must fail where memory is short: by this exit code, with one line that contains all of `says`.
fn refused_within_little(user: &User, line: &str, code: i32, says: &[&str]) {
    let (found, message) = run_within(user, LITTLE, line);
    assert_eq!(found, Some(code), "{line}: {message}");
    assert_eq!(message.lines().count(), 1, "{line}: {message}");
    for part in says {
        assert!(message.contains(part), "{line}: {part:?} is missing from {message:?}");
    }
}

/// [`User::refused`], also where memory is short.
fn refused(user: &User, line: &str, code: i32, says: &[&str]) {
    refused_within_little(user, line, code, says);
    user.refused(line, code, says);
}

#[test]
fn repeat_within_repeat_is_counted_before_it_is_written_out() {
    let nested = |levels: usize, times: u32| {
        let inner = "{ material = 1.5, thickness_nm = 100.0 }".to_owned();
        let layers = (0..levels).fold(inner, |layers, _| format!("{{ repeat = {times}, layers = [{layers}] }}"));
        let scene = format!("[stack]\nambient = 1.0\nlayers = [{layers}]\nsubstrate = 1.0\n");
        User::with(&[("s.toml", &scene)])
    };
    refused(&nested(3, 1000), "spectrum s.toml", 1, &["s.toml:3:", "1000000000 layers", "at most 10000"]);
    refused(&nested(16, 10_000), "spectrum s.toml", 1, &["s.toml:3:", "at most 10000"]);
    refused(&nested(17, 1), "spectrum s.toml", 1, &["s.toml:3:", "repeat within repeat, more than 16 deep"]);
    refused(&nested(2000, 2), "spectrum s.toml", 1, &["s.toml:3:"]);
}

#[test]
fn grids_are_counted_before_they_are_made() {
    let user = User::new();
    let many = ["1000000 wavelengths are more than the 8192 allowed"];
    refused(&user, "spectrum paper-fig3 --wavelengths 1:1000000:1", 2, &many);
    let steep = ["89000000001 angles are more than the 16384 allowed"];
    refused(&user, "spectrum paper-fig3 --theta 0:89:1e-9", 2, &steep);
    let pairs = ["67108864 values", "are too many", "4194304"];
    refused(&user, "estimate bumpy-glass -o t.exr --incident 4000x4000 --half-vectors 4000x4000", 2, &["--incident"]);
    refused(&user, "estimate bumpy-glass -o t.exr --incident 64x128 --half-vectors 64x128", 1, &pairs);
    let petabytes = ["not enough memory for all --bins at all --wavelengths, which takes 2147", "GB; ask for less"];
    refused(&user, "scatter bumpy-glass --bins 1024x1024 --wavelengths 1000:9000:1", 1, &petabytes);
}

#[test]
fn bombs_of_toml_and_yaml_are_refused() {
    let deep =
        format!("[stack]\nambient = 1.0\nlayers = {}{}\nsubstrate = 1.0\n", "[".repeat(100_000), "]".repeat(100_000));
    refused(&User::with(&[("s.toml", &deep)]), "spectrum s.toml", 1, &["s.toml:3:"]);
    let keys = format!("{}x = 1\n", "a.".repeat(100_000));
    refused(&User::with(&[("s.toml", &keys)]), "spectrum s.toml", 1, &["s.toml:1:"]);
    refused(&User::with(&[("s.toml", &"#".repeat(5 << 20))]), "spectrum s.toml", 1, &["longer than 4 MiB"]);

    let scene = "[stack]\nambient = 1.0\nsubstrate = \"x\"\n[materials.x]\nfile = \"x.yml\"\n";
    let mut laughs = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n".to_owned();
    for level in 1..12 {
        let aliases = vec![format!("*a{}", level - 1); 10].join(", ");
        laughs += &format!("a{level}: &a{level} [{aliases}]\n");
    }
    refused(&User::with(&[("s.toml", scene), ("x.yml", &laughs)]), "spectrum s.toml", 1, &["x.yml:"]);
    let deep = format!("DATA: {}{}\n", "[".repeat(50_000), "]".repeat(50_000));
    refused(
        &User::with(&[("s.toml", scene), ("x.yml", &deep)]),
        "spectrum s.toml",
        1,
        &["x.yml:1:", "recursion limit"],
    );
}

#[test]
fn an_image_that_claims_two_to_the_31_pixels_is_refused() {
    let user = User::new();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    let table = user.read("t.exr");
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let at = table.windows(name.len()).position(|window| window == name).expect("a header") + name.len();
    for (width, height) in [(i32::MAX - 1, 1_i32), (1 << 16, 1 << 15), (1 << 25, 1 << 6)] {
        let mut claim = table.clone();
        claim[at + 8..at + 12].copy_from_slice(&(width - 1).to_le_bytes());
        claim[at + 12..at + 16].copy_from_slice(&(height - 1).to_le_bytes());
        user.write("claim.exr", claim);
        refused(&user, "plot claim.exr -o disc.png", 1, &["claim.exr"]);
    }
}

#[test]
fn pictures_and_environments_are_counted_before_they_are_made() {
    let user = User::new();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    refused(&user, "render t.exr -o a.png --size 100000x100000", 2, &["--size 100000x100000", "16384 pixels"]);
    refused(&user, "render t.exr -o a.png --size 16384x16384", 2, &["more than 67108864 pixels"]);
    user.write("huge.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 15000 +X 30000\n");
    refused(&user, "render t.exr -o a.png --env huge.hdr", 1, &["30000 × 15000 texels are too many", "50000000"]);
}

#[test]
fn what_fits_the_limits_and_not_the_memory_is_refused() {
    let user = User::new();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100 --quiet");
    let short = |line: &str, says: &[&str]| {
        refused_within_little(&user, line, 1, says);
        assert!(!user.at("a.exr").exists());
    };
    let what = ["not enough memory for a picture of 8192 × 8192 pixels, which takes 2.68 GB"];
    short("render t.exr -o a.exr --size 8192 --quiet", &what);
    // Three million faces, whose text is short enough for the limit of a mesh file.
    let faces = "f 1 2 3\n".repeat(3_000_000);
    user.write("m.obj", format!("usemtl top\nv 0 0 0\nv 9 0 0\nv 0 9 0\n{faces}"));
    user.write("s.toml", "[cell]\nmesh = \"m.obj\"\nperiod_nm = [9, 9]\n[interface.top]\nabove = 1\nbelow = 1.5\n");
    short("spectrum s.toml", &["not enough memory for the mesh m.obj, which takes 1.17 GB"]);
    short("render t.exr -o a.exr --mesh m.obj --quiet", &["not enough memory for the "]);
}

#[test]
fn surfaces_of_too_many_triangles_are_refused() {
    let surface = "kind = \"pyramids\", count = [1000, 1000]";
    let scene = format!(
        "[cell]\nperiod_nm = [1000, 1000]\nsurface = {{ {surface} }}\n[interface.pyramids]\nabove = 1\nbelow = 1.5\n"
    );
    let says = ["s.toml:3:", "12000000 triangles; at most 1000000"];
    refused(&User::with(&[("s.toml", &scene)]), "scatter s.toml", 1, &says);
}

#[test]
fn making_a_table_takes_its_own_size_and_little_more() {
    /// Size of the table: incident directions × nodes × (40 wavelengths, R, G, B, the error), numbers of four bytes.
    const TABLE_KIB: u32 = 16 * 65_536 * 44 * 4 / 1024;
    /// Size of all else: the program (45 MB unoptimised), its stack, the file that it writes, and one row of blocks
    /// being compressed.
    const BESIDES_KIB: u32 = 80 << 10;
    let user = User::new();
    let options = "--incident 4x4 --half-vectors 256x256 --wavelengths 385:775:10 --rays 32 --threads 1 --quiet";
    let line = format!("estimate bumpy-glass -o t.exr {options}");
    let (code, message) = run_within(&user, TABLE_KIB + BESIDES_KIB, &line);
    assert_eq!(code, Some(0), "{message}");
    assert!(user.at("t.exr").is_file() && !user.at("t.exr.checkpoint").exists());
}
