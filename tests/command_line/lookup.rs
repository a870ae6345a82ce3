//! Tests of `lookup`: f of pairs of directions, light in exact directions, and refusals.

use std::f64::consts::PI;

use goniochrome_cli::table::file;

use crate::discs::{PITCH_NM, compact_disc};
use crate::user::{User, column, largest_difference};

/// Rounding of a number that is stored and printed in single precision, and was computed in it in some ten steps.
const SINGLE: f64 = 10.0 * f32::EPSILON as f64;

/// A user with a mirror-like table, and one of scattered light.
fn user() -> User {
    let user = User::new();
    user.ok("estimate paper-fig4 -o film.exr --angles 30 --wavelengths 400:700:50 --quiet");
    user.ok("estimate bumpy-glass -o bumpy.exr --incident 3x4 --half-vectors 4x8 --wavelengths 450,550,650 --rays 64 --quiet");
    user
}

#[test]
fn a_mirror_is_listed_with_its_reflectance() {
    let user = user();
    let csv = user.ok("lookup film.exr --wi 30,20 --csv -").stdout;
    assert_eq!(csv.lines().next(), Some("theta_i_deg,phi_i_deg,lobe,channel,theta_o_deg,phi_o_deg,power"));
    assert_eq!(csv.lines().count(), 1 + 2 * (7 + 3), "two directions; seven wavelengths, then R, G and B: {csv}");
    let theta = column(&csv, "theta_o_deg");
    let (mirrored, straight) = theta.split_at(10);
    assert!(mirrored.iter().all(|theta| (theta - 30.0).abs() < 1e-6), "{csv}");
    assert!(straight.iter().all(|theta| (theta - 150.0).abs() < 1e-6), "{csv}");
    // Both lie in the plane of incidence, on the other side of the normal.
    assert!(column(&csv, "phi_o_deg").iter().all(|phi| (phi + 160.0).abs() < 1e-6), "{csv}");
    // 30° is one of the table's angles.
    let spectrum = user.ok("spectrum paper-fig4 --theta 30 --wavelengths 400:700:50").stdout;
    for (of, first) in [("R", 0), ("T", 10)] {
        let polarised = column(&spectrum, &format!("{of}_s")).into_iter().zip(column(&spectrum, &format!("{of}_p")));
        let mean: Vec<f64> = polarised.map(|(s, p)| 0.5 * (s + p)).collect();
        assert!(largest_difference(&column(&csv, "power")[first..][..7], &mean) < SINGLE, "{csv} {spectrum}");
    }
    let text = user.ok("lookup film.exr --wi 30,20 --wo 30,-158").stdout;
    // 2° of azimuth at sin 30° = 1/2.
    assert!(text.contains("mirror") && text.contains("1.00° from the viewer"), "{text}");
}

#[test]
fn roughness_gives_the_lobe_of_the_exports() {
    let user = user();
    let csv = user.ok("lookup film.exr --wi 0,0 --wo 0,0 --roughness 0.2 --csv -").stdout;
    // Along the normal f = D ρ/4 with D = 1/(π α²), and all reflectances but one are unchanged by the lobe.
    let rho = user.ok("lookup film.exr --wi 0,0 --csv -").stdout;
    for (channel, rho) in
        ["400", "550", "700", "R", "B"].into_iter().zip([0, 3, 6, 7, 9].map(|i| column(&rho, "power")[i]))
    {
        let f = column(&csv, &format!("f_{channel}"))[0];
        assert!((f - rho / (4.0 * PI * 0.04)).abs() < SINGLE * f.abs(), "{channel}: {f} for {rho}");
    }
    assert!(
        user.ok("lookup jewel-beetle --wi 40,0 --wo 40,180 --roughness 0.1 -q").stdout.contains("R, G, B are linear")
    );
}

#[test]
fn pairs_of_a_file_are_those_of_the_options() {
    let user = user();
    user.write("pairs.csv", "theta_i, phi_i, theta_o, phi_o\n30,0,45,180\n\n12.5,-100,60,370\n");
    let all = user.ok("lookup bumpy.exr --pairs pairs.csv --csv -").stdout;
    let first = user.ok("lookup bumpy.exr --wi 30,0 --wo 45,180 --csv -").stdout;
    let second = user.ok("lookup bumpy.exr --wi 12.5,-100 --wo 60,370 --csv -").stdout;
    let lines: Vec<&str> = all.lines().collect();
    assert_eq!(lines[..2].join("\n") + "\n", first);
    assert_eq!(second.lines().nth(1), Some(lines[2]));
    assert!(column(&all, "f_550")[0] > 0.0 && column(&all, "luminance_std_error")[0] > 0.0, "{all}");
    user.ok("lookup bumpy.exr --pairs pairs.csv --csv found.csv");
    assert_eq!(String::from_utf8(user.read("found.csv")).unwrap(), all);
    let text = user.ok("lookup bumpy.exr --wi 30,0 --wo 45,180").stdout;
    assert!(text.contains("f in 1/sr") && text.contains("standard error") && text.contains("space srgb"), "{text}");
}

#[test]
fn orders_are_listed_near_the_viewer_first_or_spread() {
    let user = User::new();
    file::write(&user.at("cd.exr"), &compact_disc().into(), 1).unwrap();
    let csv = user.ok("lookup cd.exr --wi 0,0 --wo 20.1,0 --csv -").stdout;
    let (theta, away) = (column(&csv, "theta_o_deg"), column(&csv, "from_viewer_deg"));
    assert!(away.is_sorted(), "{csv}");
    // Order 1 of 550 nm leaves at arcsin(550/1600).
    let first = csv.lines().nth(1).unwrap();
    assert!(first.starts_with("0,0,order 1 0,550,"), "{first}");
    assert!((theta[0] - (550.0 / PITCH_NM).asin().to_degrees()).abs() < 1e-4, "{first}");
    // A lobe's peak in its own direction is e/(2πσ²) over cos θ_o, and neighbours are too far to matter.
    let sigma = 0.5_f64.to_radians();
    let spread = user.ok(&format!("lookup cd.exr --wi 0,0 --wo {},0 --spread 0.5 --csv -", theta[0])).stdout;
    let f = column(&spread, "f_550")[0] * theta[0].to_radians().cos();
    let peak = column(&csv, "power")[0] / (2.0 * PI * sigma * sigma);
    assert!((f / peak - 1.0).abs() < 1e-3, "{f} for {peak}");
}

#[test]
fn wrong_questions_are_refused_with_the_remedy() {
    let user = user();
    file::write(&user.at("cd.exr"), &compact_disc().into(), 1).unwrap();
    for (name, text) in [
        ("short.csv", "30,0,45\n"),
        ("word.csv", "30,0,45,180\n30,zero,45,180\n"),
        ("below.csv", "a,b,c,d\n30,0,91,180\n"),
        ("none.csv", "a,b,c,d\n"),
    ] {
        user.write(name, text);
    }
    for (line, code, says) in [
        ("lookup film.exr", 2, ["--wi", "required"]),
        ("lookup film.exr --wi 30", 2, ["--wi", "THETA,PHI"]),
        ("lookup film.exr --wi 90,0", 2, ["--wi", "[0, 90)"]),
        ("lookup film.exr --wi -1,0", 2, ["--wi", "[0, 90)"]),
        ("lookup film.exr --wi 30,NaN", 2, ["--wi", "finite"]),
        ("lookup film.exr --wi 30,0 --roughness 0.2", 2, ["--roughness", "--wo"]),
        ("lookup film.exr --wi 30,0 --wo 120,0", 2, ["--wo", "not above the horizon"]),
        ("lookup film.exr --wi 30,0 --wo 30,0 --spread 2", 2, ["--spread is for", "leave it out"]),
        ("lookup film.exr --wi 30,0 --pairs short.csv", 2, ["--pairs", "cannot be used"]),
        ("lookup bumpy.exr --wi 30,0", 2, ["--wo is missing", "--wo 45,180"]),
        (
            "lookup bumpy.exr --wi 30,0 --wo 30,0 --roughness 0.2",
            2,
            ["--roughness, --energy-compensation: are for", "leave it out"],
        ),
        (
            "lookup cd.exr --wi 30,0 --wo 30,0 --roughness 0.2",
            2,
            ["--roughness, --energy-compensation: are for", "--spread 2"],
        ),
        ("lookup bumpy.exr --pairs short.csv", 1, ["short.csv, line 1", "four numbers"]),
        ("lookup bumpy.exr --pairs word.csv", 1, ["word.csv, line 2", "four numbers"]),
        ("lookup bumpy.exr --pairs below.csv", 1, ["below.csv, line 2", "[0, 90)"]),
        ("lookup bumpy.exr --pairs none.csv", 1, ["none.csv", "no pairs"]),
        ("lookup bumpy.exr --pairs nowhere.csv", 1, ["nowhere.csv", "cannot read"]),
        ("lookup bumpy.exr --wi 30,0 --wo 30,0 --csv bumpy.exr", 2, ["would overwrite the input", "bumpy.exr"]),
        ("lookup bumpy.exr --pairs none.csv --csv none.csv", 2, ["would overwrite the input", "none.csv"]),
    ] {
        user.refused(line, code, &says);
    }
}
