//! Tests of the commands on cells of tilted facets: energy, threads, reciprocity, warnings, refusals.

use glam::{DVec3, Vec3};
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

fn direction([theta, phi]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (sin_phi, cos_phi)) = (theta.sin_cos(), phi.sin_cos());
    DVec3::new(sin * cos_phi, sin * sin_phi, cos)
}

/// Difference of what a table's look-up reflects at an incident direction and what was counted there: rounding of
/// single precision in sums over some thousand nodes.
const SUMMED: f64 = 1e-5;

#[test]
fn a_lossless_cell_loses_nothing() {
    let user = user();
    for grid in ["3x4 --half-vectors 8x16", "3x1 --half-vectors 16x8"] {
        let options = "--rays 1024 --wavelengths 550 --coherence none -q";
        user.ok(&format!("estimate bumps.toml -o t.exr --incident {grid} {options}"));
        let table = table(&user, "t.exr");
        let lookup = table.spectral_lookup().unwrap();
        let lookup = lookup.table().unwrap();
        for (incident, energy) in table.energy.iter().enumerate() {
            let sum = energy.reflected.value + energy.transmitted + energy.absorbed + energy.truncated;
            // The sum includes the power truncated; single precision rounds a few dozen factors of each path.
            assert!((sum - 1.0).abs() < 1e-4, "{incident}: {sum}");
            assert!(energy.truncated < 0.01, "{energy:?}");
            let mut albedo = [0.0];
            lookup.albedo(direction(table.layout.incident(incident)).as_vec3(), &mut albedo);
            let [albedo] = albedo.map(f64::from);
            assert!((albedo - energy.reflected.value).abs() < SUMMED, "{grid} {incident}: {albedo}, {energy:?}");
        }
    }
}

/// Walls of silicon at 54.7°, with level parts between them.
#[test]
fn pyramids_have_exact_lobes_where_two_reflections_by_hand_say() {
    let user = User::new();
    let options = "--incident 4x8 --half-vectors 4x8 --rays 1024 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate silicon-pyramids -o t.exr {options}"));
    let table = table(&user, "t.exr");
    let lookup = table.spectral_lookup().unwrap();
    let lookup = lookup.table().unwrap();
    let steep = 54.7356_f64.to_radians();
    let walls = [0.0, 90.0, 180.0, 270.0].map(|phi: f64| direction([steep, phi.to_radians()]));
    let reflected = |d: DVec3, wall: DVec3| d - 2.0 * d.dot(wall) * wall;
    let lobes = |wi: DVec3| -> Vec<(Vec3, f32)> {
        let mut rho = [0.0];
        let lobe = |lobe| Some((lookup.reflected(wi.as_vec3(), lobe, &mut rho)?, rho[0]));
        (0..table.layout.lobes()).filter_map(lobe).collect()
    };
    // Light along the normal meets a wall, then the one opposite, and leaves at 38.9° with the power of both.
    let from_above = lobes(DVec3::Z);
    for (first, second) in [(0, 2), (1, 3), (2, 0), (3, 1)] {
        let expected = reflected(reflected(-DVec3::Z, walls[first]), walls[second]).as_vec3();
        let found = from_above.iter().filter(|(wo, _)| wo.distance(expected) < 1e-5).map(|lobe| lobe.1).sum::<f32>();
        assert!(found > 0.01, "{expected}: {from_above:?}");
    }
    // Between the nodes of the table lobes are exact too.
    let wi = direction([0.2, 0.3]);
    let between = lobes(wi);
    let pairs = walls.map(|first| walls.map(|second| reflected(reflected(-wi, first), second).as_vec3()));
    let exact = |wo: &Vec3| pairs.as_flattened().iter().any(|expected| wo.distance(*expected) < 1e-5);
    let by_two: f32 = between.iter().filter(|(wo, _)| exact(wo)).map(|lobe| lobe.1).sum();
    let all: f32 = between.iter().map(|lobe| lobe.1).sum();
    println!("{by_two} of {all} by two reflections");
    assert!(by_two > 0.0 && all > 0.0);
}

#[test]
fn tables_do_not_depend_on_the_number_of_threads_and_follow_the_seed() {
    let user = user();
    let run = |name: &str, options: &str| {
        let common = "--incident 2x2 --half-vectors 4x8 --rays 64 --wavelengths 450,550 -q";
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
    let common = "--incident 2x1 --half-vectors 4x8 --rays 32 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o t.exr {common} --target-error 0.004"));
    let table = table(&user, "t.exr");
    assert!(table.worst_error() <= 0.004);
    assert!(table.energy.iter().any(|energy| energy.rays > 32));
}

/// Pairs of directions of a table's incident directions and nodes above the horizon: incident direction, node, and s of
/// the exchanged directions in a table, whose place lies between incident directions.
fn exchanged(table: &ScatterTable) -> Vec<(usize, usize, f64)> {
    let layout = table.layout;
    let lookup = table.spectral_lookup().unwrap();
    let lookup = lookup.table().unwrap();
    let least = layout.incident(layout.incident_count() - 1)[0].cos() as f32;
    let mut pairs = Vec::new();
    for incident in 0..layout.incident_count() {
        let wi = direction(layout.incident(incident)).as_vec3();
        for node in 0..layout.node_count() {
            let [x, y] = layout.node(node).map(|place| place as f32);
            let (m, _) = lookup.warp().half_vector([x, y], 0.0);
            let wo = 2.0 * wi.dot(m) * m - wi;
            if wo.z < least || wi.dot(m) <= 0.0 {
                continue;
            }
            let mut f = [0.0];
            lookup.eval(wo, wi, &mut f);
            pairs.push((incident, node, f64::from(f[0] * wo.z * wi.z.max(least))));
        }
    }
    pairs
}

/// Σ|s(wi, wo) − s(wo, wi)| over the mean Σs. 2048 rays and interpolation over 45° of azimuth leave 0.17; a turned or
/// mirrored azimuth leaves more than 1, and no common light 2.
const BOTH_WAYS: f64 = 0.25;

#[test]
fn tables_are_reciprocal() {
    let user = user();
    let common = "--incident 8x8 --half-vectors 8x16 --rays 2048 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o t.exr {common}"));
    let table = table(&user, "t.exr");
    let (mut difference, mut noise, mut sum) = (0.0, 0.0, 0.0);
    for (incident, node, back) in exchanged(&table) {
        let there = f64::from(table.row(incident, 0)[node]);
        difference += (there - back).abs();
        noise += f64::from(table.luminance_error[incident * table.layout.places() + node]);
        sum += there + back;
    }
    println!("Σ|s(wi, wo) − s(wo, wi)|/Σs {:.3}, standard errors {:.3}", 2.0 * difference / sum, 2.0 * noise / sum);
    assert!(sum > 1.0 && 2.0 * difference / sum < BOTH_WAYS);
}

#[test]
fn every_kind_of_picture_shows_a_cell() {
    let user = user();
    user.ok("estimate bumps.toml -o t.exr --incident 2x2 --half-vectors 4x8 --rays 64 --wavelengths 450:650:50 -q");
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
    user.ok("estimate bumps.toml -o one.exr --incident 2x2 --half-vectors 4x8 --rays 64 --wavelengths 550 -q");
    user.refused("plot one.exr --kind map -o b.svg", 2, &["--kind map", "one wavelength"]);
}

/// Rounding of single precision in the places of exchanged directions, some 1e-6 of the square, over which s changes by
/// as much times 16 nodes and the densities of the warp.
const ROUNDINGS: f64 = 1e-4;

#[test]
fn a_reciprocal_table_is_the_mean_of_both_ways() {
    let user = user();
    let common = "--incident 8x8 --half-vectors 8x16 --rays 256 --wavelengths 550 --coherence none -q";
    user.ok(&format!("estimate bumps.toml -o traced.exr {common}"));
    user.ok(&format!("estimate bumps.toml -o mean.exr {common} --reciprocal"));
    let [traced, mean] = ["traced.exr", "mean.exr"].map(|name| table(&user, name));
    let pairs = exchanged(&traced);
    let (mut less_noise, mut compared, mut worst) = (0, 0, 0.0f64);
    for &(incident, node, back) in &pairs {
        let [there, found] = [&traced, &mean].map(|table| f64::from(table.row(incident, 0)[node]));
        let expected = 0.5 * (there + back);
        worst = worst.max((found - expected).abs() / (1.0 + expected));
        let [before, after] =
            [&traced, &mean].map(|table| table.luminance_error[incident * table.layout.places() + node]);
        if before > 0.0 {
            compared += 1;
            less_noise += usize::from(after < before);
        }
    }
    println!("{} pairs, worst {worst:.1e}; {less_noise} of {compared} with a smaller error", pairs.len());
    assert!(pairs.len() > 2000 && worst < ROUNDINGS);
    // What is left is interpolation between incident directions, not noise.
    let apart = |table: &ScatterTable| -> f64 {
        let difference =
            |(incident, node, back): (usize, usize, f64)| (f64::from(table.row(incident, 0)[node]) - back).abs();
        exchanged(table).into_iter().map(difference).sum()
    };
    let [before, after] = [&traced, &mean].map(apart);
    println!("both ways differ by {after:.2} where they did by {before:.2}");
    assert!(after < 0.5 * before);
    // Both errors are equal on average, so the mean nearly always has the smaller one.
    assert!(less_noise * 10 > compared * 9, "{less_noise} of {compared}");
    // What reflects below the horizon, or beyond the last incident direction, stays.
    let mut stays = vec![true; traced.values.len()];
    pairs.iter().for_each(|&(incident, node, _)| stays[incident * traced.layout.places() + node] = false);
    let kept = stays.iter().zip(traced.values.iter().zip(&mean.values)).filter(|(stays, _)| **stays);
    assert!(kept.clone().count() > 100 && kept.clone().all(|(_, (a, b))| a == b));
}

#[test]
fn options_that_do_not_apply_are_refused() {
    let user = user();
    for (line, says) in [
        ("estimate bumps.toml -o t.exr --angles 4", "--angles"),
        ("estimate bumps.toml -o t.exr --model paper", "--model"),
        ("estimate bumps.toml -o t.exr --bins 16x32", "--half-vectors"),
        ("estimate bumps.toml -o t.exr --half-vectors 1x8", "half-vector angles"),
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

    let options = "--incident 3x2 --half-vectors 2x4 --rays 256 --wavelengths 550";
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
    let said =
        |line: &str| user.ok(&format!("estimate {line} -o t.exr --incident 2x2 --half-vectors 2x4 --rays 32")).stderr;
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
    user.ok("estimate faint.toml -o t.exr --incident 2x1 --half-vectors 4x8 --rays 32 --wavelengths 450,550 -q");
}

#[test]
fn every_command_refuses_a_cell_under_a_murky_medium_alike() {
    let user = User::with(&[("murky.toml", &from_inside("0.002"))]);
    let says =
        ["murky: material glass: k = 0.002 at 550 nm; light can arrive only through a medium with k up to 0.001"];
    user.refused("orders murky.toml --wavelengths 420,550 --rays 64 --csv o.csv", 1, &says);
    user.refused("estimate murky.toml -o t.exr --wavelengths 420,550 --incident 2x1 --half-vectors 4x8 -q", 1, &says);
    for coherence in ["none", "ray", "bin", "cell"] {
        user.refused(&format!("scatter murky.toml --wavelength 550 --coherence {coherence} --json -"), 1, &says);
        user.ok(&format!("scatter murky.toml --wavelength 420 --coherence {coherence} --rays 32 --json s.json"));
    }
}
