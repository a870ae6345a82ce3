use serde_json::Value;

use super::*;
use crate::scene::{load, parse};

/// Vertices and faces of a box over [x0, x1] × [y0, y1] × [0, height] on a floor over a period of 400 × 300 nm, for a
/// scene whose period is that.
fn pillar(height: f64) -> String {
    let ([x0, x1], [y0, y1], [px, py]) = ([100.0, 250.0], [60.0, 180.0], [400.0, 300.0]);
    let mut obj = String::new();
    for z in [0.0, height] {
        for (x, y) in [(x0, y0), (x1, y0), (x1, y1), (x0, y1)] {
            obj += &format!("v {x} {y} {z}\n");
        }
    }
    for (x, y) in [(0.0, 0.0), (px, 0.0), (px, py), (0.0, py)] {
        obj += &format!("v {x} {y} 0\n");
    }
    // Floor around the foot, walls, top.
    obj + "usemtl glass\nf 9 10 2 1\nf 10 11 3 2\nf 11 12 4 3\nf 12 9 1 4\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n\
           f 5 6 7 8\n"
}

fn scene_of(cell: &str, rest: &str) -> Scene {
    parse("test", &format!("[cell]\nperiod_nm = [400.0, 300.0]\n{cell}\n{rest}")).unwrap()
}

fn scene_of_mesh(obj: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.obj"), obj).unwrap();
    let path = folder.path().join("m.toml");
    let toml = "[cell]\nmesh = \"m.obj\"\nperiod_nm = [400.0, 300.0]\n[interface.glass]\nabove = 1.0\nbelow = 1.5\n";
    std::fs::write(&path, toml).unwrap();
    load(path.to_str().unwrap()).unwrap()
}

#[test]
fn a_ridge_with_shelves_has_the_layers_of_the_reference() {
    let data: Value = serde_json::from_str(include_str!("../../../../tests/data/waves.json")).unwrap();
    let case = data["cases"].as_array().unwrap().iter().find(|case| case["name"] == "morpho_ridge").unwrap();
    let scene = load("morpho-ridges").unwrap();
    let sections = Sections::new(&scene).unwrap();
    assert_eq!(sections.periodicity, Periodicity::X);
    assert!(!sections.is_stepped() && sections.graph().is_none());
    let layers = sections.layers(&scene, 1.0).unwrap();
    let expected = case["layers_from_top"].as_array().unwrap();
    assert_eq!(layers.len(), expected.len());
    for (layer, expected) in layers.iter().zip(expected) {
        assert!((layer.thickness_nm - expected["thickness_nm"].as_f64().unwrap()).abs() < 1e-9);
        // The reference lists the border of the period as an edge; nine digits of fractions of 700 nm.
        let edges: Vec<f64> =
            expected["edges"].as_array().unwrap().iter().map(|e| 700.0 * e.as_f64().unwrap()).collect();
        let found = layer.strips[0].edges_nm();
        let inner = &edges[1..edges.len() - 1];
        assert_eq!(found.len(), inner.len());
        assert!(found.iter().zip(inner).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?} {inner:?}");
        let solid = &scene.media[usize::from(layer.strips[0].media[0])].name;
        assert_eq!(solid, "cuticle");
    }
}

#[test]
fn a_pillar_has_one_layer_of_two_strips() {
    let scene = scene_of_mesh(&pillar(120.0));
    let sections = Sections::new(&scene).unwrap();
    assert_eq!(sections.periodicity, Periodicity::Both);
    assert!(!sections.is_stepped());
    let layers = sections.layers(&scene, 10.0).unwrap();
    assert_eq!(layers.len(), 1);
    let layer = &layers[0];
    assert_eq!((layer.thickness_nm, &layer.strip_edges_nm[..]), (120.0, &[60.0, 180.0][..]));
    assert_eq!(layer.strips[0].edges_nm(), [100.0, 250.0]);
    assert!(layer.strips[1].edges.is_empty());
    let name = |medium: MediumIndex| scene.media[usize::from(medium)].name.as_str();
    assert_eq!(layer.strips[0].media.iter().map(|m| name(*m)).collect::<Vec<_>>(), ["1.5", "1"]);
    assert_eq!((name(layer.strips[1].media[0]), name(sections.above), name(sections.below)), ("1", "1", "1.5"));
}

#[test]
fn lines_along_x_have_the_layers_of_lines_along_y() {
    let of = |points: &[[f64; 2]], along_x: bool| {
        let mut obj = String::new();
        for &[a, z] in points {
            for b in [0.0, if along_x { 400.0 } else { 300.0 }] {
                obj += &if along_x { format!("v {b} {a} {z}\n") } else { format!("v {a} {b} {z}\n") };
            }
        }
        obj += "usemtl glass\n";
        for i in 0..points.len() - 1 {
            let [a, d, b, c] = [1, 2, 3, 4].map(|corner| 2 * i + corner);
            obj += &if along_x { format!("f {d} {c} {b} {a}\n") } else { format!("f {a} {b} {c} {d}\n") };
        }
        let scene = scene_of_mesh(&obj);
        let sections = Sections::new(&scene).unwrap();
        (sections.periodicity, sections.layers(&scene, 10.0).unwrap(), sections.graph())
    };
    let (y, layers_y, graph_y) = of(&[[0.0, 0.0], [100.0, 0.0], [150.0, 80.0], [200.0, 80.0], [300.0, 0.0]], true);
    assert_eq!((y, layers_y.len()), (Periodicity::Y, 8));
    assert_eq!(graph_y.unwrap(), [[0.0, 0.0], [100.0, 0.0], [150.0, 80.0], [200.0, 80.0]]);
    let (x, layers_x, graph_x) = of(&[[0.0, 0.0], [100.0, 0.0], [150.0, 80.0], [200.0, 80.0], [400.0, 0.0]], false);
    assert_eq!((x, layers_x.len()), (Periodicity::X, 8));
    assert_eq!(graph_x.unwrap().len(), 4);
    // The middle of the second layer from the top lies at 65 nm, on the left wall at 140.625 nm.
    for layers in [&layers_x, &layers_y] {
        assert!((layers[1].strips[0].edges_nm()[0] - (100.0 + 50.0 * 65.0 / 80.0)).abs() < 1e-9);
    }
}

#[test]
fn one_interface_is_a_graph_and_others_are_not() {
    let grooves = |points: &str| {
        let cell = format!("surface = {{ kind = \"grooves\", points_nm = {points} }}");
        let scene = scene_of(&cell, "[interface.grooves]\nabove = 1.0\nbelow = 1.5");
        Sections::new(&scene).unwrap().graph()
    };
    assert_eq!(
        grooves("[[0, 50], [200, 50], [200, 0], [400, 0]]").unwrap(),
        [[0.0, 50.0], [200.0, 50.0], [200.0, 0.0], [400.0, 0.0]]
    );
    assert_eq!(grooves("[[0, 0], [300, 90], [400, 0]]").unwrap(), [[0.0, 0.0], [300.0, 90.0]]);
    // An overhang.
    assert_eq!(grooves("[[0, 50], [250, 50], [150, 0], [400, 0]]"), None);
    assert_eq!(Sections::new(&load("silicon-lines").unwrap()).unwrap().graph(), None);
}

#[test]
fn buried_bodies_and_films_keep_their_media() {
    let scene = load("silicon-lines").unwrap();
    let sections = Sections::new(&scene).unwrap();
    let layers = sections.layers(&scene, 10.0).unwrap();
    assert_eq!(layers.len(), 1);
    assert_eq!(layers[0].strips[0].edges_nm(), [140.0, 260.0]);
    let name = |medium: MediumIndex| scene.media[usize::from(medium)].name.as_str();
    assert_eq!(layers[0].strips[0].media.iter().map(|m| name(*m)).collect::<Vec<_>>(), ["Si", "air"]);
    assert_eq!((name(sections.above), name(sections.below)), ("air", "1.46"));
}

#[test]
fn pyramids_are_square_steps() {
    let scene = load("moth-eye").unwrap();
    let sections = Sections::new(&scene).unwrap();
    assert!(sections.is_stepped());
    let layers = sections.layers(&scene, 20.0).unwrap();
    assert_eq!(layers.len(), 10);
    for (i, layer) in layers.iter().enumerate() {
        // The side of the square at the middle of the layer; the height equals the period.
        let side = 20.0 * (i as f64 + 0.5);
        let [left, right] = layer.strips[0].edges_nm()[..] else { panic!("{layer:?}") };
        assert!((right - left - side).abs() < 1e-6, "{i}: {left} {right}");
        let [front, back] = layer.strip_edges_nm[..] else { panic!("{layer:?}") };
        assert!((back - front - side).abs() < 1e-6);
    }
}

#[test]
fn what_waves_cannot_do_is_said() {
    let refusal = |cell: &str, rest: &str| Sections::new(&scene_of(cell, rest)).unwrap_err().to_string();
    let grooves = "surface = { kind = \"grooves\", points_nm = [[0, 0], [200, 90], [400, 0]] }";
    let mirror = refusal(grooves, "[interface.grooves]\nabove = 1.0\nbelow = \"mirror\"");
    assert!(mirror.contains("perfect mirror") && !mirror.contains('\n'), "{mirror}");
    let coated = "[interface.grooves]\nabove = 1.0\nbelow = 1.5\ncoating = [{ material = 2.0, thickness_nm = 50.0 }]";
    assert!(refusal(grooves, coated).contains("no coating"));
    assert!(refusal(grooves, "[interface.grooves]\nabove = 1.5\nbelow = 1.5").contains("one medium on both sides"));
    let stack = parse("film", "[stack]\nambient = 1.0\nsubstrate = 1.5").unwrap();
    assert!(Sections::new(&stack).unwrap_err().to_string().contains("no diffraction orders"));
}

#[test]
fn bodies_that_overlap_are_refused() {
    // Two boxes that cut through one another: each is closed, and no edge meets another.
    let cube = |x0: f64, x1: f64, first: usize| {
        let mut obj = String::new();
        for z in [50.0, 100.0] {
            for (x, y) in [(x0, 60.0), (x1, 60.0), (x1, 180.0), (x0, 180.0)] {
                obj += &format!("v {x} {y} {}\n", z + x0 * 0.01);
            }
        }
        let face = |f: [usize; 4]| format!("f {}\n", f.map(|v| (v + first).to_string()).join(" "));
        let faces = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7], [3, 2, 1, 0]].map(face);
        obj + "usemtl glass\n" + &faces.concat()
    };
    let floor = "v 0 0 0\nv 400 0 0\nv 400 300 0\nv 0 300 0\nusemtl glass\nf 1 2 3 4\n";
    let scene = scene_of_mesh(&format!("{floor}{}{}", cube(100.0, 250.0, 5), cube(200.0, 350.0, 13)));
    let sections = Sections::new(&scene).unwrap();
    let error = sections.layers(&scene, 10.0).unwrap_err().to_string();
    assert!(error.contains("bodies overlap near (") && !error.contains('\n'), "{error}");
}
