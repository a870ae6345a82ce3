//! Tests of faulty scene files and refractive index files.

use crate::user::{User, column, largest_difference};

/// The scene of a film on a substrate; the film's material and thickness are in line 3.
fn film(material: &str, thickness: &str, substrate: &str) -> String {
    let layer = format!("{{ material = {material}, thickness_nm = {thickness} }}");
    format!("[stack]\nambient = 1.0\nlayers = [{layer}]\nsubstrate = {substrate}\n")
}

#[test]
fn faults_are_named_by_line_and_column_with_a_remedy() {
    let cases: &[(String, &[&str])] = &[
        (String::new(), &["scene.toml:1:1:", "neither [stack] nor [cell]", "add one"]),
        ("[stack]\nambient = 1.0\nsubstrate = = 2\n".into(), &["scene.toml:3:13:", "not valid TOML"]),
        ("[stack]\nambient = 1.0\nsubstrate = \"air\n".into(), &["scene.toml:3:", "not valid TOML"]),
        (
            "[stack]\nambient = 1.0\nsubstrat = 1.5\n".into(),
            &["scene.toml:3:1:", "\"substrat\"", "nearest is \"substrate\"", "known: ambient, layers, substrate"],
        ),
        ("[stack]\nambient = 1.0\n".into(), &["scene.toml:1:1:", "\"substrate\" is missing", "write"]),
        (film("\"chittin\"", "9", "1.5"), &["scene.toml:3:24:", "\"chittin\"", "nearest is \"chitin\"", "declare"]),
        (film("2.4", "-5.0", "1.5"), &["scene.toml:3:44:", "thickness_nm", "-5 is negative", "0 nm or more"]),
        (film("2.4", "nan", "1.5"), &["scene.toml:3:44:", "thickness_nm", "NaN is not a finite number"]),
        (film("2.4", "inf", "1.5"), &["scene.toml:3:44:", "thickness_nm", "inf is not a finite number"]),
        (film("2.4", "1e300", "1.5"), &["scene.toml:3:44:", "thickness_nm", "a metre"]),
        (film("2.4", "\"9\"", "1.5"), &["scene.toml:3:44:", "expected a number", "\"9\""]),
        (film("nan", "9.0", "1.5"), &["scene.toml:3:24:", "material", "NaN is not a finite number"]),
        (film("2.4", "9.0", "[1.5, -0.1]"), &["scene.toml:4:13:", "k = -0.1", "write +k"]),
        (film("2.4", "9.0", "[1.5, inf]"), &["scene.toml:4:19:", "inf is not a finite number"]),
        (film("0.0", "9.0", "1.5"), &["scene.toml:3:24:", "n = 0", "n > 0"]),
        (film("\"mirror\"", "9.0", "1.5"), &["scene.toml:3:24:", "can only be a substrate"]),
        ("[stack]\nambient = [1.0, 0.1]\nsubstrate = 1.5\n".into(), &["scene.toml:2:11:", "absorbs", "use k <= 0.001"]),
        // A metal absorbs at every wavelength of its table.
        ("[stack]\nambient = \"Ag\"\nsubstrate = 1.5\n".into(), &["scene.toml:2:11:", "absorbs", "use k <= 0.001"]),
    ];
    for (text, says) in cases {
        User::with(&[("scene.toml", text)]).refused("spectrum scene.toml", 1, says);
    }
}

#[test]
fn every_command_reads_scenes_alike() {
    let user = User::with(&[("scene.toml", &film("2.4", "-5.0", "1.5"))]);
    for command in ["spectrum", "colour", "estimate -o t.exr", "compare", "sampling"] {
        user.refused(&format!("{command} scene.toml"), 1, &["scene.toml:3:44:", "-5 is negative"]);
    }
}

#[test]
fn a_scene_that_cannot_be_read_is_named() {
    let user = User::new();
    user.refused("spectrum missing.toml", 1, &["missing.toml", "no such scene file", "check the path"]);
    user.refused("spectrum nowhere/film", 1, &["nowhere/film", "no such scene file", "check the path"]);
    std::fs::create_dir(user.at("folder")).unwrap();
    user.refused("spectrum folder", 1, &["folder", "is a folder", "expected a scene file"]);
    user.write("latin.toml", b"[stack]\nambient = \"\xe4ther\"\n");
    user.refused("spectrum latin.toml", 1, &["latin.toml:2:", "not UTF-8", "save the file as UTF-8"]);
    #[cfg(unix)]
    user.refused("spectrum /dev/zero", 1, &["/dev/zero", "longer than"]);
}

#[test]
fn names_are_suggested_only_if_they_are_near() {
    let user = User::new();
    let near = |name: &str, says: &[&str]| user.refused(&format!("spectrum {name}"), 2, says);
    near("jewel-betle", &["\"jewel-betle\"", "nearest preset is \"jewel-beetle\"", "`goniochrome presets`"]);
    near("Morpho", &["nearest preset is \"morpho-stack\""]);
    assert!(!near("nonexist", &["\"nonexist\"", "`goniochrome presets` lists"]).contains("nearest"));
    user.refused("presets nonexist", 2, &["\"nonexist\"", "`goniochrome presets` lists"]);

    user.write("key.toml", "[stack]\nambient = 1.0\nsubstrate = 1.0\ncolour = 3\n");
    assert!(!user.refused("spectrum key.toml", 1, &["key.toml:4:1:", "\"colour\"", "known: "]).contains("nearest"));
    user.write("material.toml", film("\"unobtainium\"", "9.0", "1.5"));
    let far = user.refused("spectrum material.toml", 1, &["\"unobtainium\"", "declare [materials.", "built in: air, "]);
    assert!(!far.contains("nearest"));
}

/// The scene of a tabulated material.
const TABULATED: &str = "[materials.glass]\nfile = \"glass.yml\"\n[stack]\nambient = 1.0\nsubstrate = \"glass\"\n";

/// A refractive index file with these rows, from line 4.
fn table(rows: &str) -> String {
    format!("DATA:\n  - type: tabulated nk\n    data: |\n        {}\n", rows.replace(';', "\n        "))
}

#[test]
fn refractive_index_files_are_refused_by_row() {
    let cases: &[(String, &[&str])] = &[
        (table("0.4 1.5 0;0.6 1.5"), &["glass.yml:5:", "needs 3 numbers", "has 2"]),
        (table("0.4 1.5 0;0.6"), &["glass.yml:5:", "needs 3 numbers", "has 1"]),
        (
            table("0.4 1.5 0;0.6 1.5 0;0.5 1.5 0;0.8 1.5 0"),
            &[
                "n is not known at 450 nm (between 400 and 800 nm)",
                "glass.yml:6:",
                "500 nm stands after that of 600 nm",
            ],
        ),
        (table("0.4 1.5 0;0.6 1.5 -0.1"), &["glass.yml:5:", "k = -0.1", "must not be negative", "write +k"]),
        (table("0.4 1.5 0;0.6 x 0"), &["glass.yml:5:", "\"x\"", "not a number"]),
        ("DATA:\n  - type: tabulated nk\n".into(), &["glass.yml:2:", "no data"]),
        ("DATA:\n  - type: [tabulated\n".into(), &["glass.yml:3:", "not valid YAML"]),
        ("n: 1.5\n".into(), &["glass.yml:1:", "no DATA", "refractiveindex.info"]),
        (String::new(), &["glass.yml:1:", "empty"]),
    ];
    for (text, says) in cases {
        User::with(&[("scene.toml", TABULATED), ("glass.yml", text)]).refused(
            "spectrum scene.toml --wavelengths 400,450,550",
            1,
            says,
        );
    }
    let missing = ["scene.toml:2:8:", "glass.yml", "no such file", "paths start at the scene file"];
    User::with(&[("scene.toml", TABULATED)]).refused("spectrum scene.toml", 1, &missing);
}

#[test]
fn beyond_its_data_a_material_is_refused_or_clamped() {
    let glass = table("0.4 1.5 0;0.6 1.7 0");
    let user = User::with(&[("scene.toml", TABULATED), ("glass.yml", &glass)]);
    let says = ["scene", "glass", "610 nm", "400 to 600 nm", "--wavelengths", "extrapolate = \"clamp\""];
    user.refused("spectrum scene.toml --wavelengths 500,610", 1, &says);
    user.refused("spectrum scene.toml", 1, &["no data for n at 380 nm (n covers 400 to 600 nm, k 400 to 600 nm)"]);
    user.refused("spectrum scene.toml --wavelengths 390:auto", 2, &["--wavelengths", "start:end:auto"]);
    user.refused("spectrum scene.toml --wavelengths 390:500:auto", 1, &["glass", "390 nm", "400 to 600 nm"]);

    user.write("clamped.toml", format!("extrapolate = \"clamp\"\n{TABULATED}"));
    let csv = user.ok("spectrum clamped.toml --wavelengths 300,400,600,900").stdout;
    let reflectance = column(&csv, "R_s");
    // Normal incidence, ((n - 1)/(n + 1))².
    const SINGLE_PRECISION: f64 = 1e-6;
    for (found, n) in reflectance.iter().zip([1.5, 1.5, 1.7, 1.7f64]) {
        assert!((found - ((n - 1.0) / (n + 1.0)).powi(2)).abs() < SINGLE_PRECISION, "{found} for n = {n}");
    }
}

/// The scene of a film on gold under an ambient medium.
fn under(ambient: &str) -> String {
    format!("[stack]\nambient = {ambient}\nlayers = [{{ material = 2.4, thickness_nm = 90 }}]\nsubstrate = \"Au\"\n")
}

#[test]
fn every_planar_command_takes_an_ambient_of_catalogue_glass() {
    let user = User::with(&[("glass.toml", &under("\"N-BK7\"")), ("clear.toml", &under("1.5185"))]);
    let run = |scene, method| {
        let options = format!("--theta 0,40,80 --wavelengths 550 --precision f64 --method {method}");
        user.ok(&format!("spectrum {scene} {options}")).stdout
    };
    let exact = run("glass.toml", "stack");
    for method in ["trace", "hits"] {
        for name in ["R_s", "R_p", "T_s", "T_p"] {
            assert!(largest_difference(&column(&exact, name), &column(&run("glass.toml", method), name)) < 1e-8);
        }
    }
    // N-BK7 has n = 1.51852 at 550 nm; its k of 7e-9 has no visible effect.
    const OF_N: f64 = 1e-4;
    let clear = run("clear.toml", "stack");
    assert!(largest_difference(&column(&exact, "R_p"), &column(&clear, "R_p")) < OF_N);
    user.ok("colour glass.toml --csv colour.csv");
    user.ok("compare glass.toml --csv compare.csv --quiet");
    user.ok("estimate glass.toml -o glass.exr --angles 9 --quiet");
}

#[test]
fn a_murky_ambient_is_refused_at_the_wavelengths_at_which_it_is_murky() {
    let dye = "[materials.dye]\ntable = [[380, 1.5, 0.5], [500, 1.5, 0.01], [501, 1.5, 0.0009], [780, 1.5, 0]]\n";
    let user = User::with(&[("dye.toml", &format!("{dye}{}", under("\"dye\"")))]);
    let says = ["dye", "k = 0.5 at 380 nm", "k up to 0.001", "lower its k, or make it a layer under a clear ambient"];
    user.refused("spectrum dye.toml", 1, &says);
    user.ok("spectrum dye.toml --wavelengths 510,600");
}

#[test]
fn n_and_k_come_as_text_in_the_unit_that_is_said_or_guessed() {
    let scene = "[materials.dye]\nfile = \"dye.csv\"\n[stack]\nambient = 1\nsubstrate = \"dye\"\n";
    let inline = scene.replace("file = \"dye.csv\"", "table = [[380, 1.5, 0.1], [780, 1.7, 0.2]]");
    let user = User::with(&[("said.toml", &scene.replace("dye.csv\"", "dye.csv\"\nunit = \"um\""))]);
    user.write("guessed.toml", scene);
    user.write("inline.toml", inline);
    user.write("dye.csv", "0.38,1.5,0.1\n0.78,1.7,0.2\n");
    let [said, guessed, inline] =
        ["said", "guessed", "inline"].map(|name| user.ok(&format!("spectrum {name}.toml --theta 0,60")));
    assert_eq!(said.stdout, guessed.stdout);
    assert_eq!(said.stdout, inline.stdout);
    assert!(guessed.stderr.contains("dye.csv: wavelengths taken as micrometres"), "{}", guessed.stderr);
    assert_eq!((said.stderr.as_str(), inline.stderr.as_str()), ("", ""));
    assert_eq!(user.ok("spectrum guessed.toml --quiet").stderr, "");
    user.write("dye.csv", "0.38,1.5,0.1\n0.78,x,0.2\n");
    user.refused("spectrum said.toml", 1, &["dye.csv:2:", "\"x\" is not a number"]);
}
