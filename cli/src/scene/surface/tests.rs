use glam::DVec3;

use crate::scene::{Mesh, Scene, Triangle, parse};
use crate::support::error::Result;

fn scene(period: &str, surface: &str, interfaces: &[&str]) -> Result<Scene> {
    let mut text = format!("[cell]\nperiod_nm = {period}\nsurface = {{ {surface} }}\n");
    for name in interfaces {
        let (above, below) = match *name {
            "lower" => ("1.5", "1"),
            "film" => ("1.5", "1.6"),
            "base" => ("1.6", "1.4"),
            "particle" => ("1.6", "2"),
            "top" if !interfaces.contains(&"film") => ("1", "1.6"),
            _ => ("1", "1.5"),
        };
        text += &format!("[interface.{name}]\nabove = {above}\nbelow = {below}\n");
    }
    parse("s.toml", &text)
}

fn mesh(period: &str, surface: &str, interfaces: &[&str]) -> Mesh {
    scene(period, surface, interfaces).unwrap().shape.polygons().expect("a cell").mesh().clone()
}

fn refusal(period: &str, surface: &str, interfaces: &[&str]) -> String {
    scene(period, surface, interfaces).unwrap_err().to_string()
}

/// Twice the areas of a mesh's triangles along their normals.
fn areas(mesh: &Mesh) -> Vec<DVec3> {
    let corners = |t: &Triangle| t.vertices.map(|v| DVec3::from(mesh.vertices[v as usize]));
    mesh.triangles.iter().map(corners).map(|[a, b, c]| (b - a).cross(c - a)).collect()
}

fn rms_slope(mesh: &Mesh) -> f64 {
    let (mut square, mut whole) = (0.0, 0.0);
    for n in areas(mesh) {
        square += (n.x * n.x + n.y * n.y) / n.z;
        whole += n.z;
    }
    (square / whole).sqrt()
}

fn heights(mesh: &Mesh) -> [f64; 2] {
    mesh.vertices.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v[2]), high.max(v[2])])
}

const SINES: &str = "kind = \"sines\", waves = 12, highest = 4, rms_slope = 0.3, grid = [96, 64]";

#[test]
fn sines_have_their_slope_and_their_seed() {
    let one = mesh("[20000, 15000]", SINES, &["upper"]);
    assert_eq!(one.triangles.len(), 2 * 96 * 64);
    // The grid cuts corners: a few thousandths at six squares to a quarter of the shortest wave.
    assert!((rms_slope(&one) / 0.3 - 1.0).abs() < 0.02, "{}", rms_slope(&one));
    assert_eq!(one, mesh("[20000, 15000]", SINES, &["upper"]));
    assert_ne!(one, mesh("[20000, 15000]", &format!("{SINES}, seed = 1"), &["upper"]));
    let film = mesh("[20000, 15000]", &format!("{SINES}, offset_nm = 420"), &["upper", "lower"]);
    let half = one.vertices.len();
    assert_eq!(film.vertices.len(), 2 * half);
    for (upper, lower) in film.vertices[..half].iter().zip(&film.vertices[half..]) {
        assert!((upper[2] - lower[2] - 420.0).abs() < 1e-9);
    }
}

#[test]
fn pits_are_hexagonal_caps() {
    let pits = mesh("[17320.508, 10000]", "kind = \"pits\", depth_nm = 1500, rings = 6", &["pits"]);
    let [low, high] = heights(&pits);
    assert!((low + 1500.0).abs() < 1e-6 && high.abs() < 0.1, "{low} {high}");
    assert!((areas(&pits).iter().map(|n| n.z).sum::<f64>() / 2.0 - 1.732_050_8e8).abs() < 1.0);
    let bottoms = pits.vertices.iter().filter(|v| v[2] < -1499.99).count();
    assert_eq!(bottoms, 5); // four corners and the middle
    // Every vertex lies on one of the two spheres about the nearest pit; their radius follows from corner and depth.
    let corner = 10_000.0 / 3f64.sqrt();
    let radius = (corner * corner + 1500.0 * 1500.0) / 3000.0;
    for v in &pits.vertices {
        let d = |x: f64, y: f64| (v[0] - x).hypot(v[1] - y);
        let nearest = [(0.0, 0.0), (17320.508, 0.0), (0.0, 1e4), (17320.508, 1e4), (8660.254, 5e3)]
            .map(|(x, y)| d(x, y))
            .into_iter()
            .fold(f64::INFINITY, f64::min);
        assert!((nearest.hypot(v[2] + 1500.0 - radius) - radius).abs() < 1e-6);
    }
    assert!(
        refusal("[10000, 10000]", "kind = \"pits\", depth_nm = 1500", &["pits"]).contains("√3 to 1: [17320.5, 10000]")
    );
}

#[test]
fn profiles_run_along_y() {
    let blazed = mesh("[6000, 10]", "kind = \"grooves\", points_nm = [[0, 0], [6000, 525]]", &["grooves"]);
    assert_eq!((blazed.triangles.len(), heights(&blazed)), (4, [0.0, 525.0])); // with the wall on the border
    let scratches = mesh("[5e4, 10]", "kind = \"scratches\", segments = 200, rms_slope = 0.15", &["scratches"]);
    assert_eq!(scratches.triangles.len(), 400);
    assert!((rms_slope(&scratches) - 0.15).abs() < 1e-9, "{}", rms_slope(&scratches));
    let shelves = "kind = \"lamellae\", shelves = 3, width_nm = 400, shelf_nm = 60, gap_nm = 130, trunk_nm = 50";
    let ridge = mesh("[700, 10]", shelves, &["cuticle"]);
    assert_eq!(heights(&ridge), [0.0, 3.0 * 190.0 + 65.0]);
    // The cross-section's area: shelves and trunk; the volume under a surface by the divergence theorem.
    let centre = |t: &Triangle| t.vertices.iter().map(|&v| ridge.vertices[v as usize][2]).sum::<f64>() / 3.0;
    let volume: f64 = ridge.triangles.iter().zip(areas(&ridge)).map(|(t, n)| 0.5 * n.z * centre(t)).sum();
    assert!((volume / 10.0 - (3.0 * 60.0 * 350.0 + 635.0 * 50.0)).abs() < 1e-6, "{volume}");
}

#[test]
fn pyramids_have_their_angle() {
    let regular = mesh("[8000, 4000]", "kind = \"pyramids\", count = [2, 1]", &["pyramids"]);
    assert_eq!(regular.triangles.len(), 8);
    assert!(areas(&regular).iter().all(|n| (n.z / n.length() - 1.0 / 3f64.sqrt()).abs() < 1e-12));
    let random = "kind = \"pyramids\", count = [3, 3], fill = [0.5, 0.9], inverted = true, seed = 7";
    let random = mesh("[9000, 9000]", random, &["pyramids"]);
    let [low, high] = heights(&random);
    assert!(high == 0.0 && (-0.9 * 1500.0 * 2f64.sqrt()..-0.5 * 1500.0 * 2f64.sqrt()).contains(&low), "{low}");
    assert!((areas(&random).iter().map(|n| n.z).sum::<f64>() / 2.0 - 81e6).abs() < 1e-3);
}

#[test]
fn particles_are_closed_and_inside_their_layer() {
    let keys = "kind = \"particles\", count = [2, 3, 2], depth_nm = 4000, tilt_deg = 20, seed = 3";
    for (shape, volume) in [
        // A sphere of 320 facets has less than 4/3 π.
        (
            "shape = \"ellipsoid\", radii_nm = [500, 400, 300], subdivisions = 2",
            4.0 / 3.0 * std::f64::consts::PI * 6e7 * 0.95,
        ),
        ("shape = \"flake\", radii_nm = [600, 500, 50]", 1.5 * 3f64.sqrt() * 600.0 * 500.0 * 100.0),
    ] {
        let all =
            mesh("[3000, 5000]", &format!("{keys}, film_nm = 300, {shape}"), &["top", "film", "base", "particle"]);
        assert_eq!(heights(&all), [-4000.0, 300.0]);
        let number = 3; // of `particle`, last in alphabetical order but for `top`
        let particles: Vec<&Triangle> = all.triangles.iter().skip(6).collect();
        assert!(particles.iter().all(|t| t.interface == particles[0].interface && t.interface < number));
        let corner = |v: u32| DVec3::from(all.vertices[v as usize]);
        let found: f64 =
            particles.iter().map(|t| t.vertices.map(corner)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((found / (12.0 * volume) - 1.0).abs() < 0.02, "{shape}: {found} {volume}");
        for triangle in particles {
            for v in triangle.vertices.map(corner) {
                assert!((-4000.0..0.0).contains(&v.z) && (0.0..3000.0).contains(&v.x) && (0.0..5000.0).contains(&v.y));
            }
        }
    }
    let large = format!("{keys}, shape = \"flake\", radii_nm = [900, 900, 50]");
    assert!(refusal("[3000, 5000]", &large, &["top", "base", "particle"]).contains("does not fit its box"));
}

#[test]
fn surfaces_are_refused_by_place() {
    let upper = &["upper"][..];
    let square = "[100, 100]";
    assert!(
        refusal(square, "kind = \"sine\"", upper)
            .starts_with("s.toml:3:20: kind: \"sine\" is unknown; nearest is \"sines\"")
    );
    assert_eq!(
        refusal(square, SINES, &["lower"]),
        "s.toml:3:11: surface: a surface of kind \"sines\" needs an [interface.upper]; add it"
    );
    assert_eq!(
        refusal(square, SINES, &["upper", "side"]),
        "s.toml:3:11: surface: [interface.side] is not of this surface; kind \"sines\" has upper; remove or rename it"
    );
    let coarse = SINES.replace("[96, 64]", "[96, 15]");
    assert!(refusal(square, &coarse, upper).ends_with("grid must be at least 4 times highest, 16 squares"));
    let many = SINES.replace("[96, 64]", "[10000, 10000]");
    assert!(refusal(square, &many, upper).ends_with("200000000 triangles; at most 1000000; use smaller counts"));
    assert!(refusal(square, &SINES.replace("12", "50"), upper).contains("there are only 24 waves with highest = 4"));
    let short = "kind = \"grooves\", points_nm = [[0, 0], [90, 5]]";
    assert!(refusal(square, short, &["grooves"]).ends_with("the profile must reach from x = 0 to x = 100 nm"));
    let far = "kind = \"grooves\", points_nm = [[0, 0], [101, 5]]";
    assert!(refusal(square, far, &["grooves"]).ends_with("x = 101 is outside the period, 0 to 100 nm"));
    let wide = "kind = \"lamellae\", shelves = 3, width_nm = 100, shelf_nm = 6, gap_nm = 13, trunk_nm = 5";
    assert!(refusal(square, wide, &["cuticle"]).contains("less than the period, 100 nm"));
    let oblong = "kind = \"pyramids\", count = [2, 1]";
    assert!(refusal(square, oblong, &["pyramids"]).contains("make count and period_nm of one ratio"));
}
