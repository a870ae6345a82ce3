//! Tests of finishes whose facets come from files and surfaces.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use goniochrome::microfacet::{Distribution, Finish, Masking};
use goniochrome::table::blob::{Blob, Contents};
use goniochrome_cli::export::{LobeWidth, Reflection};
use goniochrome_cli::table::file;
use serde_json::Value;

use crate::user::{User, column};

/// Plane aluminium with a distribution of normals.
fn aluminium(distribution: &str) -> String {
    format!("[stack]\nambient = 1.0\nlayers = []\nsubstrate = \"Al\"\n[finish]\ndistribution = {{ {distribution} }}\n")
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
}

#[test]
fn facets_of_a_file_of_ggx_are_ggx_and_stay_in_the_table() {
    /// Interpolation in the file, of rows 0.25° apart: h² |D″|/8D with |D″| ≤ 4.2 D/α²; that between the table's nodes,
    /// 2e-4; and half a unit of the fourth digit, 5e-4.
    const INTERPOLATED: f64 = 4.2 / 8.0 * 0.25 * 0.25 / (57.3 * 57.3) / (0.3 * 0.3) + 7e-4;
    let exact = Finish::new(Distribution::Ggx, Masking::Correlated, [0.3; 2]).unwrap();
    let mut csv = String::from("theta_deg,D\n");
    for i in 0..=360 {
        let theta = f64::from(i) / 4.0;
        let d = exact.density(direction(theta.to_radians().min(FRAC_PI_2 - 1e-6), 0.0).as_vec3());
        csv += &format!("{theta},{}\n", 17.0 * d);
    }
    let user = User::with(&[("d.csv", &csv), ("a.toml", &aluminium("file = \"d.csv\""))]);
    user.write("b.toml", aluminium("").replace("distribution = {  }", "roughness = 0.3"));
    for name in ["a", "b"] {
        user.ok(&format!("estimate {name}.toml -o {name}.exr --wavelengths 450,550,650 -q"));
    }
    std::fs::remove_file(user.at("d.csv")).unwrap();
    // A few kilobytes: D at 257 nodes.
    assert!(user.read("a.exr").len() < user.read("b.exr").len() + 4096);
    let pairs: String = (0..60).map(|i| format!("{},0,{},{}\n", i, (i * 37) % 75, (i * 53) % 360)).collect();
    user.write("pairs.csv", format!("theta_i_deg,phi_i_deg,theta_o_deg,phi_o_deg\n{pairs}"));
    let [a, b] = ["a", "b"]
        .map(|name| column(&user.ok(&format!("lookup {name}.exr --pairs pairs.csv --csv - -q")).stdout, "f_550"));
    for (i, (a, b)) in a.iter().zip(&b).enumerate() {
        assert!((a / b - 1.0).abs() <= INTERPOLATED, "{i}: {a} {b}");
    }
    // Options take other facets.
    let lookup = |more: &str| {
        let csv = user.ok(&format!("lookup a.exr --wi 0,0 --wo 0,0 {more} --csv - -q")).stdout;
        column(&csv, "f_550")[0]
    };
    assert!((lookup("--roughness 0.15") / lookup("") - 4.0).abs() < 4.0 * INTERPOLATED);
    user.ok("export a.exr --to bsdf --rgb -o a.bsdf -q");
    user.ok("render a.exr -o a.png --size 32 -q");
    exports_hold_the_facets(&user);
}

/// Exports of a.exr, whose file of facets is gone. Its facets are those of roughness 0.3.
fn exports_hold_the_facets(user: &User) {
    user.ok("export a.exr --to blob -o a.gonio -q");
    let bytes = user.read("a.gonio");
    let Contents::Film(film) = Blob::read(&bytes).unwrap().contents else { panic!("a film") };
    assert_eq!(film.finish().and_then(|finish| finish.facets()).map(|facets| facets.size()), Some([256, 1]));
    user.ok("export a.exr --to lut -o a-lut.exr --shader a.glsl --facets facets.exr -q");
    let shader = String::from_utf8(user.read("a.glsl")).unwrap();
    assert!(shader.contains("const int GONIOCHROME_RINGS = 256;") && shader.contains("sampler2D facets"), "{shader}");
    // The texture holds the numbers of the blob, behind its colours and its thickness.
    let texture = exr::prelude::read_first_flat_layer_from_file(user.at("facets.exr")).unwrap();
    let numbers: Vec<f32> = texture.layer_data.channel_data.list[0].sample_data.values_as_f32().collect();
    let of_blob =
        bytes[64 + 4 * (3 * film.angles() + 1)..].as_chunks().0.iter().map(|&number| f32::from_le_bytes(number));
    assert!(numbers.len().is_multiple_of(256) && of_blob.zip(&numbers).all(|(a, b)| a == *b));
    user.refused("export a.exr --to lut -o b.exr --shader b.glsl", 2, &["--facets is missing", "facets.exr"]);
    user.refused("export b.exr --to lut -o c.exr --facets d.exr", 2, &["--facets is for", "leave it out"]);
    user.refused("export a.exr --to lut -o c.exr --facets d.png", 2, &["--facets d.png", "name it .exr"]);
}

#[test]
fn a_table_far_from_the_file_of_its_facets_gives_a_material() {
    let film = "[stack]\nambient = 1.0\nlayers = [{ material = 1.33, thickness_nm = 300 }]\nsubstrate = 1.5\n";
    let user = User::with(&[("d.csv", "0,1\n20,0.5\n40,0\n")]);
    user.write("film.toml", format!("{film}[finish]\ndistribution = {{ file = \"d.csv\" }}\n"));
    user.ok("estimate film.toml -o film.exr -q");
    let said = user.ok("export film.toml --to gltf -o near.gltf").stderr;
    std::fs::remove_file(user.at("d.csv")).unwrap();
    user.ok("export film.exr --to gltf -o far.gltf -q");
    assert_eq!(user.read("near.gltf"), user.read("far.gltf"));
    assert!(said.contains("tabulated facets, approximated by GGX facets of the same median slope"), "{said}");
}

#[test]
fn facets_of_a_mesh_reflect_as_the_mesh_does() {
    /// Asked: albedo, and lobes in 30 × 36 bins as Σ |difference| over the whole. The finish's lobes are those of the
    /// mesh but for the width of its nodes; 65 536 rays leave 2 % of noise in the lobes.
    const ALBEDO: f64 = 0.01;
    const LOBES: f64 = 0.06;
    /// Places in a bin along cos θ and φ.
    const PLACES: [usize; 2] = [24, 3];
    let surface = "surface = { kind = \"sines\", waves = 1000, highest = 30, rms_slope = 0.08, grid = [240, 240] }";
    let period = "period_nm = [100000.0, 100000.0]";
    let cell = format!("[cell]\n{surface}\n{period}\n[interface.upper]\nabove = 1.0\nbelow = \"Al\"\n");
    let user = User::with(&[("cell.toml", &cell), ("facets.toml", &aluminium(&format!("{surface}, {period}")))]);
    user.ok("estimate facets.toml -o facets.exr --wavelengths 550 -q");
    let table = file::read(&user.at("facets.exr")).unwrap();
    let reflection = Reflection::new(&table, LobeWidth::default(), false).unwrap();
    let mut evaluator = reflection.evaluator();
    for theta in [0.0f64, 30.0, 50.0] {
        user.ok(&format!(
            "scatter cell.toml --theta {theta} --phi 0 --wavelengths 550 --rays 65536 --coherence none --bins 30x36 \
             --json s.json -q"
        ));
        let scattered: Value = serde_json::from_slice(&user.read("s.json")).unwrap();
        let wi = direction(theta.to_radians(), 0.0);
        let (mut of_mesh, mut of_finish, mut apart) = (0.0, 0.0, 0.0);
        for bin in scattered["bins"].as_array().unwrap() {
            let at = |key: &str| bin[key].as_f64().unwrap();
            let (low, high) = (at("cos_min"), at("cos_max"));
            let mut sum = 0.0;
            for place in 0..PLACES[0] * PLACES[1] {
                let part = |i: usize, count: usize| (i as f64 + 0.5) / count as f64;
                let cos = low + (high - low) * part(place % PLACES[0], PLACES[0]);
                let turn = part(place / PLACES[0], PLACES[1]);
                let phi = at("phi_min_deg") + (at("phi_max_deg") - at("phi_min_deg")) * turn;
                let mut f = [0.0];
                evaluator.eval(wi, direction(cos.acos(), phi.to_radians()), &mut f);
                sum += f[0] * cos;
            }
            let solid = (high - low) * (at("phi_max_deg") - at("phi_min_deg")).to_radians();
            let power = sum * solid / (PLACES[0] * PLACES[1]) as f64;
            of_mesh += at("power");
            of_finish += power;
            apart += (at("power") - power).abs();
        }
        assert!((of_finish / of_mesh - 1.0).abs() <= ALBEDO, "{theta}: {of_finish} {of_mesh}");
        assert!(apart / of_mesh <= LOBES, "{theta}: {}", apart / of_mesh);
    }
}

/// A ridge of slope ±1 along y, as a mesh and as a map of its heights.
#[test]
fn meshes_and_height_maps_of_the_same_heights_have_the_same_facets() {
    /// Rounding to four digits of D and to single precision of heights.
    const WRITTEN: f64 = 1e-3;
    let mut obj = String::new();
    for (x, z) in [(0, 0), (2, 1), (4, 0)] {
        obj += &format!("v {x} 0 {z}\nv {x} 4 {z}\n");
    }
    obj += "usemtl any\nf 1 3 4 2\nf 3 5 6 4\n";
    let user = User::with(&[("ridge.obj", &obj), ("mesh.toml", &aluminium("file = \"ridge.obj\""))]);
    // Heights of the pixels 0, 1, 2, 1 half units apart: the ridge as a period of four squares.
    let values: Vec<u8> = (0..4).flat_map(|_| [0.0f32, 0.5, 1.0, 0.5]).flat_map(f32::to_le_bytes).collect();
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (4, 4), }";
    let mut npy = b"\x93NUMPY\x01\x00".to_vec();
    npy.extend((header.len() as u16).to_le_bytes());
    npy.extend(header.as_bytes());
    npy.extend(&values);
    user.write("ridge.npy", npy);
    user.write("map.toml", aluminium("file = \"ridge.npy\", size_nm = 4.0, edges = \"wrap\""));
    let mean = "[finish]\nisotropic = true\n";
    user.write("mean.toml", aluminium("file = \"ridge.obj\"").replace("[finish]\n", mean));
    let found = |name: &str, phi: u32| {
        user.ok(&format!("estimate {name}.toml -o {name}.exr --wavelengths 550 -q"));
        let csv = user.ok(&format!("lookup {name}.exr --wi 0,0 --wo 53.13,{phi} --csv - -q")).stdout;
        column(&csv, "f_550")[0]
    };
    let [along, across, map] = [found("mesh", 0), found("mesh", 90), found("map", 0)];
    assert!(along > 1.0 && across.abs() < 1e-9 && (map / along - 1.0).abs() <= WRITTEN, "{along} {across} {map}");
    let [here, there] = [found("mean", 0), found("mean", 90)];
    assert!(here > 0.0 && (here / there - 1.0).abs() <= WRITTEN, "{here} {there}");
    user.refused("export mesh.exr --to bsdf -o a.bsdf -q", 2, &["depend on the azimuth", "--roughness 0.1"]);
}

#[test]
fn facets_that_cannot_be_are_refused() {
    let user = User::with(&[
        ("empty.csv", "theta_deg,D\n"),
        ("order.csv", "10,1\n5,1\n"),
        ("angle.csv", "10,1\n95,1\n"),
        ("sign.csv", "0,1\n# fine\n5,-1\n"),
        ("words.csv", "0,1\n5,one\n"),
        ("grid.csv", "0,0,1\n0,90,1\n10,0,1\n10,80,1\n"),
        ("zero.csv", "0,0\n90,0\n"),
        ("tilted.csv", "0,0,1\n0,180,0\n40,0,1\n40,180,0\n"),
        ("down.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n"),
        ("wall.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"),
        ("map.png", "no picture"),
    ]);
    for (name, finish, says) in [
        ("a", "file = \"empty.csv\"", ["no rows", "empty.csv:1"]),
        ("b", "file = \"order.csv\"", ["must increase", "order.csv:2"]),
        ("c", "file = \"angle.csv\"", ["from 0 to 90", "angle.csv:2"]),
        ("d", "file = \"sign.csv\"", ["not negative", "sign.csv:3"]),
        ("e", "file = \"words.csv\"", ["theta_deg, D", "words.csv:2"]),
        ("f", "file = \"grid.csv\"", ["full grid", "grid.csv:3"]),
        ("g", "file = \"zero.csv\"", ["positive somewhere", "zero.csv"]),
        ("h", "file = \"tilted.csv\"", ["mean slope", "tilted.csv"]),
        ("i", "file = \"down.obj\"", ["faces down", "line 4"]),
        ("j", "file = \"wall.obj\"", ["no facet faces up", "j.toml"]),
        ("k", "file = \"map.png\"", ["size_nm", "k.toml"]),
        ("l", "file = \"map.png\", size_nm = 100.0, height_nm = 5.0", ["map.png", "neither PNG"]),
        ("m", "file = \"none.csv\"", ["none.csv", "m.toml"]),
        ("n", "shape = 1", ["\"file\" is missing", "n.toml"]),
        (
            "o",
            "surface = { kind = \"sines\", waves = 9, highest = 3, rms_slope = 0.1, grid = [16, 16] }",
            ["period_nm is missing", "o.toml"],
        ),
    ] {
        user.write(&format!("{name}.toml"), aluminium(finish));
        user.refused(&format!("spectrum {name}.toml"), 1, &says);
    }
    for (name, more, says) in [
        ("p", "roughness = 0.1\n", ["have their own; remove it", "p.toml"]),
        ("q", "isotropic = true\n", ["is for normals", "q.toml"]),
    ] {
        user.write("one.csv", "0,1\n50,1\n");
        user.write(&format!("{name}.toml"), aluminium("file = \"one.csv\"") + more);
        user.refused(&format!("spectrum {name}.toml"), 1, &says);
    }
}
