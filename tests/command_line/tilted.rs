//! Tests of faulty meshes of tilted facets: file and line, exit code 1, no file left. Meshes that only look faulty are
//! traced.

use crate::user::User;

const SCENE: &str = "[cell]\nmesh = \"m.obj\"\nperiod_nm = [1000, 800]\n\
                     [interface.top]\nabove = 1.0\nbelow = 1.5\n[interface.base]\nabove = 1.5\nbelow = 1.3\n";

const ESTIMATE: &str =
    "estimate s.toml -o t.exr --incident 2x1 --half-vectors 2x4 --rays 32 --wavelengths 550 --coherence none -q";

/// The mesh of a roof over the period, its ridge along y: vertices in lines 1 to 6, faces in 8 and 9.
const ROOF: &str = "v 0 0 0\nv 0 800 0\nv 500 0 300\nv 500 800 300\nv 1000 0 0\nv 1000 800 0\n\
                    usemtl top\nf 1 3 4 2\nf 3 5 6 4\n";

fn user(scene: &str, mesh: &str) -> User {
    User::with(&[("s.toml", scene), ("m.obj", mesh)])
}

/// The roof's mesh with one piece of its text replaced.
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
    // These are skipped or traced, and the table may differ by rounding, so the test only sees that they work.
    result(&(ROOF.to_owned() + "v 200 100 120\nv 300 100 180\nv 400 100 240\nf -3 -2 -1\n"));
    result(&ROOF.replace(" 300\n", " 90000\n"));
}

/// The roof's mesh with each of its vertices changed.
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

/// Surfaces that cross away from their edges pass the check of the mesh, but light loses its way between them.
#[test]
fn light_that_loses_its_way_between_surfaces_that_cross_is_no_result() {
    let base = "v 0 0 20\nv 1000 0 20\nv 1000 800 20\nv 0 800 20\nusemtl base\nf 7 8 9 10\n";
    let user = user(SCENE, &(ROOF.to_owned() + base));
    let says = ["of the light was lost", "more than the 1e-3", "correct the mesh"];
    for command in [ESTIMATE, "scatter s.toml --coherence none", "orders s.toml --max-order 1 --method rays"] {
        user.refused(command, 1, &says);
    }
    user.refused("orders s.toml --max-order 1", 1, &["bodies overlap near (", "correct the mesh"]);
    let interfering = ["of the light was lost", "use --coherence none"];
    user.refused("scatter s.toml --bins 1x1", 1, &interfering);
    user.refused("scatter s.toml --bins 1x1 --coherence bin --rays 64", 1, &interfering);
}

/// The mesh of a sheet of 40 × 40 squares over 20 000 nm, of which `columns` exist, with heights off by up to `noise`
/// nm.
fn noisy(noise: f64, columns: usize) -> String {
    const SQUARES: usize = 40;
    let mut mesh = String::new();
    for (j, i) in (0..=SQUARES).flat_map(|j| (0..=SQUARES).map(move |i| (j, i))) {
        // Heights vary like random numbers; the far borders repeat the near ones.
        let z = noise * ((((j % SQUARES) * 71 + (i % SQUARES) * 113) % 101) as f64 / 50.0 - 1.0);
        mesh += &format!("v {} {} {z:.6}\n", 500 * i, 500 * j);
    }
    mesh += "usemtl top\n";
    for (j, i) in (0..SQUARES).flat_map(|j| (0..columns).map(move |i| (j, i))) {
        let a = 1 + j * (SQUARES + 1) + i;
        let b = a + SQUARES + 1;
        mesh += &format!("f {a} {} {}\nf {a} {} {b}\n", a + 1, b + 1, b + 1);
    }
    mesh
}

#[test]
fn a_plane_with_noise_is_computed_right_and_half_a_plane_is_refused_by_every_command() {
    let scene = "[cell]\nmesh = \"m.obj\"\nperiod_nm = [20000, 20000]\n[interface.top]\nabove = 1.0\nbelow = 1.5\n";
    let spectrum = "spectrum s.toml --wavelengths 550";
    let scatter = "scatter s.toml --rays 32 --bins 1x1 -q";
    let orders = "orders s.toml --rays 32 --max-order 1 -q";
    let estimate = "estimate s.toml -o t.exr -q";
    for noise in [0.0, 0.001, 0.01] {
        let whole = user(scene, &noisy(noise, 40));
        let report: serde_json::Value = serde_json::from_str(&whole.ok(scatter).stdout).expect("JSON");
        let of = |key: &str| report[key]["value"].as_f64().expect("a number");
        assert!((of("reflected") - 0.04).abs() < 1e-4 && of("truncated") == 0.0, "{noise}: {report}");
        whole.ok(orders);
        // Above the rounding of single precision the sheet counts as rough, since it may scatter.
        if noise < 0.002 {
            assert!(whole.ok(spectrum).stdout.lines().nth(1).expect("a row").contains(",0.0399999"));
            whole.ok(estimate);
        } else {
            whole.refused(spectrum, 1, &["s: has tilted facets", "use estimate"]);
        }
        let half = user(scene, &noisy(noise, 20));
        for command in [spectrum, scatter, orders, estimate] {
            half.refused(command, 1, &["m.obj:"]);
        }
    }
}

#[test]
fn commands_of_planes_and_of_facets_name_one_another() {
    let user = User::with(&[("s.toml", SCENE), ("m.obj", ROOF)]);
    let says = ["s: has tilted facets", "estimate", "scatter or orders"];
    for line in ["spectrum s.toml", "colour s.toml", "compare s.toml", "sampling s.toml"] {
        user.refused(line, 1, &says);
    }
    user.refused("export s.toml --to lut -o l.exr", 1, &says);
    user.refused("export s.toml --to gltf -o l.gltf", 1, &says);
    for line in ["scatter soap-bubble", "orders soap-bubble"] {
        user.refused(line, 1, &["soap-bubble: is a [stack]", "use spectrum, colour or estimate"]);
    }
}

#[test]
fn a_medium_without_data_gets_a_remedy_that_the_command_has() {
    let yaml = "DATA:\n  - type: tabulated n\n    data: |\n        0.5 1.5\n        0.6 1.5\n";
    let glass = "[materials.x]\nfile = \"x.yml\"\n";
    let facets = SCENE.replace("below = 1.5\n", "below = \"x\"\n") + glass;
    let stack = format!(
        "[stack]\nambient = 1.0\nlayers = [{{ material = \"x\", thickness_nm = 300 }}]\nsubstrate = 1.5\n{glass}"
    );
    let user = User::with(&[("s.toml", &facets), ("m.obj", ROOF), ("film.toml", &stack), ("x.yml", yaml)]);
    let asks = ["material x: no data", "choose --wavelengths inside", "extrapolate = \"clamp\""];
    for line in [
        "spectrum film.toml --wavelengths 450",
        "colour film.toml --wavelengths 450:550:10",
        "compare film.toml",
        "estimate film.toml -o t.exr",
        "estimate s.toml -o t.exr",
        "scatter s.toml --wavelengths 450",
        "scatter s.toml --wavelengths 450 --coherence bin",
        "orders s.toml --wavelengths 450",
    ] {
        user.refused(line, 1, &asks);
    }
    for line in ["sampling film.toml", "export film.toml --to lut -o l.exr", "export film.toml --to gltf -o l.gltf"] {
        let message = user.refused(line, 1, &["material x: no data", "extrapolate = \"clamp\""]);
        assert!(!message.contains("--wavelengths"), "{message}");
    }
}
