//! Tests that different methods, precisions, numbers of threads and commands agree.

use crate::user::{User, column, largest_difference};

const QUANTITIES: [&str; 4] = ["R_s", "R_p", "T_s", "T_p"];
const SCENES: [&str; 4] = ["paper-fig4", "jewel-beetle", "anodised-titanium", "quarter-wave-mirror"];
const GRID: &str = "--theta 0:75:15 --wavelengths 380:780:20";

/// The largest difference of the reflectances and transmittances in two CSVs.
fn difference(a: &str, b: &str) -> f64 {
    QUANTITIES.map(|name| largest_difference(&column(a, name), &column(b, name))).into_iter().fold(0.0, f64::max)
}

/// Rounding in double precision, which is all that exact sums of loops leave.
const DOUBLE_ROUNDING: f64 = 1e-11;
/// Truncation in double precision; samples with more fall back to closed loops.
const DOUBLE_TRUNCATION: f64 = 1e-9;
/// Rounding in single precision; samples with more are computed again, and the CSV rounds to single precision once
/// more.
const SINGLE: f64 = 1e-5 + 6e-8;
/// Rounding and truncation in single precision; samples truncated by more than 1e-5 fall back to closed loops.
const SINGLE_BY_HITS: f64 = 2.0 * SINGLE;
/// Share of samples computed again that would make single precision pointless; presets have few resonances.
const COMPUTED_AGAIN: f64 = 0.2;
/// Difference that `compare` promises; both of its sides are rounded alike.
const COMPARED: f64 = 1e-5;

/// Checks that the CSV of each of the options differs from the exact one by the tolerance beside them at most.
fn agree(exact: &str, run: impl Fn(&str) -> String, cases: &[(&str, f64)]) {
    for (options, tolerance) in cases {
        let found = difference(exact, &run(options));
        println!("{options}: {found:.1e}");
        assert!(found <= *tolerance, "{options}: {found:e}");
    }
}

#[test]
fn the_closed_form_and_both_ways_of_tracing_agree() {
    let user = User::new();
    for scene in SCENES {
        let run = |options: &str| user.ok(&format!("spectrum {scene} {GRID} {options}")).stdout;
        let exact = run("--precision f64 --method stack");
        println!("{scene}");
        let cases = [
            ("--precision f64 --method trace", DOUBLE_ROUNDING),
            ("--precision f64 --method hits", DOUBLE_TRUNCATION),
            ("--precision f32 --method stack", SINGLE),
            ("--precision f32 --method trace", SINGLE),
            ("--precision f32 --method hits", SINGLE_BY_HITS),
        ];
        agree(&exact, run, &cases);
        // To show that the comparison can fail: the models differ where there is more than one path.
        let paper = difference(&exact, &run("--precision f64 --method stack --model paper"));
        assert!(paper > 1e-3, "{scene}: {paper:e}");
    }
}

#[test]
fn precisions_hold_at_grazing_incidence() {
    let user = User::new();
    let run = |options: &str| user.ok(&format!("spectrum paper-fig4 --theta 85,89,89.9,89.9999 {options}")).stdout;
    let exact = run("--precision f64 --method stack");
    let cases = [
        ("--method stack", SINGLE),
        ("--method trace", SINGLE),
        ("--method hits", SINGLE_BY_HITS),
        ("--precision f64 --method trace", DOUBLE_ROUNDING),
    ];
    agree(&exact, run, &cases);
}

/// A narrow filter of quarter waves at 550 nm: so many pairs of 2.35 and 1.46 on each side of a half wave of 1.46, on
/// glass.
fn narrow_filter(pairs: usize) -> String {
    let (high, low) = (
        "{ material = 2.35, thickness_nm = 58.51063829787234 }",
        "{ material = 1.46, thickness_nm = 94.17808219178083 }",
    );
    let mirror = format!("{{ repeat = {pairs}, layers = [{high}, {low}] }}, {high}");
    format!("[stack]\nambient = 1.0\nlayers = [{mirror}, {low}, {low}, {mirror}]\nsubstrate = 1.52\n")
}

/// R_s, R_p, T_s, T_p of the first sample.
fn powers(csv: &str) -> [f64; 4] {
    QUANTITIES.map(|name| column(csv, name)[0])
}

#[test]
fn what_a_precision_cannot_hold_is_computed_again_with_more_digits() {
    // Computed with 80 digits by tests/precise/stacks.py.
    let filter = [0.042579994960947345, 0.042579994960947345, 0.9574200050390527, 0.9574200050390527];
    let thin = [0.34686137470976364, 0.34686137470976364, 0.6531386252902364, 0.6531386252902364];
    let gap = [0.4249395085181892, 0.04414539763225149, 0.5750604914818108, 0.9558546023677486];
    let film = |ambient: &str, film: &str, substrate: &str| {
        let layers = format!("[{{ material = {film}, thickness_nm = 100.0 }}]");
        format!("[stack]\nambient = {ambient}\nlayers = {layers}\nsubstrate = {substrate}\n")
    };
    let mut scenes: Vec<(String, &str, [f64; 4])> =
        [4, 6, 8, 10, 12].map(|pairs| (narrow_filter(pairs), "--theta 0 --wavelengths 550", filter)).into();
    scenes.push((film("1.0", "0.000001", "1.5"), "--theta 0 --wavelengths 550", thin));
    scenes.push((film("2.0", "1.0", "2.0"), "--theta 30 --wavelengths 633", gap));
    for (scene, light, want) in scenes {
        let user = User::with(&[("scene.toml", &scene)]);
        for method in ["stack", "trace"] {
            for (precision, tolerance) in [("f32", SINGLE), ("f64", DOUBLE_ROUNDING)] {
                let line = format!("spectrum scene.toml {light} --method {method} --precision {precision} --quiet");
                let found = powers(&user.ok(&line).stdout);
                let off = found.iter().zip(want).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs()));
                assert!(off <= tolerance, "{scene}{line}: {off:e}");
            }
        }
    }
}

#[test]
fn few_samples_of_the_presets_are_computed_again_and_estimate_says_how_many() {
    let user = User::new();
    for scene in SCENES {
        let again = |options: &str| -> f64 {
            let said =
                user.ok(&format!("estimate {scene} -o t.exr --angles 9 --wavelengths 380:780:5 {options}")).stderr;
            said.split("; ").find_map(|part| part.split_once(" samples computed again")?.0.parse().ok()).unwrap_or(0.0)
        };
        let (single, double) = (again(""), again("--precision f64"));
        println!("{scene}: {single} in single precision, {double} in double");
        assert!(single <= COMPUTED_AGAIN * 9.0 * 81.0 && double == 0.0, "{scene}: {single}, {double}");
        assert!(scene != "quarter-wave-mirror" || single > 0.0);
    }
}

#[test]
fn compare_finds_no_difference() {
    let user = User::new();
    for scene in SCENES.into_iter().chain(["paper-fig3", "paper-fig6-3000"]) {
        for method in ["trace", "hits"] {
            let ran = user.ok(&format!("compare {scene} --theta 0:85:5 --method {method} --plot compare.svg"));
            let [closed, traced] = ["R_closed_form", "R_ray_tracing"].map(|name| column(&ran.stdout, name));
            assert!(largest_difference(&closed, &traced) <= COMPARED, "{scene}");
            let said = ran.stderr.trim().rsplit(' ').next().and_then(|number| number.parse::<f64>().ok());
            let said = said.unwrap_or_else(|| panic!("the largest difference stands last: {}", ran.stderr));
            assert!((0.0..=COMPARED).contains(&said), "{scene} {method}: {said:e}");
            let shown = column(&ran.stdout, "difference").into_iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            // Unpolarised light averages s and p. The CSV has four digits, the note three.
            assert!(shown <= said * 1.01, "{scene} {method}: {shown:e} of {said:e}");
            assert!(String::from_utf8(user.read("compare.svg")).unwrap().contains("Ray tracing"));
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let user = User::new();
    for scene in SCENES {
        for method in ["stack", "trace", "hits"] {
            let run =
                |threads| user.ok(&format!("spectrum {scene} {GRID} --method {method} --threads {threads}")).stdout;
            let (one, two) = (run(1), run(2));
            assert!(one == two, "{scene} {method}");
        }
        for threads in [1, 2] {
            user.ok(&format!("estimate {scene} -o {threads}.exr --threads {threads} --quiet"));
        }
        assert!(user.read("1.exr") == user.read("2.exr"), "{scene}");
    }
}

#[test]
fn equal_runs_give_equal_files() {
    let user = User::new();
    for file in ["a.exr", "b.exr"] {
        user.ok(&format!("estimate jewel-beetle -o {file} --quiet"));
    }
    assert!(user.read("a.exr") == user.read("b.exr"));
    for kind in ["disc", "spectrum", "map"] {
        for extension in ["png", "svg"] {
            for table in ["a", "b"] {
                user.ok(&format!("plot {table}.exr --kind {kind} -o {table}.{extension}"));
            }
            let [a, b] = ["a", "b"].map(|table| user.read(&format!("{table}.{extension}")));
            assert!(a == b, "{kind} {extension}");
        }
    }
}
