//! The same question asked in different ways has one answer.

use crate::user::{User, column, largest_difference};

const QUANTITIES: [&str; 4] = ["R_s", "R_p", "T_s", "T_p"];
const SCENES: [&str; 4] = ["paper-fig4", "jewel-beetle", "anodised-titanium", "quarter-wave-mirror"];
const GRID: &str = "--theta 0:75:15 --wavelengths 380:780:20";

fn difference(a: &str, b: &str) -> f64 {
    QUANTITIES.map(|name| largest_difference(&column(a, name), &column(b, name))).into_iter().fold(0.0, f64::max)
}

/// Loops summed exactly leave only rounding.
const DOUBLE_ROUNDING: f64 = 1e-11;
/// Samples that hits would leave further off have their loops closed.
const DOUBLE_TRUNCATION: f64 = 1e-9;
/// Each of up to 21 planes rounds once, 1.2e-7; a resonance between two planes amplifies that by the inverse square of what
/// one plane transmits, no less than 0.37 up to 75°: 2e-5.
const SINGLE: f64 = 2e-5;
/// The same at 89°, where a film of n = 2.4 transmits 0.031 and six planes round: 7e-4.
const SINGLE_AT_GRAZING: f64 = 7e-4;
/// What `compare` promises: both of its sides round alike.
const COMPARED: f64 = 1e-5;

#[test]
fn the_closed_form_and_both_ways_of_tracing_agree() {
    let user = User::new();
    for scene in SCENES {
        let run = |options: &str| user.ok(&format!("spectrum {scene} {GRID} {options}")).stdout;
        let exact = run("--precision f64 --method stack");
        for (options, tolerance) in [
            ("--precision f64 --method trace", DOUBLE_ROUNDING),
            ("--precision f64 --method hits", DOUBLE_TRUNCATION),
            ("--precision f32 --method stack", SINGLE),
            ("--precision f32 --method trace", SINGLE),
            ("--precision f32 --method hits", SINGLE),
        ] {
            let found = difference(&exact, &run(options));
            println!("{scene} {options}: {found:.1e}");
            assert!(found <= tolerance, "{scene} {options}: {found:e}");
        }
        // The comparison can fail: the models differ where there is more than one path.
        let paper = difference(&exact, &run("--precision f64 --method stack --model paper"));
        assert!(paper > 1e-3, "{scene}: {paper:e}");
    }
}

#[test]
fn at_grazing_incidence_single_precision_loses_two_digits_in_resonances() {
    let user = User::new();
    let run = |options| user.ok(&format!("spectrum paper-fig4 --theta 85,89 {options}")).stdout;
    let exact = run("--precision f64 --method stack");
    for method in ["--method stack", "--method trace", "--method hits"] {
        let found = difference(&exact, &run(method));
        println!("paper-fig4 {method} at 85 and 89 degrees: {found:.1e}");
        assert!(found <= SINGLE_AT_GRAZING, "{method}: {found:e}");
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
            // Unpolarised light averages the two; the CSV rounds to four digits, the remark to three.
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
