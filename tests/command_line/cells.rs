//! Tests of the commands on cells of tilted facets: energy, threads, reciprocity, warnings, refusals.

use goniochrome_cli::table::Table;
use goniochrome_cli::table::file::read;
use goniochrome_cli::table::scatter::ScatterTable;

use crate::user::User;

const BUMPS: &str = include_str!("../data/cells/bumps-glass.obj");
const SCENE: &str = "[cell]\nmesh = \"bumps.obj\"\nperiod_nm = [20000.0, 20000.0]\n\
                     [interface.surface]\nabove = 1.0\nbelow = 1.5\n";

fn user() -> User {
    User::with(&[("bumps.toml", SCENE), ("bumps.obj", BUMPS)])
}

fn table(user: &User, name: &str) -> ScatterTable {
    match read(&user.at(name)).unwrap() {
        Table::Scatter(table) => table,
        Table::Mirror(_) | Table::Orders(_) => panic!("{name} is no scatter table"),
    }
}

#[test]
fn a_lossless_cell_loses_nothing() {
    let user = user();
    user.ok(
        "estimate bumps.toml -o t.exr --incident 2x2 --bins 8x16 --rays 1024 --wavelengths 550 --coherence none -q",
    );
    let table = table(&user, "t.exr");
    let layout = table.layout;
    for (incident, energy) in table.energy.iter().enumerate() {
        let sum = energy.reflected.value + energy.transmitted + energy.absorbed + energy.truncated;
        // The sum includes the power truncated; single precision rounds a few dozen factors of each path.
        assert!((sum - 1.0).abs() < 1e-4, "{incident}: {sum}");
        assert!(energy.truncated < 0.01, "{energy:?}");
        let solid_angle = |bin| layout.bins().projected_solid_angle(bin);
        let bins = table.row(incident, 0).iter().enumerate();
        let albedo: f64 = bins.map(|(bin, f)| f64::from(*f) * solid_angle(bin)).sum();
        assert!((albedo - energy.reflected.value).abs() < 1e-5, "{incident}: {albedo}, {energy:?}");
    }
}

#[test]
fn tables_do_not_depend_on_the_number_of_threads_and_follow_the_seed() {
    let user = user();
    let run = |name: &str, options: &str| {
        let common = "--incident 2x2 --bins 4x8 --rays 64 --wavelengths 450,550 -q";
        user.ok(&format!("estimate bumps.toml -o {name}.exr {common} {options}"));
        user.read(&format!("{name}.exr"))
    };
    let one = run("one", "--threads 1");
    assert!(one == run("two", "--threads 2"));
    assert!(one != run("seed", "--seed 1"));
}

#[test]
fn more_rays_are_traced_until_the_error_is_reached() {
    let user = user();
    let common = "--incident 2x1 --bins 4x8 --rays 32 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o t.exr {common} --target-error 0.004"));
    let table = table(&user, "t.exr");
    assert!(table.worst_error() <= 0.004);
    assert!(table.energy.iter().any(|energy| energy.rays > 32));
}

#[test]
fn tables_are_reciprocal() {
    let user = user();
    // Few incident and outgoing directions of these grids have equal cos θ, so f is interpolated, away from the ends.
    let common = "--incident 8x8 --bins 8x16 --rays 2048 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o t.exr {common}"));
    let table = table(&user, "t.exr");
    let layout = table.layout;
    let (mut pairs, mut excess, mut worst) = (0, 0, 0.0_f64);
    for incident in 8..48 {
        let [theta_i, phi_i] = layout.incident(incident);
        for bin in (32..112).step_by(5) {
            let [cos_o, relative] = layout.outgoing(bin);
            let from = layout.incident_nodes(cos_o.acos() as f32, (phi_i + relative) as f32);
            let to = layout.outgoing_nodes(theta_i.cos() as f32, -relative as f32);
            let (mut back, mut variance) = (0.0, f64::from(table.luminance_error[incident * 128 + bin]).powi(2));
            for (i, o) in from.iter().flat_map(|i| to.map(|o| (i, o))) {
                let weight = f64::from(i.weight * o.weight);
                back += weight * f64::from(table.row(i.index, 0)[o.index]);
                variance += (weight * f64::from(table.luminance_error[i.index * 128 + o.index])).powi(2);
            }
            let f = f64::from(table.row(incident, 0)[bin]);
            // Bins are wide, so interpolation between them errs by a large part of the larger value.
            let allowed = 4.0 * variance.sqrt() + 0.35 * f.max(back) + 2e-3;
            worst = worst.max((f - back).abs() / allowed);
            excess += usize::from((f - back).abs() > allowed);
            pairs += 1;
        }
    }
    println!("{pairs} pairs, {excess} beyond, worst {worst:.2}");
    assert!(pairs >= 100 && excess * 50 <= pairs, "{excess} of {pairs}");
}

#[test]
fn every_kind_of_picture_shows_a_cell() {
    let user = user();
    user.ok("estimate bumps.toml -o t.exr --incident 2x2 --bins 4x8 --rays 64 --wavelengths 450:650:50 -q");
    for (kind, says) in [
        ("disc", ["light from θ = 30°, φ = 0°", "angle from the normal θ"]),
        ("lobes --theta 20", ["light at 20°", "Luminance of f cos θ (1/sr)"]),
        ("spectrum --theta 20 --phi 30", ["θ 20° → 20°", "light from φ = 30° towards φ = 210°"]),
        ("spectrum --theta 20 --theta-out 5 --phi-out 90", ["θ 20° → 5°", "BRDF f (1/sr)"]),
        ("map --phi 30", ["Angle of incidence (°)", "light at φ = 30°"]),
        ("chromaticity --theta 0,70", ["CIE 1931 x", "70°"]),
    ] {
        user.ok(&format!("plot t.exr --kind {kind} -o a.svg"));
        let svg = String::from_utf8(user.read("a.svg")).expect("text");
        for text in says {
            assert!(svg.contains(text), "{kind}: {text} is missing");
        }
    }
    user.refused("plot t.exr --kind spectrum --theta-out 90 -o b.svg", 2, &["--theta-out 90", "[0, 90)"]);
    user.refused("plot t.exr --kind disc --theta-out 9 -o b.svg", 2, &["--theta-out", "leave them out"]);
    user.ok("estimate bumps.toml -o one.exr --incident 2x2 --bins 4x8 --rays 64 --wavelengths 550 -q");
    user.refused("plot one.exr --kind map -o b.svg", 2, &["--kind map", "one wavelength"]);
}

/// Rounding of single precision in a sum of four products.
const ROUNDINGS: f64 = 1e-6;

#[test]
fn a_reciprocal_table_is_the_mean_of_both_ways() {
    let user = user();
    let common = "--incident 8x8 --bins 8x16 --rays 256 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o traced.exr {common}"));
    user.ok(&format!("estimate bumps.toml -o mean.exr {common} --reciprocal"));
    let [traced, mean] = ["traced.exr", "mean.exr"].map(|name| table(&user, name));
    let layout = traced.layout;
    let (mut averaged, mut less_noise, mut compared) = (0, 0, 0);
    for incident in 0..64 {
        let [theta_i, phi_i] = layout.incident(incident);
        for bin in 0..128 {
            let [cos_o, relative] = layout.outgoing(bin);
            let [there, found] = [&traced, &mean].map(|table| f64::from(table.row(incident, 0)[bin]));
            // Inside the grid f(wo, wi) can be looked up; outside f is unchanged.
            let inside = cos_o < layout.incident(0)[0].cos() && cos_o > layout.incident(63)[0].cos();
            let inside = inside && theta_i.cos() > layout.outgoing(0)[0] && theta_i.cos() < layout.outgoing(127)[0];
            let expected = if inside {
                let from = layout.incident_nodes(cos_o.acos() as f32, (phi_i + relative) as f32);
                let to = layout.outgoing_nodes(theta_i.cos() as f32, -relative as f32);
                let pairs = from.iter().flat_map(|i| to.map(|o| (i, o)));
                let back: f64 =
                    pairs.map(|(i, o)| f64::from(i.weight * o.weight * traced.row(i.index, 0)[o.index])).sum();
                averaged += 1;
                0.5 * (there + back)
            } else {
                there
            };
            assert!((found - expected).abs() <= ROUNDINGS * (1.0 + expected), "{incident} {bin}: {found} {expected}");
            let [before, after] = [&traced, &mean].map(|table| table.luminance_error[incident * 128 + bin]);
            if inside && before > 0.0 {
                compared += 1;
                less_noise += usize::from(after < before);
            }
        }
    }
    assert!(averaged > 2000, "{averaged}");
    // Both errors are equal on average, so the mean nearly always has the smaller one.
    assert!(less_noise * 10 > compared * 9, "{less_noise} of {compared}");
}

#[test]
fn options_that_do_not_apply_are_refused() {
    let user = user();
    for (line, says) in [
        ("estimate bumps.toml -o t.exr --angles 4", "--angles"),
        ("estimate bumps.toml -o t.exr --model paper", "--model"),
        ("estimate bumps.toml -o t.exr --incident 4x3 --bins 4x8", "multiple"),
        ("estimate bumps.toml -o t.exr --wavelengths auto", "name the wavelengths"),
        ("estimate bumps.toml -o t.exr --target-error 0", "--target-error"),
        ("estimate bumps.toml -o t.exr --coherence cell --rays 64", "computed by waves"),
        ("scatter bumps.toml --wavelengths auto", "name the wavelengths"),
        ("orders bumps.toml --wavelengths auto", "name the wavelengths"),
        ("estimate paper-fig4 -o t.exr --rays 64", "--rays"),
        ("estimate paper-fig4 -o t.exr --reciprocal", "--reciprocal"),
    ] {
        user.refused(line, 2, &[says]);
    }
    let period = ["period of 20000 × 20000 nm", "orders at 380 nm", "for each direction and layer"];
    user.refused("estimate bumps.toml -o t.exr --coherence cell", 1, &period);
}

#[test]
fn orders_say_how_far_efficiencies_may_be_off_unless_they_are_good() {
    let wide = "[cell]\nperiod_nm = [16000, 1000]\n\
                surface = { kind = \"grooves\", points_nm = [[0, 0], [8000, 100], [16000, 0]] }\n\
                [interface.grooves]\nabove = 1.0\nbelow = 1.5\n";
    let user = User::with(&[("wide.toml", wide)]);
    let orders = |options: &str| user.ok(&format!("orders {options} --rays 1024 --csv o.csv")).stderr;
    let disc = orders("compact-disc --wavelengths 450,650");
    assert!(
        disc.contains("by up to 0.") && disc.contains("650 nm") && disc.contains("R_s = R_p by construction"),
        "{disc}"
    );
    let dvd = orders("dvd --theta 30 --phi 270 --wavelengths 650");
    assert!(dvd.contains("may be off by any amount") && !dvd.contains("by construction"), "{dvd}");
    let wide = orders("wide.toml");
    assert!(!wide.contains("may be off"), "{wide}");
    let cell = |scene: &str| {
        let line = format!("scatter {scene} --coherence cell --rays 1024 --wavelength 650 --json s.json");
        user.ok(&line).stderr
    };
    let claim =
        |said: &str| said.split_once("directions are exact").map(|(_, claim)| claim.lines().next().unwrap().to_owned());
    assert_eq!(
        claim(&cell("compact-disc")),
        claim(&orders("compact-disc --wavelengths 650")),
        "one claim in both places"
    );
    assert!(claim(&disc).is_some() && claim(&cell("wide.toml")).is_none());
}

#[test]
fn scatter_takes_several_wavelengths() {
    let user = user();
    let one = |nm: &str| user.ok(&format!("scatter bumps.toml --rays 64 --bins 1x1 --wavelength {nm}")).stdout;
    let both = user.ok("scatter bumps.toml --rays 64 --bins 1x1 --wavelengths 450,550").stdout;
    let parse = |text: &str| serde_json::from_str::<serde_json::Value>(text).expect("JSON");
    assert_eq!(parse(&both), serde_json::Value::Array(vec![parse(&one("450")), parse(&one("550"))]));
}

/// Ridges of two shelves a side, half a wavelength wide.
const RIDGES: &str = "[cell]\nperiod_nm = [700.0, 700.0]\n\
    surface = { kind = \"lamellae\", shelves = 2, width_nm = 400.0, top_width_nm = 250.0, shelf_nm = 60.0, \
    gap_nm = 130.0, trunk_nm = 60.0, stagger_nm = 65.0 }\n[interface.cuticle]\nabove = \"air\"\nbelow = [1.56, 0.06]\n";

/// Ridges at 45 degrees, where the power of waves between the shelves does not balance.
#[test]
fn power_that_does_not_balance_is_told_at_the_prompt_and_in_the_file() {
    let user = User::with(&[("ridges.toml", RIDGES)]);
    let light = "--theta 45 --phi 20 --rays 256 --bins 2x4";
    let ran = user.ok(&format!("scatter ridges.toml {light}"));
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let warning = report["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains("power balances only to -0.1") && ran.stderr.contains(warning), "{}", ran.stderr);
    let quiet = user.ok(&format!("scatter ridges.toml {light} --coherence none --quiet"));
    assert!(quiet.stdout.contains("\"warnings\": []") && quiet.stderr.is_empty());

    let options = "--incident 2x2 --bins 2x4 --rays 256 --wavelengths 550";
    let ran = user.ok(&format!("estimate ridges.toml -o ray.exr {options}"));
    assert!(ran.stderr.contains("power balances only to") && ran.stderr.contains("imbalance ≤ "), "{}", ran.stderr);
    let ray = table(&user, "ray.exr");
    let warning = ray.metadata.get("warning").unwrap();
    assert!(warning.contains("--coherence none keeps power") && warning.contains("starting rays do not converge"));
    assert!(ray.energy.iter().any(|energy| energy.without_interference > 0.01));
    assert!(ray.metadata.get("imbalance_max").unwrap().parse::<f64>().unwrap().abs() > 0.05);
    assert!(ray.energy.iter().any(|energy| energy.imbalance.value.abs() > 0.05));
    user.ok(&format!("estimate ridges.toml -o none.exr {options} --coherence none"));
    let none = table(&user, "none.exr");
    assert!(none.metadata.get("warning").is_none() && none.energy.iter().all(|e| e.imbalance.value.abs() < 1e-4));
}

/// Waves that find no slot or ring for ever fall back to paths without interference, so their light is not left out.
#[test]
fn shelves_leave_out_no_light() {
    let user = User::with(&[("ridges.toml", RIDGES)]);
    let ran = user.ok("scatter ridges.toml --theta 20 --phi 20 --rays 256 --bins 2x4 -q");
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let of = |key: &str| report[key]["value"].as_f64().expect("a number");
    assert!(of("truncated") <= 1e-3 && of("without_interference") > 0.0, "{}", ran.stdout);
}

/// Two gaps beyond the critical angle: the gain of the loop between them is above 1, so the sum hit by hit diverges.
#[test]
fn waves_without_a_sum_are_refused_or_told() {
    let plane = |z: i32| format!("v 0 0 {z}\nv 900 0 {z}\nv 900 900 {z}\nv 0 900 {z}\n");
    let face = |i: i32| format!("usemtl i{i}\nf {} {} {} {}\n", 4 * i + 1, 4 * i + 2, 4 * i + 3, 4 * i + 4);
    let mesh = [0, -200, -500, -700].map(plane).concat() + &[0, 1, 2, 3].map(face).concat();
    let media = ["1.5", "1.0", "1.6", "1.0", "1.5"];
    let between = |i: usize| format!("[interface.i{i}]\nabove = {}\nbelow = {}\n", media[i], media[i + 1]);
    let scene =
        "[cell]\nmesh = \"gaps.obj\"\nperiod_nm = [900, 900]\n".to_owned() + &[0, 1, 2, 3].map(between).concat();
    let user = User::with(&[("gaps.obj", &mesh), ("gaps.toml", &scene)]);
    let light = "--theta 43 --wavelengths 550 --rays 64";
    let says = ["interfering waves do not converge", "--coherence none"];
    user.refused(&format!("orders gaps.toml {light}"), 1, &says);
    user.refused(&format!("scatter gaps.toml {light} --coherence cell -q"), 1, &says);
    user.refused(&format!("scatter gaps.toml {light} --coherence bin"), 1, &says);
    let ran = user.ok(&format!("scatter gaps.toml {light}"));
    let report: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON");
    let warning = report["warnings"][0].as_str().expect("a warning");
    assert!(warning.contains("100 % of the starting rays") && ran.stderr.contains(warning), "{}", ran.stderr);
}

#[test]
fn wavelengths_too_few_for_films_on_facets_are_told() {
    let scene = |nm: u32| {
        format!(
            "[cell]\nperiod_nm = [1000, 1000]\n\
             surface = {{ kind = \"grooves\", points_nm = [[0, 0], [500, 100], [1000, 0]] }}\n\
             [interface.grooves]\nabove = 1.0\nbelow = 1.5\ncoating = [{{ material = 2.4, thickness_nm = {nm} }}]\n"
        )
    };
    let user = User::with(&[("thick.toml", &scene(15_000)), ("thin.toml", &scene(150))]);
    let said = |line: &str| user.ok(&format!("estimate {line} -o t.exr --incident 2x2 --bins 2x4 --rays 32")).stderr;
    assert!(said("thick.toml").contains("too few for the fringes of films"));
    assert!(table(&user, "t.exr").metadata.get("warning").unwrap().contains("too few"));
    for line in ["thin.toml", "thick.toml --wavelengths 400:500:0.5", "thick.toml --coherence none"] {
        assert!(!said(line).contains("too few"), "{line}");
    }
}

#[test]
fn orders_say_what_they_do_not_follow() {
    let user = User::with(&[(
        "roof.toml",
        "[cell]\nperiod_nm = [8000, 8000]\n\
         surface = { kind = \"grooves\", points_nm = [[0, 0], [4000, 12000], [8000, 0]] }\n\
         [interface.grooves]\nabove = 1.0\nbelow = \"mirror\"\n",
    )]);
    let light = "--rays 256 --max-order 1 --wavelengths 550";
    let ran = user.ok(&format!("orders roof.toml {light}"));
    assert!(ran.stderr.contains("single scattering: 1.0e0 of the light meets the surface again"), "{}", ran.stderr);
    assert!(ran.stdout.lines().nth(1).expect("an order").ends_with(",1.00e0"), "{}", ran.stdout);
    assert_eq!(user.ok(&format!("orders roof.toml {light} --quiet")).stderr, "");
    let says = ["of the light was lost or given up on its way, more than the 1e-3", "--hits"];
    user.refused(&format!("orders roof.toml {light} --hits 2"), 1, &says);
    let ran = user.ok(&format!("orders roof.toml {light} --hits 8"));
    assert!(
        !ran.stderr.contains("single scattering") && ran.stdout.lines().nth(1).expect("an order").ends_with(",0.00e0")
    );
}

/// A wavy surface of glass lit from inside the glass, whose k is given.
fn from_inside(k: &str) -> String {
    let surface = "{ kind = \"sines\", waves = 12, highest = 4, rms_slope = 0.35, grid = [16, 16], seed = 1 }";
    format!(
        "[cell]\nperiod_nm = [10000.0, 10000.0]\nsurface = {surface}\n[interface.upper]\nabove = \"glass\"\nbelow = 1.0\n\
         [materials.glass]\ntable = [[400, 1.52, 0], [500, 1.52, {k}], [700, 1.52, {k}]]\n"
    )
}

/// Share of light lost between facets: 4π k/λ times a hundredth of a millimetre.
const FAINTLY_LOST: f64 = 3e-6;

#[test]
fn light_reaches_a_cell_through_faint_absorption_in_every_command() {
    let user = User::with(&[("clear.toml", &from_inside("0")), ("faint.toml", &from_inside("1e-8"))]);
    let reflected = |scene: &str, coherence: &str| {
        let light = format!("--theta 20 --phi 30 --wavelength 550 --coherence {coherence} --rays 512 --quiet --json -");
        let report: serde_json::Value =
            serde_json::from_str(&user.ok(&format!("scatter {scene} {light}")).stdout).expect("JSON");
        report["reflected"]["value"].as_f64().expect("a number")
    };
    for coherence in ["none", "ray", "bin", "cell"] {
        let [clear, faint] = ["clear.toml", "faint.toml"].map(|scene| reflected(scene, coherence));
        assert!((clear - faint).abs() <= FAINTLY_LOST, "{coherence}: {clear} {faint}");
    }
    user.ok("orders faint.toml --wavelengths 550 --rays 64 --max-order 2 --csv orders.csv");
    user.ok("estimate faint.toml -o t.exr --incident 2x1 --bins 4x8 --rays 32 --wavelengths 450,550 -q");
}

#[test]
fn every_command_refuses_a_cell_under_a_murky_medium_alike() {
    let user = User::with(&[("murky.toml", &from_inside("0.002"))]);
    let says =
        ["murky: material glass: k = 0.002 at 550 nm; light can arrive only through a medium with k up to 0.001"];
    user.refused("orders murky.toml --wavelengths 420,550 --rays 64 --csv o.csv", 1, &says);
    user.refused("estimate murky.toml -o t.exr --wavelengths 420,550 --incident 2x1 --bins 4x8 -q", 1, &says);
    for coherence in ["none", "ray", "bin", "cell"] {
        user.refused(&format!("scatter murky.toml --wavelength 550 --coherence {coherence} --json -"), 1, &says);
        user.ok(&format!("scatter murky.toml --wavelength 420 --coherence {coherence} --rays 32 --json s.json"));
    }
}
