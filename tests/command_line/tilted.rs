//! Meshes of tilted facets at fault: file and line, exit code 1, no file left; and what may look like a fault and is none.

use crate::user::User;

const SCENE: &str = "[cell]\nmesh = \"m.obj\"\nperiod_nm = [1000, 800]\n\
                     [interface.top]\nabove = 1.0\nbelow = 1.5\n[interface.base]\nabove = 1.5\nbelow = 1.3\n";

const ESTIMATE: &str =
    "estimate s.toml -o t.exr --incident 1x1 --bins 2x4 --rays 32 --wavelengths 550 --coherence none -q";

/// A roof over the period, its ridge along y; vertices on lines 1 to 6, faces on 8 and 9.
const ROOF: &str = "v 0 0 0\nv 0 800 0\nv 500 0 300\nv 500 800 300\nv 1000 0 0\nv 1000 800 0\n\
                    usemtl top\nf 1 3 4 2\nf 3 5 6 4\n";

fn user(scene: &str, mesh: &str) -> User {
    User::with(&[("s.toml", scene), ("m.obj", mesh)])
}

/// The roof with one piece of its text replaced.
fn roof(from: &str, to: &str) -> String {
    assert!(ROOF.contains(from), "{from}");
    ROOF.replace(from, to)
}

#[test]
fn unusual_meshes_are_traced_like_tidy_ones() {
    let result = |mesh: &str| {
        let user = user(SCENE, mesh);
        user.ok(ESTIMATE);
        user.read("t.exr")
    };
    let tidy = result(ROOF);
    let duplicates = "v 500 0 300\nv 500 800 300\n";
    for (name, mesh) in [
        ("negative indices", roof("f 1 3 4 2\nf 3 5 6 4", "f -6 -4 -3 -5\nf -4 -2 -1 -3")),
        ("lines of Windows", ROOF.replace('\n', "\r\n")),
        ("comments and blank lines", roof("usemtl top\n", "# a comment\n\nusemtl top # and another\n   \n")),
        ("no final newline", ROOF.trim_end().to_owned()),
        ("an unreferenced vertex, far away", ROOF.to_owned() + "v 900000 -7 1e6\n"),
        ("duplicate vertices", roof("usemtl", &format!("{duplicates}usemtl")).replace("f 3 5 6 4", "f 7 5 6 8")),
    ] {
        assert!(result(&mesh) == tidy, "{name}: another table than that of the tidy mesh");
    }
    // Passed over or traced as they stand: the table differs by rounding at most, so that they work is all to be seen.
    result(&(ROOF.to_owned() + "v 200 100 120\nv 300 100 180\nv 400 100 240\nf -3 -2 -1\n"));
    result(&ROOF.replace(" 300\n", " 90000\n"));
}

/// The roof with each of its vertices changed.
fn moved(change: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let line = |line: &str| match line.strip_prefix("v ") {
        Some(words) => {
            let numbers: Vec<f64> = words.split(' ').map(|word| word.parse().unwrap()).collect();
            let [x, y, z] = change([numbers[0], numbers[1], numbers[2]]);
            format!("v {x} {y} {z}\n")
        }
        None => format!("{line}\n"),
    };
    ROOF.lines().map(line).collect()
}

#[test]
fn meshes_as_modelling_programs_export_them_are_traced_or_told_what_to_write() {
    const SCATTER: &str = "scatter s.toml --theta 20 --phi 30 --wavelength 550 --rays 256 --bins 2x4 --json -";
    let with = |keys: &str| SCENE.replace("[interface.top]", &format!("{keys}\n[interface.top]"));
    let result = |scene: &str, mesh: &str| user(scene, mesh).ok(SCATTER).stdout;
    let tidy = result(SCENE, ROOF);
    let centred = |[x, y, z]: [f64; 3]| [x - 500.0, y - 400.0, z];
    let y_up = |[x, y, z]: [f64; 3]| [x, z, -y];
    let micrometres = |place: [f64; 3]| place.map(|x| x / 1000.0);
    for (name, keys, mesh) in [
        ("centred on 0", "", moved(centred)),
        ("periods away", "", moved(|[x, y, z]| [x + 7000.0, y - 8000.0, z])),
        ("y up", "axes = \"y-up\"", moved(y_up)),
        ("y up and centred", "axes = \"y-up\"", moved(|place| y_up(centred(place)))),
        ("micrometres", "unit_nm = 1000", moved(micrometres)),
        ("all at once", "axes = \"y-up\"\nunit_nm = 1e3", moved(|place| micrometres(y_up(centred(place))))),
    ] {
        assert_eq!(result(&with(keys), &mesh), tidy, "{name}");
    }
    for (mesh, says) in [
        (moved(|place| y_up(centred(place))), "if the file has y up, write axes = \"y-up\" in [cell]"),
        (moved(micrometres), "write unit_nm = 1000 in [cell]"),
        (moved(|place| micrometres(y_up(place))), "axes = \"y-up\" in [cell], and unit_nm = 1000"),
    ] {
        for command in [SCATTER, ESTIMATE, "spectrum s.toml"] {
            user(SCENE, &mesh).refused(command, 1, &["m.obj:8:", "the mesh spans", "1000 by 800 nm", says]);
        }
    }
    for (keys, says) in [
        ("axes = \"up\"", "write \"z-up\" or \"y-up\""),
        ("axes = 1", "expected a text"),
        ("unit_nm = 0", "must be more than 0 nm"),
        ("unit_nm = inf", "not a finite number"),
        ("unit_nm = 1e7", "is more than 1000000000 nm, a metre; unit_nm in [cell] is 10000000"),
    ] {
        user(&with(keys), ROOF).refused(SCATTER, 1, &[says]);
    }
}

#[test]
fn meshes_at_fault_are_named_by_file_and_line() {
    let nan = roof("v 500 0 300", "v 500 0 nan");
    let cases: &[(&str, String, &[&str])] = &[
        ("a huge triangle", roof("v 500 0 300", "v 500 0 2e9"), &["m.obj:3:", "2000000000", "a metre", "nanometres"]),
        ("a number that is none", nan, &["m.obj:3:", "\"nan\" is not a finite number"]),
        (
            "a facet outside the period",
            roof("v 1000 0 0\nv 1000 800 0", "v 1100 0 0\nv 1100 800 0"),
            &["m.obj:9:", "leaves the period at (1100, 0, 0) nm", "cut the mesh at x = 0 and 1000"],
        ),
        (
            "inconsistent orientation",
            roof("f 3 5 6 4", "f 4 6 5 3"),
            &["m.obj:", "where the facet of line", "turn its vertices around"],
        ),
        ("a copy", ROOF.to_owned() + "f 1 3 4 2\n", &["m.obj:8:", "overlaps that of line 10", "remove one"]),
        (
            "overlapping coplanar facets",
            ROOF.to_owned() + "f 1 3 4\nf 1 4 2\n",
            &["m.obj:", "overlaps that of line", "remove one"],
        ),
        (
            "a quad that is not planar",
            roof("v 500 0 300", "v 500 0 310"),
            &["m.obj:8:", "not planar", "split it into triangles"],
        ),
        ("a hole", roof("f 3 5 6 4", "f 3 5 6"), &["m.obj:9:", "has no partner", "fill the hole"]),
        ("no facet", roof("f 1 3 4 2\nf 3 5 6 4\n", ""), &["m.obj:7:", "no faces"]),
        (
            "a vertex below the first",
            roof("f 1 3 4 2", "f -7 3 4 2"),
            &["m.obj:8:", "vertex -7 does not exist", "6 are"],
        ),
        ("a vertex twice", roof("f 1 3 4 2", "f 1 3 4 1 2"), &["m.obj:8:", "uses a vertex twice"]),
        ("no interface", roof("usemtl top", "usemtl tap"), &["m.obj:7:", "\"tap\"", "nearest is [interface.top]"]),
        (
            "media that differ between two sheets",
            format!(
                "{ROOF}{}",
                ROOF.replace(" 0\n", " -9\n")
                    .replace(" 300\n", " 291\n")
                    .replace("f 1 3 4 2\nf 3 5 6 4", "f 7 9 10 8\nf 9 11 12 10")
            ),
            &["m.obj:17:", "make them equal"],
        ),
        (
            "a body and nothing under it",
            "v 100 100 0\nv 300 100 0\nv 100 300 0\nv 100 100 200\nusemtl top\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
                .to_owned(),
            &["m.obj:6:", "no surface spans the period", "add a plane"],
        ),
    ];
    for (name, mesh, says) in cases {
        println!("{name}");
        for command in [ESTIMATE, "scatter s.toml", "orders s.toml", "spectrum s.toml"] {
            user(SCENE, mesh).refused(command, 1, says);
        }
    }
}

#[test]
fn periods_at_fault_are_named_by_file_line_and_column() {
    for (period, says) in [
        ("[1000, 0]", "more than 0 nm"),
        ("[0, 800]", "more than 0 nm"),
        ("[-1000, 800]", "-1000 is negative"),
        ("[1000, nan]", "not a finite number"),
        ("[1000]", "two lengths [x, y]"),
        ("[2e9, 800]", "a metre"),
    ] {
        user(&SCENE.replace("[1000, 800]", period), ROOF).refused(ESTIMATE, 1, &["s.toml:3:", "period_nm", says]);
    }
}
