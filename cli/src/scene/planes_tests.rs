use super::*;
use crate::scene::parse_mesh;
use crate::scene::parts::tests::{interface, medium};

/// Air (1), film (1.6), glass (1.5), absorber.
fn media() -> Vec<NamedMedium> {
    vec![medium("1", 1.0, 0.0), medium("1.6", 1.6, 0.0), medium("1.5", 1.5, 0.0), medium("1.5+0.1i", 1.5, 0.1)]
}

/// top (air over film), film (film over glass), base (film over a mirror), odd (glass over air), dark (absorber over
/// air).
fn interfaces() -> Vec<NamedInterface> {
    vec![
        interface("top", 0, Below::Medium(1)),
        interface("film", 1, Below::Medium(2)),
        interface("base", 1, Below::Mirror),
        interface("odd", 2, Below::Medium(0)),
        interface("dark", 3, Below::Medium(0)),
    ]
}

const PERIOD_NM: [f64; 2] = [4.0, 2.0];

fn mesh(obj: &str) -> Mesh {
    let interfaces = interfaces();
    let names: Vec<&str> = interfaces.iter().map(|interface| interface.name.as_str()).collect();
    parse_mesh("m.obj", obj, &names).unwrap()
}

fn flat(obj: &str) -> Result<Option<FlatCell>> {
    FlatCell::new(&mesh(obj), PERIOD_NM, &interfaces(), &media())
}

fn of(obj: &str) -> Result<Vec<Plane>> {
    flat(obj).map(|flat| flat.expect("horizontal planes").planes)
}

fn refusal(obj: &str) -> String {
    of(obj).unwrap_err().to_string()
}

/// Four vertices at a height, then a quadrilateral that faces up; six lines.
fn square(usemtl: &str, z: f64) -> String {
    format!("v 0 0 {z}\nv 4 0 {z}\nv 4 2 {z}\nv 0 2 {z}\nusemtl {usemtl}\nf -4 -3 -2 -1\n")
}

/// Two such squares that share no vertices, each half the period.
fn halves(z: [f64; 2]) -> String {
    let half = |x: f64, z: f64| {
        let to = x + 2.0;
        format!("v {x} 0 {z}\nv {to} 0 {z}\nv {to} 2 {z}\nv {x} 2 {z}\nusemtl top\nf -4 -3 -2 -1\n")
    };
    half(0.0, z[0]) + &half(2.0, z[1])
}

#[test]
fn planes_come_from_the_top_whatever_their_order_and_orientation() {
    let film = square("film", -100.0).replace("-4 -3 -2 -1", "-1 -2 -3 -4");
    // The film's faces look down: above and below change places, so it must be declared the other way round.
    let swapped = film.replace("film", "odd");
    let planes = of(&(square("top", 50.0) + &square("base", -100.0))).unwrap();
    assert_eq!(planes.iter().map(|plane| plane.z_nm).collect::<Vec<_>>(), [50.0, -100.0]);
    assert_eq!(planes[0].interface.below, Below::Medium(planes[1].interface.above));
    assert_eq!(planes[1].interface.below, Below::Mirror);
    let down = of(&swapped).unwrap();
    let up = of(&square("odd", -100.0)).unwrap();
    assert_eq!(Below::Medium(down[0].interface.above), up[0].interface.below);
    assert_eq!(down[0].interface.below, Below::Medium(up[0].interface.above));
    assert_eq!(of(&(square("base", -100.0) + &square("top", 50.0))).unwrap(), planes);
}

#[test]
fn facets_may_share_vertices_or_repeat_them() {
    assert_eq!(of(&halves([7.0, 7.0])).unwrap().len(), 1);
    let rounding = 7.0 + 2.0 * f64::from(f32::EPSILON);
    assert_eq!(of(&halves([7.0, rounding])).unwrap().len(), 1);
    let offset = square("top", 0.0).replace("v 4", "v 2").replace("v 0", "v -2");
    assert_eq!(of(&offset).unwrap().len(), 1);
}

#[test]
fn only_meshes_of_horizontal_facets_are_flat() {
    let ridge = "v 0 0 0\nv 0 2 0\nv 1 0 1\nv 1 2 1\nv 4 0 0\nv 4 2 0\nusemtl top\nf 1 3 4 2\nf 3 5 6 4\n";
    assert!(flat(ridge).unwrap().is_none());
    // Steps that are each within rounding climb to far more.
    let step = 3e-7;
    let mut stairs = String::new();
    for i in 0..=40 {
        let (x, z) = (0.1 * f64::from(i), step * f64::from(i));
        stairs += &format!("v {x} 0 {z:.9}\nv {x} 2 {z:.9}\n");
    }
    stairs += "usemtl top\n";
    for i in 0..40 {
        let a = 2 * i + 1;
        stairs += &format!("f {} {} {} {}\n", a, a + 2, a + 3, a + 1);
    }
    assert!(step < f64::from(f32::EPSILON) * 4.0 && flat(&stairs).unwrap().is_none());
}

#[test]
fn planes_are_traced_as_one_rectangle_each() {
    let cell = flat(&(halves([7.0, 7.0]) + &square("base", 1.0))).unwrap().unwrap();
    let mesh = cell.polygons().mesh();
    let corners: Vec<[f64; 3]> = mesh.triangles.iter().map(|t| mesh.vertices[t.vertices[2] as usize]).collect();
    assert_eq!(corners, [[4.0, 2.0, 7.0], [0.0, 2.0, 7.0], [4.0, 2.0, 1.0], [0.0, 2.0, 1.0]]);
    assert_eq!(mesh.triangles.iter().map(|t| t.interface).collect::<Vec<_>>(), [0, 0, 2, 2]);
    let down = square("odd", 1.0).replace("-4 -3 -2 -1", "-1 -2 -3 -4");
    let down = flat(&down).unwrap().unwrap();
    let [a, b, c] = down.polygons().mesh().triangles[0].vertices.map(|v| down.polygons().mesh().vertices[v as usize]);
    assert!((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]) < 0.0, "it still faces down");
}

#[test]
fn coatings_become_films_that_push_the_rest_down() {
    let mesh = mesh(&(square("top", 50.0) + &square("base", -100.0)));
    let mut interfaces = interfaces();
    let planes = |mesh: &Mesh, interfaces: &[NamedInterface]| {
        FlatCell::new(mesh, PERIOD_NM, interfaces, &media()).unwrap().expect("horizontal planes").planes
    };
    let [air, film, dark] = [0, 1, 2].map(|n| n as u16);
    let top = interfaces.iter_mut().find(|interface| interface.name == "top").unwrap();
    let layer = |medium, thickness_nm| Layer { medium, thickness_nm, spread: None };
    top.coating = vec![layer(dark, 7.0), layer(air, 5.0)];
    let (above, below) = (top.interface.above, top.interface.below);
    let found = planes(&mesh, &interfaces);
    assert_eq!(found.iter().map(|plane| plane.z_nm).collect::<Vec<_>>(), [50.0, 43.0, 38.0, -112.0]);
    assert_eq!(found[0].interface, Interface { above, below: Below::Medium(dark) });
    assert_eq!(found[1].interface, Interface { above: dark, below: Below::Medium(air) });
    assert_eq!(found[2].interface, Interface { above: air, below });
    // Seen from behind, the films stand in the opposite order.
    let turned = Mesh {
        triangles: mesh
            .triangles
            .iter()
            .map(|t| Triangle { vertices: [t.vertices[0], t.vertices[2], t.vertices[1]], ..*t })
            .collect(),
        ..mesh
    };
    let only: Vec<Triangle> = turned.triangles[..2].to_vec();
    let turned = planes(&Mesh { triangles: only, ..turned }, &interfaces);
    let media: Vec<Below> = turned.iter().map(|plane| plane.interface.below).collect();
    assert_eq!(media, [Below::Medium(air), Below::Medium(dark), Below::Medium(above)]);
    assert_ne!(film, dark);
}

#[test]
fn planes_that_do_not_cover_the_period_once_are_refused() {
    assert_eq!(
        refusal(&halves([7.0, 8.0])),
        "m.obj:6: the plane \"top\" at z = 7 nm spans 2 by 2 nm but the period is 4 by 2 nm; make them equal"
    );
    let hole = "v 2 1 0\n".to_owned() + &square("top", 0.0).replace("f -4 -3 -2 -1", "f 1 2 3\nf 1 3 4\nf 1 4 5");
    assert_eq!(
        refusal(&hole),
        "m.obj:7: the plane \"top\" at z = 0 nm is not closed: the edge from (2, 1) to (0, 0) has no partner; fill the hole or share the edge"
    );
    let fan = hole + "f 1 5 2\n";
    assert_eq!(of(&fan).unwrap().len(), 1);
    let twice = square("top", 0.0) + "f 1 2 3 4\n";
    assert_eq!(refusal(&twice), "m.obj:6: the plane \"top\" at z = 0 nm covers the period 2 times; remove the copies");
    let turned = halves([0.0, 0.0]) + "f 1 4 3 2\nf 1 2 3 4\n";
    assert_eq!(
        refusal(&turned),
        "m.obj:13: facet of the plane \"top\" at z = 0 nm faces the other way; turn its vertices around"
    );
}

#[test]
fn planes_that_disagree_are_refused() {
    assert_eq!(
        refusal(&(square("top", 5.0) + &square("odd", 0.0))),
        "m.obj:12: the plane \"odd\" at z = 0 nm has \"1.5\" above it but the plane \"top\" at z = 5 nm has \"1.6\" below it; make them equal"
    );
    assert_eq!(
        refusal(&(square("top", 5.0) + &square("film", 5.0))),
        "m.obj:12: the plane \"top\" at z = 5 nm and the plane \"film\" at z = 5 nm coincide; move or remove one"
    );
    assert_eq!(
        refusal(&(square("base", 5.0) + &square("film", 0.0))),
        "m.obj:12: the plane \"film\" at z = 0 nm lies below the mirror the plane \"base\" at z = 5 nm; remove it"
    );
    let mirror = square("base", 5.0).replace("-4 -3 -2 -1", "-1 -2 -3 -4");
    assert_eq!(
        refusal(&mirror),
        "m.obj:6: the plane \"base\" at z = 5 nm faces down, with its mirror on top; turn its faces around"
    );
    assert_eq!(
        refusal(&square("dark", 5.0)),
        "m.obj:6: light cannot arrive at the plane \"dark\" at z = 5 nm through \"1.5+0.1i\", which absorbs; use k <= 0.001"
    );
}
