//! Tests of the command line's colours and sampling errors against the paper and an independent colour library.

use serde_json::Value;

use crate::user::{User, column, triples};

const RGB: [&str; 3] = ["R", "G", "B"];
const XYZ: [&str; 3] = ["X", "Y", "Z"];

fn worst(found: [f64; 3], wanted: [f64; 3]) -> f64 {
    found.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Tolerance of values that are known to two decimals.
const TWO_DECIMALS: f64 = 0.01;

#[test]
fn the_papers_films_have_its_colours() {
    let user = User::new();
    let cases: &[(&str, &[[f64; 3]])] = &[
        ("paper-fig3 --model paper --theta 0,30,60", &[[0.55, 0.55, 0.71], [0.69, 0.47, 0.79], [1.00, 0.29, 0.83]]),
        ("paper-fig4 --model physical --theta 0,60", &[[1.39, 0.72, -0.01], [0.48, 0.60, 0.47]]),
    ];
    for (what, wanted) in cases {
        let line = format!("colour {what} --illuminant E --space paper --wavelengths 380:780:5 --csv -");
        let found = triples(&user.ok(&line).stdout, RGB);
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.into_iter().zip(*wanted) {
            assert!(worst(found, *wanted) <= TWO_DECIMALS, "{what}: {found:?} where {wanted:?} belongs");
        }
    }
}

#[test]
fn a_film_on_a_mirror_is_colourless_in_exact_physics() {
    let csv = User::new().ok("colour paper-fig3 --theta 0,30,60 --csv -").stdout;
    for rgb in triples(&csv, RGB) {
        assert!(worst(rgb, [1.0; 3]) < 1e-3, "{rgb:?}: sRGB of the white that the observer's table sums to");
    }
    assert_eq!(csv.matches("#ffffff").count(), 3);
}

/// Relative tolerance of errors that are read off the paper's curve.
const OF_A_CURVE: f64 = 0.15;

#[test]
fn few_wavelengths_err_by_where_they_fall() {
    let user = User::new();
    for (line, wanted) in [
        ("paper-fig6-300 --samples 9,10,11,12,14", vec![0.030, 0.0145, 0.037, 0.040, 0.008]),
        ("paper-fig6-3000 --samples 32,40", vec![0.088, 0.010]),
    ] {
        let found = column(&user.ok(&format!("sampling {line}")).stdout, "largest_error");
        assert_eq!(found.len(), wanted.len());
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found / wanted - 1.0).abs() <= OF_A_CURVE, "{line}: {found} where {wanted} belongs");
        }
    }
}

/// Free-standing films of the reference: name, index, thickness in nanometres, angle of incidence in degrees.
const FILMS: [(&str, &str, f64, u32); 4] = [
    ("film-2.4-300nm-0deg", "2.4", 300.0, 0),
    ("film-2.4-300nm-60deg", "2.4", 300.0, 60),
    ("film-2.4-3000nm-0deg", "2.4", 3000.0, 0),
    ("soap-1.33-420nm-30deg", "1.33", 420.0, 30),
];

/// The largest error of XYZ and RGB under both illuminants, and the number of wavelengths that the program chose.
fn error(user: &User, reference: &Value, theta_deg: u32, wavelengths: &str) -> (f64, Option<usize>) {
    let mut largest: f64 = 0.0;
    let mut count = None;
    for (options, xyz, rgb) in [
        ("--illuminant E --space paper", "XYZ_E", "paper_rgb_E"),
        ("--illuminant D65 --space srgb", "XYZ_D65", "linear_srgb_D65"),
    ] {
        let ran = user.ok(&format!("colour film.toml --theta {theta_deg} {options} {wavelengths} --csv -"));
        count = ran.stderr.split_once(" wavelengths from ").map(|(count, _)| count.parse().expect("a count"));
        for (names, key) in [(XYZ, xyz), (RGB, rgb)] {
            let wanted: [f64; 3] = serde_json::from_value(reference[key].clone()).expect("three numbers");
            largest = largest.max(worst(triples(&ran.stdout, names)[0], wanted));
        }
    }
    (largest, count)
}

/// Error of a component that makes a ΔE2000 of 0.05, which `auto` promises.
const AUTO: f64 = 2e-3;

#[test]
fn films_have_the_colours_of_an_independent_library() {
    let reference: Value = serde_json::from_str(include_str!("../data/colour.json")).expect("the reference is JSON");
    let cases = reference["cases"].as_array().expect("a list of cases");
    for (name, n, thickness_nm, theta_deg) in FILMS {
        let case = cases.iter().find(|case| case["name"] == name).expect("every film has a reference");
        let user = User::with(&[("film.toml", &film(n, thickness_nm, "1.0"))]);
        let (auto, count) = error(&user, case, theta_deg, "--wavelengths auto");
        let (default, same) = error(&user, case, theta_deg, "");
        println!("{name}: {auto:.1e} with {} wavelengths", count.expect("auto says how many"));
        assert!(auto <= AUTO, "{name}: {auto:e}");
        assert_eq!((default.to_bits(), same), (auto.to_bits(), count), "auto is the default");
    }
    // flat-0.5 is a spectrum, not a scene; the observer's own tests include it.
    assert_eq!(cases.len(), FILMS.len() + 1, "every case of the reference is tested");
}

/// The scene of a film in air on a substrate.
fn film(n: &str, thickness_nm: f64, substrate: &str) -> String {
    let layer = format!("{{ material = {n}, thickness_nm = {thickness_nm:?} }}");
    format!("[stack]\nambient = 1.0\nlayers = [{layer}]\nsubstrate = {substrate}\n")
}

#[test]
fn a_thick_film_is_grey_by_default_and_its_table_too() {
    let user = User::with(&[("film.toml", &film("1.58", 2e4, "1.0"))]);
    let ran = user.ok("colour film.toml --theta 0 --csv -");
    assert!(ran.stdout.contains("#575757"), "{}", ran.stdout);
    user.ok("estimate film.toml --angles 3 -o film.exr --quiet");
    user.ok("export film.exr --to lut --width 2 -o table.exr --quiet");
    user.ok("export film.toml --to lut --width 2 -o scene.exr --quiet");
    for name in ["table.exr", "scene.exr"] {
        let image = exr::prelude::read_first_rgba_layer_from_file(
            user.at(name),
            |size, _| vec![[0.0_f32; 3]; size.width()],
            |row, at, (r, g, b, _): (f32, f32, f32, f32)| row[at.x()] = [r, g, b],
        );
        let facing = image.expect("a readable texture").layer_data.channel_data.pixels[1];
        /// 0x57 in linear light, and the rounding of 8 bits and half floats.
        const GREY: (f32, f32) = (0.0953, 0.001);
        assert!(facing.iter().all(|c| (c - GREY.0).abs() < GREY.1), "{name}: {facing:?}");
    }
}

#[test]
fn wavelengths_that_are_too_few_are_said_to_be() {
    let user = User::with(&[("film.toml", &film("1.58", 2e4, "1.0")), ("thin.toml", &film("1.58", 200.0, "1.0"))]);
    for command in ["colour", "estimate -o film.exr --angles 2"] {
        let said = user.ok(&format!("{command} film.toml --wavelengths 380:780:5")).stderr;
        assert!(said.contains("81 wavelengths are too few") && said.contains("--wavelengths auto"), "{said}");
        let said = user.ok(&format!("{command} thin.toml --wavelengths 550")).stderr;
        assert!(said.contains("one wavelength has no colour"), "{said}");
        let said = user.ok(&format!("{command} thin.toml --wavelengths 500:560:5")).stderr;
        assert!(said.contains("500 to 560 nm hold 47 % of white's Y"), "{said}");
        let said = user.ok(&format!("{command} thin.toml --wavelengths 500:560:auto")).stderr;
        assert!(said.contains("hold 47 % of white's Y"), "{said}");
        let said = user.ok(&format!("{command} thin.toml --wavelengths 380:780:5")).stderr;
        assert!(!said.contains("white") && !said.contains("too few"), "{said}");
    }
    assert_eq!(user.ok("colour film.toml --wavelengths 380:780:5 --quiet").stderr, "");
}

#[test]
fn auto_says_how_many_wavelengths_it_takes_and_takes_as_many() {
    let user = User::new();
    for scene in ["soap-bubble", "paper-fig6-3000", "morpho-stack"] {
        let spectrum = user.ok(&format!("spectrum {scene} --wavelengths auto"));
        let rows = column(&spectrum.stdout, "wavelength_nm");
        let says = format!("{} wavelengths from 380 to 780 nm; their colours are within \u{394}E2000 0.0", rows.len());
        assert!(spectrum.stderr.starts_with(&says), "{}", spectrum.stderr);
        assert_eq!((rows[0], rows[rows.len() - 1]), (380.0, 780.0));
        let estimate = user.ok(&format!("estimate {scene} --angles 3 -o t.exr")).stderr;
        let (count, _) = estimate.split_once(" wavelengths from 380 to 780 nm").expect("the number of wavelengths");
        assert!(estimate.contains(&format!("3 angles × {count} wavelengths")), "{estimate}");
        assert_eq!(user.ok(&format!("colour {scene} --quiet --csv -")).stderr, "");
    }
    let thick = column(&user.ok("spectrum paper-fig6-3000 --wavelengths auto").stdout, "R_s").len();
    let thin = column(&user.ok("spectrum paper-fig6-300 --wavelengths auto").stdout, "R_s").len();
    assert!(thin == 81 && thick > thin, "fringes are sampled where there are any: {thick} and {thin}");
}

#[test]
fn a_table_that_is_full_says_so() {
    let user = User::with(&[("film.toml", &film("1.5", 1e6, "1.0"))]);
    let said = user.ok("colour film.toml --theta 0").stderr;
    assert!(
        said.starts_with("8192 wavelengths from 380 to 780 nm, the most that a table holds; their colours"),
        "{said}"
    );
}

#[test]
fn angles_and_wavelengths_keep_the_order_in_which_they_are_given() {
    let user = User::new();
    let csv = user.ok("spectrum paper-fig6-300 --theta 60,30 --wavelengths 700,500").stdout;
    assert_eq!(column(&csv, "theta_deg"), [60.0, 60.0, 30.0, 30.0]);
    assert_eq!(column(&csv, "wavelength_nm"), [700.0, 500.0, 700.0, 500.0]);
    let single = user.ok("spectrum paper-fig6-300 --theta 30 --wavelengths 700").stdout;
    assert_eq!(column(&csv, "R_s")[2].to_bits(), column(&single, "R_s")[0].to_bits());
    let csv = user.ok("colour paper-fig6-300 --theta 60,0,30 --wavelengths 700,500,600 --csv -").stdout;
    let sorted = user.ok("colour paper-fig6-300 --theta 0,30,60 --wavelengths 500,600,700 --csv -").stdout;
    assert_eq!(column(&csv, "theta_deg"), [60.0, 0.0, 30.0]);
    let (y, in_order) = (column(&csv, "Y"), column(&sorted, "Y"));
    assert_eq!([y[1], y[2], y[0]].map(f64::to_bits), [in_order[0], in_order[1], in_order[2]].map(f64::to_bits));
    user.ok("compare paper-fig6-300 --theta 60,0,30,60 --wavelengths 700,436,546 -o compare.svg --csv a.csv --quiet");
    let many = "compare paper-fig6-300 --wavelengths 380:780:5 -o compare.png";
    user.refused(many, 2, &["--output", "at most 24 wavelengths, and these are 81"]);
    let said = user.ok("estimate soap-bubble -o t.exr --angles 3 --wavelengths 600,500,500").stderr;
    assert!(said.contains("3 angles × 2 wavelengths"), "{said}");
}

#[test]
fn grazing_light_is_reflected() {
    let user = User::with(&[
        (
            "nothing.toml",
            "[stack]\nambient = 1.0\nlayers = [{ material = 1.0, thickness_nm = 50.0 }]\nsubstrate = 1.0\n",
        ),
        (
            "metal.toml",
            "[stack]\nambient = 1.0\nlayers = [{ material = \"Ag\", thickness_nm = 20.0 }]\nsubstrate = 1.5\n",
        ),
    ]);
    for method in ["stack", "trace", "hits"] {
        for (scene, reflected, transmitted) in
            [("metal.toml", 1.0, 0.0), ("paper-fig4", 1.0, 0.0), ("paper-fig3", 1.0, 0.0), ("nothing.toml", 0.0, 1.0)]
        {
            let csv =
                user.ok(&format!("spectrum {scene} --theta 90 --wavelengths 450:650:100 --method {method}")).stdout;
            for (name, wanted) in [("R_s", reflected), ("R_p", reflected), ("T_s", transmitted), ("T_p", transmitted)] {
                assert_eq!(column(&csv, name), [wanted; 3], "{scene} by {method}: {name}");
            }
        }
        // Results close to 90 degrees approach the limit.
        let csv = user
            .ok(&format!("spectrum metal.toml --theta 89.9999 --wavelengths 550 --method {method} --precision f64"));
        assert!((column(&csv.stdout, "R_s")[0] - 1.0).abs() < 1e-4, "{}", csv.stdout);
    }
    assert!(user.ok("colour soap-bubble --theta 90,0 --csv -").stdout.contains("#ffffff"));
}

#[test]
fn colours_outside_the_gamut_are_marked() {
    let user = User::new();
    let ran = user.ok("color paper-fig4 --theta 0,60");
    assert!(ran.stderr.contains("of the colours shown, 50.0 % are more saturated than sRGB"), "{}", ran.stderr);
    assert_eq!(ran.stdout.matches("out of gamut").count(), 1, "{}", ran.stdout);
    assert!(!user.ok("colour soap-bubble").stderr.contains("gamut"));
}

#[test]
fn invisible_tables_have_spectra_and_no_colour() {
    let user = User::new();
    let said = user.ok("estimate paper-fig4 --wavelengths 800:1600:10 --angles 8 -o t.exr").stderr;
    assert!(said.contains("no wavelength is visible"), "{said}");
    for kind in ["spectrum", "map"] {
        user.ok(&format!("plot t.exr --kind {kind} -o {kind}.png"));
    }
    let refused = ["no colour", "--kind spectrum or map"];
    for line in [
        "plot t.exr --kind disc -o a.png",
        "plot t.exr --kind chromaticity -o a.png",
        "render t.exr -o a.png",
        "view t.exr -o a.html",
        "export t.exr --to lut -o a.exr",
        "export t.exr --to blob -o a.gonio",
        "export t.exr --to merl --roughness 0.2 -o a.binary",
        "export t.exr --to bsdf --roughness 0.2 --rgb -o a.bsdf",
    ] {
        user.refused(line, 1, &["t.exr: ", refused[0], refused[1]]);
    }
    user.refused("render t.exr --spectral -o a.png", 1, &["t.exr", "invisible"]);
    user.refused("estimate paper-fig4 --wavelengths 800:900:10 --plot a.png -o b.exr", 2, &["--plot", "visible"]);
    user.refused("colour paper-fig4 --wavelengths 800:900:10", 2, &["--wavelengths", "invisible"]);
    // `auto` works on invisible spectra too.
    user.ok("estimate paper-fig6-3000 --wavelengths 800:1600:auto --angles 2 -o t.exr --quiet");
}
