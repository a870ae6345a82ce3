//! Tests of meshes of planes: the films that they form, and refusals of those that form none.

use std::fmt::Write;

use crate::user::{User, column, largest_difference};

/// Largest difference of a cell and a stack of the same planes: the rounding of a height.
const SAME_PLANES: f64 = 1e-5;
const GRID: &str = "--theta 0:85:5 --wavelengths 380:780:5";
const PERIOD_NM: f64 = 1000.0;

/// The corners of the period at height z, as OBJ.
fn corners(z_nm: f64) -> String {
    let p = PERIOD_NM;
    format!("v 0 0 {z_nm}\nv {p} 0 {z_nm}\nv {p} {p} {z_nm}\nv 0 {p} {z_nm}\n")
}

/// The scene of `film.obj` with interfaces, each a name and the media above and below.
fn scene(interfaces: &[(&str, &str, &str)]) -> String {
    let mut text = format!("[cell]\nmesh = \"film.obj\"\nperiod_nm = [{PERIOD_NM:?}, {PERIOD_NM:?}]\n");
    for (name, above, below) in interfaces {
        write!(text, "[interface.{name}]\nabove = {above}\nbelow = {below}\n").unwrap();
    }
    text
}

/// The scene of a film: 300 nm of n = 2.4 on n = 1.5.
fn thin_film() -> String {
    scene(&[("top", "1.0", "2.4"), ("bottom", "2.4", "1.5")])
}

const THIN_FILM_STACK: &str =
    "[stack]\nambient = 1.0\nlayers = [{ material = 2.4, thickness_nm = 300.0 }]\nsubstrate = 1.5\n";

/// The mesh of two planes with these faces of the top and the bottom one.
fn two_planes(top: &str, bottom: &str) -> String {
    format!("{}{}usemtl top\n{top}\nusemtl bottom\n{bottom}\n", corners(300.0), corners(0.0))
}

/// The largest difference of any reflectance or transmittance of two scenes.
fn difference(user: &User, a: &str, b: &str) -> f64 {
    let [a, b] = [a, b].map(|scene| user.ok(&format!("spectrum {scene} {GRID}")).stdout);
    let of = |name| largest_difference(&column(&a, name), &column(&b, name));
    ["theta_deg", "wavelength_nm", "R_s", "R_p", "T_s", "T_p"].map(of).into_iter().fold(0.0, f64::max)
}

#[test]
fn a_film_of_two_planes_is_the_stack() {
    let quads = two_planes("f 1 2 3 4", "f 5 6 7 8");
    let triangles = two_planes("f 1 2 3\nf 1 3 4", "f 5 6 7\nf 5 7 8");
    let away = two_planes("f 4 3 2 1", "f 8 7 6\nf 8 6 5");
    let relative = two_planes("f -8 -7 -6 -5", "f 5/1/1 6/2/1 7//1 8");
    // An L and the square that it leaves; a fan from the L's first corner would leave it.
    let concave = format!(
        "{}v 500 0 300\nv 1000 500 300\nv 500 500 300\n{}usemtl top\nf 3 4 1 5 \\\n7 6\nf 5 2 6 7 5\n\
         usemtl bottom\nf 8 9 10 11 8\n",
        corners(300.0),
        corners(0.0)
    );
    let bottom_first =
        format!("{}{}usemtl bottom\nf 5 6 7 8\nusemtl top\nf 1 2 3 4\n", corners(7300.0), corners(7000.0));
    for (name, mesh) in [
        ("quads", quads.clone()),
        ("triangles", triangles.clone()),
        ("the other diagonal", two_planes("f 1 2 4\nf 2 3 4", "f 5 6 7 8")),
        ("carriage returns", triangles.replace('\n', "\r\n")),
        ("no final newline", triangles.trim_end().to_owned()),
        ("relative corners", relative),
        ("concave polygons, said in pieces and closed", concave),
        ("bottom first, far from the origin", bottom_first),
    ] {
        let user = User::with(&[("film.toml", &thin_film()), ("film.obj", &mesh), ("stack.toml", THIN_FILM_STACK)]);
        let difference = difference(&user, "film.toml", "stack.toml");
        println!("{name}: {difference:.1e}");
        assert!(difference <= SAME_PLANES, "{name}: {difference:e}");
    }
    // A plane that faces down has its upper medium below.
    let turned = scene(&[("top", "2.4", "1.0"), ("bottom", "1.5", "2.4")]);
    let user = User::with(&[("film.toml", &turned), ("film.obj", &away), ("stack.toml", THIN_FILM_STACK)]);
    assert!(difference(&user, "film.toml", "stack.toml") <= SAME_PLANES);
    // To show that the comparison can fail: a film 3 nm thicker is another film.
    let thicker = quads.replace("300\n", "303\n");
    let user = User::with(&[("film.toml", &thin_film()), ("film.obj", &thicker), ("stack.toml", THIN_FILM_STACK)]);
    assert!(difference(&user, "film.toml", "stack.toml") > 100.0 * SAME_PLANES);
}

#[test]
fn three_films_of_planes_are_figure_4() {
    let mut mesh: String = (0..6).map(|plane| corners(-180.0 * f64::from(plane))).collect();
    for plane in 0..6 {
        let name = if plane % 2 == 0 { "into" } else { "out" };
        let first = 4 * plane + 1;
        writeln!(mesh, "usemtl {name}\nf {first} {} {} {}", first + 1, first + 2, first + 3).unwrap();
    }
    let cell = scene(&[("into", "1.0", "2.4"), ("out", "2.4", "1.0")]);
    let user = User::with(&[("films.toml", &cell), ("film.obj", &mesh)]);
    let difference = difference(&user, "films.toml", "paper-fig4");
    println!("three films: {difference:.1e}");
    assert!(difference <= SAME_PLANES, "{difference:e}");
}

#[test]
fn a_mesh_goes_through_every_command() {
    let user = User::with(&[("film.toml", &thin_film()), ("film.obj", &two_planes("f 1 2 3 4", "f 5 6 7 8"))]);
    let colours = user.ok("colour film.toml --csv -").stdout;
    assert_eq!(colours, user.ok("colour paper-fig6-300 --csv -").stdout);
    user.ok("estimate film.toml -o t.exr --angles 4");
    user.ok("compare film.toml --csv compare.csv");
    user.ok("sampling film.toml --samples 10 --csv sampling.csv");
}

#[test]
fn meshes_at_fault_are_named_by_line() {
    let top = |faces: &str| two_planes(faces, "f 5 6 7 8");
    let tilted = top("f 1 2 3 4").replacen("v 0 0 300", "v 0 0 310", 1);
    let ridge = "v 500 0 400\nv 500 1000 400\n".to_owned() + &two_planes("f 3 1 2 6\nf 1 4 5 2", "f 7 8 9 10");
    let cases: &[(String, &[&str])] = &[
        (String::new(), &["film.obj:1:", "no faces"]),
        (corners(0.0), &["film.obj:4:", "no faces"]),
        (format!("{}f 1 2 3 4\n", corners(0.0)), &["film.obj:5:", "before any usemtl", "name its interface first"]),
        (top("f 1 2 3"), &["film.obj:10:", "not closed", "has no partner", "fill the hole"]),
        (top("f 1 2 3\nf 1 4 3"), &["film.obj:11:", "faces the other way", "turn its vertices around"]),
        (top("f 1 2 3 4\nf 1 2 3 4"), &["film.obj:10:", "covers the period 2 times", "remove the copies"]),
        (tilted, &["film.obj:10:", "not planar", "split it into triangles"]),
        (ridge, &["film: has tilted facets", "use estimate"]),
        (top("f 1 2 3 9"), &["film.obj:10:", "vertex 9 does not exist", "8 are defined above"]),
        (top("f 1 2 3 0"), &["film.obj:10:", "vertex 0 does not exist"]),
        (top("f 1 2 x 4"), &["film.obj:10:", "\"x\"", "vertex number"]),
        (top("f 1 2"), &["film.obj:10:", "at least three corners"]),
        (top("f 1 3 2 4"), &["film.obj:10:", "crosses or touches itself", "split it into triangles"]),
        (
            top("f 1 2 3 4").replace("usemtl top", "usemtl tpo"),
            &["film.obj:9:", "\"tpo\" has no [interface]", "nearest is [interface.top]", "declare each usemtl name"],
        ),
        (top("f 1 2 3 4").replace("v 0 0 300", "v 0 0 nan"), &["film.obj:1:", "\"nan\" is not a finite number"]),
        (top("f 1 2 3 4").replace("v 0 0 300", "v 0 0"), &["film.obj:1:", "three coordinates"]),
        (
            top("f 1 2 3 4").replace("v 1000", "v 900"),
            &["film.obj:12:", "spans 900 by 1000 nm", "1000 by 1000 nm", "make them equal"],
        ),
        // Media that do not agree: the bottom plane on top.
        (top("f 1 2 3 4").replace("300\n", "-300\n"), &["film.obj:10:", "above it but", "below it", "make them equal"]),
    ];
    for (mesh, says) in cases {
        User::with(&[("film.toml", &thin_film()), ("film.obj", mesh)]).refused("spectrum film.toml", 1, says);
    }
}

#[test]
fn cells_at_fault_are_named_by_line_and_column() {
    let mesh = two_planes("f 1 2 3 4", "f 5 6 7 8");
    let film = thin_film();
    let cases: &[(String, &[&str])] = &[
        (film.replace("film.obj", "flim.obj"), &["film.toml:2:8:", "flim.obj", "no such file"]),
        (film.replace("1000.0, 1000.0", "1000.0, 0.0"), &["film.toml:3:13:", "more than 0 nm"]),
        (film.replace("1000.0, 1000.0", "1000.0"), &["film.toml:3:13:", "two lengths [x, y]"]),
        (film.replace("below = 1.5", "blow = 1.5"), &["film.toml:9:1:", "\"blow\"", "nearest is \"below\""]),
        (film.replace("above = 1.0", "above = [1.0, 0.2]"), &["film.obj:10:", "absorbs", "use k <= 0.001"]),
        (scene(&[]), &["film.toml:1:1:", "[interface.NAME]", "add them"]),
    ];
    for (scene, says) in cases {
        User::with(&[("film.toml", scene), ("film.obj", &mesh)]).refused("spectrum film.toml", 1, says);
    }
    let user = User::with(&[("film.toml", &film)]);
    std::fs::create_dir(user.at("film.obj")).unwrap();
    user.refused("spectrum film.toml", 1, &["film.obj", "is a folder", "expected a file"]);
}
