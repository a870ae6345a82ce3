//! Tests of faulty command lines: exit code 2 and one line of error.

use crate::user::User;

#[test]
fn commands_options_and_values_that_do_not_exist_are_named() {
    let user = User::new();
    let cases: &[(&str, &[&str])] = &[
        ("", &["a command is missing", "--help"]),
        ("frobnicate", &["'frobnicate'", "--help"]),
        ("spectrm paper-fig3", &["'spectrm'", "'spectrum'"]),
        ("spectrum", &["<SCENE>", "--help"]),
        ("spectrum paper-fig3 --thta 3", &["'--thta'", "'--theta'"]),
        ("spectrum paper-fig3 --model exact", &["'exact'", "--model", "physical, paper"]),
        ("spectrum paper-fig3 --method ray", &["'ray'", "--method", "stack, trace, hits"]),
        ("spectrum paper-fig3 --threads 0", &["'0'", "--threads", "1..=1024"]),
        ("colour paper-fig3 --illuminant A", &["'A'", "--illuminant", "D65, E"]),
        ("colour paper-fig3 --space hsv", &["'hsv'", "--space", "srgb, paper, rec2020, acescg"]),
        ("estimate paper-fig3", &["--output <FILE>"]),
        ("estimate paper-fig3 -o t.exr --angles 1", &["'1'", "--angles", "2..=9000"]),
        ("sampling paper-fig3 --samples 0", &["'0'", "--samples", "1..=4000"]),
        ("sampling paper-fig3 --samples 99999", &["'99999'", "--samples"]),
        ("figures", &["--output <DIR>"]),
        ("plot t.exr", &["--output <FILE>"]),
    ];
    for (line, says) in cases {
        user.refused(line, 2, says);
    }
}

#[test]
fn wavelengths_and_angles_are_checked_before_anything_is_read() {
    let user = User::new();
    let cases: &[(&str, &str, &str)] = &[
        ("--wavelengths", "0,400", "0 nm must be positive"),
        ("--wavelengths", "-5", "-5 nm must be positive"),
        ("--wavelengths", "-5:400:5", "-5 nm must be positive"),
        ("--wavelengths", "nan", "\"nan\" is not a number"),
        ("--wavelengths", "400,inf", "\"inf\" is not a number"),
        ("--wavelengths", "''", "\"\" is not a number"),
        ("--wavelengths", "400:500", "start:end:step"),
        ("--wavelengths", "400:500:0", "step > 0"),
        ("--wavelengths", "400:500:1e-9", "more than the 8192 allowed"),
        ("--wavelengths", "500:400:auto", "end > start"),
        ("--theta", "90.1", "angle 90.1 lies outside [0, 90]"),
        ("--theta", "-1", "angle -1 lies outside [0, 90]"),
        ("--theta", "0,nan", "\"nan\" is not a number"),
        ("--theta", "0:80:1e-9", "more than the 16384 allowed"),
    ];
    for (option, value, says) in cases {
        for command in ["spectrum", "colour", "compare"] {
            // The scene does not exist, but the option is checked first.
            user.refused(&format!("{command} missing.toml {option} {value}"), 2, &[option, says]);
        }
    }
}

#[test]
fn grids_that_no_table_holds_are_refused() {
    let user = User::with(&[(
        "thick.toml",
        "[stack]\nambient = 1.0\nlayers = [{ material = 1.5, thickness_nm = 1e8 }]\nsubstrate = 1.0\n",
    )]);
    user.refused("spectrum thick.toml --wavelengths 400:500:0.02 --theta 0:89:0.01", 1, &["samples are more than"]);
    let says =
        ["thick", "optical path of 150000000 nm", "more fringes than can be summed", "make the layer the substrate"];
    user.refused("spectrum thick.toml --wavelengths auto", 1, &says);
    user.refused("colour thick.toml", 1, &says);
    user.refused("colour thick.toml --wavelengths 900:1000:10", 2, &["--wavelengths", "invisible", "380 to 780 nm"]);
}

#[test]
fn wrong_extensions_are_refused_before_anything_is_read() {
    let user = User::new();
    user.refused("estimate missing.toml -o t.png", 2, &["t.png", ".exr"]);
    user.refused("estimate missing.toml -o table", 2, &["table", ".exr"]);
    user.refused("plot missing.exr -o disc.jpg", 2, &["disc.jpg", ".png or .svg"]);
    user.refused("compare paper-fig3 -o compare.gif", 2, &["compare.gif", ".png or .svg"]);
    user.refused("sampling paper-fig3 -o curve", 2, &["curve", ".png or .svg"]);
}

#[test]
fn options_without_effect_are_refused() {
    let user = User::new();
    user.ok("estimate paper-fig3 -o t.exr --angles 4 --wavelengths 400:700:100");
    user.refused("plot t.exr -o a.png --theta 10", 2, &["--theta", "shows every angle", "leave it out"]);
    user.refused("plot t.exr -o a.png --kind map --theta 10", 2, &["--theta", "shows every angle", "leave it out"]);
    user.refused("plot t.exr -o a.png --phi 80", 2, &["--phi", "every azimuth", "leave it out"]);
    user.refused("render t.exr -o a.exr --exposure 3", 2, &["a.exr", "leave --exposure and --tonemap out"]);
    user.refused("render t.exr -o a.exr --tonemap filmic", 2, &["a.exr", "leave --exposure and --tonemap out"]);
    user.refused("render t.exr -o a.png --mesh sphere --level 4", 2, &["--level", "--mesh sphere"]);
}

#[test]
fn help_and_version_are_no_errors() {
    let user = User::new();
    let help = user.ok("--help");
    for command in ["presets", "spectrum", "colour", "estimate", "compare", "sampling", "plot", "view", "figures"] {
        assert!(help.stdout.contains(command), "{command}");
        assert!(user.ok(&format!("{command} --help")).stdout.contains("Usage: goniochrome"));
    }
    assert!(user.ok("--version").stdout.starts_with(concat!("goniochrome ", env!("CARGO_PKG_VERSION"), " (")));
}
