//! Tests of the commands on diffraction by waves: orders, scattering, tables, random periods, refusals.

use std::time::Duration;
use std::{fs, thread};

use goniochrome_cli::table::Table;
use goniochrome_cli::table::file::read;
use goniochrome_cli::table::orders::OrderTable;

use crate::user::User;

/// Rounding of printed efficiencies, which have nine digits.
const DIGITS: f64 = 1e-9;

/// Largest efficiency of an order that grazes at an exact anomaly, where the solver keeps its k_z/n at 1e-6.
const GRAZING: f64 = 1e-6;

/// Lines of glass on glass: lossless, asymmetric.
const LINES: &str = "[cell]\nperiod_nm = [700.0, 700.0]\nperiods = \"coherent\"\n\
    surface = { kind = \"grooves\", points_nm = [[0, 60], [210, 60], [210, 140], [350, 140], [350, 0], [700, 0]] }\n\
    [interface.grooves]\nabove = 1.0\nbelow = 1.5\n";

fn user() -> User {
    User::with(&[("lines.toml", LINES)])
}

/// Rows of a CSV as numbers; empty fields are NaN.
fn rows(csv: &str) -> Vec<Vec<f64>> {
    csv.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect()).collect()
}

fn orders(user: &User, name: &str) -> OrderTable {
    match read(&user.at(name)).unwrap() {
        Table::Orders(table) => table,
        other => panic!("{name} is no table of orders: {}", other.name()),
    }
}

#[test]
fn orders_by_waves_keep_all_power_of_a_lossless_cell() {
    let user = user();
    let run = user.ok("orders lines.toml --theta 25 --phi 40 --wavelengths 450,600");
    assert!(run.stderr.contains("by waves (Fourier modes, orders to ±"), "{}", run.stderr);
    let header = "m,n,wavelength_nm,theta_deg,R_s,R_p,transmitted_theta_deg,T_s,T_p,error";
    assert_eq!(run.stdout.lines().next().unwrap(), header);
    for nm in [450.0, 600.0] {
        for polarisation in [0, 1] {
            let of_wavelength = rows(&run.stdout).into_iter().filter(|row| row[2] == nm);
            let powers = of_wavelength.map(|row| [row[4 + polarisation], row[7 + polarisation]]);
            let sum: f64 = powers.flatten().filter(|x| !x.is_nan()).sum();
            // Ten printed numbers.
            assert!((sum - 1.0).abs() < 10.0 * DIGITS, "{nm} {polarisation}: {sum}");
        }
    }
}

#[test]
fn scatter_counts_the_orders_of_waves() {
    let user = user();
    let run = user.ok("scatter lines.toml --coherence cell --theta 25 --phi 40 --wavelengths 450");
    let report: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    assert_eq!(report["method"], "waves");
    let value = |key: &str| report[key]["value"].as_f64().unwrap();
    assert!((value("reflected") + value("transmitted") - 1.0).abs() < DIGITS && value("absorbed").abs() < DIGITS);
    let bins: f64 = report["bins"].as_array().unwrap().iter().map(|bin| bin["power"].as_f64().unwrap()).sum();
    assert!((bins - value("reflected")).abs() < DIGITS);
}

#[test]
fn tables_of_orders_hold_what_orders_prints_and_do_not_depend_on_threads() {
    let user = user();
    let run = |name: &str, options: &str| {
        user.ok(&format!("estimate lines.toml -o {name}.exr --incident 3x5 --wavelengths 450,600 -q {options}"));
        user.read(&format!("{name}.exr"))
    };
    let one = run("one", "--threads 1");
    assert!(one == run("three", "--threads 3"));
    let table = orders(&user, "one.exr");
    for node in [0, 7, 11] {
        let wi = table.layout.direction(node);
        let (theta, phi) = (wi.x.hypot(wi.y).atan2(wi.z).to_degrees(), wi.y.atan2(wi.x).to_degrees());
        let csv = user.ok(&format!("orders lines.toml --theta {theta} --phi {phi} --wavelengths 450,600 -q")).stdout;
        for row in rows(&csv) {
            let wavelength = usize::from(row[2] == 600.0);
            let order = table.orders.iter().position(|index| index.map(f64::from) == [row[0], row[1]]).unwrap();
            let place = table.first(wavelength, node) + order;
            let factor = |k_o: f64| 4.0 * wi.z * k_o / (wi.z + k_o).powi(2);
            for (found, strength) in [(row[4], table.reflected.s[place]), (row[5], table.reflected.p[place])] {
                if !found.is_nan() {
                    let expected = f64::from(strength) * factor(row[3].to_radians().cos());
                    // Single precision, and six digits of an angle that may be near 90°.
                    assert!((found - expected).abs() < 1e-6, "{node} {row:?}: {found} {expected}");
                }
            }
            if !row[7].is_nan() {
                let expected = f64::from(table.transmitted.s[place]) * factor(1.5 * row[6].to_radians().cos());
                assert!((row[7] - expected).abs() < 1e-6, "{node} {row:?}: {expected}");
            }
        }
    }
}

#[test]
fn an_interrupted_table_is_taken_up_again() {
    let user = user();
    let line = "estimate lines.toml --incident 3x9 --wavelengths 400:700:20 -q -o";
    user.ok(&format!("{line} whole.exr"));
    let words = format!("{line} part.exr --threads 1");
    let mut killed = user.program().args(words.split_whitespace()).spawn().unwrap();
    let checkpoint = user.at("part.exr.checkpoint");
    // The head and a few parts, unless the run ends first.
    while killed.try_wait().unwrap().is_none() && fs::metadata(&checkpoint).map_or(0, |file| file.len()) < 4096 {
        thread::sleep(Duration::from_millis(1));
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    user.ok(&format!("{line} part.exr"));
    assert!(user.read("part.exr") == user.read("whole.exr"));
    assert!(!checkpoint.exists(), "a complete table needs no checkpoint");
}

#[test]
fn random_periods_spread_the_power_of_the_orders() {
    let user = user();
    user.write("random.toml", LINES.replace("coherent", "random"));
    user.ok("estimate random.toml -o t.exr --incident 4x4 --half-vectors 16x32 --wavelengths 450:600:50 -q");
    let Table::Scatter(table) = read(&user.at("t.exr")).unwrap() else { panic!("a table of scattered light") };
    let lookup = table.spectral_lookup().unwrap();
    let lookup = lookup.table().unwrap();
    for (incident, energy) in table.energy.iter().enumerate() {
        let [theta, phi] = table.layout.incident(incident).map(|angle| angle as f32);
        let wi = glam::Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        let mut albedo = vec![0.0; table.wavelength_nm.len()];
        lookup.albedo(wi, &mut albedo);
        // The mean of the spectrum by luminance lies between its ends; each is a sum over all nodes.
        let reflected = energy.reflected.value as f32;
        let (least, most) = (albedo.iter().copied().fold(1.0, f32::min), albedo.iter().copied().fold(0.0, f32::max));
        assert!(least - 1e-4 <= reflected && reflected <= most + 1e-4, "{incident}: {reflected} {albedo:?}");
        // Light of several nodes: no order keeps its one direction. At 89° few orders are above the horizon.
        let lit = table.row(incident, 0).iter().filter(|s| **s > 0.0).count();
        assert!(lit > 4 || theta > 1.5, "{incident}: {lit}");
    }
}

#[test]
fn cells_that_waves_cannot_do_fall_back_or_are_refused() {
    let user = user();
    user.write("mirror.toml", LINES.replace("below = 1.5", "below = \"mirror\""));
    user.ok("orders mirror.toml --rays 32");
    let run = user.ok("orders mirror.toml");
    assert!(run.stderr.contains("by rays, not waves: mirror: waves meet no perfect mirror"), "{}", run.stderr);
    user.refused("orders mirror.toml --method waves", 1, &["waves meet no perfect mirror", "n and k of a metal"]);
    user.refused("orders lines.toml --method waves --rays 64", 2, &["--rays"]);
    user.refused(
        "orders bumpy-glass --method waves",
        1,
        &["needs at least", "orders at 550 nm", "orders --method rays"],
    );
    user.refused("estimate lines.toml -o t.exr --rays 64", 2, &["--rays: lines: coherence cell is computed by waves"]);
    user.refused("scatter lines.toml --coherence cell --method rays --max-harmonic 9", 2, &["--max-harmonic"]);
    user.refused("estimate lines.toml -o t.exr --coherence ray --max-harmonic 9", 2, &["--max-harmonic"]);
    user.refused("estimate paper-fig4 -o t.exr --max-harmonic 9", 2, &["--max-harmonic"]);
    for error in ["0", "-1", "nan"] {
        user.refused(&format!("estimate lines.toml -o t.exr --target-error={error}"), 2, &["--target-error"]);
    }
    user.refused("scatter lines.toml --method waves", 2, &["--coherence cell"]);
    user.refused("orders lines.toml --method rays --target-error 0.1", 2, &["--target-error"]);
}

#[test]
fn an_error_bar_that_misses_its_target_is_said() {
    let user = user();
    let run = user.ok("orders lines.toml --target-error 1e-12 --max-harmonic 8 --wavelengths 600");
    assert!(run.stderr.contains("the error bar is") && run.stderr.contains("--max-harmonic"), "{}", run.stderr);
    let error = rows(&run.stdout)[0][9];
    assert!(error > 1e-12 && error < 0.1, "{error}");
}

#[test]
fn rayleigh_anomalies_give_numbers() {
    let user = user();
    // Order −1 grazes exactly at sin θ = 1 − 600/700 in the classical mount, and beside it.
    for theta in ["8.213210701738", "8.2132", "0"] {
        for nm in ["600", "700", "1050"] {
            let out = user.ok(&format!("orders lines.toml --theta {theta} --wavelengths {nm} -q")).stdout;
            let sum: f64 = rows(&out).iter().flat_map(|row| [row[4], row[7]]).filter(|x| !x.is_nan()).sum();
            assert!((sum - 1.0).abs() < GRAZING, "{theta} {nm}: {sum}");
        }
    }
}
