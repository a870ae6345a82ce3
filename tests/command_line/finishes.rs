//! Tests of finishes: scene files, look-ups and pictures of rough surfaces.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec3, Vec3};
use goniochrome::microfacet::{Distribution, Finish, Masking};
use goniochrome::table::blob::{Blob, Contents};

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
    for export in ["film.exr --to lut -o f.png", "film.toml --to lut -o g.png"] {
        let said = user.ok(&format!("export {export}")).stderr;
        assert!(said.contains("--shader writes functions for the finish"), "{export}: {said}");
        assert!(!user.ok(&format!("export {export} --roughness 0")).stderr.contains("finish"));
    }
}

#[test]
fn a_finish_goes_into_blobs_shaders_materials_and_plots() {
    let film = "[stack]\nambient = 1.0\nlayers = [{ material = 1.33, thickness_nm = 300.0 }]\nsubstrate = 1.0\n";
    let user = User::with(&[("film.toml", &format!("{film}[finish]\nroughness = [0.1, 0.4]\n"))]);
    user.ok("estimate film.toml -o film.exr --wavelengths 400:700:20 --vary 1=100:500:5 -q");
    user.ok("export film.exr --to blob -o film.gonio -q");
    let bytes = user.read("film.gonio");
    let Contents::Film(blob) = Blob::read(&bytes).unwrap().contents else { panic!("a film") };
    assert_eq!((blob.thicknesses(), blob.range_nm(), blob.is_transparent()), (5, [100.0, 500.0], true));
    assert_eq!(blob.finish().and_then(|finish| finish.alpha()), Some([0.1, 0.4]));
    // f as `lookup` finds it in the table.
    let csv = user.ok("lookup film.exr --thickness 250 --wi 20,10 --wo 30,200 --csv - -q").stdout;
    let f = blob.eval(direction(20.0, 10.0), direction(30.0, 200.0), 250.0);
    for (f, name) in f.into_iter().zip(["f_R", "f_G", "f_B"]) {
        let expected = column(&csv, name)[0];
        assert!((f64::from(f) / expected - 1.0).abs() <= SINGLE, "{name}: {f} {expected}");
    }
    let text = |name: &str| String::from_utf8(user.read(name)).unwrap();
    user.ok("export film.exr --to lut --shader film.glsl -o film.png -q");
    assert!(text("film.glsl").contains("const vec2 GONIOCHROME_ROUGHNESS = vec2(0.1, 0.4);"));
    user.ok("export film.exr --to lut --shader film.wgsl --roughness 0.3 --distribution beckmann -o film.png -q");
    let wgsl = text("film.wgsl");
    assert!(wgsl.contains("vec2<f32>(0.3, 0.3)") && wgsl.contains("GONIOCHROME_BECKMANN: bool = true"), "{wgsl}");
    user.refused("export film.exr --to gltf -o film.gltf", 2, &["--thickness is missing"]);
    let said = user.ok("export film.exr --to gltf --thickness 320 -o film.gltf").stderr;
    assert!(said.contains("a finish of roughness 0.1 along x and 0.4 along y"), "{said}");
    let gltf = text("film.gltf");
    assert!(
        gltf.contains("KHR_materials_anisotropy") && gltf.contains("TANGENT") && gltf.contains("0.31623"),
        "{gltf}"
    );
    user.ok("export film.toml --to gltf --roughness 0.25 -o film.gltf -q");
    assert!(text("film.gltf").contains("\"roughnessFactor\": 0.5"));
    user.ok("plot film.exr --kind lobes --thickness 300 --theta 30 --phi 90 -o lobes.svg -q");
    assert!(text("lobes.svg").contains("roughness 0.1, 0.4"));
    user.ok("plot jewel-beetle --kind lobes --roughness 0.2 --distribution beckmann -o lobes.svg -q");
    user.refused("plot jewel-beetle --kind lobes -o a.svg -q", 2, &["without a finish has no lobes", "--roughness"]);
    user.refused("plot film.exr --thickness 300 --roughness 0.2 -o a.svg -q", 2, &["--kind lobes"]);
    save(&user, "t.exr", &twisted(0.1));
    user.refused("export t.exr --to blob --roughness 0.2 -o a.gonio", 2, &["--roughness", "mirror-like tables"]);
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
fn energy_compensation_travels_with_the_table_and_returns_all_light() {
    let user = User::with(&[
        ("a.toml", &mirror("[finish]\nroughness = 0.8\nenergy_compensation = true\n")),
        ("b.toml", &mirror("[finish]\nroughness = 0.8\n")),
    ]);
    for name in ["a", "b"] {
        user.ok(&format!("estimate {name}.toml -o {name}.exr --wavelengths 380:780:20 -q"));
    }
    let view = "--mesh plane --elevation 40 --azimuth 0 --fov 0.1 --distance 100 --size 8 --env white --samples 64 -q";
    for (table, more, is_white) in
        [("a", "", true), ("a", "--spectral", true), ("b", "--energy-compensation", true), ("b", "", false)]
    {
        user.ok(&format!("render {table}.exr -o p.exr {view} {more}"));
        let pixels = picture(&user, "p.exr").rgba;
        let mean = pixels.iter().map(|p| f64::from(p[1])).sum::<f64>() / pixels.len() as f64;
        assert_eq!((mean - 1.0).abs() <= ALBEDO, is_white, "{table} {more}: {mean}");
    }
    // One f, wherever it is evaluated.
    let f = |options: &str| column(&user.ok(&format!("lookup {options} --csv - -q")).stdout, "f_G")[0];
    let expected = f("a.exr --wi 20,10 --wo 60,200");
    assert!(expected > 1.5 * f("a.exr --wi 20,10 --wo 60,200 --energy-compensation=false"));
    for other in ["b.exr --wi 20,10 --wo 60,200 --energy-compensation", "a.exr --wi 60,200 --wo 20,10"] {
        assert!((f(other) / expected - 1.0).abs() <= SINGLE, "{other}");
    }
    user.ok("export b.exr --to blob --energy-compensation -o b.gonio -q");
    let bytes = user.read("b.gonio");
    let Contents::Film(blob) = Blob::read(&bytes).unwrap().contents else { panic!("a film") };
    let found = f64::from(blob.eval(direction(20.0, 10.0), direction(60.0, 200.0), 0.0)[1]);
    assert!((found / expected - 1.0).abs() <= SINGLE, "{found} {expected}");
    let lut = "--to lut -o a-lut.exr --shader a.glsl";
    user.ok(&format!("export a.exr {lut} --compensation a-compensation.exr -q"));
    let shader = String::from_utf8(user.read("a.glsl")).unwrap();
    assert!(shader.contains("vec3 goniochrome_compensated_sample(sampler2D compensation,"), "{shader}");
    user.refused(&format!("export a.exr {lut}"), 2, &["--compensation is missing"]);
    user.refused(&format!("export b.exr {lut} --compensation c.exr"), 2, &["energy compensation", "leave it out"]);
    let said = user.ok("export soap-bubble --to gltf --roughness 0.3 --energy-compensation -o a.gltf").stderr;
    assert!(said.contains("glTF has no energy compensation"), "{said}");
    for table in ["a", "b"] {
        user.ok(&format!("plot {table}.exr --kind lobes -o {table}.svg -q"));
    }
    assert_ne!(user.read("a.svg"), user.read("b.svg"));
}

/// Unit vector of two angles in degrees.
fn direction(theta: f64, phi: f64) -> Vec3 {
    let (theta, phi) = (theta.to_radians(), phi.to_radians());
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()).as_vec3()
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
        (
            "g",
            mirror("[finish]\nroughness = 0.1\nenergy_compensation = 3\n"),
            ["energy_compensation: expected true or false, found 3", "g.toml"],
        ),
        ("h", mirror("[finish]\nenergy_compensation = true\n"), ["\"roughness\" is missing", "h.toml"]),
    ] {
        user.write(&format!("{name}.toml"), text);
        user.refused(&format!("spectrum {name}.toml"), 1, &says);
    }
    let preset = user.ok("presets bumpy-glass").stdout;
    user.write("f.toml", format!("{preset}\n[finish]\nroughness = 0.2\n"));
    user.refused("scatter f.toml --rays 64", 1, &["a cell of tilted facets has its own roughness", "remove [finish]"]);
    user.refused("render soap-bubble -o a.png --distribution ggx -q", 2, &["--distribution", "give --roughness too"]);
    user.refused(
        "render soap-bubble -o a.png --energy-compensation --roughness 0 -q",
        2,
        &["--energy-compensation", "a mirror loses no light"],
    );
    user.refused("render soap-bubble -o a.png --roughness 2", 2, &["--roughness", "(0, 1]"]);
    save(&user, "t.exr", &twisted(0.1));
    user.refused("render t.exr -o a.png --roughness 0.2", 2, &["--roughness", "mirror-like tables"]);
    user.refused("lookup soap-bubble --wi 0,0 --wo 0,0 --roughness 0.1,2", 2, &["--roughness", "(0, 1]"]);
    user.refused("lookup soap-bubble --wi 0,0 --wo 0,0 --distribution phong", 2, &["ggx or beckmann"]);
}
