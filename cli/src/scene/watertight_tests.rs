use super::*;
use crate::scene::parts::tests::{interface, medium};
use crate::scene::{load, parse_mesh};

/// Air, film (1.6), glass (1.5), a medium that absorbs.
fn media() -> Vec<NamedMedium> {
    vec![medium("air", 1.0, 0.0), medium("film", 1.6, 0.0), medium("glass", 1.5, 0.0), medium("dark", 1.5, 0.1)]
}

fn interfaces() -> Vec<NamedInterface> {
    vec![
        interface("top", 0, Below::Medium(1)),
        interface("base", 1, Below::Medium(2)),
        interface("mirror", 0, Below::Mirror),
        interface("grain", 1, Below::Medium(0)),
        interface("dark", 3, Below::Medium(0)),
        interface("odd", 2, Below::Medium(0)),
        interface("nothing", 0, Below::Medium(0)),
    ]
}

fn check(obj: &str) -> Result<()> {
    let interfaces = interfaces();
    let names: Vec<&str> = interfaces.iter().map(|i| i.name.as_str()).collect();
    let mesh = parse_mesh("m.obj", obj, &names)?;
    check_closed(&mesh, [10.0, 8.0], &interfaces, &media())
}

fn refusal(obj: &str) -> String {
    check(obj).unwrap_err().to_string()
}

/// A roof over the period of 10 × 8, ridge along y at x = 5; nine lines, faces on 8 and 9.
fn roof(usemtl: &str, z: f64) -> String {
    let ridge = z + 3.0;
    format!(
        "v 0 0 {z}\nv 0 8 {z}\nv 5 0 {ridge}\nv 5 8 {ridge}\nv 10 0 {z}\nv 10 8 {z}\nusemtl {usemtl}\nf -6 -4 -3 -5\nf -4 -2 -1 -3\n"
    )
}

/// A closed tetrahedron with its corner at (3, 3, z); normals outwards; nine lines.
fn grain(usemtl: &str, z: f64) -> String {
    let top = z + 2.0;
    format!(
        "v 3 3 {z}\nv 5 3 {z}\nv 3 5 {z}\nv 3 3 {top}\nusemtl {usemtl}\nf -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n"
    )
}

#[test]
fn vertices_beside_the_border_are_put_onto_it() {
    let interfaces = interfaces();
    let names: Vec<&str> = interfaces.iter().map(|i| i.name.as_str()).collect();
    let off = roof("top", 0.0).replace("v 0 0", "v -0.0000001 0.0000002").replace("v 10 8", "v 9.9999999 8.0000002");
    let mesh = parse_mesh("m.obj", &off, &names).unwrap();
    let cell = ClosedCell::new(mesh, [10.0, 8.0], interfaces, &media()).unwrap();
    let [first, last] = [0, 5].map(|vertex| cell.mesh().vertices[vertex]);
    assert_eq!((first, last), ([0.0, 0.0, 0.0], [10.0, 8.0, 0.0]));
}

#[test]
fn closed_cells_pass() {
    check(&roof("top", 0.0)).unwrap();
    check(&roof("mirror", 40.0)).unwrap(); // far higher than its period
    check(&(roof("top", 0.0) + &roof("base", -1.0))).unwrap();
    // A body in a layer, whatever the order.
    check(&(grain("grain", -5.0) + &roof("top", 0.0) + &roof("base", -10.0))).unwrap();
    // Corners written once for each face, an unused vertex, a triangle without area, lines of Windows.
    let spare = "v 500 500 500\n".to_owned() + &roof("top", 0.0) + "v 2 2 0\nv 3 2 0\nv 4 2 0\nf -3 -2 -1\n";
    check(&spare.replace('\n', "\r\n")).unwrap();
    // A wall on the border stands for both sides of the cell.
    check("v 0 0 0\nv 10 0 3\nv 10 8 3\nv 0 8 0\nv 10 0 0\nv 10 8 0\nusemtl top\nf 1 2 3 4\nf 2 5 6 3\n").unwrap();
    // A facet that divides nothing may end anywhere.
    check(&(roof("top", 0.0) + "v 1 1 9\nv 2 1 9\nv 2 2 9\nusemtl nothing\nf -3 -2 -1\n")).unwrap();
}

/// Four facets on one edge: two tetrahedra that share an edge, in a layer.
#[test]
fn more_than_two_facets_may_share_an_edge() {
    let pair = |usemtl: &str| {
        format!(
            "v 4 4 -5\nv 4 4 -3\nv 2 3 -4\nv 2 5 -4\nv 6 3 -4\nv 6 5 -4\nusemtl grain\nf -6 -4 -3\nf -6 -5 -4\nf -6 -3 -5\nf -5 -3 -4\nusemtl {usemtl}\nf -6 -1 -2\nf -6 -2 -5\nf -6 -5 -1\nf -5 -2 -1\n"
        )
    };
    let layer = roof("top", 0.0) + &roof("base", -10.0);
    check(&(pair("grain") + &layer)).unwrap();
    let message = refusal(&(pair("odd") + &layer));
    assert!(message.contains("the facet has") && message.contains("\"glass\""), "{message}");
}

#[test]
fn holes_are_named_by_line_and_place() {
    let open = roof("top", 0.0).replace("f -4 -2 -1 -3\n", "f -4 -2 -1\n");
    assert_eq!(
        refusal(&open),
        "m.obj:9: the edge from (10, 8, 0) to (5, 0, 3) nm has no partner; fill the hole or share the edge"
    );
    // Borders that do not meet.
    let step = roof("top", 0.0).replace("v 10 0 0\nv 10 8 0", "v 10 0 1\nv 10 8 1");
    assert!(refusal(&step).ends_with("has no partner; fill the hole or share the edge"));
    let body = grain("grain", -5.0).replace("f -2 -4 -1\n", "");
    assert!(refusal(&(body + &roof("top", 0.0))).contains("has no partner"));
}

#[test]
fn facets_that_disagree_are_named() {
    let turned = roof("top", 0.0).replace("f -4 -2 -1 -3", "f -3 -1 -2 -4");
    assert_eq!(
        refusal(&turned),
        "m.obj:8: at the edge from (5, 8, 3) to (5, 0, 3) nm the facet has \"film\" where the facet of line 9 has \"air\"; turn its vertices around or correct its usemtl"
    );
    let other = roof("top", 0.0).replace("f -4 -2", "usemtl base\nf -4 -2");
    assert!(refusal(&other).contains("turn its vertices around or correct its usemtl"));
    // The turned face of a body is named, not its neighbours.
    let body = grain("grain", -5.0).replace("f -3 -2 -1", "f -1 -2 -3") + &roof("top", 0.0);
    assert!(refusal(&body).starts_with("m.obj:8: at the edge"), "{}", refusal(&body));
}

#[test]
fn bodies_that_disagree_with_what_is_around_them_are_named() {
    let message = refusal(&(roof("top", 0.0) + &roof("odd", -1.0)));
    assert!(message.starts_with("m.obj:17: the facet has \"glass\" over it at ("), "{message}");
    assert!(
        message.contains("but the facet of line 8, at (")
            && message.ends_with("has \"film\" under it; make them equal")
    );
    let inside_out = grain("top", -5.0) + &roof("top", 0.0) + &roof("base", -10.0);
    assert!(refusal(&inside_out).ends_with("make them equal"));
    // A body in the air over the roof must have air around it.
    assert!(refusal(&(grain("grain", 5.0) + &roof("top", 0.0))).ends_with("make them equal"));
}

#[test]
fn overlaps_and_copies_are_named() {
    assert_eq!(
        refusal(&(roof("top", 0.0) + "f -6 -4 -3 -5\n")),
        "m.obj:8: the facet overlaps that of line 10 beside the edge from (0, 0, 0) to (5, 0, 3) nm; remove one"
    );
    let other_diagonal = roof("top", 0.0) + "f -4 -3 -5\nf -4 -5 -6\n";
    assert!(refusal(&other_diagonal).contains("overlaps that of line"));
}

#[test]
fn what_leaves_the_period_or_spans_none_is_named() {
    assert_eq!(
        refusal(&roof("top", 0.0).replace("v 10 0 0", "v 11 0 0").replace("v 10 8 0", "v 11 8 0")),
        "m.obj:9: the facet leaves the period at (11, 0, 0) nm; cut the mesh at x = 0 and 10, y = 0 and 8"
    );
    assert_eq!(
        refusal(&grain("top", 0.0)),
        "m.obj:6: no surface spans the period, so light falls through between the facets; add a plane"
    );
    let message = refusal(&roof("dark", 0.0));
    assert!(
        message.contains("light cannot arrive at (") && message.ends_with("\"dark\", which absorbs; use k <= 0.001")
    );
    let mesh = parse_mesh("m.obj", &roof("top", 0.0), &["top"]).unwrap();
    let zero = check_closed(&mesh, [0.0, 8.0], &interfaces(), &media()).unwrap_err().to_string();
    assert_eq!(zero, "m.obj:8: a period of 0 by 8 nm; both must be more than 0 nm and at most a metre");
    let mut huge = mesh.clone();
    huge.vertices[0][2] = 2e9;
    let huge = check_closed(&huge, [10.0, 8.0], &interfaces(), &media()).unwrap_err().to_string();
    assert_eq!(huge, "m.obj:8: the facet reaches (0, 0, 2000000000): more than a metre; units are nanometres");
}

/// The cells with independent reference values, and what becomes of them when one triangle is lost or turned.
#[test]
fn reference_cells_pass_and_fail_with_one_triangle_changed() {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/cells");
    let cells = [
        ("vgroove-mirror", 10_000, "[interface.mirror_surface]\nabove = 1\nbelow = \"mirror\"\n"),
        ("bumps-glass", 20_000, "[interface.surface]\nabove = 1\nbelow = 1.5\n"),
        (
            "bumpy-film",
            20_000,
            "[interface.upper]\nabove = 1\nbelow = 1.6\n[interface.lower]\nabove = 1.6\nbelow = 1\n",
        ),
    ];
    for (name, period, interfaces) in cells {
        let obj = std::fs::read_to_string(data.join(name).with_extension("obj")).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let scene = format!("[cell]\nmesh = \"m.obj\"\nperiod_nm = [{period}, {period}]\n{interfaces}");
        let path = folder.path().join("s.toml");
        std::fs::write(&path, scene).unwrap();
        let read = |obj: &str| {
            std::fs::write(folder.path().join("m.obj"), obj).unwrap();
            load(path.to_str().unwrap()).map(|_| ()).map_err(|error| error.to_string())
        };
        read(&obj).unwrap();
        let faces: Vec<&str> = obj.lines().filter(|line| line.starts_with("f ")).collect();
        let face = faces[faces.len() / 2];
        let line = 1 + obj.lines().position(|line| line == face).unwrap();
        let lost = read(&obj.replace(&format!("{face}\n"), "")).unwrap_err();
        assert!(lost.contains("has no partner; fill the hole"), "{name}: {lost}");
        let [a, b, c] = face[2..].split(' ').collect::<Vec<_>>().try_into().unwrap();
        let turned = read(&obj.replace(&format!("{face}\n"), &format!("f {a} {c} {b}\n"))).unwrap_err();
        assert!(turned.contains(&format!("m.obj:{line}: at the edge")), "{name}: {line} {turned}");
    }
}
