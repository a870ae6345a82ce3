//! Tests of finishes: scene files, look-ups and pictures of rough surfaces.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use goniochrome::microfacet::{Distribution, Finish, Masking};

use crate::render::{environment, picture};
use crate::render_scatter::{save, twisted};
use crate::user::{User, column};

/// Rounding of products in single precision.
const SINGLE: f64 = 1e-5;
/// Noise of a picture's mean: 256 samples of 16 directions each, well spread.
const ALBEDO: f64 = 2e-3;

/// A perfect mirror with a finish.
fn mirror(finish: &str) -> String {
    format!("[stack]\nambient = 1.0\nlayers = []\nsubstrate = \"mirror\"\n{finish}")
}

#[test]
fn a_scenes_finish_travels_with_its_table_and_options_replace_it() {
    let film = "[stack]\nambient = 1.0\nlayers = [{ material = 1.33, thickness_nm = 300.0 }]\nsubstrate = 1.0\n";
    let user = User::with(&[("film.toml", &format!("{film}[finish]\nroughness = [0.1, 0.4]\n"))]);
    user.ok("estimate film.toml -o film.exr --wavelengths 450,550,650 -q");
    let smooth = user.ok("spectrum film.toml --theta 0 --wavelengths 450,550,650").stdout;
    let rho = column(&smooth, "R_s");
    let found = |more: &str| {
        let csv = user.ok(&format!("lookup film.exr --wi 0,0 --wo 0,0 {more} --csv - -q")).stdout;
        ["450", "550", "650"].map(|nm| column(&csv, &format!("f_{nm}"))[0])
    };
    // Along the normal f = D ρ/4, and D = 1/(π α_x α_y) for both distributions.
    for (more, area) in [("", 0.04), ("--roughness 0.2", 0.04), ("--roughness 0.3,0.5 --distribution beckmann", 0.15)] {
        for (f, rho) in found(more).into_iter().zip(&rho) {
            let expected = rho / (4.0 * PI * area);
            assert!((f / expected - 1.0).abs() <= SINGLE, "{more}: {f} {expected}");
        }
    }
    user.refused("lookup film.exr --wi 0,0", 2, &["--wo is missing", "finish"]);
    user.refused(
        "export film.exr --to merl -o f.binary",
        2,
        &["roughness 0.1 along x and 0.4 along y", "--roughness 0.1"],
    );
    for export in ["film.exr --to blob -o f.gonio", "film.exr --to lut -o f.png", "film.toml --to lut -o g.png"] {
        let said = user.ok(&format!("export {export}")).stderr;
        assert!(said.contains("without the finish"), "{export}: {said}");
    }
}

#[test]
fn a_rough_mirror_reflects_what_its_facets_integrate_to() {
    let user = User::with(&[
        ("ggx.toml", &mirror("[finish]\nroughness = 0.3\n")),
        ("beckmann.toml", &mirror("[finish]\nroughness = [0.2, 0.6]\ndistribution = \"beckmann\"\n")),
    ]);
    environment(&user, "one.exr", [16, 8], |_, _| [1.0; 3]);
    environment(&user, "side.exr", [16, 8], |x, y| [if (x, y) == (5, 2) { 30.0 } else { 0.5 }; 3]);
    let kinds = [("ggx", Distribution::Ggx, [0.3, 0.3]), ("beckmann", Distribution::Beckmann, [0.2, 0.6])];
    for (name, distribution, alpha) in kinds {
        let finish = Finish::new(distribution, Masking::Correlated, alpha).unwrap();
        user.ok(&format!("estimate {name}.toml -o {name}.exr --wavelengths 380:780:20 -q"));
        for elevation in [75.0, 30.0] {
            let (sin, cos) = f64::to_radians(elevation).sin_cos();
            let viewer = Vec3::new(cos as f32, 0.0, sin as f32);
            let (rows, columns) = (800, 1600);
            let mut albedo = 0.0;
            for i in 0..rows * columns {
                let theta = (f64::from(i / columns) + 0.5) / f64::from(rows) * FRAC_PI_2;
                let phi = (f64::from(i % columns) + 0.5) / f64::from(columns) * TAU;
                let wi = DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
                let lobe = finish.lobe(viewer, wi.as_vec3()).map_or(0.0, |lobe| f64::from(lobe.value));
                albedo += lobe * theta.cos() * theta.sin() * (FRAC_PI_2 / f64::from(rows)) * (TAU / f64::from(columns));
            }
            let mean = |env: &str, samples: u32| {
                let view =
                    format!("--mesh plane --elevation {elevation} --azimuth 0 --fov 0.1 --distance 100 --size 8");
                user.ok(&format!("render {name}.exr -o p.exr {view} --env {env} --samples {samples} -q"));
                let pixels = picture(&user, "p.exr").rgba;
                pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64
            };
            for env in ["white", "one.exr"] {
                let found = mean(env, 256);
                assert!((found / albedo - 1.0).abs() <= ALBEDO, "{name} {elevation} {env}: {found} {albedo}");
            }
            let [few, many] = [16, 512].map(|samples| mean("side.exr", samples));
            assert!((few / many - 1.0).abs() <= 3.0 * ALBEDO, "{name} {elevation}: {few} {many}");
        }
    }
}

#[test]
fn a_roughness_of_0_is_the_mirror() {
    let user = User::with(&[("a.toml", &mirror("[finish]\nroughness = 0.3\n")), ("b.toml", &mirror(""))]);
    for name in ["a", "b"] {
        user.ok(&format!("estimate {name}.toml -o {name}.exr --wavelengths 380:780:20 -q"));
    }
    user.ok("render a.exr -o a.png --roughness 0 --size 32 -q");
    user.ok("render b.exr -o b.png --size 32 -q");
    assert_eq!(user.read("a.png"), user.read("b.png"));
    user.ok("render a.exr -o c.png --size 32 -q");
    assert_ne!(user.read("a.png"), user.read("c.png"));
}

#[test]
fn finishes_that_cannot_be_are_refused() {
    let user = User::new();
    for (name, text, says) in [
        ("a", mirror("[finish]\nroughness = 1.5\n"), ["from 0.001 to 1", "a.toml"]),
        ("b", mirror("[finish]\nroughness = [0.1, 0.2, 0.3]\n"), ["one number, or two", "b.toml"]),
        ("c", mirror("[finish]\nroughness = 0.1\ndistribution = \"phong\"\n"), ["\"phong\" is unknown", "beckmann"]),
        ("d", mirror("[finish]\ndistribution = \"ggx\"\n"), ["roughness", "d.toml"]),
        ("e", mirror("[finish]\nroughness = 0.1\nshine = 2\n"), ["shine", "e.toml"]),
    ] {
        user.write(&format!("{name}.toml"), text);
        user.refused(&format!("spectrum {name}.toml"), 1, &says);
    }
    let preset = user.ok("presets bumpy-glass").stdout;
    user.write("f.toml", format!("{preset}\n[finish]\nroughness = 0.2\n"));
    user.refused("scatter f.toml --rays 64", 1, &["a cell of tilted facets has its own roughness", "remove [finish]"]);
    user.refused("render soap-bubble -o a.png --distribution ggx -q", 2, &["--distribution", "give --roughness too"]);
    user.refused("render soap-bubble -o a.png --roughness 2", 2, &["--roughness", "(0, 1]"]);
    save(&user, "t.exr", &twisted(0.1));
    user.refused("render t.exr -o a.png --roughness 0.2", 2, &["--roughness", "mirror-like tables"]);
    user.refused("lookup soap-bubble --wi 0,0 --wo 0,0 --roughness 0.1,2", 2, &["--roughness", "(0, 1]"]);
    user.refused("lookup soap-bubble --wi 0,0 --wo 0,0 --distribution phong", 2, &["ggx or beckmann"]);
}
